// What the headline says of a calibration that was judged on groups of poses, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answerEstimate } from '../../src/page/sections/verdict_estimate.js';

const metrics = (rms) => ({ point_count: 3, distance_rms_mm: rms, distance_max_mm: rms, distance_mean_mm: rms, distance_p95_mm: rms });
const group = (poses, kind, rms) => ({ poses, group: kind, configuration_count: 15, joints: [], rms_mm: rms, lower_mm: 0.9 * rms, upper_mm: 1.2 * rms, degrees_of_freedom: 45, verdict: null });
const sentenceOf = (accuracy) => answerEstimate({
  document: { degrees_of_freedom: 5, variance_factor: 1, measured: { configurations: 10 }, accuracy: { fit: metrics(0.1), nominal: metrics(1), fit_means: metrics(0.1), ...accuracy } },
}).sentence;

test('new poses are judged on, with their interval', () => {
  const judged = [group('verification', 'new', 0.3), group('validation', 'new', 0.2), group('validation', 'repeated', 0.1)];
  assert.match(sentenceOf({ verification: metrics(0.3), validation: metrics(0.15), judged }),
    /^Calibrated, the robot is off by 0\.2000 mm RMS \(95 %: 0\.1800 to 0\.2400\) on 15 poses of the validation, new\.$/);
});

test('poses calibrated with are not: what was held out is', () => {
  const judged = [group('validation', 'repeated', 0.1)];
  const sentence = sentenceOf({ validation: metrics(0.1), held_out: { folds: 10, samples: metrics(0.4), means: metrics(0.4) }, judged });
  assert.match(sentence, /off by 0\.4000 mm RMS on configurations not measured \(held out, 10 folds\)/);
  assert.doesNotMatch(sentence, /validation/);
});

test('each group is told by itself', () => {
  const judged = [{ ...group('verification', 'new', 0.3), verdict: 'within chance', limit: 'undecided' }, group('verification', 'repeated', 0.1)];
  const { rows } = answerEstimate({
    document: { degrees_of_freedom: 5, variance_factor: 1, measured: { configurations: 10 }, accuracy: { fit: metrics(0.1), nominal: metrics(1), fit_means: metrics(0.1), judged } },
  });
  assert.equal(rows.find(([name]) => name === 'On poses not used')[1],
    'verification, 15 poses new: 0.3000 mm RMS (95 %: 0.2700 to 0.3600), within chance, limit: undecided; ' +
    'verification, 15 poses calibrated with, which say nothing of others: 0.1000 mm RMS (95 %: 0.0900 to 0.1200).');
});
