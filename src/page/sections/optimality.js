import { el } from '../core/dom.js';
import { behind, lead, note } from '../core/figure.js';
import { count, fixed, milli, short } from '../core/format.js';
import { idsOf } from '../core/poses.js';
import { facts, table } from '../core/table.js';

export const title = 'What the plan is best for';

export const isShown = (part) => part.kind === 'plan';

const meanings = {
  o1: 'volume of the singular values (O1)',
  o2: 'inverse condition number (O2)',
  o3: 'worst direction (O3)',
  o4: 'noise amplification (O4)',
  o5: 'sum of inverse singular values (O5)',
  a: 'mean variance of parameters (A)',
  d: 'volume of the confidence ellipsoid (D)',
  e: 'worst direction (E)',
  g: 'worst prediction (G)',
  v: 'mean prediction (V)',
};

/** A value of the criterion; of planned poses V and G are inverse squares of position errors. */
function valueOf({ document }, value) {
  const isOfPositions = document.candidates.kind === 'pool' && ['v', 'g'].includes(document.criterion);
  return value === null || value === undefined ? 'not known' : `${short(value, 8)}${isOfPositions ? ' /m^2' : ''}`;
}

function ofPool(part) {
  const { pool, continuous } = part.document.bounds;
  return [
    ['Best choice from the pool', pool.value === undefined ? null : valueOf(part, pool.value)],
    ['Bound over the pool', `${valueOf(part, pool.bound)}, proven: no choice from the pool has a larger value`],
    ['Efficiency of that choice', `${fixed(pool.efficiency, 4)} proven`],
    [
      'Bound beyond the pool',
      continuous?.bound === null || continuous?.bound === undefined
        ? 'not searched'
        : `${valueOf(part, continuous.bound)}, efficiency ${fixed(continuous.efficiency, 4)}: by a search, not a proof`,
    ],
  ];
}

function rejectionTable({ pool }) {
  if (!pool?.rejections?.length) return null;
  return table(
    'Why candidates of the pool were left out',
    ['constraint', 'in all', 'first'],
    pool.rejections.map((one) => [one.constraint, String(one.in_all), String(one.first)]),
  );
}

function deviationTable({ predicted }) {
  const deviations = Object.entries(predicted?.standard_deviation ?? {});
  if (deviations.length === 0) return null;
  return table(
    'Expected standard deviation of each parameter',
    ['parameter', 'std dev', ''],
    deviations.map(([key, value]) => [key.replace(/_(m|rad)$/, ''), milli(value), key.endsWith('_rad') ? 'mrad' : 'mm']),
  );
}

export function render(part) {
  const { document } = part;
  const { search } = document;
  const efficiency = document.bounds ? document.bounds.pool.efficiency : document.efficiency;
  return el(
    'div',
    {},
    lead(`The poses have the best ${meanings[document.criterion] ?? document.criterion} that was found.`),
    facts([
      ['Chosen', document.bounds ? null : idsOf(document)],
      ['Criterion', document.criterion],
      ['Value', valueOf(part, document.value)],
      ...(document.bounds
        ? ofPool(part)
        : [
            ['Bound', `${valueOf(part, document.bound)}, proven: no choice has a larger value`],
            ['Efficiency', `${fixed(document.efficiency, 4)} proven`],
          ]),
      ['Starts', `${search.starts_at_best} of ${search.starts} ended at the best`],
      ['Ended', search.stop_reason],
      ['Choices tried by branch and bound', search.tried],
    ]),
    efficiency < 0.9
      ? note(`The bound is loose at so few poses: ${search.starts_at_best} of ${count(search.starts, 'independent start')} ended at this value.`)
      : null,
    behind([rejectionTable(document), deviationTable(document)], 'Numbers behind the plan'),
  );
}
