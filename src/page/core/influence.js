// Which configuration the calibration rests on, and how sure its error is.

import { byConfiguration, distance, mainColumns } from './residuals.js';
import { mean, studentT } from './statistics.js';

const squareOf = (rows, key, columns) => mean(rows.map((row) => distance(row[key], columns) ** 2));

/**
 * RMS of each configuration with itself used (`fit`) and predicted by the others (`heldOut`), that first
 * that the others predict worst beyond its fit; empty without cross-validation.
 */
export function influence(residuals) {
  const columns = mainColumns(residuals);
  const groups = byConfiguration(residuals).filter(({ rows }) => rows.every((row) => row.held_out));
  return groups.map(({ id, rows }) => ({
    id, fit: Math.sqrt(squareOf(rows, 'residual', columns)), heldOut: Math.sqrt(squareOf(rows, 'held_out', columns)),
  })).sort((a, b) => b.heldOut - b.fit - (a.heldOut - a.fit));
}

/** The RMS of configurations like those measured is within this factor with 95 %, as their squares vary. */
export function factorOfRms(residuals, key) {
  const columns = mainColumns(residuals);
  const squares = byConfiguration(residuals).filter(({ rows }) => rows.every((row) => row[key])).map(({ rows }) => squareOf(rows, key, columns));
  if (squares.length < 3) return null;
  const middle = mean(squares);
  const error = Math.sqrt(squares.reduce((sum, value) => sum + (value - middle) ** 2, 0) / (squares.length - 1) / squares.length);
  return { factor: Math.exp((studentT(0.05, squares.length - 1) * error) / (2 * middle)), count: squares.length };
}
