// Error against number of poses, as plans predict and studies find it.

const pointOf = (one, error) => ({
  count: one.new_pose_count,
  isPlanned: one.is_planned,
  expected: error.expected_mm ?? error.total_rms_mm,
  lower: error.lower_mm ?? error.total_lower_mm,
  upper: error.upper_mm ?? error.total_upper_mm,
  assured: error.assured_mm ?? null,
  parameters: error.rms_mm ?? null,
});

/** Of a plan: points, that of the plan itself, floor and limit, mm; null where it states none. */
export function plannedCurve(document) {
  const { target, budget } = document;
  const own = { new_pose_count: document.new_pose_count, is_planned: true, error: target?.error, accuracy: document.accuracy };
  const list = [...(target ? target.curve : (document.other_counts ?? []))];
  if (!list.some((one) => one.is_planned && one.new_pose_count === own.new_pose_count)) list.push(own);
  const points = list
    .filter((one) => one.error ?? one.accuracy)
    .map((one) => pointOf(one, one.error ?? one.accuracy))
    .sort((a, b) => a.count - b.count);
  const counts = new Set(points.map((one) => one.count));
  if (counts.size < 2) return null;
  const wanted = document.new_pose_count;
  const current = points.find((one) => one.isPlanned && one.count === wanted) ?? points.find((one) => one.isPlanned) ?? points[0];
  return {
    points,
    current,
    floor: target ? target.floor.expected_mm : budget ? Math.hypot(budget.left_over_mm, budget.repeatability_mm) : null,
    limit: target?.limit_mm ?? null,
    assurance: target?.assurance ?? null,
  };
}
