import { el } from './dom.js';
import { count } from './format.js';

/** A figure with its caption, and the numbers it draws as tables behind it. */
export function figure(caption, drawing, tables = []) {
  return el('figure', {}, drawing, caption ? el('figcaption', {}, caption) : null, behind(tables));
}

/** Tables that open on demand; of closed ones paper says how long they are. */
export function behind(tables, summary = 'Numbers of this figure') {
  const shown = tables.filter(Boolean);
  if (shown.length === 0) return null;
  const rows = shown.reduce((sum, one) => sum + one.querySelectorAll('tbody tr').length, 0);
  return el('details', {}, el('summary', {}, summary, el('span', { class: 'on-paper-only' }, `: ${count(rows, 'row')} in the document`)), shown);
}

/** A sentence or two below a heading. */
export const lead = (...text) => el('p', { class: 'lead' }, ...text);
export const note = (...text) => el('p', { class: 'note' }, ...text);
