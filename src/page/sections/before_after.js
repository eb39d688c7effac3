import { el } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { mm } from '../core/format.js';
import { distance, mainColumns, readingsOf } from '../core/residuals.js';
import { lowerQuantile, quantile, rms } from '../core/statistics.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';

export const title = 'Before and after';

export const isShown = (part) => part.kind === 'estimate' && Boolean(part.document.accuracy?.fit);

const columnsOf = (accuracy) =>
  [
    ['nominal', accuracy.nominal],
    ['calibrated', accuracy.fit],
    ['means', accuracy.fit_means],
    ['held out', accuracy.held_out?.samples],
    ['held-out means', accuracy.held_out?.means],
    ['verification', accuracy.verification],
    ['not in plan', accuracy.left_out],
    ['validation', accuracy.validation],
  ].filter(([, metrics]) => metrics);

const metricRows = [
  ['distance RMS', (m) => m.distance_rms_mm],
  ['distance max', (m) => m.distance_max_mm],
  ['distance mean', (m) => m.distance_mean_mm],
  ['distance 95 %', (m) => m.distance_p95_mm],
  ...['x', 'y', 'z'].flatMap((axis) => [
    [`${axis} RMS`, (m) => m.coordinate_rms_mm?.[axis]],
    [`${axis} max`, (m) => m.coordinate_max_mm?.[axis]],
  ]),
  ['turn RMS/mrad', (m) => m.orientation_rms_mrad],
  ['turn max/mrad', (m) => m.orientation_max_mrad],
];

/** As the program prints it. */
function accuracyTable(accuracy) {
  const columns = columnsOf(accuracy);
  const rows = metricRows
    .filter(([, pick]) => pick(columns[0][1]) !== undefined)
    .map(([name, pick]) => [name, ...columns.map(([, metrics]) => (metrics.point_count > 0 ? mm(pick(metrics)) : '-'))]);
  return table('Accuracy', ['error/mm', ...columns.map(([name]) => name)], rows);
}

/** Poses that it is judged on and not made with: key, name, colour. */
const judged = [
  ['validation', 'validation', 'fourth'],
  ['verification', 'verification', 'third'],
  ['left_out', 'not in plan', 'needed'],
];

/** Residuals of all readings: of the nominal robot, held out, calibrated, and at the poses it is judged on. */
function setsOf(residuals) {
  const columns = mainColumns(residuals);
  const own = [
    ['nominal', 'nominal', 'muted'],
    ['held_out', 'held out', 'second'],
    ['residual', 'calibrated', 'accent'],
  ].map(([key, name, colour]) => ({ name, colour, rows: residuals.rows.filter((row) => row[key]).map((row) => ({ target: row.target, values: row[key] })) }));
  const others = judged.map(([key, name, colour]) => ({
    name,
    colour,
    isJudged: true,
    rows: String(residuals[key]?.axes) === String(residuals.axes) ? readingsOf(residuals[key], 'residual') : [],
  }));
  return [...own, ...others].filter((set) => set.rows.length > 0).map((set) => ({ ...set, values: set.rows.map((row) => distance(row.values, columns)) }));
}

function logBins(sets, count) {
  const all = sets.flatMap((set) => set.values).filter((value) => value > 0);
  const [low, high] = [quantile(all, 0.002), all.reduce((a, b) => Math.max(a, b)) * 1.0001];
  return Array.from({ length: count + 1 }, (unused, k) => low * (high / low) ** (k / count));
}

function histogram(sets, unit) {
  const edges = logBins(sets, 40);
  const counts = sets.map(({ values, isJudged }) => {
    const list = new Array(edges.length).fill(0);
    for (const value of values) {
      let k = edges.findIndex((edge) => edge > value) - 1;
      if (k < 0) k = value < edges[0] ? 0 : edges.length - 2;
      list[k] += 1;
    }
    return list.map((number) => (number > 0 || isJudged ? (100 * number) / values.length : null));
  });
  return chart({
    label: `Histogram of errors of readings: ${sets.map(({ name, values }) => `${name} around ${mm(quantile(values, 0.5))} ${unit}`).join(', ')}`,
    x: { label: `error of a reading/${unit}`, log: true, range: [edges[0], edges.at(-1)], ticks: logTicks(edges[0], edges.at(-1)) },
    y: { label: 'readings/%', range: [0, 1.06 * Math.max(...counts.flat())] },
    xs: edges,
    height: 260,
    series: sets.map(({ name, colour, isJudged }, k) => ({
      label: name,
      colour,
      values: counts[k],
      ...(isJudged ? { kind: 'steps', width: 2 } : { kind: 'bars', width: 1 }),
    })),
  });
}

function logTicks(low, high) {
  const list = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power) {
    for (const digit of [1, 2, 5]) list.push(Number((digit * 10 ** power).toPrecision(2)));
  }
  return list.filter((value) => value >= low && value <= high);
}

/** Of poses whose residuals are not at hand: where 95 % and all of them are below. */
function marksOf(accuracy, sets, unit) {
  if (unit !== 'mm') return [];
  return judged
    .filter(([key, name]) => accuracy[key]?.point_count > 0 && !sets.some((set) => set.name === name))
    .map(([key, name, colour]) => ({
      name: `${name}, 95 % and largest`,
      colour,
      at: [
        [accuracy[key].distance_p95_mm, 95],
        [accuracy[key].distance_max_mm, 100],
      ],
    }));
}

function cumulative(sets, marks, unit) {
  const all = [...sets.flatMap((set) => set.values), ...marks.flatMap((one) => one.at.map(([x]) => x))];
  const high = all.reduce((a, b) => Math.max(a, b)) * 1.05;
  const low = Math.max(quantile(all, 0.01), high / 3000);
  const xs = [...Array.from({ length: 181 }, (unused, k) => low * (high / low) ** (k / 180)), ...marks.flatMap((one) => one.at.map(([x]) => x))].sort(
    (a, b) => a - b,
  );
  const series = sets.map(({ name, colour, values }) => {
    const sorted = Float64Array.from(values).sort();
    let k = 0;
    return {
      label: name,
      colour,
      width: 2.5,
      values: xs.map((x) => {
        while (k < sorted.length && sorted[k] <= x) ++k;
        return (100 * k) / sorted.length;
      }),
    };
  });
  const dots = marks.map(({ name, colour, at }) => ({
    label: name,
    colour,
    kind: 'dots',
    size: 9,
    values: xs.map((x) => at.find(([place]) => place === x)?.[1] ?? null),
  }));
  const level = (value) => ({ label: `${value} %`, values: xs.map(() => value), colour: 'muted', width: 1, dash: [3, 4] });
  return chart({
    label: `Cumulative curves of errors: ${sets.map(({ name, values }) => `${name} 95 % below ${mm(quantile(values, 0.95))} ${unit}`).join(', ')}`,
    x: { label: `error of a reading below/${unit}`, log: true, range: [low, high], ticks: logTicks(low, high) },
    y: { label: 'readings/%', range: [0, 102] },
    xs,
    series: [...series, ...dots, level(50), level(95)],
    height: 260,
  });
}

const summary = (values) => [rms(values), lowerQuantile(values, 0.5), lowerQuantile(values, 0.95), Math.max(...values)].map(mm);

function targetTable(sets, unit) {
  const names = [...new Set(sets.flatMap((set) => set.rows.map((row) => row.target)))];
  const rows = names
    .flatMap((target) =>
      sets.map((set) => {
        const values = set.values.filter((unused, k) => set.rows[k].target === target);
        return values.length === 0 ? null : [String(target), set.name, String(values.length), ...summary(values)];
      }),
    )
    .filter(Boolean);
  return table('Each target', ['target', 'of', 'readings', `RMS/${unit}`, `50 %/${unit}`, `95 %/${unit}`, `max/${unit}`], rows);
}

function axisTable(sets, { axes, unit }) {
  const rows = axes.flatMap((axis, k) => sets.map((set) => [axis, set.name, ...summary(set.rows.map((row) => Math.abs(row.values[k]))), unit[k]]));
  return table('Each axis, absolute values', ['axis', 'of', 'RMS', '50 %', '95 %', 'max', ''], rows);
}

function figures({ residuals, document }) {
  const sets = setsOf(residuals);
  const unit = residuals.unit[0];
  const quantiles = table(
    'Errors of readings',
    ['of', 'readings', `RMS/${unit}`, `50 %/${unit}`, `95 %/${unit}`, `max/${unit}`],
    sets.map(({ name, values }) => [name, String(values.length), ...summary(values)]),
  );
  return el(
    'div',
    { class: 'figures' },
    figure('Errors of all readings; the scale of errors is logarithmic.', histogram(sets, unit), [targetTable(sets, unit)]),
    figure('Part of the readings whose error is below; dotted: 50 and 95 %.', cumulative(sets, marksOf(document.accuracy, sets, unit), unit), [
      quantiles,
      axisTable(sets, residuals),
    ]),
  );
}

export function render(part) {
  const { accuracy } = part.document;
  const held = accuracy.held_out;
  const others = judged.filter(([key]) => accuracy[key]).map(([, name]) => name);
  return el(
    'div',
    {},
    lead(
      'Nominal: base and targets fitted only. Calibrated: the measurements themselves. ',
      held
        ? `Held out: each predicted by a calibration without it, ${held.folds} folds, ${held.failures.length} of them not identifiable.`
        : 'Nothing was held out.',
      others.length > 0 ? ` ${others.join(', ')}: poses that it was not made with.`.replace(/[a-z]/, (first) => first.toUpperCase()) : null,
    ),
    part.residuals?.rows.length > 0 ? figures(part) : null,
    accuracyTable(accuracy),
  );
}
