import { count, fixed, mm } from '../core/format.js';
import { moreFor } from '../core/curve.js';
import { noDrift } from './verdict_plan.js';
import { warningsOf } from './warnings.js';

/** Where more poses stop paying, if they do: the least number within 10 % of the best found. */
function enoughOf(points) {
  const best = Math.min(...points.map((one) => one.value));
  return points.find((one) => one.value <= 1.1 * best);
}

function pointsOf(model, c) {
  return model.rows.filter((row) => row.planned[c]?.held_out_rms_mm)
    .map((row) => ({ count: row.pose_count, value: row.planned[c].held_out_rms_mm, row, one: row.planned[c] }));
}

function moreOf(points) {
  const steps = points.map(({ count: n }) => [n, moreFor(points, n)]).filter(([, found]) => found?.more);
  if (steps.length === 0) return `Not seen: no number of poses up to ${points.at(-1).count} leaves 20 % less than a smaller one.`;
  const last = points.at(-1).count;
  const [largest] = steps.at(-1);
  const rest = largest < last ? ` Beyond ${largest} poses up to ${last} no 20 % were gained.` : '';
  return `${steps.slice(0, 8).map(([n, { more }]) => `from ${n}: ${more} more`).join('; ')}.${rest}`;
}

function verdictsOf(model, c) {
  const lists = new Map();
  for (const row of model.rows) {
    const verdict = row.planned[c]?.against_random?.verdict ?? 'not known';
    lists.set(verdict, [...(lists.get(verdict) ?? []), row.pose_count]);
  }
  return [...lists].map(([verdict, counts]) => `${verdict} at ${counts.join(', ')}`).join('; ');
}

/** What one model or variation comes to. */
function sentenceOf(points, what, trials) {
  const enough = enoughOf(points);
  const random = enough.row.random?.held_out_rms_p50_mm;
  const more = enough === points.at(-1) ? 'more were not tried' : 'more gain less than 10 %';
  return `${count(enough.count, 'pose')} chosen by ${enough.one.criterion} leave ${mm(enough.value)} mm RMS ${what} (median of ${trials})${random ? `, random ones ${mm(random)} mm` : ''}; ${more}.`;
}

export function answerStudy(part) {
  const { document } = part;
  const models = document.models.map((model) => ({ model, points: pointsOf(model, 0) })).filter(({ points }) => points.length > 0);
  if (models.length === 0) return { sentence: 'No number of poses of this study identifies the model.', warnings: warningsOf(document), rows: [] };
  const [{ model, points }, ...others] = models;
  const enough = enoughOf(points);
  const { one } = enough;
  const { criterion } = one;
  const what = document.simulated ? 'over the workspace' : 'on configurations held out';
  const ratio = one.against_random;
  const trials = count(enough.row.splits ?? document.splits, document.simulated ? 'robot' : 'split');
  return {
    sentence: `${model.name ? `${model.name}: ` : ''}${sentenceOf(points, what, trials)}`,
    warnings: warningsOf(document),
    rows: [
      ['How accurate', `${mm(enough.value)} mm RMS ${what} with ${count(enough.count, 'pose')}${model.name ? ` (${model.name})` : ''}; the calibrations themselves expect ${mm(one.expected_rms_mm)} mm.`],
      ['How sure', ratio ? `Planned against random ${fixed(ratio.ratio, 2)}, with 95 % confidence ${fixed(ratio.lower, 2)} to ${fixed(ratio.upper, 2)}; medians over ${trials}, judged on ${count(document.judged_on, 'configuration')}.` : null],
      ['Does planning pay', `${criterion}, planned against random: ${verdictsOf(model, 0)}.`],
      ['What limits it', points.length === 1 ? 'One number of poses does not tell.' : enough === points.at(-1) ? 'The number of poses: the error still falls at the most that were tried.'
        : `Beyond ${count(enough.count, 'pose')} the number of poses does not: what is left is noise and what the model cannot express.`],
      ['Which pose matters most', 'A study compares numbers of poses; a plan says what each pose is worth.'],
      ['Drift', document.simulated ? noDrift : 'Not looked at here: a calibration of all measurements shows it.'],
      ...others.map((other) => [other.model.name, sentenceOf(other.points, what, trials)]),
      ['Poses more for 20 % better', moreOf(points)],
    ],
  };
}
