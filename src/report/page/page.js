'use strict';
// What the data of a page adds to it. A report has `sections` (tables of each scene), `frames` (tables of whole frames), `verdict` (its claims), `papers`, and
// what describes the method: `manifest`, `colors` (by label), `counters`, `interval`, `null_runs`, `learnt`, `left_out`, `count_only`. An index has
// `papers` and `verdicts` (the claims of each experiment). src/core/text/table.h says what a table is. Question, answer and plots are there without any of it.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const make = (name, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(name), properties);
    element.append(...children);
    return element;
  };

  // `code` and **bold** in sentences, as in Markdown.
  const markUp = (text) => text.split(/(`[^`]*`|\*\*.*?\*\*)/).map((part, i) => i % 2 === 0 ? part :
    part.startsWith('`') ? make('code', {}, part.slice(1, -1)) : make('b', {}, ...markUp(part.slice(2, -2))));
  for (const element of all('.card p, .card strong, .bound')) {
    for (const text of [...element.childNodes]) if (text.nodeType === 3) text.replaceWith(...markUp(text.textContent));
  }

  // ---- tables ----

  const marks = { best: '★ best', level: '≈ best' };
  const makeField = (field, column, mark) => {
    const [text, value, note] = Array.isArray(field) ? field : [field];
    const cell = make('td', { title: note ?? '' }, text || '-');
    if (column.number) cell.dataset.value = value ?? '';
    if (column.prose) cell.className = 'prose';
    if (mark) cell.append(' ', make('span', { className: 'mark' }, mark));
    return cell;
  };
  const makeRow = (row, columns) => {
    const line = make('tr', {}, ...row.fields.map((field, i) => makeField(field, columns[i], i ? '' : marks[row.standing])));
    if (row.standing) line.className = 'best';
    const labels = row.fields.filter((_, i) => columns[i].id === 'accel' || columns[i].id === 'label').flat();
    if (labels.length && data.colors) line.style.setProperty('--dot', data.colors[labels[0]]);
    return line;
  };
  const key = (cell) => {
    if (!('value' in cell.dataset)) return cell.textContent.trim();
    return cell.dataset.value === '' ? null : parseFloat(cell.dataset.value);
  };
  const compare = (a, b) => typeof a === 'number' && typeof b === 'number' ? a - b :
    String(a).localeCompare(String(b), 'en', { numeric: true });
  // What is not known stands at the end in both directions.
  const sort = (header) => {
    const body = header.closest('table').tBodies[0], column = header.cellIndex;
    const up = header.getAttribute('aria-sort') !== 'ascending';
    for (const other of header.parentNode.cells) other.removeAttribute('aria-sort');
    header.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    const rows = [...body.rows].map((row) => [key(row.cells[column]), row]);
    rows.sort(([a], [b]) => a === null || b === null ? (a === null) - (b === null) : up ? compare(a, b) : compare(b, a));
    body.append(...rows.map(([, row]) => row));
  };
  const makeHeader = (column) => {
    const button = make('button', { type: 'button' }, column.name);
    const header = make('th', { scope: 'col', title: column.meaning, className: column.number ? 'number' : '' }, button);
    header.dataset.id = column.id;
    button.addEventListener('click', () => sort(header));
    return header;
  };
  // The box scrolls if the table is wider; so it can be reached by keyboard and has a name.
  const makeTable = ({ title, columns, rows }) => {
    const table = make('table', {}, make('caption', {}, title), make('thead', {}, make('tr', {}, ...columns.map(makeHeader))),
      make('tbody', {}, ...rows.map((row) => makeRow(row, columns))));
    const box = make('div', { className: 'wide', tabIndex: 0 }, table);
    box.setAttribute('role', 'region');
    box.setAttribute('aria-label', title);
    return box;
  };
  const makeDetails = (title, ...children) => make('details', {}, make('summary', {}, title), ...children);
  const makeSection = ({ title, tables, choices, folded }) => {
    const section = make('section', { className: 'scene-tables' }, make('h3', {}, title), ...tables.map(makeTable),
      ...(choices ? [make('p', { className: 'meta' }, choices)] : []),
      ...folded.map((table) => makeDetails(table.title, makeTable(table))));
    section.dataset.scene = title;
    return section;
  };

  const place = document.getElementById('tables');
  const put = (title, ...children) => place.append(make('h2', { id: title.toLowerCase().replaceAll(' ', '-') }, title), ...children);
  const paragraph = (...children) => make('p', {}, ...children);
  place.textContent = '';
  document.getElementById('frames')?.append(...data.frames.map(makeTable));
  if (data.sections) {
    put('Tables', paragraph(`In brackets: ${data.interval} intervals. ★ marks the best of a scene and kind of rays, by ` +
      `${data.count_only ? 'object tests' : 'time'}; ≈ marks intervals that overlap that of the best. Times over all kinds have ` +
      'conservative intervals, and are unknown if a kind is missing.'));
    if (data.learnt) place.append(paragraph(data.learnt));
  }
  const filter = make('div', { className: 'filter', id: 'filter' }), input = make('input', { type: 'search', id: 'words',
    placeholder: data.sections ? 'words, e.g. of a scene, an accelerator, a kind' : 'words, e.g. of a question' }), said = make('output', { className: 'meta' });
  filter.append(make('label', { htmlFor: 'words' }, data.sections ? 'Rows with' : 'Experiments with'), input, said);
  if (data.sections) place.append(filter, ...data.sections.map(makeSection));
  else document.querySelector('h2')?.before(filter);

  // ---- claims ----

  const classes = { 'holds': 'holds', 'does not hold': 'false', 'figure': 'readout' };
  const makeBadge = (text, name = 'open') => make('span', { className: `verdict ${name}` }, text);
  // "3 of 4 claims hold, 1 does not", in the colour of the worst verdict; or that there are no claims.
  const makeVerdict = ({ claims }) => {
    const count = (verdict) => claims.filter((claim) => claim.verdict === verdict).length;
    const judged = claims.length - count('figure'), wrong = count('does not hold'), open = count('undecided'), missing = count('no measurements');
    const texts = [judged ? `${count('holds')} of ${judged} ${judged === 1 ? 'claim holds' : 'claims hold'}` : 'not judged',
      wrong && `${wrong} ${wrong === 1 ? 'does' : 'do'} not`, open && `${open} undecided`, missing && `${missing} without measurements`];
    return makeBadge(texts.filter(Boolean).join(', '), wrong ? 'false' : judged && !open && !missing ? 'holds' : 'open');
  };
  const makeClaim = ({ text, verdict, figures, later }) => make('li', {}, makeBadge(verdict, classes[verdict]), ` ${text} `,
    ...(later ? [makeBadge(later)] : []), make('small', {}, figures));
  if (data.verdict) {
    const { claims, dropped, level } = data.verdict;
    document.getElementById('verdict').append(make('section', { className: 'card' }, make('h2', {}, 'Verdict'),
      paragraph(makeVerdict(data.verdict), ...(claims.length ? [] : [' The prediction states no claims (', make('code', {}, 'expect'), ') to check.'])),
      make('ul', { className: 'claims' }, ...claims.map(makeClaim),
        ...dropped.map((text) => make('li', {}, makeBadge('dropped after the run began'), ` ${text}`))),
      make('p', { className: 'meta' }, level)));
  }
  for (const [name, verdict] of Object.entries(data.verdicts ?? {})) document.getElementById(name).lastElementChild.append(makeVerdict(verdict));

  // ---- literature and method ----

  if (data.papers.length) {
    const names = ['citation', 'page', 'quote', 'verdict', 'experiment'];
    const quote = (paper) => paper.seen ? `“${paper.quote}”` : `${paper.quote} (in our words: the text was not at hand)`;
    const verdict = (paper) => paper.problem ? `${paper.verdict} [not supported: ${paper.problem}]` : paper.verdict;
    const modelled = (paper) => paper.modelled && ` Modelled: ${paper.modelled}`;
    put('From the literature', makeTable({ title: 'Sentences that are tested',
      columns: names.map((name) => ({ id: name, name: name === 'quote' ? 'sentence' : name, meaning: '', prose: name !== 'page' })),
      rows: data.papers.map((paper) => ({ fields: [paper.citation, paper.page, quote(paper) + modelled(paper), verdict(paper), paper.experiment] })) }));
  }
  const makeList = (pairs) => make('dl', {}, ...pairs.flatMap(([name, text]) => [make('dt', {}, name), make('dd', {}, String(text))]));
  if (data.manifest) {
    const { machine, ...run } = data.manifest, plain = (object) => Object.entries(object ?? {}).filter(([name, value]) =>
      value !== null && typeof value !== 'object' && name !== 'question' && name !== 'prediction');
    put('How it was measured', paragraph('Every accelerator traced the same recorded rays. Totals weight each kind of rays by the size ' +
      'of its whole set, before any limit. Shadow rays stop at any hit. ', make('em', {}, 'ideal'), ' knows the answers in advance: it is ' +
      'the lower bound. ', make('em', {}, 'differ'), ' counts answers that differ from the reference; the run fails if an exact ' +
      'accelerator has any.'), paragraph(data.count_only ? 'Nothing was timed: this experiment counts.' :
      'Counting and timing are separate passes. Times are medians over rounds that run all accelerators in random order; ratios are ' +
      'throughput relative to the baseline, paired within a round. Intervals are order statistics: they contain the median with a ' +
      `probability of at least ${data.interval}. ${data.null_runs}`), makeDetails('Counters', makeList(data.counters)));
    if (data.left_out) place.append(make('pre', { className: 'meta' }, data.left_out));
    const plugins = (machine?.plugins ?? []).map(({ accelerators, file, hash }) => [`plugin of ${accelerators.join(', ')}`, `${file}, hash ${hash}`]);
    const manifest = makeDetails('Manifest', makeList([...plain(run), ...plain(machine), ...plugins]));
    manifest.open = true;
    place.append(manifest);
    document.querySelector('.lede').after(make('p', { className: 'meta' }, [run.date, machine?.cpu,
      `raytally ${machine?.version} (${machine?.commit})${machine?.dirty ? ', with changes' : ''}`,
      ...(run.quick ? ['quick variant'] : [])].join(' · ')));
  }

  // ---- filtering ----

  // Tables whose rows are filtered, or the cards of an index.
  const groups = all('.scene-tables').map((section) => ({ section, details: all('details', section), tables: all('.wide', section),
    rows: all('tbody tr', section).map((row) => ({ row, text: null })) }));
  if (!data.sections) groups.push({ section: null, details: [], tables: [], rows: all('.entry').map((row) => ({ row, text: null })) });
  const total = groups.reduce((sum, { rows }) => sum + rows.length, 0), unit = data.sections ? 'rows' : 'experiments';
  const show = () => {
    const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
    let shown = 0;
    for (const { section, details, tables, rows } of groups) {
      let here = 0;
      for (const entry of rows) {
        // The words of a row: its fields, and the scene's name.
        if (entry.text === null) entry.text = [section?.dataset.scene ?? '', ...[...entry.row.cells ?? [entry.row]].map((cell) => cell.textContent)].join(' ').toLowerCase();
        const there = words.every((word) => entry.text.includes(word));
        entry.row.hidden = !there;
        here += there;
      }
      shown += here;
      if (section) section.hidden = here === 0;
      const isEmpty = (part) => all('tbody tr', part).every((row) => row.hidden);
      for (const part of [...tables, ...details]) part.hidden = isEmpty(part);
      if (words.length) for (const each of details) each.open = true;
    }
    said.textContent = words.length ? `${shown} of ${total} ${unit}` : `${total} ${unit}`;
  };
  let waiting;
  input.addEventListener('input', () => { clearTimeout(waiting); waiting = setTimeout(show, 80); });
  show();

  // ---- plots and print ----

  for (const plot of all('.plot')) {
    // gnuplot writes the size as viewBox="0 0 WIDTH HEIGHT".
    const image = plot.querySelector('img'), [, width] = atob(image.src.split(',')[1]).match(/viewBox="0 0 (\d+)/) ?? [0, 960];
    image.width = width;
    plot.style.setProperty('--w', `${width}px`);
    const button = make('button', { type: 'button', className: 'enlarge' }, 'Enlarge');
    button.setAttribute('aria-label', 'Enlarge ' + plot.getAttribute('aria-label'));
    button.setAttribute('aria-pressed', 'false');
    button.addEventListener('click', () => {
      const large = plot.classList.toggle('large');
      button.setAttribute('aria-pressed', String(large));
      button.textContent = large ? 'Fit' : 'Enlarge';
    });
    plot.after(button);
  }
  // Print whole: what is folded opens, and folds again.
  let folded = [];
  addEventListener('beforeprint', () => { folded = all('details:not([open])'); for (const each of folded) each.open = true; });
  addEventListener('afterprint', () => { for (const each of folded) each.open = false; });
})();
