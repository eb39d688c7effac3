// Homogeneous transforms: 16 numbers, row by row, as the scene has them.

export const identity = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function multiply(a, b) {
  const c = new Array(16);
  for (let i = 0; i < 16; i += 4) {
    for (let j = 0; j < 4; ++j) {
      c[i + j] = a[i] * b[j] + a[i + 1] * b[4 + j] + a[i + 2] * b[8 + j] + a[i + 3] * b[12 + j];
    }
  }
  return c;
}

export const apply = (m, [x, y, z]) => [0, 4, 8].map((i) => m[i] * x + m[i + 1] * y + m[i + 2] * z + m[i + 3]);

export const origin = (m) => [m[3], m[7], m[11]];

/** "Tx" .. "Rz" by an amount in m or rad. */
export function elementary(motion, amount) {
  const m = identity();
  const axis = 'xyz'.indexOf(motion[1]);
  if (motion[0] === 'T') {
    m[4 * axis + 3] = amount;
    return m;
  }
  const [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
  const [c, s] = [Math.cos(amount), Math.sin(amount)];
  m[4 * i + i] = c;
  m[4 * i + j] = -s;
  m[4 * j + i] = s;
  m[4 * j + j] = c;
  return m;
}

/** World frames: that of the base, and that after each element; the last is the flange's. */
export function frames(scene, joints) {
  const list = [scene.world_from_base];
  for (const element of scene.elements) {
    const amount = element.joints.reduce((sum, one) => sum + one.coefficient * joints[one.joint], element.amount);
    list.push(multiply(list[list.length - 1], elementary(element.motion, amount)));
  }
  return list;
}

export const flange = (scene, joints) => frames(scene, joints).at(-1);

/** Largest difference from the flange that the program states; 0 where it states none. */
export function checkFlange(scene, joints) {
  const stated = scene.flange_of_first_pose;
  if (!stated || !joints) return 0;
  const drawn = flange(scene, joints);
  const off = Math.max(...stated.map((value, k) => Math.abs(value - drawn[k])));
  if (!(off <= 1e-9)) console.error(`posewise page: flange drawn ${off} from where it is`);
  return off;
}

/** Configurations on the way from one to another, ends included, over a via point if there is one. */
export function way(from, to, via, steps = 12) {
  const corners = via ? [from, via, to] : [from, to];
  const list = [from];
  for (let k = 1; k < corners.length; ++k) {
    for (let step = 1; step <= steps; ++step) {
      list.push(corners[k - 1].map((value, j) => value + (step / steps) * (corners[k][j] - value)));
    }
  }
  return list;
}

/** A point of the world in the frame `m`. */
export function applyInverse(m, point) {
  const off = [0, 1, 2].map((k) => point[k] - m[4 * k + 3]);
  return [0, 1, 2].map((j) => m[j] * off[0] + m[4 + j] * off[1] + m[8 + j] * off[2]);
}
