// Colours of canvases follow those of the styles: light, dark, or light on paper.

const listeners = new Set();
let known = {};

/** Calls `draw` now and whenever colours change. */
export function onTheme(draw) {
  listeners.add(draw);
  draw();
}

/** A colour of the styles. */
export function colour(name) {
  known[name] ??= getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  return known[name];
}

function redraw() {
  known = {};
  for (const draw of listeners) draw();
}

export const isOnPaper = () => document.documentElement.classList.contains('on-paper');

/** Draws all again as wide as paper is while the page is printed. */
export function watchTheme() {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
  for (const [event, isPrinting] of [
    ['beforeprint', true],
    ['afterprint', false],
  ]) {
    addEventListener(event, () => {
      document.documentElement.classList.toggle('on-paper', isPrinting);
      redraw();
    });
  }
}

const scale = ['#440154', '#472d7b', '#3b528b', '#2c728e', '#21918c', '#28ae80', '#5ec962', '#addc30', '#fde725'].map((text) =>
  [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16)),
);

/** A perceptually even colour of 0..1, as "rgb(r, g, b)", of those that can be told from the paper. */
export function ramp(part) {
  const [low, high] = colour('ramp').split(' ').map(Number);
  const at = (low + Math.min(1, Math.max(0, part)) * (high - low)) * (scale.length - 1);
  const k = Math.min(scale.length - 2, Math.floor(at));
  const mixed = scale[k].map((value, i) => Math.round(value + (at - k) * (scale[k + 1][i] - value)));
  return `rgb(${mixed.join(', ')})`;
}

/** Blue over white (black) to red, of -1..1. */
export function diverging(part) {
  const size = Math.min(1, Math.abs(part));
  const end = part < 0 ? [33, 102, 172] : [178, 24, 43];
  const middle = colour('diverging-middle').split(' ').map(Number);
  return `rgb(${middle.map((value, i) => Math.round(value + size * (end[i] - value))).join(', ')})`;
}
