// Documents as designs/page.md has them, made up, for tests that need no program.
import { readFileSync } from 'node:fs';
import { flange, apply } from '../../src/page/core/kinematics.js';

const template = new URL('../../src/page/page.html', import.meta.url);
const place = '<script type="application/json" id="posewise">';

/** The page with a document in it, as the program writes it. */
export function pageWith(document) {
  const page = readFileSync(process.env.POSEWISE_PAGE ?? template, 'utf8');
  const json = JSON.stringify(document).replace(/[<>&\u2028\u2029]/g, (c) => `\\u${c.charCodeAt(0).toString(16).padStart(4, '0')}`);
  const empty = `${place}{}</script>`;
  if (page.split(empty).length !== 2) throw new Error('no single place for the document');
  return page.replace(empty, () => `${place}${json}</script>`);
}

/** The document in a page. */
export function documentOf(html) {
  const begin = html.indexOf(place) + place.length;
  return JSON.parse(html.slice(begin, html.indexOf('</script>', begin)));
}

const mapOf = (points) => ({
  position: points.map((one) => one.position),
  predicted_mm: points.map((one) => one.predicted_mm),
  ...(points[0].displacement_mm ? { displacement_mm: points.map((one) => one.displacement_mm) } : {}),
});

/** Residuals as the page has them. */
function packed(part) {
  if (!part.residuals) return part;
  const { axes, unit, rows } = part.residuals;
  const targets = [...new Set(rows.map((row) => row.target))];
  const whole = (key, factor) => axes.map((unused, axis) => rows.map((row) => Math.round(row[key][axis] * factor)));
  const readings = {
    configuration: rows.map((row) => part.configurations.id.indexOf(row.configuration)),
    sample: rows.map((row) => row.sample),
    target: rows.map((row) => targets.indexOf(row.target)),
    residual: whole('residual', 1e6),
    nominal: whole('nominal', 1e6),
    held_out: whole('held_out', 1e6),
    standardised: axes.map((unused, axis) => rows.map((row) => row.standardised[axis])),
    ...Object.fromEntries(['range', 'azimuth', 'elevation'].map((key) => [key, rows.map((row) => row[key])])),
  };
  const { validation } = part.residuals;
  return { ...part, residuals: { axes, unit, targets, readings, ...(validation ? { validation } : {}) } };
}

export const page = (...parts) => ({ kind: 'posewise page', posewise_version: '0.1.0', format: 1, parts: parts.map(packed) });

let state = 1;
const random = () => {
  state = (state * 48271) % 2147483647;
  return state / 2147483647;
};
const normal = () => Math.sqrt(-2 * Math.log(random())) * Math.cos(2 * Math.PI * random());

const joint = (name, degrees) => ({ name, kind: 'revolute', lower: (-degrees * Math.PI) / 180, upper: (degrees * Math.PI) / 180 });
const element = (motion, amount, index, coefficient = 1) => ({ motion, amount, joints: index === undefined ? [] : [{ joint: index, coefficient }] });

export function makeScene(extra = {}) {
  const scene = {
    joints: [joint('q1', 90), joint('q2', 60), joint('q3', 80), joint('q4', 180), joint('q5', 110), joint('q6', 180)],
    elements: [
      element('Rz', 0, 0),
      element('Tx', 0.312),
      element('Ry', 0, 1),
      element('Tz', 1.075),
      element('Ry', 0, 2, -1),
      element('Tz', 0.225),
      element('Tx', 1.28),
      element('Rx', 0, 3, -1),
      element('Ry', 0, 4, -1),
      element('Rx', 0, 5, -1),
    ],
    world_from_base: [-1, 0, 0, 4.5, 0, -1, 0, -1.5, 0, 0, 1, -0.6, 0, 0, 0, 1],
    targets: {
      names: ['target1', 'target2'],
      positions: [
        [0.25, 0, 0.12],
        [0.25, 0.105, -0.06],
      ],
    },
    capsules: [
      { name: 'upper arm', kind: 'link', after_element: 3, from: [0, 0, 0.2], to: [0, 0, 0.975], radius: 0.16 },
      { name: 'forearm', kind: 'link', after_element: 5, from: [-0.1, 0, 0.225], to: [0.9, 0, 0.225], radius: 0.17 },
      { name: 'ball', kind: 'keep_out', after_element: 0, from: [4.5, -1.5, 0.6], to: [4.5, -1.5, 0.6], radius: 0.6 },
    ],
    boxes: [{ name: 'table', kind: 'keep_out', world_from_box: [1, 0, 0, 3.2, 0, 1, 0, -1.5, 0, 0, 1, -0.985, 0, 0, 0, 1], size: [0.8, 1.2, 0.57] }],
    walls: [{ name: 'wall', point: [4.5, -3.7, -0.6], normal: [0, 1, 0] }],
    floor_z: -1.27,
    instrument: { kind: 'tracker', position: [0, 0, 0] },
    ...extra,
  };
  return scene;
}

const draw = (scene) => scene.joints.map(({ lower, upper }) => lower + random() * (upper - lower));

/** A plan of so many poses, with an error map of so many places. */
export function makePlan(count = 12, name = 'cell', places = 200) {
  const scene = makeScene();
  const poses = Array.from({ length: count }, (unused, k) => {
    const joints = draw(scene);
    return {
      id: `p${k + 1}`,
      times: 1,
      joints: Object.fromEntries(joints.map((value, j) => [`q${j + 1}_rad`, value])),
      visible_targets: k % 3 === 0 ? [1] : [1, 2],
      via: k === 1 ? Object.fromEntries(draw(scene).map((value, j) => [`q${j + 1}_rad`, value])) : null,
      way_is_blocked: false,
      kept: false,
      clearance_m: k === 4 ? null : 0.05 + 0.01 * ((k * 5) % 7),
      nearest: k === 4 ? [] : ['forearm', 'table'],
    };
  });
  scene.flange_of_first_pose = flange(scene, Object.values(poses[0].joints));
  const accuracy = (scale) => ({
    rms_mm: 0.15382351 * scale,
    p95_mm: 0.26046 * scale,
    total_rms_mm: 0.23170013 * scale,
    total_lower_mm: 0.05061 * scale,
    total_upper_mm: 1.0425 * scale,
  });
  const document = {
    kind: 'posewise plan',
    posewise_version: '0.1.0',
    format: 2,
    campaign: name,
    candidates: { kind: 'pool', campaign_file: 'campaign.yaml', source: null, drawn: 2000, count: 246, repeats: 1 },
    problem: { pose_count: count, prior: false, focus: 'all', augment: null },
    criterion: 'v',
    value: 14084109.49153842,
    bounds: {
      pool: { value: 11009015.360647842, bound: 12776570.27648512, efficiency: 0.8616565418115056, is_proven: true },
      continuous: { bound: 18499528.66935789, efficiency: 0.761322612227789, is_proven: false },
    },
    search: { seed: 1, starts: 4, starts_at_best: 1, stop_reason: 'converged' },
    predicted: { position_error_rms_m: 0.00015382351, position_error_p95_m: 0.00026046, standard_deviation: { 'base.x_m': 0.0000774, dq2_rad: 0.0000531 } },
    visiting_time_s: 7.295,
    assumes: { range_sigma_m: 1e-5, angle_sigma_rad: 1.5e-5, model_error_m: 1e-4, expected_error: { 'base.x_m': 0.001, dq2_rad: 0.001 } },
    answers: [
      { key: 'accuracy', question: 'How accurate', text: '0.2317 mm RMS expected over the workspace' },
      { key: 'influence', question: 'Which pose matters most', text: "'p3': without it 0.2091 mm" },
    ],
    poses,
    accuracy: accuracy(1),
    new_pose_count: count,
    measured_count: 0,
    workspace_count: places,
    pool: { drawn: 2000, feasible: 246, rejections: [{ constraint: 'keep_out', in_all: 294, first: 70 }] },
    tour: { time_s: 7.295, as_planned_s: 11.2, to_the_nearest_s: 8.2, blocked_count: 0 },
    duration_s: 7.295,
    budget: { noise_mm: 0.064, model_mm: 0.1399, prior_mm: 0, parameters_mm: 0.15382351, left_over_mm: 0.17320508, repeatability_mm: 0, total_mm: 0.23170013 },
    pose_values: poses.map(({ id }, k) => ({ id, value_mm: k === 2 ? 0.0555 : 0.01 + 0.02 * random() })),
    drop_outs: [{ id: 'p3', rms_mm: 0.2091 }],
    other_counts: [
      [6, false, 3.7],
      [12, false, 1.06],
      [12, true, 1],
      [24, false, 0.86],
    ].map(([n, isPlanned, scale]) => ({ new_pose_count: n, is_planned: isPlanned, accuracy: accuracy(scale) })),
    monte_carlo: {
      quantity: 'rms',
      assurance: 0.95,
      expected: { predicted_mm: 0.2317, found_mm: 0.2293, uncertainty_mm: 0.0014 },
      lower: { predicted_mm: 0.0506, found_mm: 0.106, uncertainty_mm: 0.0024 },
      upper: { predicted_mm: 1.0425, found_mm: 1.02, uncertainty_mm: 0.04 },
      assured: { predicted_mm: 1.0425, found_mm: 1.02, uncertainty_mm: 0.04 },
      ending: 'converged',
      is_sure: true,
      robot_count: 500,
      expected_robot_count: 120,
      uncalibrated_count: 0,
      limit: null,
    },
  };
  const points = Array.from({ length: places }, () => {
    const joints = draw(scene);
    return { position: apply(flange(scene, joints), scene.targets.positions[0]), joints, predicted_mm: 0.1 + 0.1 * random() };
  });
  return {
    title: name,
    command: 'posewise plan campaign.yaml',
    made_at: '2026-11-23T12:00:00Z',
    printed: 'pool:        246 of 2000\n',
    document,
    scene,
    error_map: mapOf(points),
  };
}

const foundPlace = (frame, position, rpy, axes) => ({
  in: frame,
  position_m: position,
  quaternion_wxyz: [1, 0, 0, 0],
  rpy_deg: rpy,
  deviations: axes.map((name, k) => {
    const [position, rotation] = [
      [0.1, 0.2, 0.3],
      [0.4, 0.5, 0.6],
    ].map((list) => (k === 0 ? list : list.toReversed()));
    return { axes: name, position_mm: position, rotation_mrad: rotation };
  }),
  ellipsoid: [0.2795, 0.559, 0.8385].map((half, k) => ({ half_axis_mm: half, direction: [0, 1, 2].map((axis) => (axis === k ? 1 : 0)) })),
});

/** The part as two cameras on the flange measure it, by a board of 12 corners. */
export function withCamera(part) {
  const unit = (x, y, z) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1];
  const window = [-0.5, -0.4, 0.5, 0.4];
  part.scene.views = {
    on_flange: 'camera',
    flange_from_it: unit(0.1, 0, 0.2),
    cameras: [
      { in_first: unit(0, 0, 0), window },
      { in_first: unit(0.1, 0, 0), window },
    ],
    corners: Array.from({ length: 12 }, (unused, k) => [0.1 * (k % 4), 0.1 * Math.floor(k / 4), 0]),
  };
  if (part.document.kind !== 'posewise estimate') return part;
  part.document.hand_eye = {
    camera: foundPlace('flange', [0.1, 0, 0.2], [0, 0, 0], ['flange', 'camera']),
    board: foundPlace('base', [0.001, 0.002, 0.003], [4, 5, 6], ['base', 'board']),
  };
  return part;
}

/** Metrics with the keys of estimates. */
const metrics = (scale) => ({
  point_count: 120,
  distance_rms_mm: 0.19874 * scale,
  distance_max_mm: 0.4921 * scale,
  distance_mean_mm: 0.1826 * scale,
  distance_p95_mm: 0.3213 * scale,
  coordinate_rms_mm: { x: 0.1135 * scale, y: 0.1193 * scale, z: 0.1113 * scale },
  coordinate_max_mm: { x: 0.35 * scale, y: 0.42 * scale, z: 0.35 * scale },
});

/** A calibration of so many robot errors, whose residuals drift by so many mm along z over the campaign. */
export function makeEstimate({ errors = 18, drift = 0, name = 'measured robot' } = {}) {
  const scene = makeScene();
  const rows = [];
  const configurations = { id: Array.from({ length: 30 }, (unused, c) => `c${c}`), joints: Array.from({ length: 30 }, () => draw(scene)) };
  scene.flange_of_first_pose = flange(scene, configurations.joints[0]);
  configurations.joints.forEach((joints, c) => {
    const off = [normal(), normal(), normal()].map((value) => 0.08 * value);
    off[2] += drift * (c / 29 - 0.5);
    for (const target of ['target1', 'target2']) {
      const residual = off.map((value) => value + 0.03 * normal());
      rows.push({
        configuration: configurations.id[c],
        sample: '1',
        target,
        joints,
        residual,
        nominal: residual.map((value) => value + normal()),
        held_out: residual.map((value) => 1.1 * value),
        standardised: residual.map((value) => value / 0.09),
        range: 2 + random(),
        azimuth: random(),
        elevation: random(),
      });
    }
  });
  const names = ['base.x', 'base.y', 'base.z', 'base.rx', 'base.ry', 'base.rz', ...Array.from({ length: errors }, (unused, k) => `e${k + 1}`)];
  const sigma = names.map((unused, k) => 1e-5 * (1 + (k % 5)));
  const chain = {
    elements: names.slice(6).map((error, k) => ({ motion: 'Rz', error, ...(k % 13 === 0 ? { joints: { [`q${1 + k / 13}`]: 1 } } : {}) })),
    terms: [],
  };
  const document = {
    chain,
    kind: 'posewise estimate',
    posewise_version: '0.1.0',
    format: 1,
    campaign: name,
    measurements: 'measured.csv',
    made_from: {
      campaign_file: 'campaign.yaml',
      campaign_checksum: 'fnv1a64:1',
      measurements_checksum: 'fnv1a64:2',
      options: { '--measurements': ['measured.csv'] },
    },
    measured: { configurations: 30, samples: 30, readings: 60, readings_seen: 60 },
    method: 'lm',
    ending: 'converged',
    iterations: 4,
    model_error_m: 1e-4,
    model_error_rad: 1e-4,
    readings: 'points',
    degrees_of_freedom: 150,
    variance_factor: 0.9668,
    base: { position_m: [4.5, -1.5, -0.6], quaternion_wxyz: [0, 0, 0, 1], rpy_deg: [0, 0, 180] },
    robot: Object.fromEntries(names.slice(6).map((key, k) => [key, { value_m: 0.001 * normal(), sigma_m: sigma[k + 6], expected_m: 0.001 }])),
    targets: {},
    sigma: Object.fromEntries(names.slice(0, 6).map((key, k) => [`${key}_${k < 3 ? 'm' : 'rad'}`, sigma[k]])),
    covariance: {
      parameters: names,
      rows_si: names.map((unused, i) => Array.from({ length: i + 1 }, (none, j) => (i === j ? 1 : 0.6 * Math.sin(i * 7 + j)) * sigma[i] * sigma[j])),
    },
    accuracy: {
      nominal: metrics(12),
      fit: metrics(0.9),
      fit_means: metrics(0.87),
      repeatability_mm: 0.05169,
      held_out: { folds: 30, failures: [], samples: metrics(1), means: metrics(0.93) },
      expected: { at_measured: { parameters_mm: 0.0442, left_over_mm: 0.1707, noise_mm: 0.052, total_mm: 0.1838 } },
    },
    loss: { kind: 'cauchy', width_standard_deviations: 2.6656 },
    outliers: [{ configuration: 'c3', target: 2, distance_mm: 1.25, standard_deviations: 9.04, weight: 0.01 }],
    model_selection: {
      folds: 30,
      best: '+ lengths',
      recommended: '+ lengths',
      sets: [
        { name: 'base and targets', parameter_count: 12, fit_rms_mm: 2.4, held_out_rms_mm: 2.6, standard_error_mm: 0.15 },
        { name: '+ lengths', parameter_count: 24, fit_rms_mm: 0.17, held_out_rms_mm: 0.18, standard_error_mm: 0.006 },
      ],
    },
    assumes: { sigma_m: 5e-5, model_error_m: 1e-4, expected_error: {} },
    doubts: {},
    answers: [
      { key: 'accuracy', question: 'How accurate', text: 'before 2.385 mm RMS, calibrated 0.1987 mm (95 %: 0.18 to 0.22 mm) at poses held out in turn' },
      { key: 'drift', question: 'Drift', text: 'none seen; 0.1 mm from first to last would have been' },
    ],
  };
  document.accuracy.order_trend = {
    strongest: 'z',
    is_beside_joints: false,
    axes: ['x', 'y', 'z'].map((axis) => ({ axis, change_mm: axis === 'z' ? drift : 0, detectable_mm: 0.1, early_mm: 0, probability: 0.5 })),
  };
  const points = Array.from({ length: 120 }, () => {
    const joints = draw(scene);
    return {
      position: apply(flange(scene, joints), [0.25, 0, 0.12]),
      joints,
      predicted_mm: 0.03 + 0.02 * random(),
      displacement_mm: [normal(), normal(), normal()],
    };
  });
  return {
    title: name,
    command: null,
    made_at: '2026-11-23T12:00:00Z',
    printed: null,
    document,
    scene,
    configurations,
    residuals: { axes: ['x', 'y', 'z'], unit: ['mm', 'mm', 'mm'], rows },
    error_map: mapOf(points),
  };
}

/** A study of measured configurations. */
export function makeStudy(name = 'study') {
  const row = (count, found) => ({
    pose_count: count,
    planned: [
      {
        criterion: 'v',
        held_out_rms_mm: found,
        held_out_rms_p05_mm: 0.8 * found,
        held_out_rms_p95_mm: 1.3 * found,
        expected_rms_mm: 0.95 * found,
        against_random: { ratio: 0.6, lower: 0.46, upper: 0.77, verdict: 'better' },
      },
    ],
    random: { subsets: 100, unidentified: 0, held_out_rms_p10_mm: found, held_out_rms_p50_mm: 1.6 * found, held_out_rms_p90_mm: 3 * found },
  });
  return {
    title: name,
    command: 'posewise study',
    made_at: '2026-11-23T12:00:00Z',
    printed: 'poses\n',
    scene: makeScene(),
    document: {
      kind: 'posewise study',
      posewise_version: '0.1.0',
      format: 1,
      campaign: name,
      ending: 'converged',
      simulated: false,
      splits: 10,
      judged_on: 18,
      answers: [{ key: 'accuracy', question: 'How many poses', text: '12 poses chosen by v leave 0.21 mm RMS at poses held out' }],
      models: [{ name: '', rows: [row(6, 1.08), row(8, 0.33), row(10, 0.238), row(12, 0.21), row(14, 0.208)] }],
    },
  };
}

/** A study of plain blocks by two criteria, with a subset of the caller's own. */
export function makeBlocksStudy(name = 'blocks.npy') {
  const row = (count, criterion, efficiency) => ({
    pose_count: count,
    criterion,
    value: 100 * count,
    bound: (100 * count) / efficiency,
    efficiency,
    ending: 'converged',
    poses: [0, 1, 2],
    random: {
      subsets: 30,
      unidentified: 0,
      value_p5: 40 * count,
      value_p50: 60 * count,
      value_p95: 80 * count,
      efficiency_p5: 0.4,
      efficiency_p50: 0.6,
      efficiency_p95: 0.8,
    },
    subsets: count === 10 ? [{ name: 'mine.txt', value: 70 * count, efficiency: 0.7 }] : [],
  });
  return {
    title: name,
    command: 'posewise study --blocks',
    made_at: '2026-11-27T12:00:00Z',
    printed: 'poses\n',
    document: {
      kind: 'posewise blocks study',
      posewise_version: '0.1.0',
      format: 1,
      campaign: null,
      ending: 'converged',
      candidate_count: 200,
      parameter_count: 21,
      prior: false,
      answers: [{ key: 'value', question: 'How much they tell', text: 'by d, 12 of 200 candidates reach 99.00 % of the largest value that is possible' }],
      rows: ['d', 'a'].flatMap((criterion) => [row(8, criterion, 0.95), row(10, criterion, 0.98), row(12, criterion, 0.99)]),
    },
  };
}
