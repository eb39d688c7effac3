import uPlot from 'uplot';
import { el } from '../core/dom.js';
import { short } from '../core/format.js';
import { colour, isOnPaper, onTheme } from '../core/theme.js';
import { apart, span, ticks } from './canvas.js';
import { legend } from './legend.js';

const font = '12px system-ui, sans-serif';

function axis(label, values) {
  return {
    label,
    labelFont: `12px system-ui, sans-serif`,
    font,
    labelSize: 20,
    stroke: () => colour('ink-soft'),
    grid: { stroke: () => colour('rule'), width: 1 },
    ticks: { stroke: () => colour('rule'), width: 1, size: 4 },
    ...values,
  };
}

const fade = (name, alpha) => {
  const value = colour(name);
  return `${value}${Math.round(alpha * 255)
    .toString(16)
    .padStart(2, '0')}`;
};

function seriesOf(one) {
  const stroke = () => colour(one.colour);
  const isDots = one.kind === 'dots';
  return {
    label: one.label,
    stroke,
    width: isDots ? 0 : (one.width ?? 2),
    dash: one.dash,
    spanGaps: true,
    points: { show: isDots || one.kind === 'both', size: one.size ?? 7, fill: one.open ? () => colour('paper') : stroke, stroke, width: one.open ? 1.5 : 0 },
    paths: isDots
      ? () => null
      : one.kind === 'steps'
        ? uPlot.paths.stepped({ align: 1 })
        : one.kind === 'bars'
          ? uPlot.paths.bars({ size: [1, Infinity], align: 1, gap: 1 })
          : undefined,
    fill: one.kind === 'bars' ? () => fade(one.colour, 0.45) : undefined,
  };
}

/** Ticks of a logarithmic axis that are labelled: 1, 2, 5 of each decade where there is room. */
function logTicks(low, high) {
  const list = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.ceil(Math.log10(high)); ++power) {
    for (const digit of [1, 2, 5]) list.push(Number((digit * 10 ** power).toPrecision(3)));
  }
  const inside = list.filter((value) => value >= low * 0.999 && value <= high * 1.001);
  return inside.length > 9 ? inside.filter((value) => /^[0.]*1[0.]*$/.test(String(value)) || String(value).startsWith('1e')) : inside;
}

/**
 * Curves over common x values. `series`: `label`, `values`, `colour` (of the styles), `kind` line, dots,
 * both, steps or bars, `dash`; `bands`: `label`, `low`, `high`, `colour`; `x` and `y`: `label`, `log`,
 * `range`, `ticks`. Without `hasLegend` names stand elsewhere.
 */
export function chart({ label, x, y, xs, series, bands = [], height = 300, hasLegend = true }) {
  const picture = el('div', { class: 'plot', role: 'img', 'aria-label': label });
  const holder = el('div', { class: 'chart' }, hasLegend && series.length + bands.length > 1 ? legend(series, bands) : null, picture);
  const hidden = bands.flatMap((one) => [one.high, one.low].map((values) => ({ values, colour: one.colour, width: 0 })));
  const all = [...hidden, ...series];
  const xRange = x.range ?? span(xs, x.margin ?? 0.04);
  const values = all.flatMap((one) => one.values).filter((value) => Number.isFinite(value) && (!y.log || value > 0));
  const yRange = y.range ?? (y.log ? [Math.min(...values) / 1.15, Math.max(...values) * 1.15] : [y.zero ? 0 : span(values)[0], span(values)[1]]);
  const part = (value) => (x.log ? Math.log(value / xRange[0]) / Math.log(xRange[1] / xRange[0]) : (value - xRange[0]) / (xRange[1] - xRange[0]));
  const xTicks = (u) =>
    apart(
      x.ticks ?? ticks(...xRange, Math.max(4, u.width / 90)),
      (value) => part(value) * (u.width - 100),
      (value) => 7 * short(value, 4).length,
    );
  const options = {
    width: 600,
    height,
    legend: { show: false },
    cursor: { show: false },
    select: { show: false },
    padding: [10, 14, 0, 4],
    scales: { x: { time: false, range: () => xRange, distr: x.log ? 3 : 1 }, y: { range: () => yRange, distr: y.log ? 3 : 1 } },
    axes: [
      axis(x.label, {
        size: 26,
        splits: xTicks,
        ...(x.log ? { filter: (u, splits) => splits } : {}),
        values: (u, splits) => splits.map((value) => (value === null ? '' : short(value, 4))),
      }),
      axis(y.label, {
        size: 62,
        splits: () => (y.log ? logTicks(...yRange) : ticks(...yRange, 6)),
        ...(y.log ? { filter: (u, splits) => splits } : {}),
        values: (u, splits) => splits.map((value) => (value === null ? '' : short(value, 4))),
      }),
    ],
    series: [{}, ...all.map((one) => (one.label === undefined ? { ...seriesOf(one), points: { show: false } } : seriesOf(one)))],
    bands: bands.map((one, k) => ({ series: [2 * k + 1, 2 * k + 2], fill: () => fade(one.colour, one.alpha ?? 0.22) })),
  };
  let plot = null;
  const draw = () => {
    const width = holder.clientWidth;
    if (width === 0) return;
    const tall = isOnPaper() ? Math.round(0.75 * height) : height;
    if (!plot) plot = new uPlot({ ...options, width, height: tall }, [xs, ...all.map((one) => one.values)], picture);
    else if (plot.width !== width || plot.height !== tall) plot.setSize({ width, height: tall });
    else plot.redraw(false, true);
  };
  new ResizeObserver(() => {
    if (!plot || plot.width !== holder.clientWidth) draw();
  }).observe(holder);
  onTheme(draw);
  return holder;
}
