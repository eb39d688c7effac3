// A few distributions and fits.

export const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

export const rms = (values) => Math.sqrt(mean(values.map((value) => value * value)));

/** The least value that part p of them do not exceed: as errors of readings are stated. */
export const lowerQuantile = (values, p) =>
  Float64Array.from(values).sort()[Math.max(0, Math.min(values.length - 1, Math.ceil(p * values.length) - 1))];

/** Between order statistics: p of 0..1 of values in any order. */
export function quantile(values, p) {
  const sorted = Float64Array.from(values).sort();
  const at = p * (sorted.length - 1);
  const low = Math.floor(at);
  const high = Math.min(low + 1, sorted.length - 1);
  return sorted[low] + (at - low) * (sorted[high] - sorted[low]);
}

const lanczos = [76.18009172947146, -86.50532032941677, 24.01409824083091, -1.231739572450155, 0.1208650973866179e-2, -0.5395239384953e-5];

function logGamma(x) {
  const t = x + 5.5;
  const sum = lanczos.reduce((total, c, k) => total + c / (x + 1 + k), 1.000000000190015);
  return (x + 0.5) * Math.log(t) - t + Math.log((2.5066282746310005 * sum) / x);
}

/** Continued fraction of the incomplete beta function. */
function betaFraction(a, b, x) {
  const keep = (value) => (Math.abs(value) < 1e-300 ? 1e-300 : value);
  let c = 1;
  let d = 1 / keep(1 - ((a + b) * x) / (a + 1));
  let h = d;
  for (let m = 1; m <= 300; ++m) {
    for (const step of [(m * (b - m) * x) / ((a + 2 * m - 1) * (a + 2 * m)), (-(a + m) * (a + b + m) * x) / ((a + 2 * m) * (a + 2 * m + 1))]) {
      d = 1 / keep(1 + step * d);
      c = keep(1 + step / c);
      h *= c * d;
    }
    if (Math.abs(c * d - 1) < 1e-13) break;
  }
  return h;
}

function incompleteBeta(a, b, x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const front = Math.exp(logGamma(a + b) - logGamma(a) - logGamma(b) + a * Math.log(x) + b * Math.log(1 - x));
  return x < (a + 1) / (a + b + 2) ? (front * betaFraction(a, b, x)) / a : 1 - (front * betaFraction(b, a, 1 - x)) / b;
}

/** Probability of a larger |t| by chance. */
export const twoSided = (t, freedom) => incompleteBeta(freedom / 2, 0.5, freedom / (freedom + t * t));

/** |t| that is exceeded by chance with probability p. */
export function studentT(p, freedom) {
  let [low, high] = [0, 1000];
  for (let k = 0; k < 80; ++k) {
    const middle = (low + high) / 2;
    if (twoSided(middle, freedom) > p) low = middle;
    else high = middle;
  }
  return (low + high) / 2;
}

/** Quantile of the standard normal distribution, by Newton from Student's with many degrees. */
export function normalQuantile(p) {
  if (p === 0.5) return 0;
  return Math.sign(p - 0.5) * studentT(2 * Math.min(p, 1 - p), 1e7);
}

/** Straight line by least squares: `slope`, `error` of it, `offset`, `freedom`, `p` of no slope. */
export function line(xs, ys) {
  const freedom = xs.length - 2;
  const [mx, my] = [mean(xs), mean(ys)];
  const sxx = xs.reduce((sum, x) => sum + (x - mx) ** 2, 0);
  if (freedom < 1 || !(sxx > 0)) return null;
  const slope = xs.reduce((sum, x, k) => sum + (x - mx) * (ys[k] - my), 0) / sxx;
  const offset = my - slope * mx;
  const squares = ys.reduce((sum, y, k) => sum + (y - offset - slope * xs[k]) ** 2, 0);
  const error = Math.sqrt(squares / freedom / sxx);
  const p = error > 0 ? twoSided(slope / error, freedom) : slope === 0 ? 1 : 0;
  return { slope, error, offset, freedom, p };
}

const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);

/** What of `values` the orthonormal `basis` cannot express. */
function beside(values, basis) {
  const rest = [...values];
  for (let twice = 0; twice < 2; ++twice) {
    for (const one of basis) {
      const part = dot(rest, one);
      for (let k = 0; k < rest.length; ++k) rest[k] -= part * one[k];
    }
  }
  return rest;
}

/**
 * Slope of ys over xs, which stand in order, beside a constant and `others`; its error is widened by how much
 * neighbours are alike, as of a process that remembers one step. As line().
 */
export function trend(xs, ys, others = []) {
  const basis = [];
  for (const column of [xs.map(() => 1), ...others]) {
    const rest = beside(column, basis);
    const size = Math.sqrt(dot(rest, rest));
    if (size > 1e-6 * Math.sqrt(dot(column, column))) basis.push(rest.map((value) => value / size));
  }
  const [x, y] = [beside(xs, basis), beside(ys, basis)];
  const degrees = xs.length - basis.length - 1;
  const sxx = dot(x, x);
  if (degrees < 1 || !(sxx > 1e-9 * dot(xs, xs))) return null;
  const slope = dot(x, y) / sxx;
  const rest = y.map((value, k) => value - slope * x[k]);
  const square = dot(rest, rest);
  const alike = square > 0 ? Math.min(0.95, Math.max(0, dot(rest.slice(1), rest.slice(0, -1)) / square)) : 0;
  const wider = (1 + alike) / (1 - alike);
  const freedom = Math.max(1, degrees / wider);
  const error = Math.sqrt((square / degrees / sxx) * wider);
  const p = error > 0 ? twoSided(slope / error, freedom) : slope === 0 ? 1 : 0;
  return { slope, error, offset: mean(ys) - slope * mean(xs), freedom, p };
}
