// SPDX-License-Identifier: Apache-2.0
// Outlines of boxes as one draw call, a filled box or ball, and lines along rays.
import * as THREE from 'three';

// What boxes on the path of a ray show, and lights, in sRGB; main.js has the legend.
export const COLORS = { step: [0.18, 0.51, 0.97], object: [0.94, 0.5, 0], hit: [0.88, 0.13, 0.06], light: [0.95, 0.72, 0] };

// The twelve edges of the unit cube.
const edges = [];
for (let axis = 0; axis < 3; axis++) {
  for (const [u, v] of [[0, 0], [0, 1], [1, 0], [1, 1]]) {
    for (const along of [0, 1]) {
      const point = [0, 0, 0];
      point[axis] = along;
      point[(axis + 1) % 3] = u;
      point[(axis + 2) % 3] = v;
      edges.push(...point);
    }
  }
}

const outline = {
  vertexShader: `attribute vec3 lo, hi, tint; varying vec3 shade;
    void main() { shade = tint; gl_Position = projectionMatrix * modelViewMatrix * vec4(mix(lo, hi, position), 1.0); }`,
  fragmentShader: 'uniform float opacity; varying vec3 shade; void main() { gl_FragColor = vec4(shade, opacity); }',
};

// boxes: [{lo, hi, color: [r, g, b] in sRGB}]
export function boxLines(boxes, opacity = 1) {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(edges, 3));
  for (const [name, key] of [['lo', 'lo'], ['hi', 'hi'], ['tint', 'color']])
    geometry.setAttribute(name, new THREE.InstancedBufferAttribute(Float32Array.from(boxes.flatMap((box) => box[key])), 3));
  geometry.instanceCount = boxes.length;
  const lines = new THREE.LineSegments(geometry, new THREE.ShaderMaterial({ ...outline, uniforms: { opacity: { value: opacity } },
    transparent: opacity < 1, depthWrite: opacity === 1 }));
  lines.frustumCulled = false;
  return lines;
}

export const shade = (color) => new THREE.Color().setRGB(...color, THREE.SRGBColorSpace);

export function boxFill({ lo, hi }, color, round) {
  const extent = lo.map((value, a) => Math.max(hi[a] - value, 1e-6)), middle = lo.map((value, a) => (value + hi[a]) / 2);
  const mesh = new THREE.Mesh(round ? new THREE.SphereGeometry(0.5, 24, 16) : new THREE.BoxGeometry(),
    new THREE.MeshBasicMaterial({ color: shade(color), transparent: true, opacity: 0.22, depthWrite: false, side: THREE.DoubleSide }));
  mesh.scale.set(...extent);
  mesh.position.set(...middle);
  return mesh;
}

// The ray from t = `from` to t = `to`.
export function lineOf(ray, from, to, color, opacity) {
  const points = [from, to].flatMap((t) => ray.org.map((value, a) => value + t * ray.dir[a]));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
  const line = new THREE.Line(geometry, new THREE.LineBasicMaterial({ color, transparent: true, opacity, depthTest: opacity < 1 }));
  line.renderOrder = opacity < 1 ? 0 : 1;
  return line;
}
