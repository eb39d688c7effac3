import { el } from '../core/dom.js';
import { behind, figure, lead, note } from '../core/figure.js';
import { count, degrees, fixed, milli, short } from '../core/format.js';
import { parametersOf } from '../core/parameters.js';
import { table } from '../core/table.js';
import { dotRows } from '../draw/dot_rows.js';
import { correlationFigure } from './correlations.js';

export const title = 'Parameters';

export const isShown = (part) => part.kind === 'estimate' && parametersOf(part.document).length > 0;

const errorUnit = (one) => (one.isAngle ? 'mrad' : 'mm');

function parameterTable(list) {
  const rows = list.map((one) => {
    const isTurn = one.isAngle && one.name.startsWith('base.');
    const value = isTurn && one.value !== null ? fixed(degrees(one.value), 4) : milli(one.value);
    const known = one.expected > 0 && one.isRobot ? 1 - (one.sigma / one.expected) ** 2 : null;
    return [
      one.name,
      value,
      isTurn ? 'deg' : errorUnit(one),
      milli(one.sigma),
      errorUnit(one),
      one.isRobot ? milli(one.expected) : '',
      one.isRobot && one.expected > 0 ? fixed(one.value / one.expected, 2) : '',
      one.isHeld ? 'held' : one.sigma > 0 && one.isRobot ? fixed(Math.abs(one.value) / one.sigma, 1) : '',
      known === null ? '' : known > 0.5 ? 'identified' : known > 0.05 ? 'partly' : 'left to its prior',
    ];
  });
  return table(
    'Parameters (errors of the robot, base, targets)',
    ['parameter', 'value', '', 'std. dev.', '', 'expected', 'of expected', 'std. devs. from 0', 'by the measurements'],
    rows,
  );
}

function sizesTable({ learned_sizes: sizes }) {
  if (!sizes) return null;
  return table(
    'Sizes of errors learned from the measurements',
    ['class', 'stated', 'learned', ''],
    Object.entries(sizes).map(([key, one]) => [key.replace(/_(m|rad)$/, ''), milli(one.stated), milli(one.learned), key.endsWith('_rad') ? 'mrad' : 'mm']),
  );
}

/** Values in units of their expected size, with two standard deviations on either side. */
function valueFigure(list) {
  const robot = list.filter((one) => one.isRobot && one.expected > 0);
  if (robot.length === 0) return null;
  const rows = robot.map((one) => ({
    name: one.name,
    at: one.value / one.expected,
    low: (one.value - 2 * one.sigma) / one.expected,
    high: (one.value + 2 * one.sigma) / one.expected,
  }));
  return figure(
    'Errors found in units of their expected size, with two standard deviations on either side; beyond 3 an error is larger than was thought.',
    dotRows(
      `Errors of the robot in units of their expected size: ${rows.map((row) => `${row.name} ${fixed(row.at, 2)}`).join(', ')}`,
      'value/expected size',
      rows,
      [-1, 0, 1],
    ),
  );
}

export function render(part) {
  const { document } = part;
  const list = parametersOf(document);
  const robot = list.filter((one) => one.isRobot);
  const large = robot.filter((one) => Math.abs(one.value) > 3 * one.expected);
  const held = list.filter((one) => one.isHeld);
  return el(
    'div',
    {},
    lead(
      `${count(list.length, 'parameter')}, of which ${robot.length} are errors of the robot${held.length > 0 ? `; ${held.length} are held as an earlier estimate has them` : ''}.`,
    ),
    large.length > 0
      ? note(
          `More than three times their expected size: ${large.map((one) => `${one.name} (${short(Math.abs(one.value) / one.expected, 3)} times)`).join(', ')}.`,
        )
      : null,
    el('div', { class: 'figures' }, valueFigure(list), correlationFigure(document)),
    behind([parameterTable(list), sizesTable(document)], 'All parameters with their standard deviations'),
  );
}
