// Where cameras and board are drawn, and what is said of the hand-eye.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { join } from 'node:path';
import { drawn, launch, open, output, write } from './browser.mjs';
import { makeEstimate, makePlan, makeScene, page, withCamera } from './fixture.mjs';
import { apply, flange, origin } from '../../src/page/core/kinematics.js';
import { posesOf, seenBy } from '../../src/page/core/poses.js';
import { edgesOf, pyramidOf, viewsOf } from '../../src/page/core/views.js';

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

const near = (found, expected) => found.forEach((value, k) => assert.ok(Math.abs(value - expected[k]) < 1e-12, `${found} is not ${expected}`));

test('views are where the flange carries them, of the part itself first', () => {
  const part = withCamera(makePlan());
  const [first] = viewsOf(part);
  const joints = Object.values(part.document.poses[0].joints);
  near(origin(first.place), apply(flange(part.scene, joints), [0.1, 0, 0.2]));
  assert.deepEqual(
    viewsOf(part).map(({ id, kind }) => `${id} ${kind}`),
    part.document.poses.map(({ id }) => `${id} planned`),
  );
  // Target 1 is a corner in the first camera's image, 13 one in the second camera's.
  part.document.poses[1].visible_targets = [1, 12, 13];
  part.document.poses[2].visible_targets = [24];
  assert.deepEqual(
    viewsOf(part)
      .slice(0, 3)
      .map(({ cameras }) => cameras),
    [[0], [0, 1], [1]],
  );
  assert.equal(seenBy(posesOf(part)[1], part), '3 of 24');
  assert.equal(seenBy({ targets: [1, 2] }, { scene: makeScene() }), '1 2');
  assert.equal(viewsOf({ ...part, scene: makeScene() }), null);
});

test('views that contradict the others, and those of other poses, are told apart', () => {
  const part = withCamera(makeEstimate());
  part.document.doubts = { views: [{ sample: 'c3' }, { sample: 'c5:2' }] };
  const joints = [0, 0, 0, 0, 0, 0];
  part.residuals = {
    readings: { configuration: [0, 0, 2], camera: [1, 0, 1] },
    left_out: { configurations: { id: ['x', 'c3'], joints: [joints, joints] }, readings: { configuration: [1], camera: [0] } },
    validation: { readings: { camera: [0] } },
  };
  const list = viewsOf(part);
  assert.deepEqual(
    list.slice(0, 4).map(({ cameras }) => cameras),
    [[0, 1], [], [1], []],
  );
  assert.deepEqual(
    list.filter(({ contradicts }) => contradicts).map(({ id, kind }) => `${id} ${kind}`),
    ['c3 residuals', 'c5 residuals', 'c3 left_out'],
  );
  assert.deepEqual(
    list.slice(30).map(({ id, kind, cameras }) => [id, kind, cameras]),
    [
      ['x', 'left_out', []],
      ['c3', 'left_out', [0]],
    ],
  );
});

test('a plane board has four edges, a cube twelve; a camera is a pyramid towards its image', () => {
  const square = [
    [0, 0, 0],
    [0.2, 0, 0],
    [0.2, 0.1, 0],
    [0, 0.1, 0],
  ];
  const edges = edgesOf(square);
  assert.equal(edges.length, 8);
  for (let k = 0; k < edges.length; k += 2) assert.equal(edges[k].filter((value, axis) => value !== edges[k + 1][axis]).length, 1);
  assert.equal(edgesOf([...square, [0, 0, 0.3]]).length, 24);
  const pyramid = pyramidOf([-0.5, -0.4, 0.5, 0.4], 2);
  assert.equal(pyramid.length % 2, 0);
  near(pyramid[1], [-1, -0.8, 2]);
  // The mark is above the image: v grows downwards.
  assert.ok(pyramid.some(([x, y]) => x === 0 && y < -0.8));
});

const rows = (tab, caption) =>
  tab.evaluate((text) => {
    const found = [...document.querySelectorAll('table')].find((one) => one.caption?.textContent === text);
    return [...found.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent));
  }, caption);

/** A digest of a 3D view's pixels. */
const digest = (tab, section) =>
  tab.evaluate(async (id) => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const source = document.querySelector(`#${id} .stage canvas`);
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [source.width, source.height];
    const context = copy.getContext('2d');
    context.drawImage(source, 0, 0);
    return new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer).reduce((sum, value) => (Math.imul(sum, 31) + value) | 0, 0);
  }, section);

test('the page of a camera draws its views and its hand-eye', async () => {
  const part = withCamera(makeEstimate());
  part.document.doubts = { views: [{ sample: 'c3' }] };
  const { tab, complaints, close } = await open(browser, write('camera', page(part)));
  await drawn(tab);
  assert.ok((await tab.locator('h2').allTextContents()).includes('Hand-eye'));
  assert.deepEqual(await rows(tab, 'Where they are'), [
    ['camera', 'of the flange', '100.000', '0.000', '200.000', '0.0000', '0.0000', '0.0000'],
    ['board', 'of the base', '1.000', '2.000', '3.000', '4.0000', '5.0000', '6.0000'],
  ]);
  assert.deepEqual(await rows(tab, 'Standard deviations of the camera'), [
    ['of the flange', '0.1000', '0.2000', '0.3000', '0.4000', '0.5000', '0.6000'],
    ['of the camera', '0.3000', '0.2000', '0.1000', '0.6000', '0.5000', '0.4000'],
  ]);
  assert.equal((await rows(tab, 'Half axes of the 95 % ellipsoid of the place')).length, 6);
  // 0.25 of 223.6 mm is 67 times 0.8385 mm.
  assert.match(
    await tab.locator('#hand-eye figcaption').textContent(),
    /With 95 % the camera's origin is within the ellipsoid, which is drawn 50 times as large as it is\.$/,
  );
  assert.deepEqual(await tab.locator('#hand-eye .label').allTextContents(), ['flange', 'camera']);
  const pictures = [await digest(tab, 'hand-eye')];
  await tab.locator('#hand-eye').getByRole('button', { name: 'Top', exact: true }).click();
  pictures.push(await digest(tab, 'hand-eye'));
  assert.notEqual(pictures[0], pictures[1]);
  assert.ok((await tab.locator('#poses .label').allTextContents()).includes('c3 contradicts'));
  assert.match(
    await tab.locator('#poses .stage-side .note').textContent(),
    /each camera that sees the board at each view\. Orange: what contradicts the other views \(c3\)\.$/,
  );
  const views = [await digest(tab, 'poses')];
  await tab.getByLabel('Views').uncheck();
  views.push(await digest(tab, 'poses'));
  await tab.getByLabel('Views').check();
  views.push(await digest(tab, 'poses'));
  await tab.getByRole('button', { name: 'Camera and board' }).click();
  views.push(await digest(tab, 'poses'));
  assert.equal(views[0], views[2]);
  assert.equal(new Set(views).size, 3);
  await tab.screenshot({ path: join(output, 'camera.png'), fullPage: true });
  assert.deepEqual(complaints, []);
  await close();
});

test('a fixed camera, and a hand-eye without a robot to draw', async () => {
  const part = withCamera(makeEstimate());
  part.scene.views.on_flange = 'board';
  const bare = withCamera(makeEstimate({ name: 'bare' }));
  delete bare.scene;
  const { tab, complaints, close } = await open(browser, write('cameras', page(part, bare)));
  await drawn(tab);
  assert.match(
    await tab.locator('#poses .stage-side .note').first().textContent(),
    /^Drawn are the 2 cameras as pyramids towards what they see, and the board's outline at each view\.$/,
  );
  assert.equal(await tab.locator('#hand-eye .stage').count(), 1);
  assert.equal(await tab.locator('#hand-eye table', { hasText: 'Half axes' }).count(), 2);
  assert.deepEqual(complaints, []);
  await close();
});
