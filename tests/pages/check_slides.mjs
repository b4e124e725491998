// SPDX-License-Identifier: Apache-2.0
// check_slides.mjs FOLDER SOURCE: drives FOLDER/slides.html in Chromium, and looks into slides.pdf, slides.txt and the Markdown SOURCE.
// Says what does not hold; exit code 1 where anything does not.
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { inflateSync } from 'node:zlib';
import { judgeLogs, makeJudge, openBrowser } from './browser.mjs';

const folder = resolve(process.argv[2]);
const source = readFileSync(process.argv[3], 'utf8').split(/\n---\n/).slice(1);
const judge = makeJudge(), { holds } = judge;
const browser = await openBrowser();

// What is on each slide, in pixels of a window 1440 wide.
const look = () => browser.runAsync(`const done = arguments[0];
  Promise.all([...document.images].map((image) => image.decode().catch(() => {}))).then(() => done(
    [...document.querySelectorAll('section')].map((slide) => {
      const frame = slide.getBoundingClientRect(), scale = 1440 / 1280;
      const content = [...slide.querySelectorAll('h1, h2, p, li, table, pre, img')];
      const box = (each) => each.getBoundingClientRect();
      const outside = content.filter((each) => box(each).left < frame.left || box(each).right > frame.right ||
        box(each).top < frame.top || box(each).bottom > frame.bottom);
      const foot = slide.querySelector('pre:has(.language-sh, .language-bash)');
      const under = foot ? content.filter((each) => each !== foot && box(each).bottom > box(foot).top + 1 && box(each).left < box(foot).right) : [];
      const name = (each) => each.tagName + ' ' + (each.alt ?? each.textContent).slice(0, 40);
      return { heading: slide.querySelector('h1, h2')?.textContent ?? '', headings: slide.querySelectorAll('h1, h2').length,
        ratio: frame.width / frame.height, images: [...slide.querySelectorAll('img')].map(({ alt, naturalWidth }) => ({ alt, naturalWidth })),
        outside: outside.map(name), under: under.map(name),
        least: Math.min(...content.filter((each) => each.tagName !== 'IMG' && each.textContent.trim())
          .map((each) => parseFloat(getComputedStyle(each).fontSize) * scale)) };
    })));`);

function checkSlide(slide, at) {
  const name = `slide ${at + 1}, ${slide.heading}`;
  holds(slide.headings === 1 && slide.heading.trim() !== '', `${name} has one heading`);
  holds(slide.images.length > 0, `${name} has a picture`);
  for (const { alt, naturalWidth } of slide.images)
    holds(alt.length > 5 && naturalWidth > 0, `${name}: every picture is there and has an alternative text: ${alt}`);
  holds(Math.abs(slide.ratio - 16 / 9) < 0.01, `${name} is 16:9`);
  holds(slide.outside.length === 0, `${name} overflows nowhere: ${slide.outside}`);
  holds(slide.under.length === 0, `${name}: nothing covers the commands: ${slide.under}`);
  holds(slide.least >= 24, `${name} has no text below 18 points, 24 pixels: ${slide.least}`);
}

// In the source: whoever reads a figure is told the experiment; every slide has notes, with a question and its answer.
function checkSource(text, at) {
  const name = `slide ${at + 1}`, visible = text.replace(/<!--[^]*?-->|!\[.*?\)/g, '');
  for (const [, experiment] of visible.matchAll(/{{([^/]+)\//g))
    holds(at === 0 || visible.replace(/{{[^}]*}}/g, '').includes(experiment), `${name} names the experiment ${experiment} of its figures`);
  const notes = text.match(/<!--\n\d+ minutes?[^]*?-->/)?.[0] ?? '';
  holds(/^Ask: /m.test(notes) && /^Answer: /m.test(notes), `${name} has notes with a question and its answer`);
}

function countPages(pdf) {
  const streams = [...pdf.matchAll(/stream\r?\n([^]*?)\r?\nendstream/g)].map(([, bytes]) => {
    try { return inflateSync(Buffer.from(bytes, 'latin1')).toString('latin1'); } catch { return ''; }
  });
  return Math.max(...[pdf, streams.join('\n')].map((text) => [...text.matchAll(/\/Type\s*\/Page\b/g)].length));
}

try {
  await browser.size(1440, 810);
  await browser.open(`file://${folder}/slides.html`);
  const slides = await look();
  holds(slides.length > 20, `there are slides: ${slides.length}`);
  slides.forEach(checkSlide);
  source.forEach(checkSource);
  holds(source.length === slides.length, `each slide of the source is shown: ${source.length}, ${slides.length}`);
  const pages = countPages(readFileSync(`${folder}/slides.pdf`, 'latin1'));
  holds(pages === slides.length, `the PDF has a page for each slide: ${pages}`);
  holds(readFileSync(`${folder}/slides.txt`, 'utf8').includes('Answer: '), 'the notes are in slides.txt');
  await judgeLogs(browser, (to) => to === `file://${folder}/slides.html`, holds);
  if (judge.failures === 0) console.log(`check_slides: ${slides.length} slides`);
} finally {
  await browser.close();
}
process.exit(judge.failures ? 1 : 0);
