import { el } from '../core/dom.js';
import { figure, lead, note } from '../core/figure.js';
import { count, fixed, mm } from '../core/format.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';

const lines = ['accent', 'fourth', 'third', 'second'];

/** Errors so many times the least are not drawn. */
const cut = 40;

const interval = (one) => (!one || one.lower === one.upper ? '-' : `${fixed(one.lower, 2)}..${fixed(one.upper, 2)}`);

function studyTable(model, splits) {
  const criteria = model.rows[0].planned.map((one) => one.criterion);
  const header = ['poses', ...criteria.flatMap((c) => (splits > 0 ? [`${c}/mm`, 'expected', `${c}/random`, '95 %'] : [`${c}/mm`])),
    'random 10 %/mm', '50 %/mm', '90 %/mm', 'subsets', 'unidentified'];
  const rows = model.rows.map(({ pose_count: number, planned, random }) => [String(number),
    ...planned.flatMap((one) => (splits > 0 ? [mm(one.held_out_rms_mm), mm(one.expected_rms_mm), fixed(one.against_random?.ratio, 2), interval(one.against_random)] : [mm(one.held_out_rms_mm)])),
    mm(random?.held_out_rms_p10_mm), mm(random?.held_out_rms_p50_mm), mm(random?.held_out_rms_p90_mm),
    String(random?.subsets ?? 0), random ? String(random.unidentified) : '-']);
  return table(`Error held out by number of poses${model.name ? `, ${model.name}` : ''}`, header, rows);
}

function studyFigure({ document }, model) {
  const { rows } = model;
  const xs = rows.map((row) => row.pose_count);
  const values = (pick) => rows.map((row) => pick(row) ?? null);
  const criteria = rows[0].planned.map((one) => one.criterion);
  const found = criteria.map((criterion, c) => ({ label: `planned by ${criterion}, found`, values: values((row) => row.planned[c].held_out_rms_mm), colour: lines[c % lines.length], kind: 'both' }));
  const expected = criteria.slice(0, 1).map((criterion, c) => ({ label: `planned by ${criterion}, predicted`, values: values((row) => row.planned[c].expected_rms_mm), colour: lines[c % lines.length], dash: [6, 5], width: 1.5 }));
  const middle = { label: 'random, median', values: values((row) => row.random?.held_out_rms_p50_mm), colour: 'muted', width: 1.5 };
  const band = { label: 'random, 10 to 90 %', low: values((row) => row.random?.held_out_rms_p10_mm), high: values((row) => row.random?.held_out_rms_p90_mm), colour: 'muted' };
  const hasBand = band.low.some((value) => value !== null) && band.high.some((value) => value !== null);
  // Random subsets that hardly identify the model would press all else together.
  const least = Math.min(...found.flatMap((one) => one.values).filter((value) => value !== null));
  const all = [...found, ...expected, middle, { values: band.high }].flatMap((one) => one.values).filter((value) => value !== null);
  const range = [0.8 * Math.min(...all, ...band.low.filter((value) => value !== null)), Math.min(1.15 * Math.max(...all), cut * least)];
  const series = [...found, ...expected, middle].filter((one) => one.values.some((value) => value !== null));
  return figure(`RMS position error${document.simulated ? ' over the workspace' : ', held out'}, against the number of poses${model.name ? `: ${model.name}` : ''}.`, chart({
    label: `Error against number of poses: ${rows.map((row) => `${row.pose_count} poses ${mm(row.planned[0].held_out_rms_mm)} mm planned, ${mm(row.random?.held_out_rms_p50_mm)} mm random`).join('; ')}`,
    x: { label: 'poses', ticks: xs.length <= 10 ? xs : undefined }, y: { label: 'RMS error/mm', log: true, range }, xs, series, bands: hasBand ? [band] : [],
  }), [studyTable(model, document.splits)]);
}

export function studyFigures(part) {
  const { document } = part;
  const where = document.simulated ? `${count(document.judged_on, 'configuration')} of the workspace, ${count(document.splits, 'robot')} drawn`
    : `${count(document.judged_on, 'configuration')} held out, ${count(document.splits, 'split')}`;
  return el('div', {}, lead(`Judged on ${where}; planned and random subsets see the same.`),
    el('div', { class: document.models.length > 1 ? 'figures' : null }, document.models.filter((model) => model.rows.length > 0).map((model) => studyFigure(part, model))),
    note('Medians; planned against random is the geometric mean with its 95 % interval: better where all of it is below 1.'));
}
