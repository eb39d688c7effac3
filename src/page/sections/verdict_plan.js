import { count, fixed, mm, short } from '../core/format.js';
import { moreFor, plannedCurve } from '../core/curve.js';
import { idsOf } from '../core/poses.js';
import { budgetOf } from './budget.js';
import { warningsOf } from './warnings.js';

export const noDrift = 'Not known: drift shows in measurements only.';

/** Parts of budgets in other words than those of the table. */
const causes = {
  'left over: the model error itself': 'What the model of the robot cannot express',
  'parameters, by noise of measuring': 'Parameters are not known better, by the noise of measuring',
  'parameters, by the model error': 'Parameters are not known better, by the model error at the poses',
  'parameters, left of their prior': 'Parameters are not known better than before measuring',
  parameters: 'Parameters are not known better',
  'noise of the instrument': 'Noise of the instrument',
  'repeatability of one visit': 'The robot itself does not return better',
};

/** The largest part of a budget. */
export function limitOf(part) {
  const budget = budgetOf(part);
  if (!budget) return null;
  const largest = budget.parts.reduce((a, b) => (b[1] > a[1] ? b : a));
  const share = fixed(100 * (largest[1] / budget.total) ** 2, 1);
  return `${causes[largest[0]]}: ${mm(largest[1])} ${budget.unit} RMS, ${share} % of the square.`;
}

function accuracyOf({ document }) {
  const { accuracy, target, predicted } = document;
  if (target) {
    const names = { rms: 'RMS', p95: '95 % of positions', max: 'maximum' };
    return { value: target.error.expected_mm, lower: target.error.lower_mm, upper: target.error.upper_mm, name: names[target.quantity] };
  }
  if (accuracy) return { value: accuracy.total_rms_mm, lower: accuracy.total_lower_mm, upper: accuracy.total_upper_mm, name: 'RMS' };
  if (!predicted?.position_error_rms_m) return null;
  return { value: 1e3 * predicted.position_error_rms_m, p95: 1e3 * predicted.position_error_p95_m, name: 'RMS by the parameters alone', isPartial: true };
}

function surenessOf(document, found) {
  const text = [];
  if (found?.lower !== undefined) {
    text.push(`With 90 % confidence between ${mm(found.lower)} and ${mm(found.upper)} mm: before measuring, the model error is known within a factor only.`);
  }
  const checked = document.monte_carlo;
  if (checked?.expected?.found_mm) {
    text.push(`Checked on ${checked.robot_count} robots that were drawn and calibrated: see Coverage.`);
  }
  const efficiency = document.bounds?.pool.efficiency ?? document.efficiency;
  if (typeof efficiency === 'number') text.push(`${document.bounds ? 'The best choice from the pool' : 'This choice'} is proven to reach ${fixed(100 * efficiency, 2)} % of the largest possible value of its criterion, at least.`);
  return text.join(' ');
}

function mostOf({ pose_values: values, drop_outs: dropOuts, accuracy }) {
  if (!values?.length) return 'Not known: only the command that plans computes it, and plan files do not hold it.';
  const needed = values.filter((one) => one.value_mm === null);
  if (needed.length > 0) return `${needed.map((one) => one.id).join(', ')}: without ${needed.length === 1 ? 'it' : 'any of them'} parameters are left unidentified.`;
  const most = values.reduce((a, b) => (b.value_mm > a.value_mm ? b : a));
  const first = dropOuts?.find((one) => one.id === most.id);
  const rest = first ? ` (${mm(first.rms_mm)} instead of ${mm(accuracy.rms_mm)} mm)` : '';
  return `${most.id}: without it the RMS by the parameters grows by ${mm(most.value_mm)} mm${rest}.`;
}

function moreOf(document) {
  const curve = plannedCurve(document);
  if (!curve) return 'Not known from this plan: it was made for one number of poses only. "posewise plan --poses" and "study" compare numbers.';
  const chosen = curve.points.filter((one) => !one.isPlanned);
  const points = (chosen.length > 1 ? chosen : curve.points).map((one) => ({ count: one.count, value: one.expected }));
  const found = moreFor(points, curve.current.count);
  const floor = curve.floor === null ? '' : ` Were all parameters known, ${mm(curve.floor)} mm would be left.`;
  if (!found) return `Not known.${floor}`;
  if (found.more !== null) return `About ${count(found.more, 'pose')} more, interpolated on the curve below.${floor}`;
  const how = chosen.length > 1 ? ' chosen from the pool' : '';
  const rest = found.upTo > curve.current.count ? `No number tried is enough: ${count(found.upTo, 'new pose')}${how} still leave ${fixed(100 * found.ratio, 0)} % of what ${curve.current.count}${how} leave.` : 'Not known: no larger number of poses was tried.';
  return `${rest}${floor}`;
}

export function answerPlan(part) {
  const { document } = part;
  const found = accuracyOf(part);
  const alone = document.accuracy ?? { rms_mm: null, p95_mm: found?.p95 };
  const poses = count(document.poses.reduce((sum, pose) => sum + (pose.times ?? 1), 0), 'pose');
  const interval = found?.lower === undefined ? '' : ` (90 %: ${mm(found.lower)} to ${mm(found.upper)} mm)`;
  const over = document.workspace_count ? ` over ${document.workspace_count} workspace poses` : '';
  const sentence = found ? `Calibrated with these ${poses}${document.measured_count > 0 ? ` and ${document.measured_count} measured already` : ''}, the robot is expected to have a position error of ${mm(found.value)} mm ${found.name}${interval}${over}, ${found.isPartial ? 'without the model error' : 'model error included'}.`
    : `${poses} chosen for criterion ${document.criterion}: ${idsOf(document)}.`;
  const isRobot = document.candidates.kind !== 'blocks';
  const warnings = [...warningsOf(document)];
  const limit = document.monte_carlo?.limit;
  if (limit === 'not kept') warnings.push(`The limit of ${short(document.target.limit_mm)} mm is not kept on robots that were drawn.`);
  if (document.search.stop_reason === 'interrupted' || document.search.stop_reason === 'time limit') warnings.push(`The search ended early (${document.search.stop_reason}): there may be better poses.`);
  return {
    sentence, warnings,
    rows: [
      ['How accurate', !found ? null : found.isPartial ? `${mm(found.value)} mm ${found.name}, 95 % are below ${mm(alone.p95_mm)} mm.`
        : `${mm(found.value)} mm ${found.name} expected; by the parameters alone ${mm(alone.rms_mm)} mm RMS, 95 % are below ${mm(alone.p95_mm)} mm.`],
      ['How sure', surenessOf(document, found)],
      ['What limits it', limitOf(part)],
      ['Which pose matters most', isRobot ? mostOf(document) : null],
      ['Drift', isRobot ? noDrift : null],
      ['Poses more for 20 % better', isRobot ? moreOf(document) : null],
    ],
  };
}
