import { el } from '../core/dom.js';
import { figure, lead, note } from '../core/figure.js';
import { count, fixed, short } from '../core/format.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';

export const title = 'Value against number of poses';

export const isShown = ({ kind, document }) => kind === 'blocks study' && document.rows.length > 0;

const share = (efficiency) => (typeof efficiency === 'number' ? fixed(100 * efficiency, 2) : '-');

function valuesTable(criterion, rows) {
  const header = ['poses', 'value', 'bound', 'efficiency/%', 'random 5 %', '50 %', '95 %', 'of the bound/%: 5 %', '50 %', '95 %', 'unidentified'];
  return table(
    `By ${criterion}`,
    header,
    rows.map(({ pose_count: number, value, bound, efficiency, random }) => [
      String(number),
      short(value),
      short(bound),
      share(efficiency),
      ...[5, 50, 95].map((part) => short(random[`value_p${part}`])),
      ...[5, 50, 95].map((part) => share(random[`efficiency_p${part}`])),
      `${random.unidentified} of ${random.subsets}`,
    ]),
  );
}

function ownTable(criterion, rows) {
  const own = rows.flatMap((row) => row.subsets.map((one) => [String(row.pose_count), one.name, short(one.value), share(one.efficiency)]));
  return own.length > 0 ? [table(`Own subsets, by ${criterion}`, ['poses', 'subset', 'value', 'efficiency/%'], own)] : [];
}

function efficiencyFigure(criterion, rows) {
  const xs = rows.map((row) => row.pose_count);
  const at = (pick) => rows.map((row) => pick(row) ?? null).map((one) => (one === null ? null : 100 * one));
  const series = [
    { label: 'chosen', values: at((row) => row.efficiency), colour: 'accent', kind: 'both' },
    { label: 'random, median', values: at((row) => row.random.efficiency_p50), colour: 'muted', width: 1.5 },
    { label: 'own subset', values: at((row) => row.subsets[0]?.efficiency), colour: 'fourth', kind: 'dots', size: 10 },
  ].filter((one) => one.values.some((value) => value !== null));
  const bands = rows.some((row) => row.random.subsets > 0)
    ? [{ label: 'random, 5 to 95 %', low: at((row) => row.random.efficiency_p5), high: at((row) => row.random.efficiency_p95), colour: 'muted' }]
    : [];
  return figure(
    `Share of the most that so many poses can tell, by ${criterion}.`,
    chart({
      label: `Efficiency against number of poses by ${criterion}: ${rows.map((row) => `${row.pose_count} poses ${share(row.efficiency)} %`).join('; ')}`,
      x: { label: 'poses', ticks: xs.length <= 10 ? xs : undefined },
      y: { label: 'efficiency/%' },
      xs,
      series,
      bands,
    }),
    [valuesTable(criterion, rows), ...ownTable(criterion, rows)],
  );
}

export function render({ document }) {
  const { rows } = document;
  const criteria = [...new Set(rows.map((row) => row.criterion))];
  return el(
    'div',
    {},
    lead(`${count(document.candidate_count, 'candidate')}, ${count(document.parameter_count, 'parameter')}.`),
    el(
      'div',
      { class: criteria.length > 1 ? 'figures' : null },
      criteria.map((criterion) =>
        efficiencyFigure(
          criterion,
          rows.filter((row) => row.criterion === criterion),
        ),
      ),
    ),
    note('Efficiency is measured against the bound that is proven for each number of poses; random subsets are the same for all criteria.'),
  );
}
