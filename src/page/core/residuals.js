// What residuals of a calibration come to.

/** Number k of each axis' column. */
const axesOf = (columns, k, factor) => columns.map((column) => (column[k] === null ? null : column[k] * factor));

/** Of other poses: target and values of each reading, mm and mrad. */
export const readingsOf = ({ targets, readings }, key) =>
  readings.target.map((target, k) => ({ target: targets[target], values: axesOf(readings[key], k, 1e-6) }));

/** Readings as rows, residuals in mm and mrad; `joints` are those of the configuration. */
export function rowsOf({ residuals: { targets, readings }, configurations }) {
  return readings.configuration.map((c, k) => {
    const [id, joints] = [configurations.id[c], configurations.joints[c]];
    const row = {
      configuration: id,
      joints,
      sample: readings.sample[k],
      target: targets[readings.target[k]],
      standardised: axesOf(readings.standardised, k, 1),
    };
    for (const key of ['residual', 'nominal', 'held_out']) if (typeof readings[key]?.[0][k] === 'number') row[key] = axesOf(readings[key], k, 1e-6);
    for (const key of ['range', 'azimuth', 'elevation']) if (typeof readings[key]?.[k] === 'number') row[key] = readings[key][k];
    return row;
  });
}

/** Columns that are of one unit with the first: lengths, or else angles. */
export function mainColumns({ axes, unit }) {
  return axes.map((unused, k) => k).filter((k) => unit[k] === unit[0]);
}

export const distance = (values, columns) => Math.hypot(...columns.map((k) => values[k]));

/** RMS of the distances of each configuration. */
export function rmsByConfiguration(residuals, key = 'residual') {
  const columns = mainColumns(residuals);
  const sums = new Map();
  for (const row of residuals.rows) {
    if (!row[key]) continue;
    const sum = sums.get(row.configuration) ?? { square: 0, count: 0 };
    sum.square += distance(row[key], columns) ** 2;
    sum.count += 1;
    sums.set(row.configuration, sum);
  }
  return new Map([...sums].map(([id, sum]) => [id, Math.sqrt(sum.square / sum.count)]));
}

/** Groups rows by configuration, in the order measured. */
export function byConfiguration(residuals) {
  const groups = new Map();
  for (const row of residuals.rows) {
    if (!groups.has(row.configuration)) groups.set(row.configuration, []);
    groups.get(row.configuration).push(row);
  }
  return [...groups].map(([id, rows]) => ({ id, rows }));
}
