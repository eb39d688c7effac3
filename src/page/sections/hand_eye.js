import { el } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { fixed, short } from '../core/format.js';
import { table } from '../core/table.js';
import { HandEyeViewer } from '../draw/hand_eye.js';
import { roundBelow } from '../draw/image.js';
import { makeCanvas } from '../draw/viewer.js';

export const title = 'Hand-eye';

export const isShown = ({ document }) => document.hand_eye !== undefined;

/** Camera before board: the name of each, and where it was found. */
const foundIn = ({ hand_eye: places }) => ['camera', 'board'].filter((name) => places[name]).map((name) => [name, places[name]]);

const nameOf = (name, place) => `${name} in the ${place.in} frame`;

const three = (values, decimals) => values.map((value) => fixed(value, decimals));

/** On one line. */
const list = (texts) => texts.join('\u00a0');

function placeTable(found) {
  const rows = found.map(([name, place]) => [
    name,
    `of the ${place.in}`,
    ...three(
      place.position_m.map((value) => 1e3 * value),
      3,
    ),
    ...three(place.rpy_deg, 4),
  ]);
  return table('Where they are', ['', 'frame', 'x/mm', 'y/mm', 'z/mm', 'roll/deg', 'pitch/deg', 'yaw/deg'], rows);
}

function deviationTable([name, place]) {
  const rows = place.deviations.map(({ axes, position_mm: position, rotation_mrad: rotation }) => [
    `of the ${axes}`,
    ...three(position, 4),
    ...three(rotation, 4),
  ]);
  return table(`Standard deviations of the ${name}`, ['axes', 'x/mm', 'y/mm', 'z/mm', 'rx/mrad', 'ry/mrad', 'rz/mrad'], rows);
}

function ellipsoidTable(found) {
  const rows = found.flatMap(([name, place]) =>
    place.ellipsoid.map(({ half_axis_mm: half, direction }) => [nameOf(name, place), fixed(half, 4), ...three(direction, 3)]),
  );
  return table('Half axes of the 95 % ellipsoid of the place', ['', 'half axis/mm', 'x', 'y', 'z'], rows);
}

/** How large the picture is, m, and how many times as large as it is the ellipsoid is drawn. */
export function scaleOf(views, ellipsoid) {
  const at = views.flange_from_it;
  const size = Math.max(Math.hypot(at[3], at[7], at[11]), 0.06);
  const longest = Math.max(...ellipsoid.map((one) => one.half_axis_mm));
  return { size, times: longest > 0 ? Math.max(1, roundBelow((0.25e3 * size) / longest)) : 1 };
}

function stageFigure(part, name, place, tables) {
  const { views } = part.scene;
  const { size, times } = scaleOf(views, place.ellipsoid);
  const stage = el('div', { class: 'stage' });
  const holder = el('div', {}, stage);
  requestAnimationFrame(() =>
    requestAnimationFrame(() => {
      const made = makeCanvas();
      stage.dataset.ready = 'true';
      if (!made) {
        stage.classList.add('stage-empty');
        stage.append(el('p', {}, 'No 3D view: this browser offers no WebGL. The numbers are in the tables.'));
        return;
      }
      made.canvas.setAttribute('aria-label', `The ${name} on the flange in 3D, with the ellipsoid of its place. Drag to turn, wheel to come nearer.`);
      stage.append(made.canvas);
      const viewer = new HandEyeViewer(made, stage, views, place.ellipsoid, times, size);
      const looks = { all: 'Whole', front: 'Front', side: 'Side', top: 'Top' };
      const button = ([key, text]) => el('button', { type: 'button', onclick: () => viewer.look(key) }, text);
      holder.append(el('div', { class: 'views' }, Object.entries(looks).map(button)));
    }),
  );
  return figure(
    `The flange and the ${name} on it; red, green and blue are x, y and z of each. With 95 % the ${name}'s origin is within the ellipsoid, which is drawn ${short(times)} times as large as it is.`,
    holder,
    tables,
  );
}

export function render(part) {
  const found = foundIn(part.document);
  const onFlange = found.find(([, place]) => place.in === 'flange');
  const sentences = found.map(([name, place]) => {
    const [deviations] = place.deviations;
    const where = three(
      place.position_m.map((value) => 1e3 * value),
      2,
    );
    return `The ${nameOf(name, place)} is at ${list(where)} mm; standard deviations: ${list(three(deviations.position_mm, 2))} mm and ${list(three(deviations.rotation_mrad, 2))} mrad.`;
  });
  const tables = [placeTable(found), ...found.map(deviationTable)];
  const drawn = onFlange && part.scene?.views ? stageFigure(part, ...onFlange, [ellipsoidTable(found)]) : null;
  return el(
    'div',
    {},
    sentences.map((sentence) => lead(sentence)),
    el('div', { class: 'hand-eye' }, drawn, el('div', {}, tables, drawn ? null : ellipsoidTable(found))),
  );
}
