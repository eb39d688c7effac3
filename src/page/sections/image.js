import { el } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { count, fixed, short } from '../core/format.js';
import { table } from '../core/table.js';
import { kinds } from '../core/views.js';
import { cellsOf, drawImage, exaggeration, roundBelow } from '../draw/image.js';
import { legend } from '../draw/legend.js';

export const title = 'Image';

/** Corners in images: all residuals there are, or those of cameras beside other sensors. */
const ofCameras = (of) => of?.of_cameras ?? of;

const hasPlaces = (of) => of?.images?.length > 0 && of.readings?.place !== undefined;

export const isShown = ({ residuals, expected }) => hasPlaces(ofCameras(residuals)) || hasPlaces(expected);

/** Corners that a camera has seen or, of a plan, shall see, and their residuals, px. */
export function cornersOf({ readings: { camera, place, residual } }, index) {
  const corners = camera.map((unused, k) => ({ u: place[0][k], v: place[1][k], ...(residual ? { du: residual[0][k] / 1e6, dv: residual[1][k] / 1e6 } : {}) }));
  return corners.filter((unused, k) => camera[k] === index);
}

/** The image's size; that of what was seen in it where none is stated. */
const sizeOf = (image, corners) => image.size_px ?? [Math.max(1, ...corners.map(({ u }) => u)), Math.max(1, ...corners.map(({ v }) => v))];

/** Those of other poses are of the same image if it is as large. */
function setsOf(all, index) {
  const residuals = ofCameras(all);
  const isSame = (others) => others?.readings.place !== undefined && String(others.images[index]?.size_px) === String(residuals.images[index].size_px);
  return kinds
    .map(([key, label, colour]) => [ofCameras(key === 'residuals' ? all : all[key]), label, colour])
    .filter(([of]) => isSame(of))
    .map(([of, label, colour]) => ({ label, colour, kind: 'dots', corners: cornersOf(of, index) }))
    .filter(({ corners }) => corners.length > 0);
}

function cellTable(caption, { size_px: size, columns, counts }) {
  if (!counts) return null;
  const rows = counts.length / columns;
  const between = (k, all, length) => `${short((k * length) / all, 4)} to ${short(((k + 1) * length) / all, 4)}`;
  const across = Array.from({ length: columns }, (unused, k) => between(k, columns, size[0]));
  return table(
    caption,
    ['v/px by u/px', ...across],
    Array.from({ length: rows }, (unused, row) => [between(row, rows, size[1]), ...counts.slice(row * columns, (row + 1) * columns).map(String)]),
  );
}

const cellsIn = ({ size_px: size, columns, counts }) => (counts ? cellsOf(size, columns, counts) : []);

const nameOf = ({ name }) => (name ? `${name.slice(0, 1).toUpperCase()}${name.slice(1)}: ` : '');

const describe = (image, size) => (image.size_px ? `an image of ${size.map((one) => short(one)).join(' x ')} px` : 'an image whose size is not stated');

/** Where a plan expects corners. */
function expectedFigure(expected, index) {
  const image = expected.images[index];
  const corners = cornersOf(expected, index);
  const size = sizeOf(image, corners);
  const label = `${nameOf(image)}${count(corners.length, 'corner')} expected in ${describe(image, size)}`;
  return figure(
    `${label}, if the robot is as the campaign states it. The greyer a cell, the more corners it has.`,
    drawImage({ label, size, cells: cellsIn(image), sets: [{ corners, colour: 'accent' }], times: 1 }),
    [cellTable('Corners expected in each cell of the image', image)],
  );
}

function imageFigure(all, index) {
  const residuals = ofCameras(all);
  const image = residuals.images[index];
  const sets = setsOf(all, index);
  const size = sizeOf(
    image,
    sets.flatMap(({ corners }) => corners),
  );
  const times = exaggeration(size, image.rms_px);
  const bar = roundBelow((0.15 * size[0]) / times);
  const scale = el('span', {});
  scale.style.setProperty('width', `${(100 * bar * times) / size[0]}%`);
  const used = cornersOf(residuals, index).length;
  const others = sets.reduce((sum, { corners }) => sum + corners.length, -used);
  const label = `${nameOf(image)}${count(used, 'corner')} in ${describe(image, size)}, ${fixed(image.rms_px, 2)} px RMS off the place predicted`;
  return figure(
    `${label}${others > 0 ? `; ${others} of other poses` : ''}. A dot is where a corner was seen; the line is its residual, from the place predicted towards the one seen, drawn ${short(times)} times as long. The greyer a cell, the more corners were calibrated with.`,
    el(
      'div',
      {},
      sets.length > 1 ? legend(sets) : null,
      drawImage({ label, size, cells: cellsIn(image), sets, times }),
      el('p', { class: 'image-scale' }, scale, `a residual of ${short(bar)} px`),
    ),
    [cellTable('Corners calibrated with in each cell of the image', image)],
  );
}

export function render({ document, residuals, expected }) {
  const text = document.answers?.find((one) => one.key === 'image')?.text;
  return el(
    'div',
    {},
    text ? lead(`${text.slice(0, 1).toUpperCase()}${text.slice(1)}.`) : null,
    el(
      'div',
      { class: 'figures' },
      hasPlaces(ofCameras(residuals))
        ? ofCameras(residuals).images.map((unused, k) => imageFigure(residuals, k))
        : expected.images.map((unused, k) => expectedFigure(expected, k)),
    ),
  );
}
