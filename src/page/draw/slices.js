import { fixed, short } from '../core/format.js';
import { colour } from '../core/theme.js';
import { apart, drawing, span, ticks } from './canvas.js';

const gap = 46;

/** Points by height in as many slices, of as many points each. */
export function sliced(points, most) {
  const count = Math.max(1, Math.min(most, Math.floor(points.length / 30)));
  const sorted = [...points].sort((a, b) => a.at[2] - b.at[2]);
  return Array.from({ length: count }, (unused, k) =>
    sorted.slice(Math.round((k * sorted.length) / count), Math.round(((k + 1) * sorted.length) / count)),
  ).filter((slice) => slice.length > 0);
}

/** Value at a place: mean of the points around with weights that fall as a bell; null far from all. */
function valueAt(slice, x, y, reach) {
  let [sum, weights, nearest] = [0, 0, Infinity];
  for (const { at, value } of slice) {
    const square = ((at[0] - x) ** 2 + (at[1] - y) ** 2) / (reach * reach);
    nearest = Math.min(nearest, square);
    const weight = Math.exp(-1.5 * square);
    sum += weight * value;
    weights += weight;
  }
  return nearest > 1 ? null : sum / weights;
}

function drawSlice(context, slice, { left, top, size, xs, ys, reach, paint }) {
  const scale = size / (xs[1] - xs[0]);
  const px = (x) => left + (x - xs[0]) * scale;
  const py = (y) => top + (ys[1] - y) * scale;
  const height = (ys[1] - ys[0]) * scale;
  const cell = 4;
  context.globalAlpha = 0.55;
  for (let u = 0; u < size - 1; u += cell) {
    for (let v = 0; v < height - 1; v += cell) {
      const value = valueAt(slice, xs[0] + (u + cell / 2) / scale, ys[1] - (v + cell / 2) / scale, reach);
      if (value === null) continue;
      context.fillStyle = paint(value);
      context.fillRect(left + u, top + v, Math.min(cell, size - u), Math.min(cell, height - v));
    }
  }
  context.globalAlpha = 1;
  for (const { at, value, arrow } of slice) {
    context.fillStyle = paint(value);
    context.strokeStyle = colour('paper');
    context.lineWidth = 0.7;
    context.beginPath();
    context.arc(px(at[0]), py(at[1]), 3.2, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    if (!arrow) continue;
    context.strokeStyle = colour('ink');
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(px(at[0]), py(at[1]));
    context.lineTo(px(at[0]) + arrow[0], py(at[1]) - arrow[1]);
    context.stroke();
  }
  frame(context, { left, top, size, height, xs, ys, px, py });
}

function frame(context, { left, top, size, height, xs, ys, px, py }) {
  context.strokeStyle = colour('muted');
  context.lineWidth = 1;
  context.strokeRect(left, top, size, height);
  context.fillStyle = colour('ink-soft');
  context.textAlign = 'center';
  const room = (x) => context.measureText(short(x, 3)).width;
  for (const x of apart(ticks(...xs, 4), px, room)) context.fillText(short(x, 3), px(x), top + height + 15);
  context.textAlign = 'right';
  for (const y of ticks(...ys, 4)) context.fillText(short(y, 3), left - 5, py(y) + 4);
  if (px(0) > left && px(0) < left + size && py(0) > top && py(0) < top + height) {
    context.beginPath();
    context.moveTo(px(0) - 6, py(0));
    context.lineTo(px(0) + 6, py(0));
    context.moveTo(px(0), py(0) - 6);
    context.lineTo(px(0), py(0) + 6);
    context.strokeStyle = colour('ink');
    context.stroke();
  }
}

/** Slices seen from above, each between two heights; places in m, `paint(value)` gives colours. */
export function drawSlices(description, slices, paint) {
  const all = slices.flat();
  const xs = span(all.map(({ at }) => at[0]));
  const ys = span(all.map(({ at }) => at[1]));
  const reach = 0.11 * Math.max(xs[1] - xs[0], ys[1] - ys[0]);
  const layout = (width) => {
    const most = Math.max(1, Math.min(slices.length, Math.floor(width / 170)));
    const rows = Math.ceil(slices.length / most);
    const columns = Math.ceil(slices.length / rows);
    const size = Math.floor(Math.min(width / columns - gap - 6, 400));
    return { columns, size, tall: (size * (ys[1] - ys[0])) / (xs[1] - xs[0]) + 56 };
  };
  return drawing(
    description,
    (width) => {
      const { columns, tall } = layout(width);
      return Math.ceil(slices.length / columns) * tall + 16;
    },
    (context, width, height) => {
      const { columns, size, tall } = layout(width);
      slices.forEach((slice, k) => {
        const left = Math.round((k % columns) * (size + gap + 6) + gap - 4);
        const top = Math.round(Math.floor(k / columns) * tall + 22);
        const heights = slice.map(({ at }) => at[2]);
        context.fillStyle = colour('ink');
        context.textAlign = 'left';
        context.fillText(`z ${fixed(Math.min(...heights), 2)} to ${fixed(Math.max(...heights), 2)} m`, left, top - 7);
        drawSlice(context, slice, { left, top, size, xs, ys, reach, paint });
      });
      context.fillStyle = colour('ink-soft');
      context.textAlign = 'center';
      context.fillText('x/m across, y/m up; the cross is the robot\u2019s base', width / 2, height - 3, width);
    },
  ).element;
}
