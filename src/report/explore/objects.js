// SPDX-License-Identifier: Apache-2.0
// The objects of the scene in a few meshes: spheres as instances, triangles merged, CSG trees as their boxes.
import * as THREE from 'three';
import { boxLines } from './boxes.js';

function spheresOf(spheres, color, look) {
  const fine = spheres.length > 20000 ? 6 : spheres.length > 2000 ? 10 : 24, place = new THREE.Matrix4();
  const mesh = new THREE.InstancedMesh(new THREE.SphereGeometry(1, fine, fine >> 1), look, spheres.length);
  spheres.forEach(({ at: [x, y, z, radius], material }, i) => {
    mesh.setMatrixAt(i, place.makeScale(radius, radius, radius).setPosition(x, y, z));
    mesh.setColorAt(i, color[material]);
  });
  return mesh;
}

function trianglesOf(triangles, color, look) {
  const corners = new Float32Array(9 * triangles.length), colors = new Float32Array(9 * triangles.length);
  triangles.forEach(({ at, material }, i) => {
    corners.set(at, 9 * i);
    for (let k = 0; k < 3; k++) color[material].toArray(colors, 9 * i + 3 * k);
  });
  const geometry = new THREE.BufferGeometry(), tinted = look.clone();
  geometry.setAttribute('position', new THREE.BufferAttribute(corners, 3));
  geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
  geometry.computeVertexNormals();
  tinted.vertexColors = true;
  return new THREE.Mesh(geometry, tinted);
}

export function objectsOf(data, look) {
  const group = new THREE.Group(), color = data.scene.materials.map((c) => new THREE.Color(...c));
  const { spheres, triangles, boxes } = data.objects;
  if (spheres.length) group.add(spheresOf(spheres, color, look));
  if (triangles.length) group.add(trianglesOf(triangles, color, look));
  if (boxes.length)
    group.add(boxLines(boxes.map(({ at, material }) => ({ lo: at.slice(0, 3), hi: at.slice(3), color: color[material].clone().convertLinearToSRGB().toArray() }))));
  return group;
}
