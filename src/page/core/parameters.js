// Parameters of an estimate, as its table has them.

const unitOf = (keys, name) => (keys.has(`${name}_rad`) ? 'rad' : 'm');

/** Rotation vector of a unit quaternion, rad. */
function rotationVector([w, ...v]) {
  const size = Math.hypot(...v);
  if (size === 0) return [0, 0, 0];
  const angle = 2 * Math.atan2(w < 0 ? -size : size, Math.abs(w));
  return v.map((value) => (value / size) * angle);
}

/** Values of base, targets and whatever else the sensor has, by name, m and rad. */
function valuesOf(document) {
  const values = new Map();
  if (document.base) {
    const turn = rotationVector(document.base.quaternion_wxyz);
    ['x', 'y', 'z'].forEach((axis, k) => {
      values.set(`base.${axis}`, document.base.position_m[k]);
      values.set(`base.r${axis}`, turn[k]);
    });
  }
  for (const [name, target] of Object.entries(document.targets ?? {})) {
    ['x', 'y', 'z'].forEach((axis, k) => values.set(`${name}.${axis}`, target.position_m[k]));
  }
  for (const [key, value] of Object.entries(document.sensor ?? {})) {
    if (typeof value === 'number') values.set(key.replace(/_(m|rad)$/, ''), value);
  }
  for (const [name, one] of Object.entries(document.robot ?? {})) values.set(name, one.value_m ?? one.value_rad);
  return values;
}

/** `name`, `value`, `sigma`, `expected` (m, rad), `isAngle`, `isRobot`, `isHeld`, in the order of the covariance. */
export function parametersOf(document) {
  const names = document.covariance?.parameters ?? Object.keys(document.robot ?? {});
  const values = valuesOf(document);
  const keys = new Set([...Object.keys(document.sigma ?? {}), ...Object.keys(document.assumes?.expected_error ?? {})]);
  const held = new Set(document.held ?? []);
  return names.map((name) => {
    const robot = document.robot?.[name];
    const isAngle = robot ? 'value_rad' in robot : unitOf(keys, name) === 'rad';
    const suffix = isAngle ? 'rad' : 'm';
    return {
      name,
      isAngle,
      isRobot: Boolean(robot),
      isHeld: held.has(name),
      value: values.get(name) ?? null,
      sigma: robot ? robot[`sigma_${suffix}`] : document.sigma?.[`${name}_${suffix}`],
      expected: robot ? robot[`expected_${suffix}`] : document.assumes?.expected_error?.[`${name}_${suffix}`],
    };
  });
}

/** The joint that each error of the robot belongs to: the one that it follows in the chain, or that its name begins with. */
function jointsOf({ elements = [], terms = [] }) {
  const joints = elements.flatMap((element) => Object.keys(element.joints ?? {}));
  const list = new Map();
  let [last] = joints;
  for (const element of elements) {
    last = Object.keys(element.joints ?? {})[0] ?? last;
    if (element.error) list.set(element.error, last);
  }
  for (const { name, of, sine_of: sineOf } of terms) {
    list.set(name, joints.find((joint) => name.startsWith(joint) && !/\w/.test(name[joint.length] ?? '')) ?? Object.keys(of ?? sineOf ?? {})[0]);
  }
  return { joints: [...new Set(joints)], list };
}

/** Correlation coefficients of the covariance's parameters and the block of each: the base, a joint's errors, a target; null where there is none. */
export function correlationsOf({ covariance, chain, robot }) {
  if (!covariance?.rows_si?.length) return null;
  const rows = covariance.rows_si;
  const { joints, list } = jointsOf(chain ?? {});
  const named = covariance.parameters
    .map((name, k) => {
      const block = list.get(name) ?? (robot && name in robot ? 'robot' : name.replace(/\.[^.]*$/, ''));
      return { name, k, block, rank: block === 'base' ? -1 : joints.includes(block) ? joints.indexOf(block) : joints.length };
    })
    .sort((a, b) => a.rank - b.rank || a.k - b.k);
  const order = named.map((one) => one.k);
  const sigma = rows.map((row, k) => Math.sqrt(row[k]));
  const at = (first, second) => {
    const [i, j] = [order[first], order[second]];
    if (i === j) return 1;
    const value = (i > j ? rows[i][j] : rows[j][i]) / (sigma[i] * sigma[j]);
    return Number.isFinite(value) ? value : 0;
  };
  return { names: named.map((one) => one.name), blocks: named.map((one) => one.block), at };
}
