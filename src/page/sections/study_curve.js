import { el } from '../core/dom.js';
import { figure, lead, note } from '../core/figure.js';
import { count, fixed, mm } from '../core/format.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';

const lines = ['accent', 'fourth', 'third', 'second'];

/** Errors so many times the least are not drawn. */
const cut = 40;

const interval = (one) => (!one || one.lower === one.upper ? '-' : `${fixed(one.lower, 2)}..${fixed(one.upper, 2)}`);

/** Rows that fewer splits are finished of than were asked for. */
const isPartial = (model, splits) => model.rows.some((row) => row.splits < splits);

function studyTable(model, { splits, simulated }) {
  const criteria = model.rows[0].planned.map((one) => one.criterion);
  const header = [
    'poses',
    ...criteria.flatMap((c) => (splits > 0 ? [`${c}/mm`, 'expected', `${c}/random`, '95 %'] : [`${c}/mm`])),
    'random 10 %/mm',
    '50 %/mm',
    '90 %/mm',
    'subsets',
    'unidentified',
    ...(isPartial(model, splits) ? ['splits'] : []),
  ];
  const rows = model.rows.map(({ pose_count: number, planned, random, splits: finished }) => [
    String(number),
    ...planned.flatMap((one) =>
      splits > 0
        ? [mm(one.held_out_rms_mm), mm(one.expected_rms_mm), fixed(one.against_random?.ratio, 2), interval(one.against_random)]
        : [mm(one.held_out_rms_mm)],
    ),
    mm(random?.held_out_rms_p10_mm),
    mm(random?.held_out_rms_p50_mm),
    mm(random?.held_out_rms_p90_mm),
    String(random?.subsets ?? 0),
    random ? String(random.unidentified) : '-',
    String(finished ?? splits),
  ]);
  return table(`Error ${simulated ? 'over the workspace' : 'held out'} by number of poses${model.name ? `, ${model.name}` : ''}`, header, rows);
}

/** The widest quantiles of the errors that all rows have: a band over splits or robots, or over random subsets. */
function bandOf(rows, pick, name, colour) {
  const found = rows.map((row) => pick(row) ?? {});
  const parts = Object.keys(Object.assign({}, ...found))
    .map((key) => Number(/^held_out_rms_p(\d+)_mm$/.exec(key)?.[1]))
    .filter((part) => part !== 50 && !Number.isNaN(part));
  const [low, high] = [Math.min(...parts), Math.max(...parts)];
  const values = (part) => found.map((one) => one[`held_out_rms_p${String(part).padStart(2, '0')}_mm`] ?? null);
  const band = { label: `${name}, ${low} to ${high} %`, low: values(low), high: values(high), colour };
  return [band.low, band.high].every((list) => list.some((value) => value !== null)) ? band : null;
}

function studyFigure({ document }, model) {
  const { rows } = model;
  const xs = rows.map((row) => row.pose_count);
  const values = (pick) => rows.map((row) => pick(row) ?? null);
  const criteria = rows[0].planned.map((one) => one.criterion);
  const found = criteria.map((criterion, c) => ({
    label: `planned by ${criterion}, found`,
    values: values((row) => row.planned[c].held_out_rms_mm),
    colour: lines[c % lines.length],
    kind: 'both',
  }));
  const expected = criteria
    .slice(0, 1)
    .map((criterion, c) => ({
      label: `planned by ${criterion}, predicted`,
      values: values((row) => row.planned[c].expected_rms_mm),
      colour: lines[c % lines.length],
      dash: [6, 5],
      width: 1.5,
    }));
  const middle = { label: 'random, median', values: values((row) => row.random?.held_out_rms_p50_mm), colour: 'muted', width: 1.5 };
  const bands = [
    bandOf(rows, (row) => row.random, 'random', 'muted'),
    ...criteria.map((criterion, c) => bandOf(rows, (row) => row.planned[c], `planned by ${criterion}`, lines[c % lines.length])),
  ].filter(Boolean);
  // Random subsets that hardly identify the model would press all else together.
  const known = (lists) => lists.flat().filter((value) => value !== null);
  const least = Math.min(...known(found.map((one) => one.values)));
  const all = known([...found, ...expected, middle].map((one) => one.values));
  const range = [
    0.8 * Math.min(...all, ...known(bands.map((one) => one.low))),
    Math.min(1.15 * Math.max(...all, ...known(bands.map((one) => one.high))), cut * least),
  ];
  const series = [...found, ...expected, middle].filter((one) => one.values.some((value) => value !== null));
  return figure(
    `RMS position error${document.simulated ? ' over the workspace' : ', held out'}, against the number of poses${model.name ? `: ${model.name}` : ''}.`,
    chart({
      label: `Error against number of poses: ${rows.map((row) => `${row.pose_count} poses ${mm(row.planned[0].held_out_rms_mm)} mm planned, ${mm(row.random?.held_out_rms_p50_mm)} mm random`).join('; ')}`,
      x: { label: 'poses', ticks: xs.length <= 10 ? xs : undefined },
      y: { label: 'RMS error/mm', log: true, range },
      xs,
      series,
      bands,
    }),
    [studyTable(model, document)],
  );
}

export function studyFigures(part) {
  const { document } = part;
  const judged = count(document.judged_on, 'configuration');
  const splits = `${document.models.some((model) => isPartial(model, document.splits)) ? 'up to ' : ''}${count(document.splits, document.simulated ? 'robot' : 'split')}`;
  const where = document.simulated ? `${judged} of the workspace, ${splits} drawn` : `${judged} held out, ${splits}`;
  const hasRandom = document.models.some((model) => model.rows.some((row) => row.random?.subsets > 0));
  return el(
    'div',
    {},
    lead(`Judged on ${where}${hasRandom ? '; planned and random subsets see the same' : ''}.`),
    el(
      'div',
      { class: document.models.length > 1 ? 'figures' : null },
      document.models.filter((model) => model.rows.length > 0).map((model) => studyFigure(part, model)),
    ),
    note(`Medians${hasRandom ? '; planned against random is the geometric mean with its 95 % interval: better where all of it is below 1' : ''}.`),
  );
}
