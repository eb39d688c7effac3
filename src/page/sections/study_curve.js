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

/** What a document of a study names its errors by, which ends in their unit. */
const keysOf = ({ unit = 'mm' }) => ({
  unit,
  found: `held_out_rms_${unit}`,
  expected: `expected_rms_${unit}`,
  quantile: (part) => `held_out_rms_p${String(part).padStart(2, '0')}_${unit}`,
});

function studyTable(model, { splits, simulated }, keys) {
  const criteria = model.rows[0].planned.map((one) => one.criterion);
  const header = [
    'poses',
    ...criteria.flatMap((c) => (splits > 0 ? [`${c}/${keys.unit}`, 'expected', `${c}/random`, '95 %'] : [`${c}/${keys.unit}`])),
    ...['random 10 %', '50 %', '90 %'].map((name) => `${name}/${keys.unit}`),
    'subsets',
    'unidentified',
    ...(isPartial(model, splits) ? ['splits'] : []),
  ];
  const rows = model.rows.map(({ pose_count: number, planned, random, splits: finished }) => [
    String(number),
    ...planned.flatMap((one) =>
      splits > 0 ? [mm(one[keys.found]), mm(one[keys.expected]), fixed(one.against_random?.ratio, 2), interval(one.against_random)] : [mm(one[keys.found])],
    ),
    ...[10, 50, 90].map((part) => mm(random?.[keys.quantile(part)])),
    String(random?.subsets ?? 0),
    random ? String(random.unidentified) : '-',
    String(finished ?? splits),
  ]);
  return table(`Error ${simulated ? 'over the workspace' : 'held out'} by number of poses${model.name ? `, ${model.name}` : ''}`, header, rows);
}

/** The widest quantiles of the errors that all rows have: a band over splits or robots, or over random subsets. */
function bandOf(rows, pick, name, colour, keys) {
  const found = rows.map((row) => pick(row) ?? {});
  const parts = Object.keys(Object.assign({}, ...found))
    .map((key) => Number(/^held_out_rms_p(\d+)_/.exec(key)?.[1]))
    .filter((part) => part !== 50 && !Number.isNaN(part));
  const [low, high] = [Math.min(...parts), Math.max(...parts)];
  const values = (part) => found.map((one) => one[keys.quantile(part)] ?? null);
  const band = { label: `${name}, ${low} to ${high} %`, low: values(low), high: values(high), colour };
  return [band.low, band.high].every((list) => list.some((value) => value !== null)) ? band : null;
}

function studyFigure({ document }, model) {
  const { rows } = model;
  const keys = keysOf(document);
  const xs = rows.map((row) => row.pose_count);
  const values = (pick) => rows.map((row) => pick(row) ?? null);
  const criteria = rows[0].planned.map((one) => one.criterion);
  const found = criteria.map((criterion, c) => ({
    label: `planned by ${criterion}, found`,
    values: values((row) => row.planned[c][keys.found]),
    colour: lines[c % lines.length],
    kind: 'both',
  }));
  const expected = criteria
    .slice(0, 1)
    .map((criterion, c) => ({
      label: `planned by ${criterion}, predicted`,
      values: values((row) => row.planned[c][keys.expected]),
      colour: lines[c % lines.length],
      dash: [6, 5],
      width: 1.5,
    }));
  const middle = { label: 'random, median', values: values((row) => row.random?.[keys.quantile(50)]), colour: 'muted', width: 1.5 };
  const bands = [
    bandOf(rows, (row) => row.random, 'random', 'muted', keys),
    ...criteria.map((criterion, c) => bandOf(rows, (row) => row.planned[c], `planned by ${criterion}`, lines[c % lines.length], keys)),
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
    `RMS ${keys.unit === 'mm' ? 'position ' : ''}error${document.simulated ? ' over the workspace' : ', held out'}, against the number of poses${model.name ? `: ${model.name}` : ''}.`,
    chart({
      label: `Error against number of poses: ${rows.map((row) => `${row.pose_count} poses ${mm(row.planned[0][keys.found])} ${keys.unit} planned, ${mm(row.random?.[keys.quantile(50)])} ${keys.unit} random`).join('; ')}`,
      x: { label: 'poses', ticks: xs.length <= 10 ? xs : undefined },
      y: { label: `RMS error/${keys.unit}`, log: true, range },
      xs,
      series,
      bands,
    }),
    [studyTable(model, document, keys)],
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
