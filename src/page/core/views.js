// Cameras and the board that they see, at each pose.

import { flange, multiply } from './kinematics.js';
import { posesOf, posesToVerify } from './poses.js';

/** Poses by what they were for, with the colours that they have. */
export const kinds = [
  ['residuals', 'calibrated with', 'accent'],
  ['validation', 'validation', 'fourth'],
  ['verification', 'verification', 'third'],
  ['left_out', 'not in plan', 'needed'],
];

/** Cameras, from 0, that see a corner in each configuration, by index. */
function camerasOf({ configuration, camera }) {
  const seen = [];
  configuration.forEach((index, k) => (seen[index] ??= new Set()).add(camera[k]));
  return seen.map((cameras) => [...cameras].sort());
}

/** Of a plan's pose: its targets are the corners of the first camera, then those of the next. */
const plannedCameras = ({ targets }, corners) => [...new Set((targets ?? []).map((number) => Math.floor((number - 1) / corners)))];

/** Of poses that are not those of the part. */
function othersOf({ residuals }, key) {
  const { configurations, readings } = residuals?.[key] ?? {};
  if (!configurations) return [];
  const seen = camerasOf(readings);
  return configurations.id.map((id, k) => ({ id, joints: configurations.joints[k], cameras: seen[k] ?? [] }));
}

/**
 * Each view: `id`, `kind` as above (of a plan: `planned` or `verification`), `place`: of what the
 * flange carries (the first camera, or the board) in the world, `cameras` that see the board, and
 * whether it `contradicts` the others. Null where there is no camera.
 */
export function viewsOf(part) {
  const { document, residuals, scene } = part;
  if (!scene?.views) return null;
  const { flange_from_it: onFlange, cameras, corners } = scene.views;
  const odd = (document.doubts?.views ?? []).map(({ sample }) => sample);
  const seen = residuals?.readings?.camera ? camerasOf(residuals.readings) : null;
  const all = cameras.map((unused, k) => k);
  const isPlan = Boolean(document.poses);
  const of = (pose) => (isPlan ? plannedCameras(pose, corners.length) : all);
  const view = (kind, pose) => ({
    id: pose.id,
    kind,
    place: multiply(flange(scene, pose.joints), onFlange),
    cameras: pose.cameras,
    contradicts: odd.some((sample) => sample === pose.id || sample.startsWith(`${pose.id}:`)),
  });
  return [
    ...posesOf(part).map((pose, k) => view(isPlan ? 'planned' : 'residuals', { ...pose, cameras: seen ? (seen[k] ?? []) : of(pose) })),
    ...posesToVerify(part).map((pose) => view('verification', { ...pose, cameras: of(pose) })),
    ...kinds.slice(1).flatMap(([key]) => othersOf(part, key).map((pose) => view(key, pose))),
  ];
}

/** Ends of the edges of the smallest box about the corners, in the board's frame; of a plane board those of a rectangle. */
export function edgesOf(corners) {
  const low = [0, 1, 2].map((axis) => Math.min(...corners.map((corner) => corner[axis])));
  const high = [0, 1, 2].map((axis) => Math.max(...corners.map((corner) => corner[axis])));
  const wide = [0, 1, 2].filter((axis) => high[axis] - low[axis] > 1e-6);
  const ends = wide.reduce((points, axis) => [...points, ...points.map((point) => point.map((value, k) => (k === axis ? high[k] : value)))], [low]);
  return wide.flatMap((axis) =>
    ends.filter((point) => point[axis] === low[axis]).flatMap((point) => [point, point.map((value, k) => (k === axis ? high[k] : value))]),
  );
}

/** Edges of the pyramid from a camera to its image at this depth, in the camera's frame. */
export function pyramidOf([left, top, right, bottom], depth) {
  const image = [
    [left, top],
    [right, top],
    [right, bottom],
    [left, bottom],
  ].map(([x, y]) => [x * depth, y * depth, depth]);
  const above = [(left + right) / 2, top - 0.18 * (bottom - top)].map((value) => value * depth);
  const roof = [image[0], [...above, depth], [...above, depth], image[1]];
  return [...image.flatMap((corner, k) => [[0, 0, 0], corner, corner, image[(k + 1) % 4]]), ...roof];
}
