import { el } from '../core/dom.js';
import { behind, figure, lead, note } from '../core/figure.js';
import { count, fixed, mm } from '../core/format.js';
import { checkFlange } from '../core/kinematics.js';
import { cellOf, columnTitle, posesOf, posesToVerify, seenBy, valueOf, wayOf } from '../core/poses.js';
import { rmsByConfiguration } from '../core/residuals.js';
import { table } from '../core/table.js';
import { colour, ramp } from '../core/theme.js';
import { kinds, viewsOf } from '../core/views.js';
import { colourBar } from '../draw/colour_bar.js';
import { legend } from '../draw/legend.js';
import { parallelCoordinates } from '../draw/parallel.js';
import { RobotViewer } from '../draw/robot_viewer.js';
import { makeCanvas } from '../draw/viewer.js';
import { player } from './player.js';

export const title = 'Poses';

export const isShown = (part) => posesOf(part).length > 0;

/** What poses are coloured by: the colour of pose k as the theme has it, and what it means. */
function colouring(part, poses) {
  let name = 'order of the visit';
  let numbers = poses.map((unused, k) => k + 1);
  let text = (value) => fixed(value, 0);
  if (poses.some((pose) => typeof pose.value === 'number')) {
    name = 'value of the pose/mm';
    numbers = poses.map((pose) => pose.value);
    text = mm;
  } else if (part.residuals) {
    const rms = rmsByConfiguration(part.residuals);
    name = `residual RMS/${part.residuals.unit[0]}`;
    numbers = poses.map((pose) => rms.get(pose.id) ?? null);
    text = mm;
  }
  const known = numbers.filter((value) => typeof value === 'number');
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const colours = (k) => (typeof numbers[k] !== 'number' ? colour('needed') : ramp(high > low ? (numbers[k] - low) / (high - low) : 0.5));
  const bar = known.length > 1 ? colourBar(name, text(low), text(high)) : null;
  return { colours, bar, hasNeeded: numbers.includes(null) && part.document.pose_values };
}

function poseTable(caption, poses, part) {
  const isPlan = poses[0].hasWay;
  const header = ['pose', ...poses[0].keys.map(columnTitle)];
  if (poses.some((pose) => pose.value !== undefined)) header.push('value/mm');
  if (poses.some((pose) => pose.targets)) header.push('targets seen');
  if (poses.some((pose) => pose.touched)) header.push('socket');
  if (isPlan) header.push('way there');
  const hasNearest = poses.some((pose) => pose.nearest);
  if (hasNearest) header.push('nearest/mm');
  const rows = poses.map((pose) => {
    const row = [pose.id, ...pose.all.map((value, k) => cellOf(pose.keys[k], value))];
    if (header.includes('value/mm')) row.push(pose.value === undefined ? '-' : valueOf(pose));
    if (header.includes('targets seen')) row.push(pose.targets ? seenBy(pose, part) : '');
    if (header.includes('socket')) row.push((pose.touched ?? []).join(' '));
    if (isPlan) row.push(wayOf(pose));
    if (hasNearest) row.push(pose.nearest ?? '');
    return row;
  });
  return table(isPlan ? `${caption}, in the order to visit them` : caption, header, rows);
}

function rangeTable(joints, poses) {
  const rows = joints.map((joint, j) => {
    const key = poses[0].keys[j];
    const used = poses.map((pose) => pose.joints[j]);
    const [low, high] = [Math.min(...used), Math.max(...used)];
    const part = (high - low) / (joint.upper - joint.lower);
    return [
      columnTitle(key),
      cellOf(key, joint.lower),
      cellOf(key, joint.upper),
      cellOf(key, low),
      cellOf(key, high),
      Number.isFinite(part) ? `${fixed(100 * part, 0)} %` : '-',
    ];
  });
  return table('Joint ranges', ['joint', 'lower limit', 'upper limit', 'least used', 'largest used', 'of the range'], rows);
}

/** Joints of one pose; changes in place. */
function jointTable(joints, poses) {
  const cells = joints.map(() => el('td', { class: 'number' }));
  const bars = joints.map(() => el('span', { class: 'bar-mark' }));
  const element = el(
    'table',
    { class: 'joints' },
    el('caption', {}, 'Joints of this pose'),
    el(
      'thead',
      {},
      el(
        'tr',
        {},
        ['joint', 'value', 'between its limits'].map((text) => el('th', { scope: 'col' }, text)),
      ),
    ),
    el(
      'tbody',
      {},
      joints.map((joint, j) =>
        el('tr', {}, el('th', { scope: 'row' }, columnTitle(poses[0].keys[j])), cells[j], el('td', {}, el('span', { class: 'bar-track' }, bars[j]))),
      ),
    ),
  );
  return {
    element,
    show(values) {
      values.forEach((value, j) => {
        cells[j].textContent = cellOf(poses[0].keys[j], value);
        const part = (value - joints[j].lower) / (joints[j].upper - joints[j].lower);
        bars[j].style.left = `${100 * Math.min(1, Math.max(0, Number.isFinite(part) ? part : 0.5))}%`;
      });
    },
  };
}

function describe(poses, k, part) {
  const pose = poses[k];
  const parts = [`Pose ${pose.id}, ${k + 1} of ${poses.length}`];
  if (pose.value !== undefined) parts.push(pose.value === null ? 'needed' : `value ${mm(pose.value)} mm`);
  if (pose.targets) parts.push(pose.targets.length > 0 ? `targets seen: ${seenBy(pose, part)}` : 'no target seen');
  if (pose.touched) parts.push(`socket: ${pose.touched.join(' ')}`);
  if (pose.nearest) parts.push(`nearest: ${pose.nearest.replace(' ', ' mm ')}`);
  if (pose.blocked) parts.push('no free way there was found');
  else if (pose.via) parts.push('reached over a via point');
  return parts.join(' \u00b7 ');
}

/** A box to tick that shows something. */
function tick(name, show) {
  const box = el('input', { type: 'checkbox', checked: true });
  box.addEventListener('change', () => show(box.checked));
  return el('label', {}, box, name);
}

function views(viewer) {
  const names = { all: 'Whole', near: 'Robot', front: 'Front', side: 'Side', top: 'Top' };
  return el(
    'div',
    { class: 'views' },
    Object.entries(names).map(([key, name]) => el('button', { type: 'button', onclick: () => viewer.look(key) }, name)),
    viewer.views ? el('button', { type: 'button', onclick: () => viewer.lookAtViews() }, 'Camera and board') : null,
    tick('Frames', (isShown) => viewer.showFrames(isShown)),
    viewer.views ? tick('Views', (isShown) => viewer.showViews(isShown)) : null,
  );
}

/** What is drawn of a camera's views, in a sentence. */
function viewsNote({ scene: { views } }, list) {
  const rig = views.cameras.length > 1;
  const what =
    views.on_flange === 'camera'
      ? `the board with its corners and, as a pyramid towards what it sees, ${rig ? 'each camera that sees the board' : 'the camera'} at each view`
      : `${rig ? `the ${views.cameras.length} cameras` : 'the camera'} as ${rig ? 'pyramids' : 'a pyramid'} towards what ${rig ? 'they see' : 'it sees'}, and the board's outline at each view`;
  const odd = list.filter((one) => one.contradicts).map((one) => one.id);
  return note(`Drawn are ${what}.${odd.length > 0 ? ` Orange: what contradicts the other views (${odd.join(', ')}).` : ''}`);
}

/** Other poses than those of the part, where some are drawn. */
function viewsLegend(list) {
  const others = kinds.slice(1).filter(([key]) => list.some((one) => one.kind === key));
  return others.length > 0 ? legend(others.map(([, label, name]) => ({ label, colour: name }))) : null;
}

/** Fills the stage with the robot in 3D where there is WebGL, with a sentence else; gives the viewer. */
function fillStage(stage, part, poses, colours, shown) {
  const made = makeCanvas();
  stage.dataset.ready = 'true';
  if (!made) {
    stage.classList.add('stage-empty');
    stage.append(el('p', {}, 'No 3D view: this browser offers no WebGL. The poses are in the tables below.'));
    return null;
  }
  made.canvas.setAttribute('aria-label', `Robot in 3D: ${part.name}. Drag to turn, wheel to come nearer; arrow keys step through the poses.`);
  stage.append(made.canvas);
  const viewer = new RobotViewer(made, stage, part.scene, poses, colours, shown);
  stage.after(views(viewer));
  return viewer;
}

export function render(part) {
  const poses = posesOf(part);
  const joints = part.scene?.joints ?? poses[0].keys.slice(0, poses[0].joints.length).map((key) => ({ name: key, lower: null, upper: null }));
  const toVerify = posesToVerify(part);
  const { colours, bar, hasNeeded } = colouring(part, poses);
  const stage = part.scene ? el('div', { class: 'stage' }) : null;
  const shown = viewsOf(part);
  const coordinates = parallelCoordinates(joints, poses, colours, `Joints of ${count(poses.length, 'pose')} between their limits, as parallel coordinates`);
  const one = jointTable(joints, poses);
  let viewer = null;
  const steps = player(
    poses,
    stage ?? coordinates.element,
    (k, onTheWay) => {
      one.show(onTheWay ?? poses[k].joints);
      if (onTheWay) viewer?.show(onTheWay, [], '', []);
      else viewer?.show(poses[k].joints, shown ? null : poses[k].targets, poses[k].id, shown?.[k].cameras);
      if (!onTheWay) coordinates.show(k);
    },
    (k) => describe(poses, k, part),
  );
  const side = el(
    'div',
    { class: 'stage-side' },
    one.element,
    bar,
    shown ? [viewsLegend(shown), viewsNote(part, shown)] : null,
    hasNeeded ? note('Red: without this pose parameters are left unidentified.') : null,
  );
  const together = el('div', { class: 'stage-row' }, stage ? el('div', {}, stage) : null, side);
  const element = el(
    'div',
    {},
    introduction(part, poses),
    steps.bar,
    together,
    figure('Joint values of all poses between the limits; the current pose is dark.', coordinates.element, [rangeTable(joints, poses)]),
    behind([poseTable('Poses', poses, part)], `All ${count(poses.length, 'pose')} as a table`),
    toVerify.length > 0
      ? behind(
          [poseTable('Poses to judge the calibration on', toVerify, part)],
          `${count(toVerify.length, 'pose')} more, to judge the calibration on and not to calibrate with`,
        )
      : null,
  );
  if (stage) {
    checkFlange(part.scene, poses[0].joints);
    // After the page stands: to make a context and its programs takes a while.
    requestAnimationFrame(() =>
      requestAnimationFrame(() => {
        viewer = fillStage(stage, part, poses, colours, shown);
        steps.go(0);
      }),
    );
  }
  steps.go(0);
  return element;
}

function introduction(part, poses) {
  const { document } = part;
  if (!document.poses) return lead(`${count(poses.length, 'configuration')}, as measured.`);
  const text = [`${count(poses.length, 'pose')}${poses[0].hasWay ? ', in the order to visit them' : ''}`];
  if (document.tour) text.push(`all moves take ${fixed(document.tour.time_s, 1)} s at the joints' speeds`);
  if (document.tour?.blocked_count > 0) text.push(`${count(document.tour.blocked_count, 'move')} blocked: find a way by hand`);
  const near = poses.filter((pose) => typeof pose.clearance === 'number').sort((a, b) => a.clearance - b.clearance);
  if (near.length > 0) text.push(`nothing comes nearer than ${near[0].nearest.replace(' ', ' mm, ')}, at ${near[0].id}`);
  return lead(`${text.join('; ')}.`);
}
