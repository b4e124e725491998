// SPDX-License-Identifier: Apache-2.0
// The path of one ray through one accelerator, step by step: counters, cell, the rows around the step.
import { drawSides } from './cells.js';
import { element, number, plural } from './text.js';

const AROUND = 7; // rows shown before and after the current one

// Where the ray is in the box, as t; null if it misses it.
export function span(ray, box) {
  let enter = 0, leave = ray.tmax;
  for (let a = 0; a < 3; a++) {
    if (ray.dir[a] === 0) {
      if (ray.org[a] < box.lo[a] || ray.org[a] > box.hi[a]) return null;
      continue;
    }
    const first = (box.lo[a] - ray.org[a]) / ray.dir[a], second = (box.hi[a] - ray.org[a]) / ray.dir[a];
    enter = Math.max(enter, Math.min(first, second));
    leave = Math.min(leave, Math.max(first, second));
  }
  return enter <= leave ? [enter, leave] : null;
}

function subject(data, { form, index }) {
  if (form.of === 'object') return data.nameOf(index);
  if (form.name === 'passed on') return `by ${form.of}`;
  return form.of ? `${form.of} ${index}` : '';
}

function result({ form, t }) {
  if (form.hit) return `hit at ${number(t)}`;
  return form.met === null ? '' : form.met ? 'hit' : 'missed';
}

// The counters after `step` rows; after the last those of the kernel.
export function countsAfter(data, path, step) {
  if (step >= path.rows.length) return path.tally;
  const counts = Object.fromEntries(data.counters.map(({ name }) => [name, 0]));
  for (const { form } of path.rows.slice(0, step)) for (const name of form.counts) counts[name]++;
  return counts;
}

function faceOf(dir) {
  const away = dir.map((value) => -value), axis = [0, 1, 2].reduce((most, a) => Math.abs(away[a]) > Math.abs(away[most]) ? a : most, 0);
  return (away[axis] < 0 ? '-' : '+') + 'xyz'[axis];
}

function cellText(data, accelerator, ray, cell) {
  if (!cell) return ray.kind === 'shadow' || accelerator.cells.length === 0 ? '' :
    `The cubes of cells around the lights are for shadow rays only: they do not answer this ${ray.kind} ray.`;
  if (ray.kind !== 'shadow') return `It is looked up in sample ${cell.number}, which holds ${data.nameOf(cell.object)}.`;
  return `It is looked up in cell ${cell.number} of the cube around light ${ray.source}, on the side ${faceOf(ray.dir)}: ` +
    `a list of ${plural(cell.length, 'object')}${cell.cut ? ', truncated, so a ray that reaches its end is passed on' : ''}.`;
}

function answer(data, ray, path) {
  const blocked = ray.kind === 'shadow';
  if (path.object === null) return blocked ? 'Nothing blocks it.' : 'It hits nothing.';
  return `${blocked ? 'It is blocked by' : 'Its nearest hit is'} ${data.nameOf(path.object)}` +
    (Number.isFinite(path.t) ? `, at t = ${number(path.t)}.` : '.');
}

function sentence(data, ray, path, step) {
  if (path.count === 0) return `Nothing is counted. ${answer(data, ray, path)}`;
  if (step === 0) return `Before the first of ${plural(path.count, 'step')}: press Play or Step.`;
  if (step > path.rows.length) return answer(data, ray, path);
  const row = path.rows[step - 1], said = [row.form.name, subject(data, row), result(row)].filter(Boolean).join(', ');
  const end = step === path.rows.length ? ` ${path.count > path.rows.length ?
    `The page has the first ${path.rows.length} rows of ${path.count}; the counters are those of all.` : ''} ${answer(data, ray, path)}` : '';
  return `${step} of ${path.count}: ${said}.${end}`;
}

function showRow(data, ray, row, i, step) {
  const ends = row.box && row.form.level === 0 ? (span(ray, row.box) ?? [NaN, NaN]).map(number) : ['', ''];
  return element('tr', { 'aria-current': i + 1 === step ? 'step' : null },
    element('td', { class: 'number' }, String(i + 1)), element('td', {}, '\u2003'.repeat(row.form.level) + row.form.name), element('td', {}, subject(data, row)),
    element('td', { class: 'number' }, ends[0]), element('td', { class: 'number' }, ends[1]), element('td', {}, result(row)));
}

const heads = ['', 'event', 'of', 'enters at t', 'leaves at t', 'result'];

// A panel in `place`; its show(ray, path, step, aloud) displays a step, and tells screen readers if `aloud`.
export function makePanel(data, accelerator, place) {
  const counts = element('ul', { class: 'counts' }), cell = element('p', { class: 'meta cell' }), said = element('p', { class: 'said' });
  const sides = element('canvas', { class: 'sides', role: 'img' });
  const caption = element('caption'), body = element('tbody');
  place.append(element('article', { 'aria-label': accelerator.accel }, element('h3', {}, accelerator.accel),
    element('details', {}, element('summary', {}, 'all parameters'), element('p', { class: 'meta' }, accelerator.spec)), cell, sides, counts, said,
  element('div', { class: 'wide', tabindex: 0, role: 'region', 'aria-label': `Rows of ${accelerator.accel}` },
    element('table', { class: 'rows' }, caption, element('thead', {}, element('tr', {}, ...heads.map((head) => element('th', {}, head)))), body))));
  return (ray, path, step, aloud) => {
    const now = countsAfter(data, path, step);
    counts.replaceChildren(...data.counters.filter(({ name }) => name !== 'rays' && name !== 'hits' && path.tally[name] > 0)
      .map(({ name }) => element('li', { 'data-counter': name }, element('b', {}, String(now[name])), ` of ${path.tally[name]} `,
        element('small', {}, name.replaceAll('_', ' ')))));
    cell.textContent = cellText(data, accelerator, ray, path.cell);
    cell.hidden = !cell.textContent;
    const light = path.cell && ray.kind === 'shadow' ? accelerator.cells[ray.source] : null;
    sides.hidden = !light;
    if (light && sides.dataset.cell !== `${ray.source} ${path.cell.number}`) {
      sides.dataset.cell = `${ray.source} ${path.cell.number}`;
      sides.setAttribute('aria-label', `The six sides of the cube around light ${ray.source}; yellow has the longest lists, ` +
        `${plural(light.longest, 'object')}; red is the cell that is looked up`);
      drawSides(data, light, path.cell.number, sides);
    }
    said.setAttribute('aria-live', aloud ? 'polite' : 'off');
    said.textContent = sentence(data, ray, path, Math.min(step, path.rows.length));
    const middle = Math.min(step, path.rows.length), from = Math.max(0, Math.min(middle - 1 - AROUND, path.rows.length - 2 * AROUND - 1));
    const rows = path.rows.slice(from, from + 2 * AROUND + 1);
    caption.textContent = rows.length ? `Rows ${from + 1} to ${from + rows.length} of ${path.count}` : 'No rows';
    body.replaceChildren(...rows.map((row, i) => showRow(data, ray, row, from + i, step)));
  };
}
