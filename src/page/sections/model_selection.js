import { el } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { mm } from '../core/format.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';

export const title = 'Model selection';

export const isShown = (part) => Boolean(part.document.model_selection?.sets?.length);

export function render(part) {
  const { sets, folds, best, recommended } = part.document.model_selection;
  const mark = ({ name }) => [name === recommended ? 'recommended' : '', name === best ? 'best' : ''].filter(Boolean).join(', ');
  const judged = sets.filter((set) => typeof set.held_out_rms_mm === 'number');
  const xs = judged.map((set) => set.parameter_count);
  const values = (pick) => judged.map(pick);
  const figureOf = () =>
    chart({
      label: `Held-out error against number of parameters: ${judged.map((set) => `${set.name} ${mm(set.held_out_rms_mm)} mm`).join(', ')}`,
      x: { label: 'parameters', ticks: xs },
      y: { label: 'RMS of means/mm', log: true },
      xs,
      height: 260,
      series: [
        { label: 'held out', values: values((set) => set.held_out_rms_mm), colour: 'accent', kind: 'both' },
        { label: 'fit', values: values((set) => set.fit_rms_mm), colour: 'second', kind: 'both', dash: [6, 5] },
      ],
      bands: [
        {
          label: 'one standard error',
          low: values((set) => Math.max(1e-9, set.held_out_rms_mm - set.standard_error_mm)),
          high: values((set) => set.held_out_rms_mm + set.standard_error_mm),
          colour: 'accent',
          alpha: 0.18,
        },
      ],
    });
  const numbers = table(
    'Parameter sets, each holding those above it',
    ['set', 'parameters', 'fit RMS/mm', 'held-out RMS/mm', 'std. error/mm', ''],
    sets.map((set) => [set.name, String(set.parameter_count), mm(set.fit_rms_mm), mm(set.held_out_rms_mm), mm(set.standard_error_mm), mark(set)]),
  );
  const failures = sets.filter((set) => set.failure).map((set) => el('p', {}, `${set.name}: ${set.failure}`));
  return el(
    'div',
    {},
    lead(
      recommended
        ? `Recommended: ${recommended}, the smallest set within one standard error of the best; ${folds} folds over configurations.`
        : 'No set could be judged.',
    ),
    judged.length > 1 ? figure('Error of configurations held out, and of the fit, against the number of parameters.', figureOf(), [numbers]) : numbers,
    failures,
  );
}
