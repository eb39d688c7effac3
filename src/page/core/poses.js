// The configurations of a part: those planned, or those measured.

import { fixed, reading, splitUnit } from './format.js';

/** Names of sockets that poses touch, in their order, by the parameters of a plan; empty of other sensors. */
const socketsOf = ({ predicted }) => [
  ...new Set(
    Object.keys(predicted?.standard_deviation ?? {})
      .map((key) => /^socket\.(.+)\.[^.]+$/.exec(key)?.[1])
      .filter(Boolean),
  ),
];

function planned(document, poses) {
  const sockets = socketsOf(document);
  const values = new Map((document.pose_values ?? []).map((one) => [one.id, one.value_mm]));
  return poses.map((pose) => {
    const keys = Object.keys(pose.joints);
    const drawn = keys.filter((key) => splitUnit(key).unit !== 'Nm');
    return {
      id: pose.id,
      times: pose.times,
      keys,
      all: keys.map((key) => pose.joints[key]),
      joints: drawn.map((key) => pose.joints[key]),
      via: pose.via ? drawn.map((key) => pose.via[key]) : null,
      clearance: pose.clearance_m,
      nearest: typeof pose.clearance_m === 'number' ? `${fixed(1e3 * pose.clearance_m, 2)} ${pose.nearest.join(' to ')}` : null,
      blocked: pose.way_is_blocked,
      kept: pose.kept,
      hasWay: 'via' in pose,
      value: values.get(pose.id),
      targets: sockets.length > 0 ? null : (pose.visible_targets ?? null),
      touched: sockets.length > 0 ? (pose.visible_targets ?? []).map((number) => sockets[number - 1] ?? number) : null,
    };
  });
}

/**
 * `id`, `joints` (m, rad), `keys` of them, and of plans `value` (mm; null: needed), `targets` it shows or
 * `touched` sockets, `via`, `clearance` (m), `nearest`: how near (mm) which two bodies come.
 */
export function posesOf(part) {
  const { document, scene } = part;
  if (document.poses?.length > 0 && document.poses[0].joints) return planned(document, document.poses);
  const keys = (scene?.joints ?? []).map((joint) => `${joint.name}_${joint.kind === 'prismatic' ? 'm' : 'rad'}`);
  const measured = (scene && part.configurations) || { id: [], joints: [] };
  return measured.joints.map((joints, k) => ({
    id: measured.id[k],
    keys,
    all: joints,
    joints: joints.slice(0, keys.length),
    via: null,
    targets: null,
    times: 1,
  }));
}

/** Numbers of the targets that a pose shows; of a board's many corners how many. */
export function seenBy({ targets }, { scene }) {
  const corners = scene?.views ? scene.views.corners.length * scene.views.cameras.length : 0;
  return corners > 12 ? `${targets.length} of ${corners}` : targets.join(' ');
}

/** The same of those that a plan has to judge the calibration on. */
export const posesToVerify = ({ document }) => planned(document, Array.isArray(document.verification) ? document.verification : []);

/** Ids of a plan's poses, with how often each is to be measured. */
export const idsOf = ({ poses }) => poses.map(({ id, times }) => (times > 1 ? `${id} (x${times})` : id)).join(' ');

/** "q1/deg". */
export const columnTitle = (key) => {
  const { name, unit } = reading(key, 0);
  return `${name}/${unit}`;
};

export const cellOf = (key, value) => (value === null ? '-' : fixed(reading(key, value).value, 2));

/** How it gets there: "straight", "via 1.00 2.00", "BLOCKED". */
export function wayOf(pose) {
  if (pose.blocked) return 'BLOCKED';
  if (!pose.via) return 'straight';
  return ['via', ...pose.via.map((value, k) => cellOf(pose.keys[k], value))].join(' ');
}

/** "0.0123", or "needed" of a pose without which parameters are left open. */
export const valueOf = (pose) => (pose.value === null ? 'needed' : fixed(pose.value, 4));
