'use strict';
// Sorting by a click on a header, filtering by words, larger plots. The page is whole without any of it.
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const key = (cell) => {
    if (!('value' in cell.dataset)) return cell.textContent.trim();
    const value = parseFloat(cell.dataset.value);
    return Number.isNaN(value) ? null : value;
  };
  // What is not known stands at the end in both directions.
  const compare = (a, b) => typeof a === 'number' && typeof b === 'number' ? a - b :
    String(a).localeCompare(String(b), 'en', { numeric: true });
  const sort = (header) => {
    const body = header.closest('table').tBodies[0], column = header.cellIndex;
    const up = header.getAttribute('aria-sort') !== 'ascending';
    for (const other of header.parentNode.cells) other.removeAttribute('aria-sort');
    header.setAttribute('aria-sort', up ? 'ascending' : 'descending');
    const rows = [...body.rows].map((row) => [key(row.cells[column]), row]);
    rows.sort(([a], [b]) => a === null || b === null ? (a === null) - (b === null) : up ? compare(a, b) : compare(b, a));
    body.append(...rows.map(([, row]) => row));
  };
  for (const header of all('.wide thead th')) {
    const button = document.createElement('button');
    button.type = 'button';
    button.append(...header.childNodes);
    button.addEventListener('click', () => sort(header));
    header.append(button);
  }

  const place = document.querySelector('#filter');
  if (place) {
    place.hidden = false;
    const input = place.querySelector('input'), said = place.querySelector('output');
    const sections = all('.scene-tables').map((section) => ({ section, details: all('details', section),
      tables: all('table', section),
      rows: all('tbody tr', section).map((row) => ({ row, text: null })) }));
    const total = sections.reduce((sum, { rows }) => sum + rows.length, 0);
    const filter = () => {
      const words = input.value.toLowerCase().split(/\s+/).filter(Boolean);
      let shown = 0;
      for (const { section, details, tables, rows } of sections) {
        let here = 0;
        for (const entry of rows) {
          // The words of a row: its fields, and the scene's name.
          if (entry.text === null) {
            const fields = [...entry.row.cells].map((cell) => cell.textContent);
            entry.text = [section.dataset.scene, ...fields].join(' ').toLowerCase();
          }
          const there = words.every((word) => entry.text.includes(word));
          entry.row.hidden = !there;
          here += there;
        }
        shown += here;
        section.hidden = here === 0;
        const isEmpty = (part) => all('tbody tr', part).every((row) => row.hidden);
        for (const part of [...tables, ...details]) part.hidden = isEmpty(part);
        if (words.length) for (const each of details) each.open = true;
      }
      said.textContent = words.length ? `${shown} of ${total} rows` : `${total} rows`;
    };
    let waiting;
    input.addEventListener('input', () => { clearTimeout(waiting); waiting = setTimeout(filter, 80); });
    filter();
  }

  for (const plot of all('.plot')) {
    const button = document.createElement('button');
    button.type = 'button';
    button.className = 'enlarge';
    button.textContent = 'Enlarge';
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
