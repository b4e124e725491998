// SPDX-License-Identifier: Apache-2.0
// check_explorer.mjs PROGRAM [AXE]: writes pages by `raytally explore` and drives them in Chromium; what they show must be what
// `raytally trace` prints. Says what does not hold; exit code 1 where anything does not.
import { execFileSync } from 'node:child_process';
import { statSync } from 'node:fs';
import { resolve } from 'node:path';
import { judgeByAxe, judgeLogs, makeJudge, openBrowser, sleep } from './browser.mjs';

const [program, axe] = process.argv.slice(2).map((path) => resolve(path));
const browser = await openBrowser(), judge = makeJudge(), { holds } = judge;
const scene = 'balls:size=2', size = '40x30', url = (page) => `file://${resolve(page)}`;

function explore(page, accels, ...more) {
  exploreScene(scene, page, accels, ...more);
}

function exploreScene(of, page, accels, ...more) {
  execFileSync(program, ['explore', of, '--size', size, '--depth', '3', ...accels.flatMap((spec) => ['--accel', spec]), '-o', page, ...more]);
}

const trace = (x, y, accel, ...more) => JSON.parse(execFileSync(program,
  ['trace', scene, '--size', size, '--pixel', `${x},${y}`, '--accel', accel, '--json', ...more]));

// The rays of a tree, depth first.
const flat = (ray) => [ray, ...ray.rays.flatMap(flat)];

async function open(page) {
  await browser.open(url(page));
  for (let i = 0; i < 100 && !(await browser.run("return document.querySelector('#tree tbody tr') !== null;")); i++) await sleep(50);
}

const choosePixel = (x, y) => browser.run(`document.querySelector('#pixel-x').value = arguments[0];
  document.querySelector('#pixel-y').value = arguments[1]; document.querySelector('#pixel').requestSubmit();`, x, y);
// A frame without the objects takes little time, also where it is drawn in software.
const hideObjects = () => browser.run(`const at = document.querySelector('#objects'); at.value = 'none';
  at.dispatchEvent(new Event('input', { bubbles: true }));`);
const press = (id) => browser.run('document.getElementById(arguments[0]).click();', id);
const chooseRay = (i) => browser.run("document.querySelector('#tree tr[data-ray=\"' + arguments[0] + '\"] button').click();", i);

// What the page shows: rays, and of each panel its counters so far and in all, and what it says.
const shown = () => browser.run(`const text = (element) => element.textContent;
  return { said: text(document.querySelector('#pixel-said')), step: text(document.querySelector('#step-said')),
    rays: [...document.querySelectorAll('#tree tbody tr')].map((row) => [...row.cells].map(text)),
    sample: text(document.querySelector('#sample')),
    panels: [...document.querySelectorAll('#walks article')].map((panel) => ({ name: panel.getAttribute('aria-label'),
      counts: Object.fromEntries([...panel.querySelectorAll('[data-counter]')].map((item) =>
        [item.dataset.counter, [Number(text(item.querySelector('b'))), Number(item.textContent.match(/ of ([0-9]+)/)[1])]])),
      cell: text(panel.querySelector('.cell')), said: text(panel.querySelector('.said')),
      live: panel.querySelector('.said').getAttribute('aria-live'),
      current: panel.querySelector('tr[aria-current]')?.textContent ?? '' })) };`);

// The terms of the chosen ray by name, "sum" the last, each [red, green, blue] with all digits; and the colour of the pixel.
const light = () => browser.run(`return { color: document.querySelector('#color')?.title.split(' ').map(Number),
  terms: Object.fromEntries([...document.querySelectorAll('#terms tbody tr')].map((row) => [row.cells[0].textContent.split(' ')[0],
    [...row.cells].slice(2).map(({ title }) => Number(title))])) };`);

const counters = (tally) => Object.fromEntries(Object.entries(tally).filter(([name, value]) => value > 0 && name !== 'rays' && name !== 'hits'));
const same = (a, b) => JSON.stringify(Object.entries(a).sort()) === JSON.stringify(Object.entries(b).sort());
const sums = (panel, which) => Object.fromEntries(Object.entries(panel.counts).map(([name, both]) => [name, both[which]]));

async function checkTree(accels) {
  const x = 22, y = 17;
  await choosePixel(x, y);
  const expected = accels.map((accel) => flat(trace(x, y, accel, '--depth', '3').tree));
  const page = await shown();
  holds(page.said.startsWith(`pixel ${x},${y}: ${expected[0].length} rays`), `the page says which pixel it shows: ${page.said}`);
  holds(page.rays.length === expected[0].length && expected[0].length > 3, `it shows the rays of the tree: ${page.rays.length}`);
  expected[0].forEach((ray, i) => {
    const [name, object, t] = page.rays[i];
    holds(name.startsWith(ray.kind) && (ray.object === null || object === `object ${ray.object}, ${ray.shape}`) &&
      (ray.t === null || Math.abs(Number(t) - ray.t) <= 1e-5 * ray.t), `ray ${i} is what trace prints: ${page.rays[i]}`);
  });
  for (let i = 0; i < expected[0].length; i++) {
    await chooseRay(i);
    const { panels: first } = await shown();
    first.forEach((panel, k) => holds(Object.values(sums(panel, 0)).every((count) => count === 0) && /press Play or Step/.test(panel.said) || panel.said.startsWith('Nothing is counted'),
      `ray ${i} begins before the first step in ${accels[k]}: ${panel.said}`));
    await press('last');
    const { panels } = await shown();
    panels.forEach((panel, k) => holds(same(sums(panel, 1), counters(expected[k][i].counts)) && same(sums(panel, 0), sums(panel, 1)),
      `ray ${i} counts in ${accels[k]} what trace counts: ${JSON.stringify(panel.counts)}, ${JSON.stringify(expected[k][i].counts)}`));
    await checkLight(expected[0][i], i);
  }
}

// `trace` prints nine digits; the sum of the terms has the bits of the light.
async function checkLight(ray, i) {
  const { terms } = await light(), names = Object.keys(terms), sum = terms.sum ?? terms.background;
  const near = (a, b) => a.every((value, c) => Math.abs(value - b[c]) <= 1e-8 * Math.abs(b[c]));
  holds(near(sum, ray.light), `ray ${i} brings the light that trace prints: ${sum}, ${ray.light}`);
  holds(names.sort().join() === (terms.background ? 'background' : ray.kind === 'shadow' ? 'diffuse,specular,sum' : 'ambient,diffuse,reflected,specular,sum,transmitted'),
    `ray ${i} shows the terms that it can have: ${names}`);
  if (terms.background) return;
  const parts = ['ambient', 'diffuse', 'specular', 'reflected', 'transmitted'].filter((name) => terms[name]);
  for (const name of parts) holds(near(terms[name], ray.terms[name]), `ray ${i}: ${name} is what trace prints: ${terms[name]}, ${ray.terms[name]}`);
  sum.forEach((value, c) => holds(parts.reduce((all, name) => all + terms[name][c], 0) === value, `ray ${i}: its terms add up to its light, bit for bit`));
}

async function checkColors(accel) {
  for (const [x, y] of [[22, 17], [3, 5], [20, 20], [30, 25], [12, 22], [25, 12], [17, 14], [36, 28], [8, 18]]) {
    await choosePixel(x, y);
    const { color } = await light(), expected = trace(x, y, accel, '--depth', '3').color.map(Math.fround);
    holds(same(color, expected), `pixel ${x},${y}: what its rays add, in their order, is the colour of the image, bit for bit: ${color}, ${expected}`);
  }
}

// Counters that the first `step` rows of trace add up to, as their events say.
function countsOf(rows) {
  const counts = { steps: 0, extent_tests: 0, object_tests: 0, object_hits: 0 };
  for (const { event, met } of rows) {
    counts.steps += event.startsWith('step');
    counts.extent_tests += event === 'extent test';
    counts.object_tests += event === 'object test';
    counts.object_hits += event === 'object test' && met;
  }
  return counts;
}

async function checkSteps(accels) {
  const x = 22, y = 17;
  await hideObjects();
  await choosePixel(x, y);
  const paths = accels.map((accel) => trace(x, y, accel).rows), most = Math.max(...paths.map((rows) => rows.length));
  await press('first');
  for (let step = 0; step <= most; step++) {
    const page = await shown();
    holds(page.step === `${step} of ${most}`, `after ${step} steps it says so: ${page.step}`);
    page.panels.forEach((panel, k) => {
      const at = Math.min(step, paths[k].length), counts = countsOf(paths[k].slice(0, at));
      for (const [name, value] of Object.entries(counts))
        holds((panel.counts[name]?.[0] ?? 0) === value, `${accels[k]} has ${value} ${name} after ${step} steps: ${JSON.stringify(panel.counts[name])}`);
      holds(at === 0 || panel.current.startsWith(String(at) + paths[k][at - 1].event), `${accels[k]} marks row ${at}: ${panel.current}`);
      holds(panel.live === 'polite' && panel.said.length > 0, 'a step is told to screen readers');
    });
    await press('on');
  }
  for (let i = 0; i < 6; i++) await press('back');
  await press('play');
  await sleep(300);
  const { panels } = await shown();
  holds(panels[0].live === 'off', 'while it plays, screen readers are left in peace');
  for (let i = 0; i < 200 && (await shown()).step !== `${most} of ${most}`; i++) await sleep(100);
  holds((await shown()).step === `${most} of ${most}`, 'play ends at the last step');
  holds(await browser.run("return document.querySelector('#play').getAttribute('aria-pressed') === 'false';"), 'and stops');
}

async function checkPointerAndKeys() {
  const clicked = await browser.run(`const canvas = document.querySelector('#image'), box = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new MouseEvent('click', { clientX: box.left + box.width * 10.5 / 40, clientY: box.top + box.height * 20.5 / 30 }));
    return document.querySelector('#pixel-said').textContent;`);
  holds(clicked.startsWith('pixel 10,20:'), `a click chooses the pixel under it: ${clicked}`);
  const moved = await browser.run(`document.querySelector('#image').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight', cancelable: true }));
    return document.querySelector('#pixel-said').textContent;`);
  holds(moved.startsWith('pixel 11,20:'), `an arrow key moves to the next: ${moved}`);
}

async function checkStructures() {
  await browser.run(`const boxes = document.querySelector('#boxes'); boxes.value = 'all'; boxes.dispatchEvent(new Event('input', { bubbles: true }));`);
  const legend = await browser.run("return document.querySelector('#legend').textContent;"), [, bvh, grid] = legend.match(/bvh (\d+), grid (\d+)/) ?? [];
  holds(bvh > 100 && grid > 10, `the boxes of both structures are drawn: ${legend}`);
  const colors = await browser.run(`return [...document.querySelectorAll('#colors .swatch')].map((swatch) =>
    [getComputedStyle(swatch).backgroundColor, swatch.parentElement.textContent]);`), deepest = await browser.run("return document.querySelector('#to-level').max;");
  holds(colors[0][1] === `boxes of levels 0 to ${deepest}` && same(Object.fromEntries(colors.slice(1)), { 'rgb(46, 130, 247)': 'on the path of the ray, the current one filled',
    'rgb(240, 128, 0)': 'a tested object', 'rgb(224, 33, 15)': 'a hit', 'rgb(242, 184, 0)': 'a light' }), `a legend says what the colours mean: ${colors}`);
  const cut = await browser.run(`const set = (id, value) => { const at = document.getElementById(id); at.value = value;
      at.dispatchEvent(new Event('input', { bubbles: true })); };
    set('axis', 'z'); set('slice', '0.4');
    const legend = document.querySelector('#legend').textContent;
    set('axis', ''); set('to-level', '2');
    const levels = document.querySelector('#legend').textContent;
    set('to-level', '99');
    return [legend, levels].map((text) => Number(text.match(/bvh (\\d+)/)[1]));`);
  holds(cut[0] > 0 && cut[0] < bvh, `a slice leaves the boxes that it cuts: ${cut[0]} of ${bvh}`);
  holds(cut[1] > 0 && cut[1] <= 7, `levels 0 to 2 of a binary tree have at most 7 boxes: ${cut[1]}`);
}

async function checkBuffers(page, spec) {
  await open(page);
  await hideObjects();
  await choosePixel(22, 17);
  const primary = trace(22, 17, spec), first = await shown();
  holds(first.sample.includes(`sample ${17 * 40 + 22} holds object ${primary.object},`), `the item buffer's sample names its object: ${first.sample}`);
  const [nearest] = await browser.run("return [...document.querySelectorAll('#sample tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent));");
  holds(nearest[0].startsWith(`object ${primary.object},`) && nearest[2] === 'kept' && Math.abs(Number(nearest[1]) - primary.t) <= 1e-5 * primary.t,
    `the nearest competitor is kept: ${nearest}`);
  const other = first.rays.findIndex(([name]) => name.startsWith('reflection'));
  await chooseRay(other);
  holds(/for shadow rays only/.test((await shown()).panels[0].cell), 'a reflection ray is told that the cubes are for shadow rays');
  const at = first.rays.findIndex(([name]) => name.startsWith('shadow'));
  await chooseRay(at);
  const { panels: [{ cell }] } = await shown();
  holds(/cell \d+ of the cube around light \d, on the side [+-][xyz]: a list of \d+ objects?/.test(cell), `a shadow ray shows its cell: ${cell}`);
}

async function checkGiven(page, ray) {
  await open(page);
  const expected = flat(JSON.parse(execFileSync(program, ['trace', scene, '--size', size, '--ray', ray, '--accel', 'item+bvh', '--depth', '3', '--json'])).tree);
  const isShown = async (when) => {
    const { said, rays } = await shown();
    holds(said.startsWith(`the given ray: ${expected.length} ray`) && rays.length === expected.length &&
      rays[0][1] === `object ${expected[0].object}, ${expected[0].shape}`, `${when} the page shows the given ray and its tree: ${said}`);
  };
  await isShown('at first');
  await press('last');
  const { panels: [panel] } = await shown();
  holds(same(sums(panel, 0), counters(expected[0].counts)), `it counts what trace counts: ${JSON.stringify(panel.counts)}`);
  await choosePixel(22, 17);
  holds((await shown()).said.startsWith('pixel 22,17:'), 'the pixels are there too');
  await press('given');
  await isShown('by its button');
}

async function checkWithoutWebGL(page) {
  const { identifier } = await browser.before(`const old = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) { return /webgl/.test(kind) ? null : old.call(this, kind, ...more); };
    console.error = () => {};`);
  await open(page);
  await choosePixel(22, 17);
  const { rays, panels } = await shown();
  holds(rays.length > 3 && Object.keys(panels[0].counts).length > 0, 'without WebGL image, tree and paths work');
  holds(await browser.run("return document.querySelector('#space').textContent.includes('WebGL') && document.querySelector('#shown').hidden;"),
    'and the page says what is missing');
  await browser.devtools('Page.removeScriptToEvaluateOnNewDocument', { identifier });
}

async function checkLooks(page, width, scheme) {
  await browser.size(width, 900);
  await browser.media('screen', scheme);
  await open(page);
  const found = await browser.run('return document.documentElement.scrollWidth;');
  holds(found <= width, `${page} at ${width} pixels is not wider than that: ${found}`);
  const cut = await browser.run("const { scrollWidth, clientWidth } = document.querySelector('#tree').parentElement; return [scrollWidth, clientWidth];");
  holds(cut[0] <= cut[1], `no column of the ray tree is cut at ${width} pixels: ${cut}`);
  if (axe) await judgeByAxe(browser, axe, `${page}, ${width} pixels, ${scheme}`, holds);
}

try {
  const accels = ['bvh', 'grid'], given = '0.1,0.2,9,0,0.01,-1', buffers = 'item+light:cells=20+octree';
  explore('walk.html', accels);
  explore('buffers.html', [buffers]);
  exploreScene('random:n=30000', 'deep.html', ['kd'], '--size', '8x6');
  explore('given.html', ['item+bvh'], '--ray', given);
  explore('limited.html', ['brute'], '--megabytes', '1', '--size', '400x300');
  await browser.size(390, 300); // drawn in software, a frame of a large window takes seconds
  await browser.media('screen');
  await open('walk.html');
  holds(/^0 of [1-9]/.test((await shown()).step), 'the page opens before the first step');
  await checkTree(accels);
  await checkColors(accels[0]);
  await checkSteps(accels);
  await checkPointerAndKeys();
  await checkStructures();
  await checkBuffers('buffers.html', buffers);
  await checkGiven('given.html', given);
  await checkWithoutWebGL('walk.html');
  for (const width of [390, 768, 1440]) for (const scheme of ['light', 'dark']) await checkLooks('walk.html', width, scheme);
  await browser.size(390, 300);
  await open('deep.html');
  const legend = await browser.run("return document.querySelector('#legend').textContent;");
  holds(/no boxes of kd below level \d+: deeper leaves are missing/.test(legend), `leaves that are left out are told: ${legend}`);
  const atFirst = Number(legend.match(/kd (\d+)/)[1]);
  holds(atFirst > 7 && atFirst <= 400 && await browser.run("return document.querySelector('#boxes').value === 'all' && Number(document.querySelector('#to-level').value) < Number(document.querySelector('#to-level').max);"),
    `a structure of many leaves is shown by its upper levels at first: ${legend}`);
  await open('limited.html');
  holds(statSync('limited.html').size < 4e6, `paths take the room that they are given: ${statSync('limited.html').size} bytes`);
  holds(/of one pixel in (\d+) x \1/.test(await browser.run("return document.querySelector('#about').textContent;")), 'the page says which pixels it has');
  await judgeLogs(browser, (to) => ['walk.html', 'buffers.html', 'given.html', 'deep.html', 'limited.html'].map(url).includes(to), holds);
  if (judge.failures === 0) console.log(`check_pages: the explorer shows what trace prints${axe ? '; axe finds nothing serious' : ''}`);
} finally {
  await browser.close();
}
process.exit(judge.failures ? 1 : 0);
