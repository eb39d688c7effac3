// What is drawn into a camera's image, without a browser.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import './elements.mjs';
import { cellsOf, exaggeration, pathsOf, roundBelow } from '../../src/page/draw/image.js';
import { cornersOf, isShown, render } from '../../src/page/sections/image.js';

const counts = (full) => Array.from({ length: 48 }, (unused, k) => full[k] ?? 0);

/** Residuals of two cameras: two corners of the first one, one of the second. */
const residualsOf = () => ({
  images: [
    { name: 'camera 1', rms_px: 0.5, size_px: [800, 600], columns: 8, counts: counts({ 0: 1, 47: 4 }) },
    { name: 'camera 2', rms_px: 0.1, size_px: [600, 800], columns: 6, counts: counts({ 7: 1 }) },
  ],
  readings: {
    camera: [0, 1, 0],
    place: [
      [10, 150, 700.25],
      [20, 150, 590],
    ],
    residual: [
      [300000, 100000, -500000],
      [400000, 0, 0],
    ],
  },
});

test('lengths are drawn a round number of times as long', () => {
  for (const [value, below] of [
    [1, 1],
    [1.99, 1],
    [2, 2],
    [4.99, 2],
    [0.5, 0.5],
    [0.3, 0.2],
    [99, 50],
    [100, 100],
  ]) {
    assert.equal(roundBelow(value), below);
  }
  assert.equal(exaggeration([1280, 960], 1.2), 20);
  assert.equal(exaggeration([960, 1280], 0.3), 100);
  assert.equal(exaggeration([1280, 960], 0), 1);
  // One of RMS length is well seen and crosses no more than a few cells.
  for (let rms = 0.01; rms < 30; rms *= 1.07) {
    const drawn = (exaggeration([1280, 960], rms) * rms) / 1280;
    assert.ok(drawn > 0.0159 && drawn < 0.0401, `${rms} px: ${drawn}`);
  }
});

test('corners stand where they were seen, lines lead to where the residual points', () => {
  const corners = cornersOf(residualsOf(), 0);
  assert.deepEqual(corners, [
    { u: 10, v: 20, du: 0.3, dv: 0.4 },
    { u: 700.25, v: 590, du: -0.5, dv: 0 },
  ]);
  assert.deepEqual(pathsOf(corners, 100), { dots: 'M10 20h0M700.3 590h0', lines: 'M10 20l30 40M700.3 590l-50 0' });
});

test('cells are as dark as they have corners', () => {
  const cells = cellsOf([600, 800], 6, counts({ 0: 2, 7: 4 }));
  assert.equal(cells.length, 48);
  assert.deepEqual(cells[0], { x: 0, y: 0, width: 100, height: 100, part: 0.5 });
  assert.deepEqual(cells[7], { x: 100, y: 100, width: 100, height: 100, part: 1 });
  assert.equal(cells[1].part, 0);
});

test('each camera has a figure with its scale, its corners and the sentence of the program', () => {
  const residuals = residualsOf();
  const document = { answers: [{ key: 'image', question: 'Where in the image', text: 'corners of the board cover 4 % of the image' }] };
  const drawn = render({ document, residuals });
  assert.equal(drawn.all('p', 'lead')[0].textContent, 'Corners of the board cover 4 % of the image.');
  const [first, second] = drawn.all('figure');
  assert.match(
    first.all('figcaption')[0].textContent,
    /^Camera 1: 2 corners in an image of 800 x 600 px, 0\.50 px RMS off the place predicted\. .*drawn 50 times as long/,
  );
  assert.match(second.all('figcaption')[0].textContent, /^Camera 2: 1 corner in an image of 600 x 800 px, .*drawn 200 times as long/);
  assert.equal(first.all('svg')[0].attributes.viewBox, '-8 -8 816 616');
  assert.deepEqual(
    first.all('path').map(({ attributes: { d, class: name } }) => [d, name]),
    [
      ['M10 20l15 20M700.3 590l-25 0', 'line-accent'],
      ['M10 20h0M700.3 590h0', 'dots line-accent'],
    ],
  );
  // The bar is as long as a residual of 2 px is drawn: 100 of 800 px.
  assert.match(first.all('p', 'image-scale')[0].textContent, /a residual of 2 px$/);
  assert.equal(first.all('span').find(({ styles }) => styles.width).styles.width, '12.5%');
  const filled = first.all('rect', 'fill-muted').map(({ attributes }) => Number(attributes['fill-opacity']));
  assert.deepEqual([filled[0], filled[1], filled[47]], [0.135, 0, 0.36]);
  assert.equal(first.all('legend').length, 0);
  const last = first.all('tbody')[0].all('tr').at(-1);
  assert.deepEqual(
    last.children.map((cell) => cell.textContent),
    ['500 to 600', '0', '0', '0', '0', '0', '0', '0', '4'],
  );
});

test('poses that were left out have their own colour where they are of the same image', () => {
  const others = { ...residualsOf() };
  const left = { ...residualsOf(), images: [others.images[0], { ...others.images[1], size_px: [640, 480] }] };
  const drawn = render({ document: {}, residuals: { ...others, left_out: left } });
  const [first, second] = drawn.all('figure');
  assert.deepEqual(
    first.all('li').map((one) => one.textContent),
    ['calibrated with', 'not in plan'],
  );
  assert.deepEqual(
    first.all('path', 'dots').map((one) => one.attributes.class),
    ['dots line-accent', 'dots line-needed'],
  );
  assert.match(first.all('figcaption')[0].textContent, /^Camera 1: 2 corners in .*; 2 of other poses\. /);
  assert.equal(second.all('path', 'dots').length, 1);
});

test('cameras beside a tracker have their images', () => {
  const corners = residualsOf();
  const beside = { axes: ['x', 'y', 'z'], readings: { residual: [[1], [2], [3]] } };
  const residuals = { ...beside, of_cameras: corners, validation: { ...beside, of_cameras: corners } };
  assert.ok(isShown({ residuals }));
  assert.ok(!isShown({ residuals: beside }));
  const [first] = render({ document: {}, residuals }).all('figure');
  assert.match(first.all('figcaption')[0].textContent, /^Camera 1: 2 corners in .*; 2 of other poses\. /);
});

test('a plan shows where corners are expected', () => {
  const { images, readings } = residualsOf();
  const expected = { images: images.map(({ rms_px: unused, ...image }) => image), readings: { camera: readings.camera, place: readings.place } };
  const [first, second] = render({ document: {}, expected }).all('figure');
  assert.match(first.all('figcaption')[0].textContent, /^Camera 1: 2 corners expected in an image of 800 x 600 px, if the robot is as/);
  assert.deepEqual(
    first.all('path').map(({ attributes: { d } }) => d),
    ['M10 20h0M700.3 590h0'],
  );
  assert.equal(second.all('table').length, 1);
  assert.ok(isShown({ expected }));
});

test('an image of no stated size is as large as what was seen; other sensors have none', () => {
  const residuals = residualsOf();
  residuals.images = [{ rms_px: 0.5 }, { rms_px: 0 }];
  const drawn = render({ document: {}, residuals });
  assert.equal(drawn.all('svg')[0].attributes.viewBox, '-7.0025 -7.0025 714.255 604.005');
  assert.match(drawn.all('figcaption')[0].textContent, /in an image whose size is not stated/);
  assert.equal(drawn.all('rect', 'fill-muted').length, 0);
  assert.ok(isShown({ residuals }));
  assert.ok(!isShown({ residuals: { readings: {} } }));
  assert.ok(!isShown({}));
});
