// SPDX-License-Identifier: Apache-2.0
// raytally's explorer: which pixel, ray and step are shown, and all that follows from it.
import { COLORS } from './boxes.js';
import { load } from './data.js';
import { makePicker } from './picker.js';
import { makeSpace } from './space.js';
import { byId, element, number, plural } from './text.js';
import { markRay, rayName, showTerms, showTree } from './tree.js';
import { makePanel } from './walk.js';

const data = await load();
const state = { tree: [], color: [0, 0, 0], ray: 0, step: 0, playing: 0, shown: data.accelerators.map((_, i) => i).slice(0, 2) };
const depths = data.accelerators.map(({ boxList }) => boxList.reduce((most, { depth }) => Math.max(most, depth), 0));
const dark = matchMedia('(prefers-color-scheme: dark)');
const deepest = Math.max(0, ...depths);
for (const accelerator of data.accelerators) {
  // Yellow for the first level, as in the pictures of `render --structure`; lighter on a dark page.
  accelerator.colorOf = (depth) => data.scale[Math.round((data.scale.length - 1) * (1 - depth / (deepest || 1)))]
    .map((c) => dark.matches ? 0.4 + 0.6 * c / 255 : c / 255);
  // Some structures do not tell the lengths of their lists.
  accelerator.leastList = accelerator.boxList.some(({ list }) => list > 0) ? 1 : 0;
}
const space = makeSpace(data, byId('space'));

/* ---- about the page ---- */

function about() {
  const every = data.stride === 1 ? 'of all pixels' : `of one pixel in ${data.stride} x ${data.stride}; a click takes the nearest`;
  const notes = [`${data.width} x ${data.height} pixels, ray trees of ${plural(data.depth, 'level')}, ${plural(data.scene.objects, 'object')}.`,
    `The page has ${data.rays} rays ${every}.`];
  if (data.cut) notes.push(`${plural(data.cut, 'path')} had more than ${data.most_rows} rows, of which the first are here.`);
  if (data.scene.shown_every > 1) notes.push(`The 3-D view shows one object in ${data.scene.shown_every}.`);
  for (const { accel, boxes, boxes_shown: shown, boxes_of: of, thinned_level: level, thinned_every: every_ } of data.accelerators) {
    if (!of) notes.push(`${accel} has no boxes to draw.`);
    else if (shown < boxes) notes.push(`The 3-D view shows ${shown} of ${boxes} boxes of ${of}: of level ${level} ${every_ ? `one in ${every_}` : 'none'}, and none below.`);
  }
  byId('about').textContent = notes.join(' ');
  byId('words').append(...data.counters.flatMap(({ name, meaning }) => [element('dt', {}, name.replaceAll('_', ' ')), element('dd', {}, meaning)]));
}

/* ---- one ray, step by step ---- */

let panels = [];
const calm = matchMedia('(prefers-reduced-motion: reduce)');

function ray() {
  return state.tree[state.ray];
}

function steps() {
  return ray() ? Math.max(0, ...state.shown.map((i) => ray().paths[i].rows.length)) : 0;
}

function showStep(step, aloud = true) {
  state.step = Math.min(Math.max(step, 0), steps());
  byId('step').value = state.step;
  byId('step-said').textContent = `${state.step} of ${steps()}`;
  byId('step').setAttribute('aria-valuetext', `step ${state.step} of ${steps()}`);
  for (const { number: i, show } of panels) {
    const path = ray().paths[i], at = Math.min(state.step, path.rows.length);
    show(ray(), path, at, aloud);
    space?.step(i, ray(), path, at);
  }
}

function play(on) {
  clearInterval(state.playing);
  state.playing = 0;
  byId('play').setAttribute('aria-pressed', String(on));
  byId('play').textContent = on ? 'Pause' : 'Play';
  if (!on) return;
  if (state.step >= steps()) showStep(0, false);
  state.playing = setInterval(() => {
    showStep(state.step + 1, false);
    if (state.step >= steps()) play(false);
  }, calm.matches ? 700 : Math.max(30, Math.min(400, 12000 / steps())));
}

function chooseRay(i) {
  play(false);
  state.ray = i;
  const at = (v) => `(${v.map(number).join(', ')})`;
  markRay(i);
  showTerms(state.tree, state.color, i);
  byId('ray-said').textContent = ray() ? `${rayName(ray())}, from ${at(ray().org)} along ${at(ray().dir)}` : 'There is no ray.';
  byId('step').max = steps();
  space?.tree(state.tree, i);
  if (ray()) showStep(0);
}

function choosePixel(column, row) {
  const x = column * data.stride + (data.stride >> 1), y = row * data.stride + (data.stride >> 1);
  ({ rays: state.tree, color: state.color } = data.pixel(column, row));
  mark(column, row, `${row < data.rows ? `pixel ${x},${y}` : 'the given ray'}: ${plural(state.tree.length, 'ray')}, ${data.nameOf(state.tree[0]?.object ?? null)}`);
  showTree(data, state.tree, 0, chooseRay);
  chooseRay(0);
}

/* ---- which accelerators, and how their structures are drawn ---- */

function showAccelerators() {
  byId('walks').replaceChildren();
  panels = state.shown.map((i) => ({ number: i, show: makePanel(data, data.accelerators[i], byId('walks')) }));
  space?.show(state.shown);
}

function choices() {
  if (data.accelerators.length < 2) return;
  const select = (place) => {
    const made = element('select', { 'aria-label': place ? 'second accelerator' : 'accelerator' },
      ...(place ? [element('option', { value: -1 }, 'none')] : []), ...data.accelerators.map(({ accel }, i) => element('option', { value: i }, accel)));
    made.value = String(state.shown[place]);
    return made;
  };
  const both = [select(0), select(1)];
  for (const each of both) {
    each.addEventListener('change', () => {
      play(false);
      state.shown = [...new Set(both.map(({ value }) => Number(value)).filter((i) => i >= 0))];
      showAccelerators();
      chooseRay(state.ray);
    });
    byId('choice').append(each);
  }
}

function showColors() {
  const css = (color) => `rgb(${color.map((c) => Math.round(255 * c)).join(', ')})`, { colorOf } = data.accelerators[0];
  const meanings = [[`linear-gradient(to right, ${css(colorOf(0))}, ${css(colorOf(deepest))})`, `boxes of levels 0 to ${deepest}`],
    [css(COLORS.step), 'on the path of the ray, the current one filled'], [css(COLORS.object), 'a tested object'], [css(COLORS.hit), 'a hit'], [css(COLORS.light), 'a light']];
  byId('colors').replaceChildren(...meanings.map(([color, meaning]) =>
    element('span', { class: 'group' }, element('span', { class: 'swatch', style: `background: ${color}` }), meaning)));
}

function showBoxes() {
  showColors();
  const axis = ['x', 'y', 'z'].indexOf(byId('axis').value), { lo, hi } = data.scene;
  const position = axis < 0 ? 0 : lo[axis] + Number(byId('slice').value) * (hi[axis] - lo[axis]);
  const choice = { boxes: byId('boxes').value, levels: [Number(byId('from-level').value), Number(byId('to-level').value)], axis, position };
  byId('slice').disabled = axis < 0;
  byId('slice').setAttribute('aria-valuetext', number(position));
  space.slice(axis, position);
  const drawn = data.accelerators.map((_, i) => space.boxes(i, choice));
  const missing = data.accelerators.filter(({ thinned_level: level }) => level !== null).map(({ boxes_of: of, thinned_level: level }) =>
    ` The page has no boxes of ${of} below level ${level}: deeper leaves are missing.`);
  byId('legend').textContent = `Boxes drawn: ${data.accelerators.map(({ accel, boxes_of: of }, i) => `${of ?? accel} ${drawn[i]}`).join(', ')}` +
    (axis < 0 ? '.' : `, cut by ${'xyz'[axis]} = ${number(position)}.`) + missing.join('');
}

// The last level shown at first: where leaves would hide each other, upper levels with inner nodes give an overview.
function firstLevel() {
  const MOST = 400, LEAST_LEVEL = 2;
  const count = (belongs) => Math.max(0, ...data.accelerators.map(({ boxList, leastList }) => boxList.filter((box) => belongs(box, leastList)).length));
  let level = deepest;
  if (count(({ list }, least) => list >= least) < MOST) return level;
  while (level > LEAST_LEVEL && count(({ depth }) => depth <= level) > MOST) level--;
  return level;
}

function connectSpace() {
  if (!space) {
    byId('shown').hidden = true;
    byId('space-help').hidden = true;
    byId('space').removeAttribute('role');
    return;
  }
  byId('to-level').value = firstLevel();
  if (Number(byId('to-level').value) < deepest) byId('boxes').value = 'all';
  for (const id of ['from-level', 'to-level']) byId(id).max = deepest;
  byId('shown').addEventListener('submit', (event) => event.preventDefault());
  byId('shown').addEventListener('input', (event) => event.target.id === 'objects' ? space.objects(event.target.value) : showBoxes());
  byId('from-eye').addEventListener('click', space.eye);
  byId('aside').addEventListener('click', space.aside);
  byId('whole').addEventListener('click', space.whole);
  byId('closer').addEventListener('click', () => ray() && space.closer(ray()));
  dark.addEventListener('change', showBoxes);
  space.objects('clear');
  showBoxes();
}

const mark = makePicker(data, choosePixel);
about();
choices();
showAccelerators();
connectSpace();
byId('player').addEventListener('submit', (event) => event.preventDefault());
byId('first').addEventListener('click', () => { play(false); showStep(0); });
byId('back').addEventListener('click', () => { play(false); showStep(state.step - 1); });
byId('on').addEventListener('click', () => { play(false); showStep(state.step + 1); });
byId('last').addEventListener('click', () => { play(false); showStep(steps()); });
byId('play').addEventListener('click', () => play(!state.playing));
byId('step').addEventListener('input', () => { play(false); showStep(Number(byId('step').value)); });
const showGiven = () => choosePixel(0, data.rows); // recorded as the pixel after the last
byId('given').hidden = !data.given;
byId('given').addEventListener('click', showGiven);
if (data.given) showGiven();
else choosePixel(data.columns >> 1, data.rows >> 1);
