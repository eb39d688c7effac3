// Whether residuals follow the order of the measurements.

import { byConfiguration } from './residuals.js';
import { line, mean, studentT } from './statistics.js';

/**
 * A line through the means of the configurations, each axis by itself: `slopes` with `p` corrected for
 * the number of axes, the worst of them, and what over all would have been seen.
 */
export function driftOf(residuals) {
  const groups = byConfiguration(residuals);
  if (groups.length < 4) return null;
  const xs = groups.map((unused, k) => k + 1);
  const length = xs.length - 1;
  const slopes = residuals.axes.map((axis, k) => {
    const ys = groups.map(({ rows }) => mean(rows.map((row) => row.residual[k])));
    const fit = line(xs, ys);
    if (!fit) return null;
    const corrected = Math.min(1, fit.p * residuals.axes.length);
    const seen = studentT(0.05 / residuals.axes.length, fit.freedom) * fit.error * length;
    return { axis, unit: residuals.unit[k], k, ...fit, corrected, change: fit.slope * length, seen, ys };
  }).filter(Boolean);
  if (slopes.length === 0) return null;
  const worst = slopes.reduce((a, b) => (b.corrected < a.corrected || (b.corrected === a.corrected && b.p < a.p) ? b : a));
  return { xs, slopes, worst, verdict: worst.corrected < 0.01 ? 'yes' : worst.corrected < 0.05 ? 'perhaps' : 'no' };
}
