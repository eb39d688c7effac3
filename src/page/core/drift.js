// Whether residuals follow the order or time of the measurements.

import { byConfiguration } from './residuals.js';
import { line, mean, studentT } from './statistics.js';

const timeOf = (value) => (typeof value === 'number' ? value : Date.parse(value) / 1000);

/** Numbers when each configuration was measured: hours since the first, or its place in the order. */
function moments(groups) {
  const times = groups.map(({ rows }) => (rows[0].time === undefined ? NaN : timeOf(rows[0].time)));
  if (times.every(Number.isFinite) && Math.max(...times) > Math.min(...times)) {
    const first = Math.min(...times);
    return { xs: times.map((time) => (time - first) / 3600), name: 'time/h', unit: 'h' };
  }
  return { xs: groups.map((unused, k) => k + 1), name: 'configuration, in the order measured', unit: 'configuration' };
}

/**
 * A line through the means of the configurations, each axis by itself: `slopes` with `p` corrected for
 * the number of axes, the worst of them, and what over all would have been seen.
 */
export function driftOf(residuals) {
  const groups = byConfiguration(residuals);
  if (groups.length < 4) return null;
  const when = moments(groups);
  const length = Math.max(...when.xs) - Math.min(...when.xs);
  const slopes = residuals.axes.map((axis, k) => {
    const ys = groups.map(({ rows }) => mean(rows.map((row) => row.residual[k])));
    const fit = line(when.xs, ys);
    if (!fit) return null;
    const corrected = Math.min(1, fit.p * residuals.axes.length);
    const seen = studentT(0.05 / residuals.axes.length, fit.freedom) * fit.error * length;
    return { axis, unit: residuals.unit[k], k, ...fit, corrected, change: fit.slope * length, seen, ys };
  }).filter(Boolean);
  if (slopes.length === 0) return null;
  const worst = slopes.reduce((a, b) => (b.corrected < a.corrected || (b.corrected === a.corrected && b.p < a.p) ? b : a));
  return { ...when, slopes, worst, ids: groups.map(({ id }) => id), verdict: worst.corrected < 0.01 ? 'yes' : worst.corrected < 0.05 ? 'perhaps' : 'no' };
}
