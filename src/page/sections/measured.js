import { el } from '../core/dom.js';
import { count, milli, mm, short } from '../core/format.js';
import { facts, table } from '../core/table.js';
import { behind } from '../core/figure.js';

export const title = 'What it rests on';

export const isShown = () => true;

const options = (made) =>
  Object.entries(made ?? {})
    .map(([name, values]) => [name, ...[values].flat()].join(' '))
    .join('  ');

function ofPlan({ candidates, problem, search, pool, poses, assumes }) {
  return [
    ['Campaign file', candidates.campaign_file],
    ['Poses from', candidates.source],
    ['Candidates', pool ? `${pool.feasible} of ${pool.drawn} drawn are feasible` : count(candidates.count, 'candidate')],
    ['Checksum of candidates', candidates.checksum],
    ['Samples of each pose', short(candidates.repeats ?? 1)],
    ['Measured already', problem.augment],
    ['Prior', problem.estimate?.file ? `earlier estimate ${problem.estimate.file}` : problem.prior ? 'the expected sizes, as standard deviation' : 'none'],
    ['Noise and model error', describeNoise(assumes)],
    ['Seed', search.seed],
    ['Poses', poses.length],
  ];
}

function describeNoise(assumes) {
  if (!assumes) return null;
  const text = [];
  const add = (key, name, factor, unit) => {
    const value = assumes[key];
    if (typeof value === 'number') text.push(`${name} ${short(factor * value)} ${unit}`);
    else if (Array.isArray(value)) text.push(`${name} ${value.map((one) => short(factor * one)).join(', ')} ${unit}`);
  };
  add('sigma_m', 'sigma', 1e3, 'mm');
  add('range_sigma_m', 'sigma of range', 1e6, 'um');
  add('angle_sigma_rad', 'sigma of angles', 1e6, 'urad');
  add('orientation_sigma_rad', 'sigma of orientation', 1e3, 'mrad');
  add('model_error_m', 'model error', 1e3, 'mm');
  add('model_error_rad', 'model error of orientations', 1e3, 'mrad');
  return text.join(', ');
}

const methods = { lm: 'Levenberg-Marquardt' };

function ofEstimate(document) {
  const { measured, made_from: made } = document;
  return [
    ['Measurements', document.measurements],
    [
      'Measured',
      `${count(measured.configurations, 'configuration')}, ${count(measured.samples, 'sample')}, ${measured.readings_seen} of ${measured.readings} readings seen`,
    ],
    ['Left out', (document.excluded ?? []).join(', ')],
    ['Readings', document.readings],
    ['Campaign file', made?.campaign_file],
    ['Checksum of campaign', made?.campaign_checksum],
    ['Checksum of measurements', made?.measurements_checksum],
    ['Options', options(made?.options)],
    ['Method', `${methods[document.method] ?? document.method}: ${document.ending} after ${count(document.iterations, 'iteration')}`],
    ['Degrees of freedom', document.degrees_of_freedom],
    ['Variance factor', short(document.variance_factor, 4)],
    ['Model error', `${short(1e3 * document.model_error_m, 4)} mm`],
    ['Repeatability', document.accuracy?.repeatability_mm === undefined ? null : `${mm(document.accuracy.repeatability_mm)} mm per coordinate`],
    ['Faults', [document.faults ?? []].flat().join('; ')],
  ];
}

function ofStudy(document) {
  return [
    ['Kind', document.simulated ? 'robots that were drawn' : 'measured configurations'],
    [document.simulated ? 'Robots' : 'Splits', document.splits],
    ['Judged on', count(document.judged_on, 'configuration')],
    ['Ending', document.ending],
  ];
}

/** Expected sizes of errors, which everything is scaled by. */
function sizeTable(assumes) {
  const sizes = Object.entries(assumes?.expected_error ?? {});
  if (sizes.length === 0) return null;
  return table(
    'Expected size of each error',
    ['parameter', 'expected', ''],
    sizes.map(([key, value]) => [key.replace(/_(m|rad)$/, ''), milli(value), key.endsWith('_rad') ? 'mrad' : 'mm']),
  );
}

const kinds = { plan: ofPlan, estimate: ofEstimate, study: ofStudy };

export function render(part) {
  const { document } = part;
  return el(
    'div',
    {},
    facts([
      ['Robot', part.robot],
      ['File', part.file],
      ['Joints', part.scene ? part.scene.joints.map((joint) => joint.name).join(' ') : null],
      ['Instrument', part.scene?.instrument?.kind],
      ['Made at', part.made_at],
      ['Command', part.command ? el('code', {}, part.command) : null],
      ['Version', `posewise ${document.posewise_version}, document format ${document.format}`],
      ...(kinds[part.kind]?.(document) ?? []),
    ]),
    behind([sizeTable(document.assumes)], 'Expected sizes of errors'),
  );
}
