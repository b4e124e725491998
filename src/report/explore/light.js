// SPDX-License-Identifier: Apache-2.0
// The light of the rays of a pixel, and the five terms of the illumination model that it is the sum of, by the operations of
// src/render/ray_tree.c in their order.

export const TERMS = ['ambient', 'diffuse', 'specular', 'reflected', 'transmitted'];

const add = (a, b) => a.map((value, c) => value + b[c]);

// What the ray itself adds, by terms: a shadow ray the light that it sees, another one the ambient light of its hit.
function ownTerms(ray) {
  const terms = Object.fromEntries(TERMS.map((term) => [term, [0, 0, 0]]));
  if (ray.kind !== 'shadow') terms.ambient = ray.object === null ? [0, 0, 0] : ray.added;
  else if (ray.object === null) Object.assign(terms, { diffuse: ray.diffuse, specular: ray.added.map((value, c) => value - ray.diffuse[c]) });
  return terms;
}

function joinParent({ terms }, ray) {
  const own = ray.kind === 'shadow' ? ['diffuse', 'specular'] : [ray.kind === 'transmission' ? 'transmitted' : 'reflected'];
  for (const term of own) terms[term] = add(terms[term], ray.kind === 'shadow' ? ray.terms[term] : ray.light);
}

// Takes the rays of a pixel in the order in which the renderer adds their light. Gives each its terms and its light, and returns them
// depth first, as `raytally trace --depth` numbers them, with the colour of the pixel: the sum in float32.
export function light(rays) {
  const color = rays.reduce((sum, { added }) => add(sum, added).map(Math.fround), [0, 0, 0]);
  for (const ray of rays) Object.assign(ray, { terms: ownTerms(ray), children: [] });
  for (const ray of rays) rays[ray.parent]?.children.push(ray);
  for (let i = rays.length; i-- > 0;) {
    const ray = rays[i], background = ray.kind !== 'shadow' && ray.object === null;
    ray.light = TERMS.reduce((sum, term) => add(sum, ray.terms[term]), background ? ray.added : [0, 0, 0]);
    if (ray.parent >= 0) joinParent(rays[ray.parent], ray);
  }
  const list = [], visit = (ray) => { list.push(ray); ray.children.forEach(visit); };
  rays.slice(0, 1).forEach(visit);
  return { color, rays: list };
}
