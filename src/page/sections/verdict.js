import { el } from '../core/dom.js';
import { facts } from '../core/table.js';
import { answerEstimate } from './verdict_estimate.js';
import { answerExport } from './verdict_export.js';
import { answerPlan } from './verdict_plan.js';
import { answerStudy } from './verdict_study.js';

export const title = 'Verdict';

export const isShown = (part) => part.kind in answers;

const answers = { plan: answerPlan, estimate: answerEstimate, study: answerStudy, export: answerExport };

/** One sentence, and what people ask first. */
export function render(part, parts) {
  const { sentence, rows, warnings } = answers[part.kind](part, parts);
  return el('div', {}, el('p', { class: 'verdict' }, sentence),
    warnings.map((text) => el('p', { class: 'warning', role: 'note' }, text)), facts(rows));
}
