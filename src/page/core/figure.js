import { el } from './dom.js';

/** A figure with its caption, and the numbers it draws as tables behind it. */
export function figure(caption, drawing, tables = []) {
  return el('figure', {}, drawing, caption ? el('figcaption', {}, caption) : null, behind(tables));
}

/** Tables that open on demand. */
export function behind(tables, summary = 'Numbers of this figure') {
  const shown = tables.filter(Boolean);
  return shown.length === 0 ? null : el('details', {}, el('summary', {}, summary), shown);
}

/** A sentence or two below a heading. */
export const lead = (...text) => el('p', { class: 'lead' }, ...text);
export const note = (...text) => el('p', { class: 'note' }, ...text);
