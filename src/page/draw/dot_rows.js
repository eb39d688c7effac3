import { short } from '../core/format.js';
import { colour, isOnPaper } from '../core/theme.js';
import { apart, drawing, span, ticks } from './canvas.js';

const [top, bottom] = [8, 40];

function frame(context, { label, low, high, left, right, height, x, lines }) {
  context.lineWidth = 1;
  context.textAlign = 'center';
  for (const value of apart(ticks(low, high, Math.max(4, (right - left) / 70)), x, (one) => context.measureText(short(one, 4)).width)) {
    context.strokeStyle = colour('rule');
    context.beginPath();
    context.moveTo(x(value), top);
    context.lineTo(x(value), height - bottom);
    context.stroke();
    context.fillStyle = colour('ink-soft');
    context.fillText(short(value, 4), x(value), height - bottom + 16);
  }
  context.strokeStyle = colour('muted');
  for (const value of lines) {
    context.beginPath();
    context.moveTo(x(value), top);
    context.lineTo(x(value), height - bottom);
    context.stroke();
  }
  context.fillStyle = colour('ink-soft');
  context.fillText(label, (left + right) / 2, height - 6, right - left);
}

/**
 * A row for each of `rows` (`name`, `at`, its interval `low` .. `high`, and another value `other`): dots with
 * whiskers over one axis. `lines` are drawn across all.
 */
export function dotRows(description, label, rows, lines = []) {
  const [low, high] = span([...lines, ...rows.flatMap((row) => [row.at, row.low, row.high, row.other])]) ?? [0, 1];
  // Paper has all on part of a page.
  const rowHeight = () => Math.max(7, Math.min(18, (isOnPaper() ? 520 : 1100) / rows.length));
  return drawing(
    description,
    () => top + bottom + rowHeight() * rows.length,
    (context, width, height) => {
      const tall = rowHeight();
      const font = Math.min(12, tall);
      const nameWidth = Math.min(190, 12 + 0.6 * font * Math.max(...rows.map((row) => row.name.length)));
      const [left, right] = [nameWidth, width - 16];
      const x = (value) => left + ((value - low) / (high - low)) * (right - left);
      const dot = Math.min(4, tall / 4);
      frame(context, { label, low, high, left, right, height, x, lines });
      context.font = context.font.replace('12px', `${font}px`);
      rows.forEach((row, k) => {
        const y = top + tall * (k + 0.5);
        context.fillStyle = colour('ink');
        context.textAlign = 'right';
        context.fillText(row.name, left - 8, y + 4, nameWidth - 10);
        context.strokeStyle = colour('accent');
        context.lineWidth = 2;
        if (Number.isFinite(row.low) && Number.isFinite(row.high)) {
          context.beginPath();
          context.moveTo(x(row.low), y);
          context.lineTo(x(row.high), y);
          context.stroke();
        }
        if (Number.isFinite(row.at)) {
          context.fillStyle = colour('accent');
          context.beginPath();
          context.arc(x(row.at), y, dot, 0, 2 * Math.PI);
          context.fill();
        }
        if (Number.isFinite(row.other)) {
          context.strokeStyle = colour('second');
          context.beginPath();
          context.arc(x(row.other), y, dot + 1, 0, 2 * Math.PI);
          context.stroke();
        }
      });
    },
  ).element;
}
