import { el } from '../core/dom.js';
import { ramp, diverging } from '../core/theme.js';
import { drawing } from './canvas.js';

/** What colours mean: from `low` to `high`, as text. */
export function colourBar(title, low, high, isDiverging = false) {
  const paint = isDiverging ? (part) => diverging(2 * part - 1) : ramp;
  const strip = drawing(`${title}: colours from ${low} to ${high}`, 12, (context, width, height) => {
    for (let x = 0; x < width; ++x) {
      context.fillStyle = paint(x / width);
      context.fillRect(x, 0, 1.5, height);
    }
  });
  return el('div', { class: 'colour-bar' }, el('span', { class: 'name' }, title), el('span', {}, low), strip.element, el('span', {}, high));
}
