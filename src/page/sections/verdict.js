import { el } from '../core/dom.js';
import { facts } from '../core/table.js';
import { answerExport } from './verdict_export.js';

export const title = 'Verdict';

export const isShown = ({ kind }) => ['plan', 'estimate', 'study', 'blocks study', 'export'].includes(kind);

const sentence = (text) => `${text.slice(0, 1).toUpperCase()}${text.slice(1)}.`;

/** What the program warned of, and faults that no warning names. */
export function warningsOf({ warnings, faults }) {
  const said = Array.isArray(warnings) ? warnings.map(String) : [];
  return [...(faults ?? []).map(String).filter((fault) => !said.some((text) => text.includes(fault))), ...said];
}

/** The answers of the program: the first one sums up. */
export function render({ kind, document }) {
  const [first, ...others] = kind === 'export' ? answerExport(document) : (document.answers ?? []);
  return el(
    'div',
    {},
    el('p', { class: 'verdict' }, first ? sentence(first.text) : 'This document has no answers yet: make it again with this posewise.'),
    warningsOf(document).map((text) => el('p', { class: 'warning', role: 'note' }, text)),
    facts(others.map(({ question, text }) => [question, sentence(text)])),
  );
}
