// SPDX-License-Identifier: Apache-2.0
// The cube of cells around a light in 3-D, its sides half `reach` away.
import * as THREE from 'three';
import { sidePixels } from './cells.js';

export function cubeOf(data, light, marked, at, reach) {
  const group = new THREE.Group();
  for (let side = 0; side < 6; side++) {
    const axis = side >> 1, texture = new THREE.DataTexture(sidePixels(data, light, side, marked), data.cell_map, data.cell_map);
    const corners = [[0, 0], [1, 0], [1, 1], [0, 0], [1, 1], [0, 1]], points = corners.flatMap(([u, v]) => {
      const offset = [0, 0, 0];
      offset[axis] = side & 1 ? 1 : -1;
      offset[(axis + 1) % 3] = 2 * u - 1;
      offset[(axis + 2) % 3] = 2 * v - 1;
      return offset.map((value, a) => at[a] + reach * value / 2);
    });
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(points, 3));
    geometry.setAttribute('uv', new THREE.Float32BufferAttribute(corners.flat(), 2));
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.needsUpdate = true;
    group.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide, transparent: true, opacity: 0.75 })));
  }
  return group;
}
