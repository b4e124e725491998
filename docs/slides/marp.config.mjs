// SPDX-License-Identifier: Apache-2.0
// marp.config.mjs: adds two things to marp's Markdown, so that slides agree with results and are one file:
//   {{EXPERIMENT/FILE COLUMN KEY=VALUE...}}   a figure: COLUMN of the one row of results/reference/EXPERIMENT/FILE.csv in which each
//                                             column KEY has this VALUE; COLUMN/OTHER is their ratio, COLUMN% a share in percent
//   ![text](FILE.svg "X Y WIDTH HEIGHT")      a part of a picture; a HEIGHT of * reaches to its bottom
// All pictures become part of the page. Throws if a figure does not name one row, or a picture is missing.
import { readFileSync } from 'node:fs';
import { extname } from 'node:path';

// The rows of a CSV file as objects; a field in quotes may have commas.
function readRows(file) {
  const [names, ...rows] = readFileSync(file, 'utf8').trim().split('\n')
    .map((line) => [...line.matchAll(/(?:^|,)(?:"([^"]*)"|([^,]*))/g)].map(([, quoted, plain]) => quoted ?? plain));
  return rows.map((row) => Object.fromEntries(names.map((name, i) => [name, row[i]])));
}

// Three digits, all before the point.
function format(value) {
  return value.toLocaleString('en', value < 100 ? { minimumSignificantDigits: 3, maximumSignificantDigits: 3 } : { maximumFractionDigits: 0 });
}

function figure(query) {
  const [file, columns, ...conditions] = query.trim().split(/\s+/);
  const keys = conditions.map((condition) => [condition.slice(0, condition.indexOf('=')), condition.slice(condition.indexOf('=') + 1)]);
  const rows = readRows(`results/reference/${file}.csv`).filter((row) => keys.every(([key, value]) => row[key] === value));
  if (rows.length !== 1) throw new Error(`{{${query}}} names ${rows.length} rows`);
  const percent = columns.endsWith('%');
  const [first, second] = columns.replace('%', '').split('/').map((name) => rows[0][name]);
  if (!first || second === '') throw new Error(`{{${query}}} has no value`);
  if (Number.isNaN(Number(first))) return first;
  const value = Number(first) / Number(second ?? 1);
  return percent ? `${format(100 * value)} %` : format(value);
}

function dataUri(file, part) {
  if (extname(file) === '.png') return `data:image/png;base64,${readFileSync(file, 'base64')}`;
  let svg = readFileSync(file, 'utf8');
  if (part) {
    const [x, y, width, height] = part.split(' ');
    const whole = Number(svg.match(/viewBox="0 0 \S+ ([^"]+)"/)[1]);
    const high = height === '*' ? whole - y : height;
    svg = svg.replace(/<svg[^>]*>/, (tag) => tag.replace(/ (width|height|viewBox)="[^"]*"/g, '')
      .replace('<svg', `<svg width="${width}" height="${high}" viewBox="${x} ${y} ${width} ${high}"`));
  }
  return `data:image/svg+xml;base64,${Buffer.from(svg).toString('base64')}`;
}

function slides(markdown) {
  markdown.core.ruler.before('normalize', 'figures', (state) => {
    state.src = state.src.replace(/{{([^}]*)}}/g, (_, query) => figure(query));
  });
  const render = markdown.renderer.rules.image;
  markdown.renderer.rules.image = (tokens, i, ...rest) => {
    const image = tokens[i];
    image.attrSet('src', dataUri(image.attrGet('src'), image.attrGet('title')));
    image.attrs = image.attrs.filter(([name]) => name !== 'title');
    return render(tokens, i, ...rest);
  };
}

export default { engine: ({ marp }) => marp.use(slides), pdfOutlines: true };
