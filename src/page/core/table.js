import { el } from './dom.js';

const isNumeric = (cell) => /^(-|[-+]?[\d.]+(e[-+]?\d+)?( %)?|[-+.\d]+\.\.[-+.\d]+)$/.test(cell);

/** Rows that paper has of a table. */
const most = 24;

/**
 * A table of text; columns that hold only numbers are set to the right. The first column names
 * its row.
 */
export function table(caption, header, rows) {
  const numeric = header.map((unused, k) => rows.length > 0 && rows.every((row) => row[k] === '' || row[k] === undefined || isNumeric(String(row[k]))));
  const cell = (tag, k, text, scope) => el(tag, { class: numeric[k] ? 'number' : null, scope }, text ?? '');
  return el(
    'div',
    { class: 'scroll', tabindex: 0, role: 'group', 'aria-label': caption },
    el(
      'table',
      {},
      el(
        'caption',
        {},
        caption,
        rows.length > most ? el('span', { class: 'on-paper-only' }, `: ${most} of ${rows.length} rows, all are in the document`) : null,
      ),
      el(
        'thead',
        {},
        el(
          'tr',
          {},
          header.map((text, k) => (text === '' ? cell('td', k, '') : cell('th', k, text, 'col'))),
        ),
      ),
      el(
        'tbody',
        {},
        rows.map((row, i) =>
          el(
            'tr',
            { class: i < most ? null : 'not-on-paper' },
            header.map((unused, k) => (k === 0 ? cell('th', k, row[k], 'row') : cell('td', k, row[k]))),
          ),
        ),
      ),
    ),
  );
}

/** The same, but not for paper: too wide for it. */
export function screenTable(...arguments_) {
  const element = table(...arguments_);
  element.classList.add('not-on-paper');
  return element;
}

/** A list of what is stated: pairs of a name and text or elements. */
export function facts(pairs) {
  const shown = pairs.filter(([, value]) => value !== null && value !== undefined && value !== '');
  return el(
    'dl',
    { class: 'facts' },
    shown.map(([name, value]) => el('div', {}, el('dt', {}, name), el('dd', {}, value))),
  );
}
