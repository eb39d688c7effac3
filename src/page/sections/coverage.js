import { el } from '../core/dom.js';
import { figure, lead, note } from '../core/figure.js';
import { count, fixed, mm, short } from '../core/format.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';
import { dotRows } from '../draw/dot_rows.js';

export const title = 'Coverage: predicted against found';

const isNumber = (value) => typeof value === 'number';

const sets = { validation: 'validation', verification: 'verification', left_out: 'not in plan' };

/**
 * Of an estimate: pairs of what it expects and what was found, of the same thing: means of repeats held out with the means expected there,
 * readings of poses that it was not made with. Where parameters are little known they are known worse at a pose held out: no pair.
 */
function pairsOf({ accuracy }) {
  const { at_measured: expected } = accuracy?.expected ?? {};
  const unit = expected && 'total_mrad' in expected ? 'mrad' : 'mm';
  const [parameters, leftOver, noise] = ['parameters', 'left_over', 'noise'].map((part) => expected?.[`${part}_${unit}`] ** 2);
  const isByFewPoses = 2 * parameters > leftOver + noise;
  const heldOut = {
    name: 'held out, means',
    predicted: isByFewPoses ? null : expected?.[`total_${unit}`],
    found: accuracy?.held_out?.means[unit === 'mm' ? 'distance_rms_mm' : 'orientation_rms_mrad'],
  };
  const judged = (accuracy?.judged ?? [])
    .filter((one) => one.group !== 'repeated')
    .map((one) => ({
      name: `${sets[one.poses]}, ${one.group}`,
      predicted: one[`expected_${unit}`],
      found: one[`rms_${unit}`],
      low: one[`lower_${unit}`],
      high: one[`upper_${unit}`],
    }));
  return [heldOut, ...judged].filter(({ predicted, found }) => isNumber(predicted) && isNumber(found)).map((one) => ({ ...one, unit }));
}

const studyRows = ({ models, unit = 'mm' }) =>
  (models ?? []).flatMap((model) =>
    model.rows.flatMap((row) =>
      row.planned
        .filter((one) => isNumber(one[`held_out_rms_${unit}`]) && isNumber(one[`expected_rms_${unit}`]))
        .map((one) => ({
          model: model.name,
          count: row.pose_count,
          criterion: one.criterion,
          predicted: one[`expected_rms_${unit}`],
          found: one[`held_out_rms_${unit}`],
        })),
    ),
  );

export const isShown = ({ kind, document }) =>
  kind === 'plan'
    ? Boolean(document.monte_carlo?.robot_count)
    : kind === 'estimate'
      ? pairsOf(document).length > 0
      : kind === 'study' && studyRows(document).length > 0;

/** To the first digit that is not sure. */
function foundText({ found_mm: found, uncertainty_mm: sure }) {
  if (!isNumber(found) || !isNumber(sure)) return '-';
  const decimals = Math.min(6, Math.max(0, -Math.floor(Math.log10(2 * sure))));
  return fixed(found, decimals);
}

function ofPlan({ document }) {
  const checked = document.monte_carlo;
  const names = { rms: 'RMS', p95: '95 % of positions', max: 'maximum' };
  const list = [
    [checked.quantity === 'rms' ? 'expected' : 'median', checked.expected],
    ['5 % below', checked.lower],
    ['95 % below', checked.upper],
  ];
  if (checked.assurance !== 0.95) list.push([`${short(100 * checked.assurance)} % below`, checked.assured]);
  const shown = list.filter(([, one]) => one);
  const rows = shown.map(([name, one]) => [name, mm(one.predicted_mm), foundText(one), isNumber(one.uncertainty_mm) ? short(2 * one.uncertainty_mm, 2) : '-']);
  const dots = shown.map(([name, one]) => ({
    name,
    at: one.found_mm,
    other: one.predicted_mm,
    low: one.found_mm - 2 * (one.uncertainty_mm ?? NaN),
    high: one.found_mm + 2 * (one.uncertainty_mm ?? NaN),
  }));
  const limit = { kept: 'The limit is kept.', 'not kept': 'The limit is not kept.', open: 'Too close to the limit to say.' }[checked.limit];
  return el(
    'div',
    {},
    lead(
      `Of ${count(checked.robot_count, 'robot')} that were drawn, measured at these poses and calibrated${checked.expected_robot_count ? `, and ${checked.expected_robot_count} of expected sizes` : ''}: ${checked.is_sure ? 'sure as asked' : 'not as sure as asked'}. ${limit ?? ''}`,
    ),
    figure(
      'Open circles: closed form; dots: Monte Carlo, with two standard deviations.',
      dotRows(`Closed form and Monte Carlo: ${rows.map((row) => `${row[0]} ${row[1]} and ${row[2]} mm`).join(', ')}`, 'position error/mm', dots),
      [
        table(
          `Position error (${names[checked.quantity] ?? checked.quantity}) as predicted, and of robots that were drawn and calibrated`,
          ['quantity', 'closed form/mm', 'Monte Carlo/mm', 'sure to/mm'],
          rows,
        ),
      ],
    ),
    checked.uncalibrated_count > 0 ? note(`${count(checked.uncalibrated_count, 'robot')} could not be calibrated, and count as the worst.`) : null,
  );
}

function ofEstimate(part) {
  const pairs = pairsOf(part.document);
  const [{ unit }] = pairs;
  const rows = pairs.map((one) => [
    one.name,
    mm(one.predicted),
    mm(one.found),
    isNumber(one.low) ? `${mm(one.low)}..${mm(one.high)}` : '-',
    fixed(one.found / one.predicted, 2),
  ]);
  return el(
    'div',
    {},
    lead('What the calibration expects, and what was found: held out of the means of repeats, elsewhere of each reading. The fit itself is no test.'),
    figure(
      'Open circles: predicted; dots: found, with 95 % confidence where it is known.',
      dotRows(
        `Predicted and found: ${rows.map((row) => row.slice(0, 3).join(' ')).join(', ')}`,
        `RMS/${unit}`,
        pairs.map((one) => ({ name: one.name, at: one.found, low: one.low, high: one.high, other: one.predicted })),
      ),
      [table('RMS, predicted and found', ['where', `predicted/${unit}`, `found/${unit}`, '95 %', 'found/predicted'], rows)],
    ),
  );
}

function ofStudy({ document }) {
  const list = studyRows(document);
  const keys = [...new Set(list.map((one) => JSON.stringify([one.model, one.criterion])))].map((key) => JSON.parse(key));
  const xs = [...new Set(list.map((one) => one.count))].sort((a, b) => a - b);
  const colours = ['accent', 'second', 'third', 'fourth'];
  const series = keys.map(([model, criterion], k) => ({
    label: [model, criterion].filter(Boolean).join(', '),
    colour: colours[k % colours.length],
    kind: 'both',
    values: xs.map((x) => {
      const one = list.find((row) => row.model === model && row.criterion === criterion && row.count === x);
      return one ? one.found / one.predicted : null;
    }),
  }));
  const ratios = list.map((one) => one.found / one.predicted).sort((a, b) => a - b);
  return el(
    'div',
    {},
    lead(
      `Found against predicted error of planned poses: ${fixed(ratios[0], 2)} to ${fixed(ratios.at(-1), 2)} times; 1 is right, above 1 predictions are too small.`,
    ),
    figure(
      'Error found, divided by what the calibrations expect.',
      chart({
        label: `Found divided by predicted error: ${list.map((one) => `${one.criterion} ${one.count} poses ${fixed(one.found / one.predicted, 2)}`).join(', ')}`,
        x: { label: 'poses', ticks: xs.length <= 10 ? xs : undefined },
        y: { label: 'found/predicted', range: [Math.min(0.5, ratios[0] * 0.95), Math.max(1.5, ratios.at(-1) * 1.05)] },
        xs,
        height: 240,
        series: [...series, { label: 'as predicted', values: xs.map(() => 1), colour: 'muted', dash: [4, 4], width: 1.5 }],
      }),
      [
        table(
          'Predicted and found, medians',
          ['poses', 'by', 'predicted/mm', 'found/mm', 'found/predicted'],
          list.map((one) => [
            String(one.count),
            [one.model, one.criterion].filter(Boolean).join(', '),
            mm(one.predicted),
            mm(one.found),
            fixed(one.found / one.predicted, 2),
          ]),
        ),
      ],
    ),
  );
}

export const render = (part) => ({ plan: ofPlan, estimate: ofEstimate, study: ofStudy })[part.kind](part);
