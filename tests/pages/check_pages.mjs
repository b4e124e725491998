// SPDX-License-Identifier: Apache-2.0
// check_pages.mjs SMALL LARGE INDEX [AXE]: drives the pages in Chromium: a report, one of 10,112 cells, an index. AXE: axe.min.js,
// to judge them too. Says what does not hold; exit code 1 where anything does not.
import { statSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import { judgeByAxe, judgeLogs, makeJudge, openBrowser, sleep } from './browser.mjs';

const [small, large, index, axe] = process.argv.slice(2).map((path) => resolve(path));
const browser = await openBrowser();
const judge = makeJudge(), { holds } = judge;

const url = (page) => `file://${page}`;
const columnOf = (id) => browser.run(`const table = document.querySelector('.scene-tables table');
  const at = [...table.tHead.rows[0].cells].findIndex((cell) => cell.dataset.id === arguments[0]);
  return [...table.tBodies[0].rows].map((row) => parseFloat(row.cells[at].dataset.value));`, id);
const clickHeader = (id) => browser.run(`const table = document.querySelector('.scene-tables table');
  table.querySelector('th[data-id="' + arguments[0] + '"] button').click();
  return table.querySelector('th[data-id="' + arguments[0] + '"]').getAttribute('aria-sort');`, id);

async function filter(words) {
  await browser.run(`const input = document.querySelector('#words'); input.value = arguments[0];
    input.dispatchEvent(new Event('input'));`, words);
  await sleep(250);
  return browser.run(`const rows = [...document.querySelectorAll('.scene-tables tbody tr')];
    const shown = rows.filter((row) => !row.hidden);
    return { all: rows.length, shown: shown.map((row) => row.closest('section').dataset.scene + ' ' + row.textContent),
             headers: [...document.querySelectorAll('.scene-tables table')].filter((table) => table.checkVisibility() &&
               [...table.tBodies[0].rows].every((row) => row.hidden)).length,
             said: document.querySelector('#filter output').textContent };`);
}

async function checkVerdict(page, where) {
  await browser.open(url(page));
  const found = await browser.run("return [...document.querySelectorAll(arguments[0])].map((badge) => badge.textContent);", where);
  holds(found[0] === '0 of 3 claims hold, 3 undecided', `${page} says what the claims came to: ${found}`);
}

async function checkSorting() {
  holds(await clickHeader('tests_a_ray') === 'ascending', 'a click on a header sorts, and says so');
  const up = (await columnOf('tests_a_ray')).filter((value) => !Number.isNaN(value));
  holds(up.length > 1 && up.every((value, i) => i === 0 || up[i - 1] <= value), 'the column rises');
  holds(await clickHeader('tests_a_ray') === 'descending', 'a second click sorts the other way');
  const down = (await columnOf('tests_a_ray')).filter((value) => !Number.isNaN(value));
  holds(down.join() === [...up].reverse().join() && down[0] > down.at(-1), 'the column falls');
}

async function checkFilter() {
  const some = await filter('grid random');
  holds(some.shown.length > 0 && some.shown.length < some.all, 'a filter leaves some rows');
  holds(some.shown.every((text) => /grid/i.test(text) && /random/i.test(text)), 'each row left has all the words');
  holds(some.said === `${some.shown.length} of ${some.all} rows`, 'the page says how many rows are left');
  holds(some.headers === 0, 'no table is left with a header and no row');
  const none = await filter('no-such-accelerator');
  holds(none.shown.length === 0, 'a filter that nothing has leaves nothing');
  const all = await filter('');
  holds(all.shown.length === all.all, 'without words all rows are there');
}

// Nothing stands beyond the page, but in what scrolls.
async function checkWidth(page, width, media) {
  await browser.size(width, 800);
  await browser.media(media);
  await browser.open(url(page));
  if (media === 'print') await browser.run('dispatchEvent(new Event("beforeprint"))');
  const found = await browser.run(`const over = (box) => box.scrollWidth > box.clientWidth + 1;
    return { page: document.documentElement.scrollWidth, cut: [...document.querySelectorAll('.wide, .plot, figure, .card')]
      .filter((box) => over(box) && (arguments[0] === 'print' || !box.matches('.wide, .plot')))
      .map((box) => box.className + ' ' + (box.getAttribute('aria-label') ?? '')),
      plots: [...document.querySelectorAll('.plot img')].map((img) => img.clientWidth / img.getAttribute('width')),
      folded: document.querySelectorAll('details:not([open])').length };`, media);
  holds(found.page <= width, `${page} at ${width} pixels (${media}) is not wider than that: ${found.page}`);
  holds(found.cut.length === 0, `${page} at ${width} pixels (${media}) cuts nothing: ${found.cut}`);
  if (media === 'screen') holds(found.plots.every((scale) => scale >= 0.74), `letters of plots can be read at ${width} pixels`);
  if (media === 'print') holds(found.folded === 0, 'what is folded is printed');
  await browser.media('screen');
}

// A plot is as dark as the page, in a report and in an index.
async function checkDark(page, plot) {
  await browser.size(1440, 900);
  await browser.media('screen', 'dark');
  await browser.open(url(page));
  await browser.run("for (const image of document.images) image.loading = 'eager';");
  const found = await browser.runAsync(`const done = arguments[arguments.length - 1];
    Promise.all([...document.images].map((image) => image.decode()))
      .then(() => done(getComputedStyle(document.querySelector(arguments[0])).filter), () => done('a picture is missing'));`, plot);
  holds(found.startsWith('invert('), `plots of ${page} are dark in dark mode: ${found}`);
  await browser.media('screen');
}

async function checkAxe(page, width, scheme) {
  if (!axe) return;
  await browser.size(width, 800);
  await browser.media('screen', scheme);
  await browser.open(url(page));
  await browser.run("for (const each of document.querySelectorAll('details')) each.open = true;");
  await judgeByAxe(browser, axe, `${page}, ${width} pixels, ${scheme}`, holds);
}

async function checkLarge() {
  holds(statSync(large).size < 12e6, `a report of 10,112 cells is under 12 MB: ${statSync(large).size} bytes`);
  const started = performance.now();
  await browser.open(url(large));
  const all = await filter('');
  const opened = performance.now() - started;
  holds(all.all > 10112, `it has a row a cell: ${all.all}`);
  holds(opened < 60000, `it opens within a minute, whatever runs beside it: ${opened} ms`);
  const slowest = await browser.run(`const input = document.querySelector('#words'), begun = performance.now();
    input.value = 'shadow'; input.dispatchEvent(new Event('input'));
    for (const header of document.querySelectorAll('.scene-tables details th[data-id="tests_a_ray"] button')) header.click();
    document.body.offsetHeight;
    return performance.now() - begun;`);
  holds(slowest < 5000, `all its tables are sorted within 5 s: ${slowest} ms`);
  return { bytes: statSync(large).size, opened: Math.round(opened), sorted: Math.round(slowest) };
}

async function checkLogs() {
  const own = [small, large, index].map(url), plots = new RegExp(`^${url(dirname(index))}/[^/]+/plots/[^/]+[.]svg$`);
  await judgeLogs(browser, (to) => own.includes(to) || plots.test(to), holds);
}

try {
  await browser.size(1440, 900);
  await browser.media('screen');
  await browser.open(url(small));
  await checkSorting();
  await checkFilter();
  for (const page of [small, index]) {
    for (const width of [390, 768, 1440]) await checkWidth(page, width, 'screen');
    await checkWidth(page, 703, 'print'); // A4 within its margins
    for (const scheme of ['light', 'dark']) {
      await checkAxe(page, 390, scheme);
      await checkAxe(page, 1440, scheme);
    }
  }
  await checkVerdict(small, '#verdict .verdict');
  await checkVerdict(index, '.entry .verdict');
  await checkDark(small, '.plot img');
  await checkDark(index, '.thumb img');
  const { bytes, opened, sorted } = await checkLarge();
  await checkLogs();
  if (judge.failures === 0)
    console.log(`check_pages: 10,112 cells are ${(bytes / 1e6).toFixed(1)} MB, open in ${opened} ms, are sorted in ${sorted} ms` +
      (axe ? '; axe finds nothing serious' : ''));
} finally {
  await browser.close();
}
process.exit(judge.failures ? 1 : 0);
