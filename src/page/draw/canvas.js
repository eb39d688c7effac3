import { el } from '../core/dom.js';
import { onTheme } from '../core/theme.js';

/**
 * A canvas as wide as there is room, drawn again where its width or the colours change:
 * `draw(context, width, height)` in CSS pixels. `height` is a number, or a function of the width.
 */
export function drawing(label, height, draw) {
  const canvas = el('canvas', { role: 'img', 'aria-label': label });
  const holder = el('div', { class: 'drawing' }, canvas);
  const redraw = () => {
    const width = holder.clientWidth;
    if (width === 0) return;
    const tall = typeof height === 'function' ? height(width) : height;
    const ratio = Math.max(2, devicePixelRatio);
    canvas.width = width * ratio;
    canvas.height = tall * ratio;
    canvas.style.height = `${tall}px`;
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    context.font = '12px system-ui, sans-serif';
    draw(context, width, tall);
  };
  new ResizeObserver(redraw).observe(holder);
  onTheme(redraw);
  return { element: holder, redraw };
}

/** A range that holds all values, a little wider; null where there are none. */
export function span(values, margin = 0.05) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return null;
  const room = high > low ? margin * (high - low) : Math.abs(low) * 0.1 || 1;
  return [low - room, high + room];
}

/** Round numbers within a range. */
export function ticks(low, high, about = 5) {
  const raw = (high - low) / about;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].find((one) => one * power >= raw) * power;
  const list = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push(Number((k * step).toPrecision(12)));
  return list;
}

/** Those of `values`, which rise, whose texts do not touch: `place` and `size` of each in pixels. */
export function apart(values, place, size) {
  let end = -Infinity;
  return values.filter((value) => {
    const [low, high] = [place(value) - size(value) / 2, place(value) + size(value) / 2];
    if (low < end + 8) return false;
    end = high;
    return true;
  });
}
