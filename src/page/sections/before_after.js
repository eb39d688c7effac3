import { el } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { mm } from '../core/format.js';
import { distance, mainColumns } from '../core/residuals.js';
import { lowerQuantile, quantile, rms } from '../core/statistics.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';

export const title = 'Before and after';

export const isShown = (part) => part.kind === 'estimate' && Boolean(part.document.accuracy?.fit);

const columnsOf = (accuracy) => [
  ['nominal', accuracy.nominal], ['calibrated', accuracy.fit], ['means', accuracy.fit_means],
  ['held out', accuracy.held_out?.samples], ['held-out means', accuracy.held_out?.means],
  ['verification', accuracy.verification], ['not in plan', accuracy.left_out], ['validation', accuracy.validation],
].filter(([, metrics]) => metrics);

const metricRows = [
  ['distance RMS', (m) => m.distance_rms_mm], ['distance max', (m) => m.distance_max_mm],
  ['distance mean', (m) => m.distance_mean_mm], ['distance 95 %', (m) => m.distance_p95_mm],
  ...['x', 'y', 'z'].flatMap((axis) => [
    [`${axis} RMS`, (m) => m.coordinate_rms_mm?.[axis]], [`${axis} max`, (m) => m.coordinate_max_mm?.[axis]]]),
  ['turn RMS/mrad', (m) => m.orientation_rms_mrad], ['turn max/mrad', (m) => m.orientation_max_mrad],
];

/** As the program prints it. */
function accuracyTable(accuracy) {
  const columns = columnsOf(accuracy);
  const rows = metricRows.filter(([, pick]) => pick(columns[0][1]) !== undefined)
    .map(([name, pick]) => [name, ...columns.map(([, metrics]) => (metrics.point_count > 0 ? mm(pick(metrics)) : '-'))]);
  return table('Accuracy', ['error/mm', ...columns.map(([name]) => name)], rows);
}

/** Distances of all readings: of the nominal robot, held out, calibrated. */
function setsOf(residuals) {
  const columns = mainColumns(residuals);
  return [['nominal', 'nominal', 'muted'], ['held_out', 'held out', 'second'], ['residual', 'calibrated', 'accent']]
    .map(([key, name, colour]) => ({
      name, key, colour, values: residuals.rows.filter((row) => row[key]).map((row) => distance(row[key], columns)),
    })).filter((set) => set.values.length > 0);
}

function logBins(sets, count) {
  const all = sets.flatMap((set) => set.values).filter((value) => value > 0);
  const [low, high] = [Math.min(quantile(all, 0.002)), Math.max(...all) * 1.0001];
  return Array.from({ length: count + 1 }, (unused, k) => low * (high / low) ** (k / count));
}

function histogram(sets, unit) {
  const edges = logBins(sets, 40);
  const counts = sets.map(({ values }) => {
    const list = new Array(edges.length).fill(0);
    for (const value of values) {
      let k = edges.findIndex((edge) => edge > value) - 1;
      if (k < 0) k = value < edges[0] ? 0 : edges.length - 2;
      list[k] += 1;
    }
    return list.map((number) => (number > 0 ? (100 * number) / values.length : null));
  });
  return chart({
    label: `Histogram of errors of readings: ${sets.map(({ name, values }) => `${name} around ${mm(quantile(values, 0.5))} ${unit}`).join(', ')}`,
    x: { label: `error of a reading/${unit}`, log: true, range: [edges[0], edges.at(-1)], ticks: logTicks(edges[0], edges.at(-1)) },
    y: { label: 'readings/%', range: [0, 1.06 * Math.max(...counts.flat())] }, xs: edges, height: 260,
    series: sets.map(({ name, colour }, k) => ({ label: name, colour, values: counts[k], kind: 'bars', width: 1 })),
  });
}

function logTicks(low, high) {
  const list = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power) {
    for (const digit of [1, 2, 5]) list.push(Number((digit * 10 ** power).toPrecision(2)));
  }
  return list.filter((value) => value >= low && value <= high);
}

function cumulative(sets, unit) {
  const all = sets.flatMap((set) => set.values);
  const high = Math.max(...all) * 1.05;
  const low = Math.max(quantile(all, 0.01), high / 3000);
  const xs = Array.from({ length: 181 }, (unused, k) => low * (high / low) ** (k / 180));
  const series = sets.map(({ name, colour, values }) => {
    const sorted = Float64Array.from(values).sort();
    let k = 0;
    return { label: name, colour, width: 2.5, values: xs.map((x) => {
      while (k < sorted.length && sorted[k] <= x) ++k;
      return (100 * k) / sorted.length;
    }) };
  });
  const level = (value) => ({ label: `${value} %`, values: xs.map(() => value), colour: 'muted', width: 1, dash: [3, 4] });
  return chart({
    label: `Cumulative curves of errors: ${sets.map(({ name, values }) => `${name} 95 % below ${mm(quantile(values, 0.95))} ${unit}`).join(', ')}`,
    x: { label: `error of a reading below/${unit}`, log: true, range: [low, high], ticks: logTicks(low, high) },
    y: { label: 'readings/%', range: [0, 102] }, xs, series: [...series, level(50), level(95)], height: 260,
  });
}

const summary = (values) => [rms(values), lowerQuantile(values, 0.5), lowerQuantile(values, 0.95), Math.max(...values)].map(mm);

function targetTable(residuals, unit) {
  const columns = mainColumns(residuals);
  const names = [...new Set(residuals.rows.map((row) => row.target))];
  const rows = names.flatMap((target) => [['nominal', 'nominal'], ['held_out', 'held out'], ['residual', 'calibrated']].map(([key, name]) => {
    const values = residuals.rows.filter((row) => row.target === target && row[key]).map((row) => distance(row[key], columns));
    return values.length === 0 ? null : [String(target), name, String(values.length), ...summary(values)];
  })).filter(Boolean);
  return table('Each target', ['target', 'of', 'readings', `RMS/${unit}`, `50 %/${unit}`, `95 %/${unit}`, `max/${unit}`], rows);
}

function axisTable(residuals) {
  const rows = residuals.axes.flatMap((axis, k) => [['nominal', 'nominal'], ['held_out', 'held out'], ['residual', 'calibrated']].map(([key, name]) => {
    const values = residuals.rows.filter((row) => row[key]).map((row) => Math.abs(row[key][k]));
    return values.length === 0 ? null : [axis, name, ...summary(values), residuals.unit[k]];
  })).filter(Boolean);
  return table('Each axis, absolute values', ['axis', 'of', 'RMS', '50 %', '95 %', 'max', ''], rows);
}

function figures({ residuals }) {
  const sets = setsOf(residuals);
  const unit = residuals.unit[0];
  const quantiles = table('Errors of readings', ['of', 'readings', `RMS/${unit}`, `50 %/${unit}`, `95 %/${unit}`, `max/${unit}`],
    sets.map(({ name, values }) => [name, String(values.length), ...summary(values)]));
  return el('div', { class: 'figures' },
    figure('Errors of all readings; the scale of errors is logarithmic.', histogram(sets, unit), [targetTable(residuals, unit)]),
    figure('Part of the readings whose error is below; dotted: 50 and 95 %.', cumulative(sets, unit), [quantiles, axisTable(residuals)]));
}

export function render(part) {
  const { accuracy } = part.document;
  const held = accuracy.held_out;
  return el('div', {},
    lead('Nominal: base and targets fitted only. Calibrated: the measurements themselves. ',
      held ? `Held out: each predicted by a calibration without it, ${held.folds} folds, ${held.failures.length} of them not identifiable.` : 'Nothing was held out.'),
    part.residuals?.rows.length > 0 ? figures(part) : null, accuracyTable(accuracy));
}
