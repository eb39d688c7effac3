// Of a list of numbers, and the axis of a normal plot.

export const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

export const rms = (values) => Math.sqrt(mean(values.map((value) => value * value)));

/** The least value that part p of them do not exceed: as errors of readings are stated. */
export const lowerQuantile = (values, p) => Float64Array.from(values).sort()[Math.max(0, Math.min(values.length - 1, Math.ceil(p * values.length) - 1))];

/** Between order statistics: p of 0..1 of values in any order. */
export function quantile(values, p) {
  const sorted = Float64Array.from(values).sort();
  const at = p * (sorted.length - 1);
  const low = Math.floor(at);
  const high = Math.min(low + 1, sorted.length - 1);
  return sorted[low] + (at - low) * (sorted[high] - sorted[low]);
}

/** The value of a polynomial, the coefficient of the highest power first. */
const polynomial = (coefficients, x) => coefficients.reduce((sum, one) => sum * x + one, 0);

/** Quantile of the standard normal distribution, for the axis of a normal plot [Acklam 2003]: to 1e-9 of it. */
export function normalQuantile(p) {
  const tail = 0.02425;
  if (p > 1 - tail) return -normalQuantile(1 - p);
  if (p < tail) {
    const q = Math.sqrt(-2 * Math.log(p));
    return (
      polynomial([-7.784894002430293e-3, -0.3223964580411365, -2.400758277161838, -2.549732539343734, 4.374664141464968, 2.938163982698783], q) /
      polynomial([7.784695709041462e-3, 0.3224671290700398, 2.445134137142996, 3.754408661907416, 1], q)
    );
  }
  const q = p - 0.5;
  const r = q * q;
  return (
    (q * polynomial([-39.69683028665376, 220.9460984245205, -275.9285104469687, 138.357751867269, -30.66479806614716, 2.506628277459239], r)) /
    polynomial([-54.47609879822406, 161.5858368580409, -155.6989798598866, 66.80131188771972, -13.28068155288572, 1], r)
  );
}
