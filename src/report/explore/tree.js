// SPDX-License-Identifier: Apache-2.0
// The ray tree of a pixel as a table, the five terms of a ray, and what its item buffer sample saw.
import { TERMS } from './light.js';
import { byId, element, number, srgb } from './text.js';

export const rayName = (ray) => ray.kind === 'shadow' ? `shadow ray to light ${ray.source}` :
  ray.kind === 'reflection' && ray.total ? 'reflection ray (total)' : `${ray.kind} ray`;

function note(ray) {
  if (ray.kind === 'shadow') return ray.object === null ? 'lit' : 'in shadow';
  if (ray.object === null) return 'background';
  return ray.cut ? 'depth reached' : '';
}

const swatch = (color) => element('span', { class: 'swatch', style: `background: ${srgb(color)}` });

// Calls choose(number of the ray).
export function showTree(data, tree, chosen, choose) {
  const body = byId('tree').tBodies[0];
  body.replaceChildren(...tree.map((ray, i) => {
    const depth = ray.level - (ray.kind === 'shadow' ? 0 : 1);
    const button = element('button', { type: 'button', style: `margin-left: ${depth * 1.4}em` },
      element('span', { class: 'kind', style: `--kind: var(--${ray.kind})` }), rayName(ray));
    button.addEventListener('click', () => choose(i));
    return element('tr', { 'data-ray': i, 'aria-current': i === chosen ? 'true' : null }, element('td', {}, button),
      element('td', {}, ray.object === null ? '-' : data.nameOf(ray.object)), element('td', { class: 'number' }, number(ray.t)),
      element('td', { class: 'light', title: ray.light.join(' ') }, swatch(ray.light), ray.light.map((value) => value.toFixed(4)).join(' ')),
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

const FORMULAS = { ambient: 'ka Ia', diffuse: 'kd (N.L)', specular: 'ks (R.V)^shine', reflected: 'kr Ir', transmitted: 'kt It' };

function lightRow(name, formula, color) {
  return element('tr', {}, element('th', { scope: 'row' }, name, ' ', element('small', {}, formula)), element('td', {}, swatch(color)),
    ...color.map((value) => element('td', { class: 'number', title: String(value) }, value.toFixed(4))));
}

// The light of a ray as the sum of its terms; of the primary ray also the colour of the pixel.
export function showTerms(tree, color, chosen) {
  const ray = tree[chosen], place = byId('terms');
  place.replaceChildren();
  if (!ray) return;
  const shadow = ray.kind === 'shadow', background = !shadow && ray.object === null;
  const terms = background ? [] : shadow ? ['diffuse', 'specular'] : TERMS;
  const formula = (term) => FORMULAS[term] + (!shadow && ['diffuse', 'specular'].includes(term) ? ', all lights' : '');
  place.append(element('table', {},
    element('caption', {}, `The light that the ${rayName(ray)} brings, and its terms, as shares of the colour of the pixel`),
    element('thead', {}, element('tr', {}, element('th', {}, 'term'), element('th', {}, ''), ...['red', 'green', 'blue'].map((name) =>
      element('th', { class: 'number' }, name)))),
    element('tbody', {}, ...terms.map((term) => lightRow(term, formula(term), ray.terms[term])), lightRow(background ? 'background' : 'sum', '', ray.light))));
  if (chosen === 0)
    place.append(element('p', { class: 'meta', id: 'color', title: color.join(' ') }, `The renderer adds what each ray of the tree brings from its own hit or light, ` +
      `in float32 and in the order in which it traced them: ${color.map((value) => value.toFixed(4)).join(' ')}, the colour.`));
}

// The objects that compete for the sample, if an item buffer answers it.
function showSample(data, primary) {
  const place = byId('sample');
  place.replaceChildren();
  if (!primary || !primary.paths.some(({ cell }) => cell)) return;
  const items = data.accelerators.flatMap(({ accel }, i) => primary.paths[i].cell ? [[accel, primary.paths[i].cell]] : []);
  place.append(element('h3', {}, 'The sample in the item buffer'),
    ...items.map(([accel, cell]) => element('p', {}, `${accel}: sample ${cell.number} holds ${data.nameOf(cell.object)}.`)));
  if (primary.candidates.length === 0) return;
  place.append(element('div', { class: 'wide', tabindex: 0, role: 'region', 'aria-label': 'Objects that compete for the sample' }, element('table', {},
    element('caption', {}, 'Objects that compete for the sample: the z-buffer keeps the nearest'),
    element('thead', {}, element('tr', {}, element('th', {}, 'object'), element('th', { class: 'number' }, 'depth t'), element('th', {}, ''))),
    element('tbody', {}, ...primary.candidates.map(({ object, t }, i) => element('tr', {}, element('td', {}, data.nameOf(object)),
      element('td', { class: 'number' }, number(t)), element('td', {}, i === 0 ? 'kept' : 'hidden')))))));
}
