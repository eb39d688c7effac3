// Numbers of the page, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { plannedCurve } from '../../src/page/core/curve.js';
import { fixed, short } from '../../src/page/core/format.js';
import { applyInverse, apply, elementary, flange, multiply, way } from '../../src/page/core/kinematics.js';
import { correlationsOf, parametersOf } from '../../src/page/core/parameters.js';
import { normalQuantile, quantile } from '../../src/page/core/statistics.js';
import { makeEstimate, makePlan, makeScene } from './fixture.mjs';

const near = (found, expected, tolerance) => assert.ok(Math.abs(found - expected) <= tolerance, `${found} is not ${expected}`);

test('numbers are as printf writes them', () => {
  // Of %.*f; 0.125, 0.375, 2.5 and 3.5 are ties.
  for (const [value, decimals, text] of [
    [0.2317, 4, '0.2317'],
    [0.125, 2, '0.12'],
    [0.375, 2, '0.38'],
    [-0.125, 2, '-0.12'],
    [2.5, 0, '2'],
    [3.5, 0, '4'],
    [1e-9, 4, '0.0000'],
    [-1e-9, 4, '0.0000'],
    [-0.00004, 4, '0.0000'],
    [1234.56785, 4, '1234.5678'],
    [null, 4, '-'],
    [Infinity, 2, '-'],
    [0.5, 0, '0'],
    [1.5, 0, '2'],
  ]) {
    assert.equal(fixed(value, decimals), text);
  }
  // Of %.*g.
  for (const [value, digits, text] of [
    [14084109.49, 8, '14084109'],
    [0.0001, 6, '0.0001'],
    [0.00001234, 3, '1.23e-05'],
    [1e21, 6, '1e+21'],
    [123456789, 4, '1.235e+08'],
    [0.9668, 4, '0.9668'],
    [100, 6, '100'],
    [999999.5, 6, '1e+06'],
    [0, 6, '0'],
    [-Infinity, 6, '-inf'],
    [0.1, 1, '0.1'],
  ]) {
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

test('quantiles are those of the tables', () => {
  near(normalQuantile(0.975), 1.959963985, 1e-8);
  near(normalQuantile(0.001), -3.090232306, 1e-8);
  assert.equal(quantile([3, 1, 2], 0.5), 2);
  assert.equal(quantile([0, 10], 0.95), 9.5);
});

test('the curve of a plan ends at its floor', () => {
  const { current, floor } = plannedCurve(makePlan().document);
  assert.equal(current.count, 12);
  assert.equal(current.isPlanned, true);
  near(floor, 0.17320508, 1e-12);
});

test('parameters of an estimate have their values and correlations', () => {
  const { document } = makeEstimate({ errors: 3 });
  const list = parametersOf(document);
  assert.deepEqual(
    list.map((one) => one.name),
    document.covariance.parameters,
  );
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
  const chain = {
    elements: [{ joints: { q1: 1 }, error: 'dq1' }, { joints: { q2: 1 }, error: 'dq2' }, { error: 'Tz2' }],
    terms: [{ name: 'q1.cos', sine_of: { q1: 1 } }],
  };
  const rows = parameters.map((unused, i) => parameters.slice(0, i + 1).map((none, j) => (i === j ? 1 : (10 * i + j) / 100)));
  const { names, blocks, at } = correlationsOf({ covariance: { parameters, rows_si: rows }, chain, robot: { Tz2: {}, 'q1.cos': {}, dq1: {}, dq2: {} } });
  assert.deepEqual(names, ['base.x', 'q1.cos', 'dq1', 'Tz2', 'dq2', 'target1.x']);
  assert.deepEqual(blocks, ['base', 'q1', 'q1', 'q2', 'q2', 'target1']);
  assert.equal(at(0, 5), 0.1);
  assert.equal(at(3, 4), 0.42);
});
