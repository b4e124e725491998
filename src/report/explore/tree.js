// SPDX-License-Identifier: Apache-2.0
// The ray tree of a pixel as a table, and what its item buffer sample saw.
import { byId, element, number, srgb } from './text.js';

// What each ray and all rays below it add to the pixel; children follow their parents.
function sums(tree) {
  const light = tree.map((ray) => [...ray.added]);
  for (let i = tree.length; i-- > 0;)
    if (tree[i].parent >= 0) light[tree[i].parent] = light[tree[i].parent].map((value, c) => value + light[i][c]);
  return light;
}

export const rayName = (ray) => ray.kind === 'shadow' ? `shadow ray to light ${ray.source}` :
  ray.kind === 'reflection' && ray.total ? 'reflection ray (total)' : `${ray.kind} ray`;

function note(ray) {
  if (ray.kind === 'shadow') return ray.object === null ? 'lit' : 'in shadow';
  if (ray.object === null) return 'background';
  return ray.cut ? 'the depth is reached' : '';
}

// Calls choose(number of the ray).
export function showTree(data, tree, chosen, choose) {
  const light = sums(tree), body = byId('tree').tBodies[0];
  body.replaceChildren(...tree.map((ray, i) => {
    const depth = ray.level - (ray.kind === 'shadow' ? 0 : 1), color = light[i].map(number).join(', ');
    const button = element('button', { type: 'button', style: `margin-left: ${depth * 1.4}em` },
      element('span', { class: 'kind', style: `--kind: var(--${ray.kind})` }), rayName(ray));
    button.addEventListener('click', () => choose(i));
    return element('tr', { 'data-ray': i, 'aria-current': i === chosen ? 'true' : null }, element('td', {}, button),
      element('td', {}, ray.object === null ? '-' : data.nameOf(ray.object)), element('td', { class: 'number' }, number(ray.t)),
      element('td', {}, element('span', { class: 'swatch', style: `background: ${srgb(light[i])}` }), color),
      element('td', {}, note(ray)));
  }));
  showSample(data, tree[0]);
}

export function markRay(chosen) {
  for (const row of byId('tree').tBodies[0].rows) {
    if (Number(row.dataset.ray) === chosen) row.setAttribute('aria-current', 'true');
    else row.removeAttribute('aria-current');
  }
}

// The objects that compete for the sample, if an item buffer answers it.
function showSample(data, primary) {
  const place = byId('sample');
  place.replaceChildren();
  if (!primary || !primary.paths.some(({ cell }) => cell)) return;
  const items = data.accelerators.flatMap(({ spec }, i) => primary.paths[i].cell ? [[spec, primary.paths[i].cell]] : []);
  place.append(element('h3', {}, 'The sample in the item buffer'),
    ...items.map(([spec, cell]) => element('p', {}, `${spec}: sample ${cell.number} holds ${data.nameOf(cell.object)}.`)));
  if (primary.candidates.length === 0) return;
  place.append(element('div', { class: 'wide', tabindex: 0, role: 'region', 'aria-label': 'Objects that compete for the sample' }, element('table', {},
    element('caption', {}, 'Objects that compete for the sample: the z-buffer keeps the nearest'),
    element('thead', {}, element('tr', {}, element('th', {}, 'object'), element('th', { class: 'number' }, 'depth t'), element('th', {}, ''))),
    element('tbody', {}, ...primary.candidates.map(({ object, t }, i) => element('tr', {}, element('td', {}, data.nameOf(object)),
      element('td', { class: 'number' }, number(t)), element('td', {}, i === 0 ? 'kept' : 'hidden')))))));
}
