import { count, mm, short } from '../core/format.js';
import { driftOf } from '../core/drift.js';
import { factorOfRms, influence } from '../core/influence.js';
import { rms } from '../core/statistics.js';
import { limitOf } from './verdict_plan.js';
import { warningsOfEstimate } from './warnings.js';

/** The poses that it was judged on and not made with, those most like the workspace first: ones calibrated with say nothing. */
function judgedOf({ judged }, unit) {
  const names = { validation: 'of the validation', verification: 'that the plan has to verify', left_out: 'not in the plan' };
  for (const [group, which] of [['new', 'new'], ['beyond', 'beyond the joint ranges calibrated with']]) {
    for (const [poses, name] of Object.entries(names)) {
      const one = judged?.find((judgement) => judgement.poses === poses && judgement.group === group);
      if (!one) continue;
      const poseCount = one.configuration_count;
      const interval = one[`lower_${unit}`] === null ? null : { lower: one[`lower_${unit}`], upper: one[`upper_${unit}`], count: poseCount };
      return { rms: one[`rms_${unit}`], unit, interval, where: `on ${count(poseCount, 'pose')} ${name}, ${which}`, key: null };
    }
  }
  return null;
}

/** Each group of poses that it was judged on, with its interval and verdicts. */
function groupsOf({ judged }, unit) {
  const sets = { validation: 'validation', verification: 'verification', left_out: 'not in the plan' };
  const kinds = { new: 'new', beyond: 'beyond the joint ranges calibrated with', repeated: 'calibrated with, which say nothing of others' };
  const groups = (judged ?? []).map((one) => {
    const interval = one[`lower_${unit}`] === null ? '' : ` (95 %: ${mm(one[`lower_${unit}`])} to ${mm(one[`upper_${unit}`])})`;
    const verdicts = [one.verdict, one.limit && `limit: ${one.limit}`].filter(Boolean).map((text) => `, ${text}`).join('');
    return `${sets[one.poses]}, ${count(one.configuration_count, 'pose')} ${kinds[one.group]}: ${mm(one[`rms_${unit}`])} ${unit} RMS${interval}${verdicts}`;
  });
  return groups.length > 0 ? `${groups.join('; ')}.` : null;
}

/** What the calibration leaves where it was not measured: of what is known the most honest. */
function errorOf({ accuracy }) {
  const unit = accuracy.fit.distance_rms_mm === undefined ? 'mrad' : 'mm';
  const pick = (metrics) => ({ rms: metrics[unit === 'mm' ? 'distance_rms_mm' : 'orientation_rms_mrad'], p95: metrics.distance_p95_mm, turn: unit === 'mm' ? metrics.orientation_rms_mrad : undefined, unit });
  const moved = accuracy.moved_before_validation ? `, before which ${accuracy.moved_before_validation.parts.join(' and ')} moved` : '';
  const judged = judgedOf(accuracy, unit);
  if (judged) return { ...judged, where: `${judged.where}${accuracy.validation ? moved : ''}` };
  const isOld = !accuracy.judged;  // of a file that tells no groups of poses apart
  if (isOld && accuracy.validation) return { ...pick(accuracy.validation), where: `on the measurements kept for validation${moved}`, key: null };
  if (isOld && accuracy.left_out) return { ...pick(accuracy.left_out), where: 'on configurations not in the plan', key: null };
  if (accuracy.held_out) return { ...pick(accuracy.held_out.samples), where: `on configurations not measured (held out, ${accuracy.held_out.folds} folds)`, key: 'held_out' };
  return { ...pick(accuracy.fit), where: 'on the measurements it was made from (nothing was held out)', key: 'residual' };
}

export function describeDrift(drift) {
  if (!drift) return 'Not known: too few configurations, or their residuals are not at hand.';
  const { worst } = drift;
  const size = `${worst.axis}: ${mm(worst.change)} ${worst.unit} from first to last configuration, p ${worst.corrected < 1e-4 ? '< 0.0001' : `= ${short(worst.corrected, 2)}`} for ${drift.slopes.length} axes`;
  const beside = drift.besideJoints ? ', besides what follows the joints\u2019 positions' : '; poses that were measured in an order of theirs look alike';
  if (drift.verdict === 'yes') return `Yes: residuals follow the order of the measurements (${size}${beside}). The first tenth is off the rest by ${mm(worst.early)} ${worst.unit}.`;
  if (drift.verdict === 'perhaps') return `Perhaps: ${size}${beside}.`;
  return `None seen (strongest in ${size}); ${mm(Math.max(...drift.slopes.filter((one) => one.unit === worst.unit).map((one) => one.seen)))} ${worst.unit} over the campaign would have been seen with 95 % confidence.`;
}

function mostOf(part) {
  if (!part.residuals) return 'Not known: the residuals are not at hand.';
  const list = influence(part.residuals);
  const unit = part.residuals.unit[0];
  if (list.length === 0) return 'Not known: nothing was held out.';
  const [first] = list;
  const folds = part.document.accuracy.held_out?.folds;
  const alone = folds === list.length ? 'the others' : 'the other groups';
  return `Configuration ${first.id}: predicted by ${alone} it is missed by ${mm(first.heldOut)} ${unit} RMS, with it by ${mm(first.fit)} ${unit}: the largest difference of all.`;
}

/** Poses more for 0.8 of the error, if they tell as much as those measured: of variances only that of the parameters falls.
 * Over the workspace, where its map is there: at the poses measured parameters look better known than they are. */
function moreOf(part) {
  const { document } = part;
  const expected = document.accuracy.expected?.at_measured;
  if (!expected) return null;
  const unit = 'total_mm' in expected ? 'mm' : 'mrad';
  const atMeasured = expected[`parameters_${unit}`] ** 2;
  const rest = expected[`total_${unit}`] ** 2 - atMeasured;
  const parameters = Math.max(atMeasured, unit === 'mm' ? (workspaceOf(part)?.rms ?? 0) ** 2 : 0);
  const all = rest + parameters;
  const wanted = 0.64 * all - rest;
  const now = document.measured.configurations;
  if (!(wanted > 0)) return `More poses like these cannot do it: of the ${mm(Math.sqrt(all))} ${unit} RMS expected only ${mm(Math.sqrt(parameters))} ${unit} are by parameters not known better; without that ${mm(Math.sqrt(rest))} ${unit} would be left. A better model of the robot or a better instrument would help.`;
  return `About ${count(Math.ceil((now * parameters) / wanted - now), 'configuration')} more, if they tell as much as those measured.`;
}

/** What the parameters alone leave over the workspace, where these poses may not have told enough. */
function workspaceOf(part) {
  const errors = part.error_map?.predicted_mm ?? [];
  return errors.length === 0 ? null : { rms: rms(errors), most: Math.max(...errors), count: errors.length };
}

/** Whether parameters are so little known that leaving a pose out makes a difference. */
function isByFewPoses(expected) {
  const [parameters, leftOver, noise] = ['parameters', 'left_over', 'noise'].map((part) => (expected?.[`${part}_mm`] ?? expected?.[`${part}_mrad`] ?? 0) ** 2);
  return 2 * parameters > leftOver + noise;
}

/** What the calibration expected of the mean of the samples, where what was held out contradicts it. */
function surpriseOf({ accuracy }, { key, unit }, sure) {
  const expected = accuracy.expected?.at_measured?.[`total_${unit}`];
  if (!sure || key !== 'held_out' || expected === undefined) return null;
  const found = (accuracy.held_out.means ?? accuracy.held_out.samples)[unit === 'mm' ? 'distance_rms_mm' : 'orientation_rms_mrad'];
  const text = `The calibration itself expected ${mm(expected)} ${unit} RMS at these configurations, held out they are missed by ${mm(found)} ${unit}`;
  if (expected * sure.factor < found && !isByFewPoses(accuracy.expected.at_measured)) return `${text}: more. Outliers, drift, or errors that the model leaves out?`;
  if (expected > found * sure.factor) return `${text}: less. The sizes or the model error stated may be too large.`;
  return null;
}

/** What is in the squares left over but not the robot's. */
function besidesModel(part, drift) {
  const outliers = part.document.outliers?.length ?? 0;
  const causes = [drift?.verdict === 'yes' ? 'The drift below' : null, outliers > 0 ? count(outliers, 'outlier') : null].filter(Boolean);
  return causes.length === 0 ? '' : ` ${causes.join(' and ')} may be in it.`;
}

/** Parameters that these poses do not tell of far from them limit more than what the table of the budget says. */
function limitOfEstimate(part) {
  const left = part.document.accuracy.expected?.at_measured?.left_over_mm;
  const workspace = workspaceOf(part);
  if (!workspace || left === undefined || workspace.rms <= left) return limitOf(part);
  return `Parameters are not known better: over the workspace ${mm(workspace.rms)} mm RMS by them, ${mm(left)} mm by what the model of the robot cannot express.`;
}

export function answerEstimate(part) {
  const { document } = part;
  const { accuracy } = document;
  if (!accuracy?.fit) return { sentence: 'This calibration identified nothing.', warnings: warningsOfEstimate(document), rows: [] };
  const error = errorOf(document);
  const nominal = accuracy.nominal?.[error.unit === 'mm' ? 'distance_rms_mm' : 'orientation_rms_mrad'];
  const sure = part.residuals && error.key ? factorOfRms(part.residuals, error.key) : null;
  const interval = error.interval ?? (sure && { lower: error.rms / sure.factor, upper: error.rms * sure.factor, count: sure.count });
  const surprise = surpriseOf(document, error, sure);
  const warnings = [...warningsOfEstimate(document), surprise].filter(Boolean);
  const drift = part.residuals ? driftOf(part.residuals, part.scene?.joints) : null;
  const workspace = workspaceOf(part);
  if (error.unit === 'mm' && workspace?.rms > 2 * error.rms) {
    warnings.push(`The poses measured cover the workspace badly: over ${workspace.count} of its configurations the parameters alone are expected to leave ${mm(workspace.rms)} mm RMS, ${mm(workspace.most)} mm at worst.`);
  }
  const limit = limitOfEstimate(part);
  const within = interval ? ` (95 %: ${mm(interval.lower)} to ${mm(interval.upper)})` : '';
  const times = nominal > 0 && error.key ? `, ${short(nominal / error.rms, 3)} times less than the robot that is not calibrated (${mm(nominal)} ${error.unit})` : '';
  return {
    sentence: `Calibrated, the robot is off by ${mm(error.rms)} ${error.unit} RMS${within} ${error.where}${times}.`,
    warnings,
    rows: [
      ['How accurate', `${mm(error.rms)} ${error.unit} RMS${error.p95 === undefined ? '' : `, 95 % are below ${mm(error.p95)} mm`}${error.turn === undefined ? '' : `, orientations ${mm(error.turn)} mrad RMS`}, ${error.where}, noise of the instrument included.`],
      ['How sure', interval ? `RMS with 95 % confidence between ${mm(interval.lower)} and ${mm(interval.upper)} ${error.unit}, by how ${interval.count} configurations differ; ${document.degrees_of_freedom} degrees of freedom, variance factor ${short(document.variance_factor, 4)}.`
        : `${document.degrees_of_freedom} degrees of freedom, variance factor ${short(document.variance_factor, 4)}.`],
      ['On poses not used', groupsOf(accuracy, error.unit)],
      ['Over the workspace', workspace ? `${mm(workspace.rms)} mm RMS, ${mm(workspace.most)} mm at worst, are expected by the parameters alone, at ${workspace.count} configurations within the limits: see the error map.` : null],
      ['What limits it', limit && limit + besidesModel(part, drift)],
      ['Which pose matters most', mostOf(part)],
      ['Drift', describeDrift(drift)],
      ['Poses more for 20 % better', moreOf(part)],
    ],
  };
}
