// SPDX-License-Identifier: Apache-2.0
// The scene, the structures and the rays in 3-D, drawn by three.js: a view for each accelerator that is shown, all
// from the same camera. The layers of three.js tell them apart: 0 is in every view, 1 + i in that of accelerator i.
import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { COLORS, boxLines, boxFill, lineOf, shade } from './boxes.js';
import { cubeOf } from './cube.js';
import { objectsOf } from './objects.js';
import { element } from './text.js';
import { span } from './walk.js';

const vector = (v) => new THREE.Vector3(...v);
const rowColor = ({ form }) => COLORS[form.hit ? 'hit' : form.of === 'object' ? 'object' : 'step'];

function themeColors() {
  const style = getComputedStyle(document.documentElement), get = (name) => new THREE.Color(style.getPropertyValue(name).trim());
  return { paper: get('--ground'), ink: get('--ink'), primary: get('--primary'), shadow: get('--shadow'), reflection: get('--reflection'),
    transmission: get('--transmission'), swatch: get('--swatch') };
}

// Null, and a message in `place`, without WebGL.
export function makeSpace(data, place) {
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ antialias: true });
  } catch {
    place.append(element('p', { class: 'missing' }, 'This browser shows no WebGL, so the 3-D view is missing. Image, ray tree and paths work.'));
    return null;
  }
  renderer.localClippingEnabled = true;
  renderer.setPixelRatio(Math.min(2, devicePixelRatio));
  renderer.domElement.setAttribute('aria-hidden', 'true');
  place.append(renderer.domElement);
  const scene = new THREE.Scene(), lo = vector(data.scene.lo), hi = vector(data.scene.hi), size = Math.max(1e-6, lo.distanceTo(hi));
  const center = lo.clone().add(hi).multiplyScalar(0.5), from = vector(data.scene.from), at = vector(data.scene.at);
  const camera = new THREE.PerspectiveCamera(data.scene.fov, 1, size / 2000, size * 50);
  camera.up.copy(vector(data.scene.up).normalize());
  const controls = new OrbitControls(camera, renderer.domElement);
  const sun = new THREE.DirectionalLight(0xffffff, 2);
  camera.add(sun);
  sun.position.set(0.4, 0.7, 1);
  sun.layers.enableAll();
  scene.add(camera, new THREE.AmbientLight(0xffffff, 1.2));
  const cut = new THREE.Plane(), look = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide });
  const objects = objectsOf(data, look);
  scene.add(objects);
  for (const light of data.scene.lights) {
    const mark = new THREE.Mesh(new THREE.OctahedronGeometry(size / 120), new THREE.MeshBasicMaterial({ color: shade(COLORS.light) }));
    mark.position.set(...light);
    scene.add(mark);
  }
  const rays = new THREE.Group(), views = [];
  scene.add(rays);
  let colors = themeColors(), shown = [], asked = false;

  const draw = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; paint(); });
  };
  // The views side by side, or one above the other.
  const parts = () => {
    const { clientWidth: width, clientHeight: height } = place, wide = width >= height, count = shown.length || 1;
    return { width, height, list: shown.map((view, i) => wide ? { view, x: i * width / count, y: 0, w: width / count, h: height } :
      { view, x: 0, y: i * height / count, w: width, h: height / count }) };
  };
  const paint = () => {
    const { width, height, list } = parts();
    renderer.setSize(width, height);
    renderer.setScissorTest(true);
    for (const { view, x, y, w, h } of list) {
      renderer.setViewport(x, height - y - h, w, h);
      renderer.setScissor(x, height - y - h, Math.max(1, w - 1), Math.max(1, h - 1));
      renderer.setClearColor(colors.paper);
      camera.aspect = w / h;
      camera.layers.set(0);
      camera.layers.enable(1 + view.number);
      camera.updateProjectionMatrix();
      renderer.render(scene, camera);
    }
  };
  const aim = (eye, target) => {
    camera.position.copy(eye);
    controls.target.copy(target);
    controls.update();
    draw();
  };

  for (const [number, accelerator] of data.accelerators.entries()) {
    const group = new THREE.Group(), steps = new THREE.Group(), name = element('span', { class: 'name', title: accelerator.spec }, accelerator.accel);
    scene.add(group, steps);
    place.append(name);
    views.push({ number, accelerator, group, steps, name });
  }
  const clear = (group) => {
    group.traverse((part) => {
      part.geometry?.dispose();
      part.material?.map?.dispose();
    });
    group.clear();
  };
  // How far from `at` along the unit vector `dir`, at least `least`, no leaf is around the camera.
  const outside = (dir, least) => data.accelerators.flatMap(({ boxList, leastList }) => boxList.filter(({ list }) => list >= leastList))
    .map((box) => span({ org: data.scene.at, dir: dir.toArray(), tmax: Infinity }, box)).filter(Boolean)
    .sort(([a], [b]) => a - b).reduce((distance, [enter, leave]) => enter <= distance && distance <= leave ? 1.05 * leave : distance, least);
  const onLayer = (group, number) => group.traverse((part) => part.layers.set(1 + number));
  const space = {
    draw,
    whole: () => aim(center.clone().add(from.clone().sub(at).normalize().multiplyScalar(1.1 * size)), center),
    eye: () => aim(from, at),
    // Beside the eye, where primary rays are not seen end-on.
    aside() {
      const dir = from.clone().sub(at).normalize().applyAxisAngle(camera.up, -0.6);
      aim(at.clone().addScaledVector(dir, outside(dir, 1.2 * from.distanceTo(at))), at);
    },
    // From the side, so that the ray is seen in its length.
    closer(ray) {
      const end = vector(ray.org).addScaledVector(vector(ray.dir), Number.isFinite(ray.t) ? ray.t : 0), to = vector(ray.dir).normalize();
      const aside = new THREE.Vector3().crossVectors(to, camera.up).normalize();
      aim(end.clone().addScaledVector(aside, size / 4).addScaledVector(to, -size / 8).addScaledVector(camera.up, size / 12), end);
    },
    show(numbers) {
      shown = views.filter(({ number }) => numbers.includes(number));
      const { width, height, list } = parts();
      for (const view of views) view.name.hidden = true;
      for (const { view, x, y } of list) {
        view.name.hidden = false;
        view.name.style.left = `${100 * x / width + 1}%`;
        view.name.style.top = `calc(${100 * y / height}% + .4rem)`;
        view.name.style.maxWidth = list.length > 1 && x + y > 0 || list.length > 1 && list[1].y === 0 ? '48%' : '96%';
      }
      draw();
    },
    // The boxes of a structure: {levels: [from, to], leaves, axis, position, list}.
    boxes(number, choice) {
      const { group, accelerator } = views[number];
      clear(group);
      const list = choice.boxes === 'path' ? [] : accelerator.boxList.filter((box) =>
        box.depth >= choice.levels[0] && box.depth <= choice.levels[1] && box.list >= (choice.boxes === 'all' ? -1 : choice.boxes === 'leaves' ? 0 : accelerator.leastList) &&
        (choice.axis < 0 || (box.lo[choice.axis] <= choice.position && box.hi[choice.axis] >= choice.position)));
      if (list.length) group.add(boxLines(list.map((box) => ({ ...box, color: accelerator.colorOf(box.depth) })), list.length > 3000 ? 0.35 : 0.8));
      onLayer(group, number);
      draw();
      return list.length;
    },
    slice(axis, position) {
      cut.normal.set(0, 0, 0).setComponent(axis < 0 ? 0 : axis, -1);
      cut.constant = position;
      objects.traverse((part) => { if (part.material) part.material.clippingPlanes = axis < 0 ? null : [cut]; });
      draw();
    },
    objects(how) {
      objects.visible = how !== 'none';
      objects.traverse(({ material }) => {
        if (!material || material.isShaderMaterial) return;
        Object.assign(material, { transparent: how === 'clear', opacity: how === 'clear' ? 0.28 : 1, depthWrite: how !== 'clear' });
        material.needsUpdate = true;
      });
      draw();
    },
    // The ray tree; the chosen ray is thick.
    tree(tree, chosen) {
      clear(rays);
      tree.forEach((ray, i) => {
        const far = Number.isFinite(ray.t) ? ray.t : Number.isFinite(ray.tmax) ? ray.tmax : size / Math.hypot(...ray.dir) / 2;
        const line = lineOf(ray, 0, far, colors[ray.kind] ?? colors.ink, i === chosen ? 1 : 0.55);
        rays.add(line);
        if (i === chosen && Number.isFinite(ray.t) && ray.kind !== 'shadow') {
          const point = new THREE.BufferGeometry().setFromPoints([vector(ray.org).addScaledVector(vector(ray.dir), ray.t)]);
          rays.add(new THREE.Points(point, new THREE.PointsMaterial({ color: colors[ray.kind], size: 9, sizeAttenuation: false, depthTest: false })));
        }
      });
      draw();
    },
    // Boxes of the rows up to `step`, the current one filled.
    step(number, ray, path, step) {
      const { steps, accelerator } = views[number], before = path.rows.slice(0, step).filter(({ box }) => box), row = path.rows[step - 1];
      clear(steps);
      if (before.length) steps.add(boxLines(before.slice(-400).map((each) => ({ ...each.box, color: rowColor(each) })), 0.6));
      if (row?.box) {
        const inside = span(ray, row.box);
        steps.add(boxFill(row.box, rowColor(row), row.form.round));
        if (inside) steps.add(lineOf(ray, inside[0], Math.min(inside[1], inside[0] + 4 * size), shade(rowColor(row)), 1));
      }
      const light = path.cell && ray.kind === 'shadow' ? accelerator.cells[ray.source] : null;
      if (light) steps.add(cubeOf(data, light, path.cell.number, data.scene.lights[ray.source], Math.min(size / 8, 0.4 * at.distanceTo(vector(data.scene.lights[ray.source])))));
      onLayer(steps, number);
      draw();
    },
  };
  controls.addEventListener('change', draw);
  new ResizeObserver(() => space.show(shown.map(({ number }) => number))).observe(place);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { colors = themeColors(); draw(); });
  place.addEventListener('keydown', (event) => {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const zoom = { '+': 0.85, '=': 0.85, '-': 1 / 0.85 }[event.key];
    if (!turns && !zoom) return;
    event.preventDefault();
    const offset = camera.position.clone().sub(controls.target);
    if (zoom) offset.multiplyScalar(zoom);
    if (turns) {
      offset.applyAxisAngle(camera.up, 0.12 * turns[0]);
      offset.applyAxisAngle(new THREE.Vector3().crossVectors(camera.up, offset).normalize(), 0.12 * turns[1]);
    }
    aim(controls.target.clone().add(offset), controls.target);
  });
  space.aside();
  return space;
}
