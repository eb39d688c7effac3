import { columnTitle, cellOf } from '../core/poses.js';
import { colour, isOnPaper } from '../core/theme.js';
import { drawing } from './canvas.js';

/** Joints side by side, each over its range, limits marked; a line for each pose. */
export function parallelCoordinates(joints, poses, colours, label) {
  let current = 0;
  const keys = poses[0].keys.slice(0, joints.length);
  const ranges = joints.map((joint, j) => {
    const used = poses.map((pose) => pose.joints[j]);
    const limits = [joint.lower, joint.upper].filter(Number.isFinite);
    return [Math.min(...used, ...limits), Math.max(...used, ...limits)];
  });
  const { element, redraw } = drawing(
    label,
    () => (isOnPaper() ? 170 : 250),
    (context, width, height) => {
      const [left, right, top, bottom] = [36, width - 36, 36, height - 22];
      const x = (j) => (joints.length > 1 ? left + (j / (joints.length - 1)) * (right - left) : (left + right) / 2);
      const y = (j, value) => {
        const [low, high] = ranges[j];
        return bottom - ((value - low) / (high - low || 1)) * (bottom - top);
      };
      const line = (pose, style, thick) => {
        context.strokeStyle = style;
        context.lineWidth = thick;
        context.beginPath();
        pose.joints.forEach((value, j) => (j === 0 ? context.moveTo(x(j), y(j, value)) : context.lineTo(x(j), y(j, value))));
        context.stroke();
      };
      context.textAlign = 'center';
      context.globalAlpha = poses.length > 60 ? 0.35 : 0.85;
      poses.forEach((pose, k) => line(pose, colours(k), 1.4));
      context.globalAlpha = 1;
      line(poses[current], colour('paper'), 6);
      line(poses[current], colour('ink'), 2.6);
      const room = (right - left) / Math.max(1, joints.length - 1) - 6;
      joints.forEach((joint, j) => {
        context.strokeStyle = colour('muted');
        context.lineWidth = 1;
        context.strokeRect(x(j), top, 0.01, bottom - top);
        for (const limit of [joint.lower, joint.upper].filter(Number.isFinite)) context.strokeRect(x(j) - 5, y(j, limit), 10, 0.01);
        context.fillStyle = colour('ink');
        context.fillText(columnTitle(keys[j]), x(j), 14, room);
        context.fillStyle = colour('ink-soft');
        context.fillText(cellOf(keys[j], ranges[j][1]).replace(/\.00$/, ''), x(j), 29, room);
        context.fillText(cellOf(keys[j], ranges[j][0]).replace(/\.00$/, ''), x(j), height - 6, room);
      });
    },
  );
  return {
    element,
    show(pose) {
      current = pose;
      redraw();
    },
  };
}
