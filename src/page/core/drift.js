// Whether residuals follow the order of the measurements.

import { byConfiguration } from './residuals.js';
import { mean, studentT, trend } from './statistics.js';

/** What errors of the model may follow: sine and cosine of each joint, joints that slide as they are. */
function positionsOf(groups, joints) {
  return groups[0].rows[0].joints.flatMap((unused, j) => {
    const values = groups.map(({ rows }) => rows[0].joints[j]);
    return joints?.[j]?.kind === 'prismatic' ? [values] : [values.map(Math.sin), values.map(Math.cos)];
  });
}

/**
 * A line through the means of the configurations in the order measured, each axis by itself, beside what
 * follows the joints' positions, so that poses which were measured in an order of theirs are not taken for
 * drift; with few configurations without that. `slopes` have `p` `corrected` for the number of axes, and what
 * would have been `seen` over all, and by how much the first tenth is off the rest (`early`: a robot that warms
 * up); `worst` is the most certain one.
 */
export function driftOf(residuals, joints) {
  const groups = byConfiguration(residuals);
  if (groups.length < 4) return null;
  const xs = groups.map((unused, k) => k + 1);
  const length = xs.length - 1;
  const all = positionsOf(groups, joints);
  const others = groups.length >= 3 * (all.length + 2) ? all : [];
  const slopes = residuals.axes.map((axis, k) => {
    const ys = groups.map(({ rows }) => mean(rows.map((row) => row.residual[k])));
    const fit = trend(xs, ys, others);
    if (!fit) return null;
    const corrected = Math.min(1, fit.p * residuals.axes.length);
    const seen = studentT(0.05 / residuals.axes.length, fit.freedom) * fit.error * length;
    const first = Math.ceil(ys.length / 10);
    const early = mean(ys.slice(0, first)) - mean(ys.slice(first));
    return { axis, unit: residuals.unit[k], ...fit, corrected, change: fit.slope * length, seen, early, ys };
  }).filter(Boolean);
  if (slopes.length === 0) return null;
  const worst = slopes.reduce((a, b) => (b.corrected < a.corrected || (b.corrected === a.corrected && b.p < a.p) ? b : a));
  return { xs, slopes, worst, besideJoints: others.length > 0, verdict: worst.corrected < 0.01 ? 'yes' : worst.corrected < 0.05 ? 'perhaps' : 'no' };
}
