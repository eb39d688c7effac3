// A camera's image with what was seen in it.
import { svg } from '../core/dom.js';

/** The largest of 1, 2, 5, 10, ... that is not above the value. */
export function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  const digit = [5, 2, 1].find((one) => one * power <= value * (1 + 1e-9)) ?? 1;
  return Number((digit * power).toPrecision(1));
}

/** How many times as long as it is a residual is drawn: one of RMS length is 1.6 to 4 % of the image's longer side. */
export const exaggeration = (size, rms) => (rms > 0 ? roundBelow((0.04 * Math.max(...size)) / rms) : 1);

const short = (value) => String(Math.round(10 * value) / 10);

/** Paths of dots at places and of lines from there, in pixels of the image. */
export function pathsOf(corners, times) {
  return {
    dots: corners.map(({ u, v }) => `M${short(u)} ${short(v)}h0`).join(''),
    lines: corners
      .filter(({ du }) => du !== undefined)
      .map(({ u, v, du, dv }) => `M${short(u)} ${short(v)}l${short(times * du)} ${short(times * dv)}`)
      .join(''),
  };
}

/** Cells of the image with their counts, the fullest one 1. */
export function cellsOf(size, columns, counts) {
  const rows = counts.length / columns;
  const most = Math.max(1, ...counts);
  const [width, height] = [size[0] / columns, size[1] / rows];
  return counts.map((count, k) => ({ x: (k % columns) * width, y: Math.floor(k / columns) * height, width, height, part: count / most }));
}

/** The image to scale: cells that are the darker the more corners they have, and `sets` of corners with a `colour`. */
export function drawImage({ label, size, cells, sets, times }) {
  const margin = 0.01 * size[0];
  return svg(
    'svg',
    { viewBox: [-margin, -margin, size[0] + 2 * margin, size[1] + 2 * margin].join(' '), class: 'image', role: 'img', 'aria-label': label },
    cells.map(({ part, ...place }) => svg('rect', { ...place, class: 'fill-muted', 'fill-opacity': part > 0 ? (0.06 + 0.3 * part).toFixed(3) : 0 })),
    svg('rect', { x: 0, y: 0, width: size[0], height: size[1], class: 'frame' }),
    sets.map(({ corners, colour }) => {
      const { dots, lines } = pathsOf(corners, times);
      return [lines ? svg('path', { d: lines, class: `line-${colour}` }) : null, svg('path', { d: dots, class: `dots line-${colour}` })];
    }),
  );
}
