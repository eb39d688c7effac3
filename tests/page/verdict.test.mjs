// What the verdict takes from a document, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { warningsOf } from '../../src/page/sections/verdict.js';
import { answerExport } from '../../src/page/sections/verdict_export.js';

test('what the program warned of is said in its words, faults once', () => {
  const warnings = ['s.csv: plane 2 looks reversed', 'this is no calibration: it did not converge'];
  assert.deepEqual(warningsOf({ warnings, faults: ['it did not converge', 'another fault'] }), ['another fault', ...warnings]);
  assert.deepEqual(warningsOf({}), []);
  assert.deepEqual(warningsOf({ warnings: 5 }), []);
});

test('an export is summed up by how well its files read back', () => {
  const lost = { nominal: { rms_mm: 2 }, estimate: { rms_mm: 0.5, largest_mm: 1 } };
  const [first, ...others] = answerExport({ geometry: 'estimate', lost, not_exported: ['q1.sin'], read_back: [{ path: 'a.yaml', position_m: 1e-12 }] });
  assert.equal(first.text, '1 file written and read back: the flange is where it should be within 1e-12 m');
  assert.deepEqual(
    others.map(({ question }) => question),
    ['Files', 'Geometry', 'Not in the files', 'Lost by that'],
  );
});
