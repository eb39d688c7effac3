// What the page warns of, without a browser: each doubt of a document, and what the program said.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { answerEstimate } from '../../src/page/sections/verdict_estimate.js';
import { answerExport } from '../../src/page/sections/verdict_export.js';
import { warningsOf, warningsOfEstimate } from '../../src/page/sections/warnings.js';

const doubts = {
  misfit: { distance_mm: 1, expected_mm: 0.1, unit: 'none', planes: [], reversed: [], other_choices: 0 }, planes: [2],
  places: [{ what: 'base', stated_mm: [1, 2, 3], measured_mm: [1000, 2000, 3000], unit: 'm' }], gross_error_mm: 150,
  orientations: { rms_deg: 120, sense: 'inverted', rms_in_sense_deg: 0.1 }, sizes: [{ parameter: 'dq2', value_mrad: 90, times_expected: 9 }],
  model_errors: [{ value_mm: 1, times_expected: 8 }, { value_mrad: 2, times_expected: 7 }], scatter: { ratio: 9, sample: '7:2' }, lacks_length: true,
  distance: { socket: 'A', from: 'B', stated_mm: 100, measured_mm: 120 }, held_back_size: { key: 'offset_mrad', learned_mrad: 1, fitting_mrad: 13 },
  residual_ratio: 3, residuals: [{ ratio: 3, fitting_model_error_mm: 0.4 }], small_residuals: 0.01, missing_errors: 0.4, negative_compliances: ['q2'],
  of_a_later_version: { what: 'anything' },
};
const metrics = { point_count: 3, distance_rms_mm: 599.98, distance_max_mm: 600, distance_mean_mm: 599, distance_p95_mm: 600 };
const estimate = ({ accuracy, ...rest } = {}) => ({ degrees_of_freedom: 5, variance_factor: 1, measured: { configurations: 10 }, accuracy: { fit: metrics, nominal: metrics, fit_means: metrics, ...accuracy }, ...rest });

test('each doubt of a document is shown where its sentences are not at hand', () => {
  for (const [key, value] of Object.entries(doubts)) {
    const texts = answerEstimate({ document: estimate({ doubts: { [key]: value } }) }).warnings;
    assert.equal(texts.length, 1, `${key}: ${texts}`);
    assert.doesNotMatch(texts[0], /undefined|NaN|null/, key);
  }
  assert.equal(warningsOfEstimate(estimate({ doubts })).length, Object.keys(doubts).length - 1);  // the ratio is that of the residuals
  assert.deepEqual(warningsOfEstimate(estimate({ doubts: { lacks_length: false } })), []);
});

test('a base that moved is a warning, and in the headline', () => {
  const moved = { parts: ['base'], base_mm: 600, targets_mm: 0 };
  for (const key of ['moved_before_validation', 'moved_since_earlier']) {
    assert.match(answerEstimate({ document: estimate({ accuracy: { [key]: moved } }) }).warnings.join(), /base 600 mm from where/);
  }
  const { sentence } = answerEstimate({ document: estimate({ accuracy: { validation: metrics, moved_before_validation: moved } }) });
  assert.match(sentence, /off by 599\.9800 mm RMS on the measurements kept for validation, before which base moved/);
});

test('what the program said is shown in its words, once', () => {
  const warnings = ['s.csv: plane 2 looks reversed', 'this is no calibration: it did not converge'];
  const document = estimate({ warnings, doubts: { planes: [2], missing_errors: 0.4 }, faults: ['it did not converge', 'another fault'] });
  const texts = answerEstimate({ document }).warnings;
  assert.deepEqual(texts.slice(0, 3), ['another fault', ...warnings]);
  assert.equal(texts.length, 4);
  assert.match(texts[3], /40 % of the squares/);
});

test('an export has the warnings of its document', () => {
  const document = { geometry: 'estimate', lost: {}, not_exported: [], read_back: [{ path: 'a.yaml', position_m: 1e-12 }], warnings: ['do not round it'] };
  assert.deepEqual(answerExport({ document }).warnings, ['do not round it']);
  assert.deepEqual(warningsOf({}), []);
  assert.deepEqual(warningsOf({ warnings: 5 }), []);
});
