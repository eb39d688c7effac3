import { el } from '../core/dom.js';
import { figure, lead } from '../core/figure.js';
import { count, fixed, mm } from '../core/format.js';
import { applyInverse } from '../core/kinematics.js';
import { quantile } from '../core/statistics.js';
import { screenTable, table } from '../core/table.js';
import { ramp } from '../core/theme.js';
import { colourBar } from '../draw/colour_bar.js';
import { drawSlices, sliced } from '../draw/slices.js';

export const title = 'Error map of the workspace';

export const isShown = (part) => part.error_map?.position?.length > 0;

const slicesShown = 4;

function mapOf(name, points, unit) {
  const values = points.map((one) => one.value);
  const [low, high] = [quantile(values, 0.02), quantile(values, 0.98)];
  const [least, most] = [Math.min(...values), Math.max(...values)];
  const paint = (value) => ramp(high > low ? (value - low) / (high - low) : 0.5);
  const description = `${name} over the workspace: from ${mm(least)} to ${mm(most)} ${unit}, half below ${mm(quantile(values, 0.5))} ${unit}`;
  return el(
    'div',
    {},
    colourBar(`${name}/${unit}`, `${least < low ? '\u2264 ' : ''}${mm(low)}`, `${most > high ? '\u2265 ' : ''}${mm(high)}`),
    drawSlices(description, sliced(points, slicesShown), paint),
  );
}

function summaryTable(sets) {
  return table(
    'Over the workspace',
    ['of', 'RMS/mm', '50 %/mm', '95 %/mm', 'max/mm'],
    sets.map(([name, values]) => [
      name,
      mm(Math.sqrt(values.reduce((sum, value) => sum + value * value, 0) / values.length)),
      mm(quantile(values, 0.5)),
      mm(quantile(values, 0.95)),
      mm(Math.max(...values)),
    ]),
  );
}

function pointTable(points) {
  const hasDisplacement = points.some((one) => one.displacement);
  return screenTable(
    'Points of the map, in the robot\u2019s base frame',
    ['x/m', 'y/m', 'z/m', 'predicted/mm', ...(hasDisplacement ? ['dx/mm', 'dy/mm', 'dz/mm'] : [])],
    points.map((one) => [
      ...one.at.map((value) => fixed(value, 3)),
      mm(one.predicted_mm),
      ...(hasDisplacement ? (one.displacement ?? [null, null, null]).map(mm) : []),
    ]),
  );
}

/** Turns a vector of the world into the base frame. */
const turned = (frame, vector) => applyInverse([...frame.slice(0, 3), 0, ...frame.slice(4, 7), 0, ...frame.slice(8, 11), 0, 0, 0, 0, 1], vector);

export function render(part) {
  const frame = part.scene?.world_from_base ?? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const map = part.error_map;
  const points = map.position.map((position, k) => ({
    at: applyInverse(frame, position),
    predicted_mm: map.predicted_mm[k],
    displacement: map.displacement_mm ? turned(frame, map.displacement_mm[k]) : null,
  }));
  const predicted = points.map((one) => ({ at: one.at, value: one.predicted_mm }));
  const moved = points.filter((one) => one.displacement).map((one) => ({ at: one.at, value: Math.hypot(...one.displacement), vector: one.displacement }));
  const longest =
    moved.length > 0
      ? quantile(
          moved.map((one) => one.value),
          0.95,
        )
      : 1;
  const arrows = moved.map((one) => ({ ...one, arrow: one.vector.slice(0, 2).map((value) => (16 * value) / longest) }));
  const sets = [['predicted standard deviation', predicted.map((one) => one.value)]];
  if (moved.length > 0) sets.push(['displacement by the calibration', moved.map((one) => one.value)]);
  return el(
    'div',
    {},
    lead(
      `At ${count(points.length, 'configuration')} of the workspace, by the height of the first target in the robot\u2019s base frame: ${mm(quantile(sets[0][1], 0.5))} mm in the median, ${mm(Math.max(...sets[0][1]))} mm at worst, by the parameters alone.`,
    ),
    figure('Predicted standard deviation of the position (RMS of the distance) by the parameters.', mapOf('predicted', predicted, 'mm'), [
      summaryTable(sets),
      pointTable(points),
    ]),
    moved.length > 0
      ? figure(
          'By how much the calibrated robot is elsewhere than the nominal one, lines in the direction of x and y: what the calibration corrects.',
          mapOf('displacement', arrows, 'mm'),
        )
      : null,
  );
}
