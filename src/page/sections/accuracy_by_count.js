import { el } from '../core/dom.js';
import { figure, lead, note } from '../core/figure.js';
import { fixed, mm, percent, short } from '../core/format.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';
import { plannedCurve } from '../core/curve.js';
import { studyFigures } from './study_curve.js';

export const title = 'Accuracy against number of poses';

export const isShown = (part) => (part.kind === 'study' ? part.document.models?.some((model) => model.rows.length > 0) : plannedCurve(part.document) !== null);

const quantities = { rms: 'RMS', p95: '95 % of positions', max: 'maximum' };

function planTable({ document }, curve) {
  if (document.target) {
    const below = `${short(100 * document.target.assurance)} % below/mm`;
    return table(
      `Position error (${quantities[document.target.quantity] ?? document.target.quantity}) by number of poses, model error and repeatability included`,
      ['new poses', 'how', 'expected/mm', '5..95 %/mm', below, 'minutes'],
      document.target.curve.map((one) => [
        String(one.new_pose_count),
        one.is_planned ? 'planned' : 'chosen from the pool',
        mm(one.error?.expected_mm),
        one.error ? `${mm(one.error.lower_mm)}..${mm(one.error.upper_mm)}` : '-',
        mm(one.error?.assured_mm),
        one.duration_s > 0 ? fixed(one.duration_s / 60, 1) : '-',
      ]),
    );
  }
  return table(
    'Predicted position error by number of poses',
    ['new poses', 'how', 'RMS/mm', '95 %/mm', 'with model error/mm', '90 % interval'],
    document.other_counts.map(({ new_pose_count: number, is_planned: isPlanned, accuracy: a }) => [
      String(number),
      isPlanned ? 'planned' : 'chosen from the pool',
      mm(a?.rms_mm),
      mm(a?.p95_mm),
      mm(a?.total_rms_mm),
      a ? `${mm(a.total_lower_mm)}..${mm(a.total_upper_mm)}` : '-',
    ]),
  );
}

function planFigure(part) {
  const curve = plannedCurve(part.document);
  const chosen = curve.points.filter((one) => !one.isPlanned);
  const xs = [...new Set(curve.points.map((one) => one.count))].sort((a, b) => a - b);
  const at = (list, key) => xs.map((x) => list.find((one) => one.count === x)?.[key] ?? null);
  const planned = curve.points.filter((one) => one.isPlanned);
  const level = (value) => xs.map(() => value);
  const band = chosen.length > 1 ? chosen : curve.points;
  const series = [
    { label: 'chosen from the pool, expected', values: at(chosen, 'expected'), colour: 'second', kind: 'both', size: 6 },
    { label: 'planned, expected', values: at(planned, 'expected'), colour: 'accent', kind: 'dots', size: 11 },
    { label: 'by the parameters alone, chosen', values: at(chosen, 'parameters'), colour: 'third', kind: 'line', dash: [6, 5] },
    { label: `floor: ${mm(curve.floor)} mm, were all parameters known`, values: level(curve.floor), colour: 'muted', kind: 'line', dash: [2, 4] },
    {
      label: `target: ${short(curve.limit)} mm with ${percent(curve.assurance ?? 0)}`,
      values: level(curve.limit),
      colour: 'fourth',
      kind: 'line',
      dash: [10, 4],
    },
    { label: 'planned, with the assurance asked for', values: at(planned, 'assured'), colour: 'fourth', kind: 'dots', size: 9 },
  ].filter((one) => one.values.some((value) => typeof value === 'number'));
  const bands = [
    { label: '90 % interval, over robots whose model error differs', low: at(band, 'lower'), high: at(band, 'upper'), colour: 'second', alpha: 0.15 },
  ];
  return figure(
    'Predicted position error over the workspace against the number of new poses.',
    chart({
      label: `Predicted position error against number of poses: ${curve.points.map((one) => `${one.count} poses ${mm(one.expected)} mm`).join(', ')}`,
      x: { label: 'new poses', ticks: xs.length <= 9 ? xs : undefined },
      y: { label: `position error ${quantities[part.document.target?.quantity ?? 'rms']}/mm`, log: true },
      xs,
      series,
      bands,
    }),
    [planTable(part, curve)],
  );
}

export function render(part) {
  if (part.kind === 'study') return studyFigures(part);
  const { document } = part;
  const curve = plannedCurve(document);
  const text = document.target?.limit_mm
    ? `${short(document.target.limit_mm)} mm were asked for with ${short(100 * document.target.assurance)} % assurance: ${curve.current.count} new poses keep ${mm(document.target.error.assured_mm)} mm; the floor, were all parameters known, is ${mm(document.target.floor.assured_mm)} mm.`
    : `${curve.current.count} poses are expected to leave ${mm(curve.current.expected)} mm RMS, model error included.`;
  return el(
    'div',
    {},
    lead(text),
    planFigure(part),
    note(
      'No measurement has been made for this curve: it is computed from the noise and model error that the campaign states. "study" finds such a curve on measurements or on robots that are drawn.',
    ),
  );
}
