import { el, svg } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { fixed, mm } from '../core/format.js';
import { table } from '../core/table.js';

export const title = 'Uncertainty budget';

/** Parts of the expected RMS whose squares add up, and the unit; null where none are stated. */
export function budgetOf({ document }) {
  const { budget } = document;
  if (budget) {
    return {
      unit: 'mm',
      total: budget.total_mm,
      where: 'What the position error is expected to consist of',
      parts: [
        ['parameters, by noise of measuring', budget.noise_mm],
        ['parameters, by the model error', budget.model_mm],
        ['parameters, left of their prior', budget.prior_mm],
        ['left over: the model error itself', budget.left_over_mm],
        ['repeatability of one visit', budget.repeatability_mm],
      ],
    };
  }
  const expected = document.accuracy?.expected?.at_measured;
  if (!expected) return null;
  const unit = 'total_mm' in expected ? 'mm' : 'mrad';
  return {
    unit,
    total: expected[`total_${unit}`],
    where: 'Expected at poses like these',
    parts: [
      ['parameters', expected[`parameters_${unit}`]],
      ['left over: the model error itself', expected[`left_over_${unit}`]],
      ['noise of the instrument', expected[`noise_${unit}`]],
    ],
  };
}

export const isShown = (part) => budgetOf(part) !== null;

const colours = ['accent', 'second', 'third', 'muted', 'fourth'];

export function render(part) {
  const { parts, total, unit, where } = budgetOf(part);
  const shares = parts.map(([, value]) => (total > 0 ? (value / total) ** 2 : 0));
  const rows = [...parts.map(([name, value], k) => [name, mm(value), `${fixed(100 * shares[k], 1)} %`]), ['all', mm(total), '100.0 %']];
  let at = 0;
  const label = `${where}: ${parts.map(([name], k) => `${name} ${fixed(100 * shares[k], 1)} %`).join(', ')}`;
  const bar = svg(
    'svg',
    { viewBox: '0 0 1000 44', preserveAspectRatio: 'none', class: 'budget-bar', role: 'img', 'aria-label': label },
    parts.map((unused, k) => {
      const piece = svg('rect', { x: 1000 * at, y: 0, width: Math.max(0, 1000 * shares[k] - 1.5), height: 44, class: `fill-${colours[k % colours.length]}` });
      at += shares[k];
      return piece;
    }),
  );
  const names = el(
    'ul',
    { class: 'legend' },
    parts.map(([name, value], k) =>
      shares[k] === 0
        ? null
        : el(
            'li',
            {},
            el('span', { class: `key key-block fill-${colours[k % colours.length]}` }),
            `${name}: ${mm(value)} ${unit}, ${fixed(100 * shares[k], 1)} %`,
          ),
    ),
  );
  return el(
    'div',
    {},
    lead(`Squares add up: together ${mm(total)} ${unit} RMS.`),
    figure(where, el('div', {}, names, bar), [table(where, ['part', `RMS/${unit}`, 'of the square'], rows)]),
  );
}
