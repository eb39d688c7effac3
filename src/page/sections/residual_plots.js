import { el } from '../core/dom.js';
import { behind, figure, lead } from '../core/figure.js';
import { count, fixed, mm, short } from '../core/format.js';
import { cellOf, columnTitle } from '../core/poses.js';
import { byConfiguration } from '../core/residuals.js';
import { mean, normalQuantile } from '../core/statistics.js';
import { table } from '../core/table.js';
import { chart } from '../draw/chart.js';
import { scatter, scatterLegend } from '../draw/scatter.js';

export const title = 'Residuals';

export const isShown = (part) => part.residuals?.rows.length > 0;

const keyOf = (part, j) => {
  const joint = part.scene?.joints[j];
  return joint ? `${joint.name}_${joint.kind === 'prismatic' ? 'm' : 'rad'}` : `joint ${j + 1}_rad`;
};

/** Means of configurations: what is independent from one to the next. */
function meansOf(residuals) {
  return byConfiguration(residuals).map(({ id, rows }) => ({
    id,
    joints: rows[0].joints,
    means: residuals.axes.map((unused, k) => mean(rows.map((row) => row.residual[k]))),
    ...Object.fromEntries(
      ['range', 'azimuth', 'elevation'].filter((key) => typeof rows[0][key] === 'number').map((key) => [key, mean(rows.map((row) => row[key]))]),
    ),
  }));
}

/** Columns of lengths, and of angles. */
const kindsOf = ({ axes, unit }) => [...new Set(unit)].map((one) => ({ unit: one, columns: axes.map((axis, k) => k).filter((k) => unit[k] === one) }));

const dotSize = (count, size) => (count > 400 ? Math.ceil(size / 2) : size);

function driftFigures({ document, residuals }, groups) {
  const trend = document.accuracy?.order_trend;
  if (!trend) return null;
  const text = document.answers?.find((one) => one.key === 'drift')?.text ?? '';
  const xs = groups.map((unused, k) => k + 1);
  const rows = trend.axes.map((one, k) => {
    const unit = residuals.unit[k];
    return [one.axis, mm(one[`change_${unit}`]), mm(one[`detectable_${unit}`]), mm(one[`early_${unit}`]), unit, short(one.probability, 3)];
  });
  const numbers = table(
    `Straight lines through the means of configurations${trend.is_beside_joints ? ', besides what follows the joints\u2019 positions' : ''}`,
    ['axis', 'change from first to last', 'would be seen', 'first tenth off the rest', '', 'p'],
    rows,
  );
  return kindsOf(residuals).map(({ unit, columns }, k) => {
    const means = columns.map((column) => groups.map((group) => group.means[column]));
    const fits = columns.map((column, n) => {
      const slope = (trend.axes.find((one) => one.axis === residuals.axes[column])?.[`change_${unit}`] ?? 0) / (xs.length - 1);
      return { slope, offset: mean(means[n]) - slope * mean(xs) };
    });
    return figure(
      k === 0 ? text : null,
      scatter({
        label: `Residuals/${unit} in the order measured. ${text}`,
        x: { label: 'configuration, in the order measured' },
        y: { label: `mean residual/${unit}` },
        xs,
        columns: means,
        names: columns.map((column) => residuals.axes[column]),
        fits,
        size: dotSize(xs.length, 6),
        height: 280,
      }),
      k === 0 ? [numbers] : [],
    );
  });
}

/** Small pictures, one for each of what residuals are drawn against. */
function against(residuals, groups, list) {
  const columns = residuals.axes.map((unused, k) => groups.map((group) => group.means[k]));
  return el(
    'div',
    {},
    kindsOf(residuals).map((kind) => [
      scatterLegend(kind.columns.map((k) => residuals.axes[k])),
      el(
        'div',
        { class: 'figures figures-small' },
        list.map(({ name, xs }) =>
          figure(
            null,
            scatter({
              label: `Mean residuals/${kind.unit} against ${name}`,
              x: { label: name },
              y: { label: `residual/${kind.unit}` },
              xs,
              columns: kind.columns.map((k) => columns[k]),
              names: kind.columns.map((k) => residuals.axes[k]),
              height: 190,
              size: dotSize(xs.length, 4),
              hasLegend: false,
            }),
          ),
        ),
      ),
    ]),
  );
}

function normalFigure(residuals) {
  const values = residuals.rows
    .flatMap((row) => row.standardised ?? [])
    .filter(Number.isFinite)
    .sort((a, b) => a - b);
  if (values.length < 8) return null;
  const every = Math.max(1, Math.floor(values.length / 600));
  const shown = values
    .map((value, k) => [normalQuantile((k + 0.5) / values.length), value])
    .filter((unused, k) => k % every === 0 || k < 20 || k >= values.length - 20);
  const xs = shown.map(([x]) => x);
  const within = (size) => values.filter((value) => Math.abs(value) <= size).length / values.length;
  const rows = [
    [1, 0.682689],
    [1.959964, 0.95],
    [2.575829, 0.99],
    [3.290527, 0.999],
  ].map(([size, part]) => [fixed(size, 2), `${fixed(100 * part, 1)} %`, `${fixed(100 * within(size), 1)} %`]);
  return figure(
    `Normal plot of ${values.length} standardised residuals: on the line they are as large, and as often, as stated; steeper at the ends: outliers.`,
    chart({
      label: `Normal plot of standardised residuals; ${fixed(100 * within(1.959964), 1)} % are within 1.96`,
      x: { label: 'quantile of the normal distribution' },
      y: { label: 'standardised residual' },
      xs,
      height: 280,
      series: [
        { label: 'expected', values: xs, colour: 'muted', width: 1.5, dash: [5, 4] },
        { label: 'found', values: shown.map(([, y]) => y), colour: 'accent', kind: 'dots', size: 5 },
      ],
    }),
    [table('Part of the standardised residuals within', ['std. devs.', 'expected', 'found'], rows)],
  );
}

/** The readings farthest off, by name; those that chance would have in 1 of 20 campaigns at most are marked. */
function farthest({ residuals, sub }) {
  const all = residuals.rows.filter((row) => row.standardised?.every(Number.isFinite));
  if (all.length === 0) return null;
  const size = (row) => Math.max(...row.standardised.map(Math.abs));
  const limit = normalQuantile(1 - 0.025 / (all.length * residuals.axes.length));
  const list = [...all].sort((a, b) => size(b) - size(a)).slice(0, 12);
  const beyond = all.filter((row) => size(row) > limit).length;
  const header = ['configuration', 'sample', 'target', ...residuals.axes.map((axis, k) => `${axis}/${residuals.unit[k]}`), 'std. devs.', 'by chance'];
  return [
    el(sub, { class: 'sub' }, 'Farthest readings'),
    lead(
      `${beyond === 0 ? 'None is' : `${beyond} ${beyond === 1 ? 'is' : 'are'}`} farther off than chance would have it (${fixed(limit, 2)} standard deviations, 1 campaign in 20).`,
    ),
    table(
      'Farthest readings',
      header,
      list
        .map((row) => [row.configuration, row.sample, row.target, ...row.residual.map(mm), fixed(size(row), 2), size(row) > limit ? 'no' : 'yes'])
        .map((row) => row.map((cell) => String(cell ?? ''))),
    ),
  ];
}

function outliers({ document: { outliers: list, loss }, sub }) {
  if (!loss) return null;
  const sorted = [...(list ?? [])].sort((a, b) => b.standard_deviations - a.standard_deviations);
  return [
    el(sub, { class: 'sub' }, 'Outliers'),
    lead(`Loss ${loss.kind} with width ${short(loss.width_standard_deviations, 4)} standard deviations: ${count(sorted.length, 'outlier')}.`),
    sorted.length === 0
      ? null
      : table(
          'Outliers, farthest first',
          ['configuration', 'target', 'error/mm', 'std. devs.', 'weight'],
          sorted.map((one) => [one.configuration, String(one.target), mm(one.distance_mm), fixed(one.standard_deviations, 1), fixed(one.weight, 3)]),
        ),
  ];
}

function meansTable(part, residuals, groups) {
  const keys = groups[0].joints.map((unused, j) => keyOf(part, j));
  const header = ['configuration', ...keys.map(columnTitle), ...residuals.axes.map((axis, k) => `${axis}/${residuals.unit[k]}`)];
  return table(
    'Mean residual of each configuration',
    header,
    groups.map((group) => [group.id, ...group.joints.map((value, j) => cellOf(keys[j], value)), ...group.means.map(mm)]),
  );
}

export function render(part) {
  const { residuals, sub } = part;
  const groups = meansOf(residuals);
  const joints = groups[0].joints.map((unused, j) => {
    const name = columnTitle(keyOf(part, j));
    return { name, xs: groups.map((group) => Number(cellOf(keyOf(part, j), group.joints[j]))) };
  });
  const sight = [
    ['range', 'range/m', 1],
    ['azimuth', 'azimuth/deg', 180 / Math.PI],
    ['elevation', 'elevation/deg', 180 / Math.PI],
  ]
    .filter(([key]) => groups.every((group) => key in group))
    .map(([key, name, factor]) => ({ name, xs: groups.map((group) => factor * group[key]) }));
  return el(
    'div',
    {},
    lead(`What ${residuals.rows.length} readings miss the calibrated robot by. Dots are means of ${count(groups.length, 'configuration')}.`),
    el('div', { class: 'figures' }, driftFigures(part, groups), normalFigure(residuals)),
    el(sub, { class: 'sub' }, 'Against each joint'),
    against(residuals, groups, joints),
    sight.length > 0 ? [el(sub, { class: 'sub' }, 'Against range and angles of the instrument'), against(residuals, groups, sight)] : null,
    outliers(part),
    farthest(part),
    behind([meansTable(part, residuals, groups)], 'Mean residuals as a table'),
  );
}
