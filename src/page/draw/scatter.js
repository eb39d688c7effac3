import { chart } from './chart.js';
import { legend } from './legend.js';

const colours = ['accent', 'second', 'third', 'fourth', 'muted'];

/** Dots of several columns over one x, with straight lines through some: `fits[k]` is `{slope, offset}`. */
export function scatter({ label, x, y, xs, columns, names, fits = [], height = 240, size = 5, hasLegend = true }) {
  const order = xs.map((unused, k) => k).sort((a, b) => xs[a] - xs[b]);
  const sorted = order.map((k) => xs[k]);
  const dots = columns.map((values, k) => ({ label: names[k], values: order.map((i) => values[i]), colour: colours[k % colours.length], kind: 'dots', size }));
  const lines = fits
    .map((fit, k) => fit && { label: fit.label, values: sorted.map((value) => fit.offset + fit.slope * value), colour: colours[k % colours.length], width: 2 })
    .filter(Boolean);
  return chart({ label, x, y, xs: sorted, series: [...dots, ...lines], height, hasLegend });
}

/** The names of the columns of several scatters. */
export const scatterLegend = (names) => legend(names.map((label, k) => ({ label, colour: colours[k % colours.length], kind: 'dots' })));
