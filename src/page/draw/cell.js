import { Group } from 'three';
import { apply, origin } from '../core/kinematics.js';
import { ball, box, capsule, lines, place, rod, stretch, wall } from './solids.js';

function grid(centre, height, size, material) {
  const points = [];
  const step = size / 10;
  for (let k = -10; k <= 10; ++k) {
    const at = k * step;
    points.push([centre[0] + at, centre[1] - size, height], [centre[0] + at, centre[1] + size, height]);
    points.push([centre[0] - size, centre[1] + at, height], [centre[0] + size, centre[1] + at, height]);
  }
  return lines(points, material);
}

/** Foot of the perpendicular from a point to a wall. */
function foot({ point, normal }, from) {
  const norm = Math.hypot(...normal);
  const unit = normal.map((value) => value / norm);
  const off = unit.reduce((sum, value, k) => sum + value * (from[k] - point[k]), 0);
  return from.map((value, k) => value - off * unit[k]);
}

/** What stands around the robot. Gives its labels: world places with text. */
export function drawCell(scene, materials, size) {
  const group = new Group();
  const labels = [];
  const base = origin(scene.world_from_base);
  for (const one of scene.boxes ?? []) {
    group.add(box(one, materials));
    if (one.kind === 'keep_out') labels.push({ world: origin(one.world_from_box), text: one.name });
  }
  for (const one of (scene.capsules ?? []).filter((solid) => solid.kind === 'keep_out')) {
    const holder = new Group();
    holder.add(capsule(one.from, one.to, one.radius, materials.obstacle));
    place(holder, scene.world_from_base);
    group.add(holder);
    const middle = one.from.map((value, k) => (value + one.to[k]) / 2);
    labels.push({ world: apply(scene.world_from_base, middle), text: one.name });
  }
  for (const one of scene.walls ?? []) {
    const centre = foot(one, base);
    group.add(wall(one, centre, 2.2 * size, materials.wall));
    labels.push({ world: centre, text: one.name });
  }
  if (typeof scene.floor_z === 'number') group.add(grid(base, scene.floor_z, 1.6 * size, materials.faint));
  if (scene.instrument) {
    const at = scene.instrument.position;
    group.add(ball(0.045 * size, materials.instrument));
    group.children.at(-1).position.set(...at);
    if (typeof scene.floor_z === 'number') {
      const post = rod(0.018 * size, materials.instrument);
      stretch(post, at, [at[0], at[1], scene.floor_z]);
      group.add(post);
    }
    const isNamed = labels.some(({ text }) => text === scene.instrument.kind);
    if (!isNamed) labels.push({ world: at, text: scene.instrument.kind });
  }
  return { group, labels };
}
