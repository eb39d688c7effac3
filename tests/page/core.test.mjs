// Numbers of the page, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { moreFor, plannedCurve } from '../../src/page/core/curve.js';
import { driftOf } from '../../src/page/core/drift.js';
import { fixed, short } from '../../src/page/core/format.js';
import { factorOfRms, influence } from '../../src/page/core/influence.js';
import { applyInverse, apply, elementary, flange, multiply, way } from '../../src/page/core/kinematics.js';
import { correlationsOf, parametersOf } from '../../src/page/core/parameters.js';
import { line, normalQuantile, quantile, studentT, trend, twoSided } from '../../src/page/core/statistics.js';
import { makeEstimate, makePlan, makeScene } from './fixture.mjs';

const near = (found, expected, tolerance) => assert.ok(Math.abs(found - expected) <= tolerance, `${found} is not ${expected}`);

test('numbers are as printf writes them', () => {
  // Of %.*f; 0.125, 0.375, 2.5 and 3.5 are ties.
  for (const [value, decimals, text] of [[0.2317, 4, '0.2317'], [0.125, 2, '0.12'], [0.375, 2, '0.38'], [-0.125, 2, '-0.12'], [2.5, 0, '2'], [3.5, 0, '4'],
    [1e-9, 4, '0.0000'], [-1e-9, 4, '0.0000'], [-0.00004, 4, '0.0000'], [1234.56785, 4, '1234.5678'], [null, 4, '-'], [Infinity, 2, '-'], [0.5, 0, '0'], [1.5, 0, '2']]) {
    assert.equal(fixed(value, decimals), text);
  }
  // Of %.*g.
  for (const [value, digits, text] of [[14084109.49, 8, '14084109'], [0.0001, 6, '0.0001'], [0.00001234, 3, '1.23e-05'], [1e21, 6, '1e+21'], [123456789, 4, '1.235e+08'],
    [0.9668, 4, '0.9668'], [100, 6, '100'], [999999.5, 6, '1e+06'], [0, 6, '0'], [-Infinity, 6, '-inf'], [0.1, 1, '0.1']]) {
    assert.equal(short(value, digits), text);
  }
});

test('transforms turn and move', () => {
  const quarter = elementary('Rz', Math.PI / 2);
  apply(quarter, [1, 0, 0]).forEach((value, k) => near(value, [0, 1, 0][k], 1e-15));
  const both = multiply(elementary('Tx', 2), quarter);
  apply(both, [1, 0, 0]).forEach((value, k) => near(value, [2, 1, 0][k], 1e-15));
  applyInverse(both, [2, 1, 0]).forEach((value, k) => near(value, [1, 0, 0][k], 1e-15));
  // The arm stretched upwards with its forearm level, base turned half a turn about z.
  const scene = makeScene();
  const at = flange(scene, [0, 0, 0, 0, 0, 0]);
  [at[3], at[7], at[11]].forEach((value, k) => near(value, [4.5 - 0.312 - 1.28, -1.5, -0.6 + 1.075 + 0.225][k], 1e-12));
  assert.deepEqual(way([0], [2], [4], 2), [[0], [2], [4], [3], [2]]);
});

test('distributions are those of the tables', () => {
  near(studentT(0.05, 10), 2.228139, 1e-5);
  near(studentT(0.01, 58), 2.663287, 1e-5);
  near(twoSided(2.228139, 10), 0.05, 1e-7);
  near(normalQuantile(0.975), 1.959964, 1e-5);
  near(normalQuantile(0.001), -3.090232, 1e-4);
  assert.equal(quantile([3, 1, 2], 0.5), 2);
  assert.equal(quantile([0, 10], 0.95), 9.5);
  const fit = line([1, 2, 3, 4], [1, 3, 2, 4]);
  near(fit.slope, 0.8, 1e-12);
  near(fit.error, Math.sqrt(1.8 / 2 / 5), 1e-12);
});

test('drift is seen where there is some, and hardly ever where there is none', () => {
  assert.equal(driftOf(makeEstimate({ drift: 0.4 }).residuals).verdict, 'yes');
  assert.equal(driftOf(makeEstimate({ drift: 0.4 }).residuals).worst.axis, 'z');
  const verdicts = Array.from({ length: 40 }, () => driftOf(makeEstimate().residuals).verdict);
  assert.ok(verdicts.filter((one) => one !== 'no').length <= 6, verdicts.join(' '));
});

test('poses measured in an order of theirs are not taken for drift', () => {
  const { residuals } = makeEstimate();
  residuals.rows.forEach((row, k) => {
    // The model misses by the sine of a joint that turns steadily.
    row.residual = row.residual.map((value) => value + 0.4 * Math.sin(k / 60));
    row.joints = row.joints.slice(0, 2);
  });
  assert.equal(driftOf(residuals).besideJoints, true);
  assert.equal(driftOf(residuals).verdict, 'yes');
  residuals.rows.forEach((row, k) => { row.joints[0] = k / 60; });
  assert.equal(driftOf(residuals).verdict, 'no');
});

test('a slope among neighbours that are alike is less sure', () => {
  const xs = Array.from({ length: 200 }, (unused, k) => k);
  const alone = trend(xs, xs.map((k) => Math.sin(1.7 * k * k)));
  near(alone.error, line(xs, xs.map((k) => Math.sin(1.7 * k * k))).error, 0.3 * alone.error);
  const alike = trend(xs, xs.map((k) => Math.sin(k / 8)));
  assert.ok(alike.error > 3 * line(xs, xs.map((k) => Math.sin(k / 8))).error);
  assert.ok(alike.p > 0.05);
  // y = 2 + 3 x + 5 cos x, to the digit.
  const exact = trend(xs, xs.map((k) => 2 + 3 * k + 5 * Math.cos(k)), [xs.map(Math.cos)]);
  near(exact.slope, 3, 1e-10);
});

test('the configuration that matters most is the one the others miss', () => {
  const { residuals } = makeEstimate();
  for (const row of residuals.rows.filter((one) => one.configuration === 'c7')) row.held_out = row.residual.map((value) => 9 * value);
  const [first] = influence(residuals);
  assert.equal(first.id, 'c7');
  near(first.heldOut / first.fit, 9, 1e-9);
  const { factor, count } = factorOfRms(residuals, 'held_out');
  assert.equal(count, 30);
  assert.ok(factor > 1 && factor < 4);
});

test('poses more for a fifth less are read off the curve', () => {
  const points = [4, 8, 16, 32].map((count) => ({ count, value: 1 / Math.sqrt(count) }));
  // 1 / sqrt(n) falls to 0.8 at 1.5625 n.
  assert.equal(moreFor(points, 8).more, 5);
  assert.equal(moreFor(points, 32).more, null);
  const { current, floor } = plannedCurve(makePlan().document);
  assert.equal(current.count, 12);
  assert.equal(current.isPlanned, true);
  near(floor, 0.17320508, 1e-12);
});

test('parameters of an estimate have their values and correlations', () => {
  const { document } = makeEstimate({ errors: 3 });
  const list = parametersOf(document);
  assert.deepEqual(list.map((one) => one.name), document.covariance.parameters);
  // Half a turn about z, as a rotation vector.
  near(list[5].value, Math.PI, 1e-12);
  assert.equal(list[5].isAngle, true);
  assert.equal(list[6].expected, 0.001);
  const { at } = correlationsOf(document);
  assert.equal(at(2, 2), 1);
  near(at(4, 1), 0.6 * Math.sin(29), 1e-12);
  assert.equal(at(1, 4), at(4, 1));
});

test('correlations stand in blocks: base, joints along the chain, targets', () => {
  const parameters = ['target1.x', 'base.x', 'Tz2', 'q1.cos', 'dq2', 'dq1'];
  const chain = { elements: [{ joints: { q1: 1 }, error: 'dq1' }, { joints: { q2: 1 }, error: 'dq2' }, { error: 'Tz2' }], terms: [{ name: 'q1.cos', sine_of: { q1: 1 } }] };
  const rows = parameters.map((unused, i) => parameters.slice(0, i + 1).map((none, j) => (i === j ? 1 : (10 * i + j) / 100)));
  const { names, blocks, at } = correlationsOf({ covariance: { parameters, rows_si: rows }, chain, robot: { Tz2: {}, 'q1.cos': {}, dq1: {}, dq2: {} } });
  assert.deepEqual(names, ['base.x', 'q1.cos', 'dq1', 'Tz2', 'dq2', 'target1.x']);
  assert.deepEqual(blocks, ['base', 'q1', 'q1', 'q2', 'q2', 'target1']);
  assert.equal(at(0, 5), 0.1);
  assert.equal(at(3, 4), 0.42);
});
