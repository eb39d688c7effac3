// What the page shows in a browser.
import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { join } from 'node:path';
import { drawn, launch, open, output, write } from './browser.mjs';
import { documentOf, makeBlocksStudy, makeEstimate, makePlan, makeStudy, page } from './fixture.mjs';

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

const sections = {
  plan: [
    'Verdict',
    'Poses',
    'Accuracy against number of poses',
    'Error map of the workspace',
    'Coverage: predicted against found',
    'Uncertainty budget',
    'What the plan is best for',
    'What it rests on',
    'As printed',
  ],
  estimate: [
    'Verdict',
    'Poses',
    'Before and after',
    'Error map of the workspace',
    'Residuals',
    'Parameters',
    'Model selection',
    'Coverage: predicted against found',
    'Uncertainty budget',
    'What it rests on',
  ],
  study: ['Verdict', 'Accuracy against number of poses', 'Coverage: predicted against found', 'What it rests on', 'As printed'],
  blocks: ['Verdict', 'Value against number of poses', 'What it rests on', 'As printed'],
};
const makers = { plan: () => makePlan(), estimate: () => makeEstimate({ errors: 54 }), study: () => makeStudy(), blocks: () => makeBlocksStudy() };

for (const kind of Object.keys(sections)) {
  test(`a ${kind} has its sections, figures with tables, and asks for nothing`, async () => {
    const { tab, complaints, requests, close } = await open(browser, write(kind, page(makers[kind]())));
    await drawn(tab);
    assert.deepEqual(await tab.locator('h2').allTextContents(), sections[kind]);
    assert.deepEqual(await tab.locator('nav a').allTextContents(), sections[kind]);
    const bare = await tab.evaluate(() =>
      [...document.querySelectorAll('section')].filter((one) => one.querySelector('figure') && !one.querySelector('table')).map((one) => one.id),
    );
    assert.deepEqual(bare, []);
    const unnamed = await tab.evaluate(() => [...document.querySelectorAll('canvas, .plot')].filter((one) => !one.closest('[role=img][aria-label]')).length);
    assert.equal(unnamed, 0);
    assert.deepEqual(requests, []);
    await tab.screenshot({ path: join(output, `${kind}.png`), fullPage: true });
    assert.deepEqual(complaints, []);
    await close();
  });
}

test('tables are the numbers of the document inside', async () => {
  const path = write('numbers', page(makePlan(), makeEstimate(), makeStudy()));
  const { tab, close } = await open(browser, path);
  const [plan, estimate, study] = documentOf(readFileSync(path, 'utf8')).parts.map((part) => part.document);
  const cells = (caption) =>
    tab.evaluate((text) => {
      const found = [...document.querySelectorAll('table')].find((one) => one.caption.textContent === text);
      return [...found.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent));
    }, caption);
  const four = (value) => value.toFixed(4);
  assert.deepEqual(
    await cells('Predicted position error by number of poses'),
    plan.other_counts.map(({ new_pose_count: count, is_planned: isPlanned, accuracy: a }) => [
      String(count),
      isPlanned ? 'planned' : 'chosen from the pool',
      four(a.rms_mm),
      four(a.p95_mm),
      four(a.total_rms_mm),
      `${four(a.total_lower_mm)}..${four(a.total_upper_mm)}`,
    ]),
  );
  const { nominal, fit, fit_means: means, held_out: held } = estimate.accuracy;
  assert.deepEqual((await cells('Accuracy'))[0], ['distance RMS', ...[nominal, fit, means, held.samples, held.means].map((one) => four(one.distance_rms_mm))]);
  assert.deepEqual(
    (await cells('Error held out by number of poses')).map((row) => row.slice(0, 3)),
    study.models[0].rows.map((row) => [String(row.pose_count), four(row.planned[0].held_out_rms_mm), four(row.planned[0].expected_rms_mm)]),
  );
  const poses = await cells('Poses, in the order to visit them');
  assert.deepEqual(
    poses.slice(3, 5).map((row) => row.at(-1)),
    ['60.00 forearm to table', ''],
  );
  assert.match(await tab.locator('#poses .lead').first().textContent(), /nothing comes nearer than 50\.00 mm, forearm to table, at p1\.$/);
  assert.deepEqual(
    poses.map((row) => row[1]),
    plan.poses.map((pose) => ((pose.joints.q1_rad * 180) / Math.PI).toFixed(2)),
  );
  const [save] = await Promise.all([tab.waitForEvent('download'), tab.getByRole('button', { name: 'Save all numbers as JSON' }).click()]);
  assert.deepEqual(JSON.parse(readFileSync(await save.path(), 'utf8')), documentOf(readFileSync(path, 'utf8')));
  await close();
});

test('the head says who measured, where the document does', async () => {
  const part = makeEstimate();
  part.document.record = { operator: '<b>A. Smith', instrument: 'AT960', serial: '4711', date: '2026-11-20', temperature_C: '20.5' };
  const { tab, close } = await open(browser, write('record', page(part, makePlan())));
  assert.deepEqual(await tab.locator('header .record').allTextContents(), [
    'Operator: <b>A. Smith \u00b7 Instrument: AT960 \u00b7 Serial number: 4711 \u00b7 Date: 2026-11-20 \u00b7 Temperature/\u00b0C: 20.5',
  ]);
  await close();
});

test('figures name what they draw', async () => {
  const estimate = makeEstimate();
  const { accuracy } = estimate.document;
  accuracy.validation = accuracy.verification = { ...accuracy.fit, distance_p95_mm: 0.4, distance_max_mm: 0.6 };
  estimate.residuals.validation = {
    axes: ['x', 'y', 'z'],
    unit: ['mm', 'mm', 'mm'],
    targets: ['other'],
    readings: {
      configuration: [0, 1],
      sample: ['1', '1'],
      target: [0, 0],
      residual: [
        [300000, 0],
        [400000, 0],
        [0, 100000],
      ],
    },
  };
  const judged = (poses, group) => ({
    poses,
    group,
    configuration_count: 2,
    joints: [],
    rms_mm: 0.3,
    lower_mm: 0.25,
    upper_mm: 0.5,
    expected_mm: 0.2,
    verdict: null,
  });
  accuracy.judged = [judged('validation', 'new'), judged('verification', 'repeated')];
  const { tab, complaints, close } = await open(browser, write('named', page(estimate, makeStudy())));
  await drawn(tab);
  const legend = (section, k) => tab.locator(`#${section} .legend`).nth(k).locator('li').allTextContents();
  assert.deepEqual(await legend('before-and-after', 0), ['nominal', 'held out', 'calibrated', 'validation']);
  assert.deepEqual(await legend('before-and-after', 1), ['nominal', 'held out', 'calibrated', 'validation', 'verification, 95 % and largest', '50 %', '95 %']);
  assert.ok((await legend('accuracy-against-number-of-poses', 0)).includes('planned by v, 5 to 95 %'));
  const row = (name) =>
    tab
      .locator('tr', { has: tab.locator('th', { hasText: new RegExp(`^${name}$`) }) })
      .first()
      .locator('td')
      .allTextContents();
  assert.deepEqual(await row('validation'), ['2', '0.3606', '0.1000', '0.5000', '0.5000']);
  // Means with means, and poses calibrated with are no test.
  assert.deepEqual(await tab.locator('#coverage-predicted-against-found table').first().locator('tbody th').allTextContents(), [
    'held out, means',
    'validation, new',
  ]);
  assert.deepEqual(complaints, []);
  await close();
});

test('a plan of 1000 poses is drawn at once', async (t) => {
  const { tab, complaints, close } = await open(browser, write('thousand', page(makePlan(1000))));
  const { load, script } = await tab.evaluate(() => {
    const [entry] = performance.getEntriesByType('navigation');
    return { load: entry.loadEventEnd, script: entry.domContentLoadedEventEnd - entry.responseEnd };
  });
  t.diagnostic(`1000 poses: loaded in ${load.toFixed(0)} ms, of which reading and drawing ${script.toFixed(0)} ms`);
  assert.equal(await tab.locator('table', { hasText: 'Poses, in the order to visit them' }).locator('tbody tr').count(), 1000);
  await drawn(tab);
  assert.deepEqual(complaints, []);
  await close();
});

/** How many colours a 3D view has, and a digest of its pixels, once it is drawn. */
const pixels = (tab) =>
  tab.evaluate(async () => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const source = document.querySelector('.stage canvas');
    const copy = document.createElement('canvas');
    [copy.width, copy.height] = [source.width, source.height];
    const context = copy.getContext('2d');
    context.drawImage(source, 0, 0);
    const values = new Uint32Array(context.getImageData(0, 0, copy.width, copy.height).data.buffer);
    let digest = 0;
    for (const value of values) digest = (Math.imul(digest, 31) + value) | 0;
    return { colours: new Set(values).size, digest };
  });

test('stepping through the poses moves the robot, the table and what is read out', async () => {
  const { tab, complaints, close } = await open(browser, write('steps', page(makePlan())));
  await drawn(tab);
  const status = () => tab.locator('.status').textContent();
  const joints = () => tab.locator('.joints td.number').allTextContents();
  const views = [await pixels(tab)];
  const texts = [await joints()];
  assert.ok(views[0].colours > 100, `${views[0].colours} colours`);
  assert.match(await status(), /^Pose p1, 1 of 12 · value [0-9.]+ mm · targets seen: 1 · nearest: 50\.00 mm forearm to table$/);
  await tab.getByRole('button', { name: 'Next pose' }).click();
  assert.match(await status(), /^Pose p2, 2 of 12 .*targets seen: 1 2 · nearest: 100\.00 mm forearm to table · reached over a via point$/);
  views.push(await pixels(tab));
  texts.push(await joints());
  await tab.locator('.stage canvas').focus();
  await tab.keyboard.press('ArrowRight');
  assert.match(await status(), /^Pose p3/);
  views.push(await pixels(tab));
  texts.push(await joints());
  await tab.getByRole('slider', { name: 'Pose' }).fill('12');
  assert.match(await status(), /^Pose p12/);
  await tab.getByRole('button', { name: 'Previous pose' }).click();
  assert.match(await status(), /^Pose p11/);
  assert.equal(new Set(views.map((one) => one.digest)).size, 3);
  assert.equal(new Set(texts.map(String)).size, 3);
  await tab.getByRole('button', { name: 'Play' }).click();
  await tab.waitForFunction(() => document.querySelector('.status').textContent.startsWith('Pose p12'));
  await tab.getByRole('button', { name: 'Play' }).waitFor();
  assert.deepEqual(complaints, []);
  await close();
});

test('seen from above and from the side the instrument is in the picture, and a scale', async () => {
  const { tab, complaints, close } = await open(browser, write('views', page(makePlan())));
  await drawn(tab);
  const seen = () => tab.locator('.stage .label:not([hidden])').allTextContents();
  const scale = tab.locator('.scale-bar');
  assert.equal(await scale.isVisible(), false);
  for (const view of ['Top', 'Side']) {
    await tab.getByRole('button', { name: view, exact: true }).click();
    await scale.waitFor();
    assert.ok((await seen()).includes('tracker'), view);
    assert.match(await scale.textContent(), /^[125]00 mm$|^[125] m$/);
    assert.ok((await scale.boundingBox()).width > 60);
  }
  await tab.getByRole('button', { name: 'Robot', exact: true }).click();
  await scale.waitFor({ state: 'hidden' });
  assert.deepEqual(complaints, []);
  await close();
});

test('without WebGL it says so, and the tables are there', async () => {
  const { tab, complaints, close } = await open(browser, write('without_webgl', page(makePlan())), {
    before: () => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith('webgl') ? null : getContext.call(this, kind, ...rest);
      };
    },
  });
  await drawn(tab);
  assert.match(await tab.locator('.stage').textContent(), /no WebGL/);
  await tab.getByRole('button', { name: 'Next pose' }).click();
  assert.match(await tab.locator('.status').textContent(), /^Pose p2/);
  assert.equal(await tab.locator('table', { hasText: 'Poses, in the order to visit them' }).locator('tbody tr').count(), 12);
  assert.deepEqual(complaints, []);
  await close();
});

test('without the campaign there is no robot, and all else', async () => {
  const part = makePlan();
  delete part.scene;
  const { tab, complaints, close } = await open(browser, write('without_scene', page(part)));
  assert.deepEqual(await tab.locator('h2').allTextContents(), sections.plan);
  assert.equal(await tab.locator('.stage').count(), 0);
  const ranges = await tab.locator('table', { hasText: 'Joint ranges' }).locator('tbody tr').first().locator('td').allTextContents();
  assert.deepEqual([ranges[0], ranges[1], ranges[4]], ['-', '-', '-']);
  await tab.getByRole('button', { name: 'Next pose' }).click();
  assert.match(await tab.locator('.status').textContent(), /^Pose p2/);
  assert.deepEqual(complaints, []);
  await close();
});

test('names are text, whatever they are', async () => {
  const evil = '</script><script>alert(1)</script><img src=x onerror=alert(2)>\u2028';
  const part = makePlan(3, evil);
  part.document.poses[0].id = evil;
  part.document.pose_values[0].id = evil;
  part.scene.joints[0].name = evil;
  part.scene.boxes[0].name = evil;
  part.command = evil;
  part.printed = evil;
  const estimate = makeEstimate({ name: evil });
  estimate.residuals.rows[0].target = evil;
  estimate.document.model_selection.sets[0].name = evil;
  const { tab, complaints, requests, close } = await open(browser, write('hostile', page(part, estimate)));
  await drawn(tab);
  assert.equal(await tab.locator('h1').textContent(), evil);
  assert.equal(await tab.evaluate(() => document.querySelectorAll('img, iframe, object').length), 0);
  assert.equal(await tab.evaluate(() => document.querySelectorAll('script').length), 2);
  assert.ok((await tab.locator('.status').first().textContent()).includes(evil));
  assert.ok((await tab.locator('pre').textContent()).includes(evil));
  assert.deepEqual(requests, []);
  assert.deepEqual(complaints, []);
  await close();
});

test('the policy stops scripts that are not its own', async () => {
  const { tab, complaints, close } = await open(browser, write('policy', page(makeStudy())));
  const ran = await tab.evaluate(() => {
    const script = document.createElement('script');
    script.textContent = 'window.strangerRan = true';
    document.body.append(script);
    return Boolean(window.strangerRan);
  });
  assert.equal(ran, false);
  assert.ok(
    complaints.some((text) => text.includes('Content Security Policy')),
    complaints.join(),
  );
  await close();
});

test('a flange drawn elsewhere than the program has it is told', async () => {
  const part = makePlan();
  part.scene.flange_of_first_pose[3] += 1e-6;
  const { tab, complaints, close } = await open(browser, write('flange', page(part)));
  await drawn(tab);
  assert.equal(complaints.length, 1);
  assert.match(complaints[0], /flange drawn .* from where it is/);
  await close();
});

test('nothing is cut on narrow and wide screens', async () => {
  const { tab, close } = await open(browser, write('wide', page(makePlan(), makeEstimate({ errors: 54 }))), { width: 400 });
  await drawn(tab);
  const setOpen = (isOpen) =>
    tab.evaluate(
      (all) =>
        document.querySelectorAll('details').forEach((one) => {
          one.open = all;
        }),
      isOpen,
    );
  for (const width of [400, 1920]) {
    await tab.setViewportSize({ width, height: 900 });
    for (const isOpen of [true, false]) {
      await setOpen(isOpen);
      const over = await tab.evaluate(() =>
        [...document.querySelectorAll('body *')]
          .filter((one) => !one.closest('.scroll, .stage, pre, svg, .skip') && one.getBoundingClientRect().right > innerWidth + 1)
          .map((one) => `${one.tagName}.${one.className}`),
      );
      assert.deepEqual(over, [], `${width} pixels, ${isOpen ? 'open' : 'closed'}`);
      assert.ok(await tab.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    }
    await tab.locator('#verdict').screenshot({ path: join(output, `verdict_${width}.png`) });
    await tab.locator('#poses').screenshot({ path: join(output, `poses_${width}.png`) });
  }
  await close();
});

test('paper has every section on a few pages, and says what is closed', async () => {
  const { tab, complaints, close } = await open(browser, write('paper', page(makeEstimate({ errors: 74 }))), { scheme: 'dark' });
  await drawn(tab);
  await tab.evaluate(() => {
    addEventListener('beforeprint', () => {
      window.printed = {
        paper: getComputedStyle(document.body).backgroundColor,
        wide: [...document.querySelectorAll('.uplot, .drawing canvas')].filter(
          (one) => one.getBoundingClientRect().right > document.body.getBoundingClientRect().right + 1,
        ).length,
        note: document.querySelector('#before-and-after summary').innerText,
      };
    });
  });
  const headings = await tab.locator('h2').allTextContents();
  const print = async (name) =>
    (await tab.pdf({ path: join(output, `${name}.pdf`), format: 'A4', printBackground: true, outline: true, tagged: true })).toString('latin1');
  const pdf = await print('paper');
  assert.deepEqual(await tab.evaluate(() => window.printed), { paper: 'rgb(255, 255, 255)', wide: 0, note: 'Numbers of this figure: 6 rows in the document' });
  for (const heading of headings) assert.ok(pdf.includes(`(${heading})`), `${heading} is not in the outline of the PDF`);
  const count = pdf.split(/\/Type \/Page\b/).length - 1;
  assert.ok(count >= 5 && count <= 8, `${count} pages`);
  // What is open is printed, 24 rows of a table at most.
  await tab.getByText('All parameters with their standard deviations').click();
  await tab.evaluate(() => {
    addEventListener('beforeprint', () => {
      const table = [...document.querySelectorAll('table')].find((one) => one.caption.textContent.startsWith('Parameters'));
      window.table = { rows: [...table.tBodies[0].rows].filter((row) => row.checkVisibility()).length, caption: table.caption.innerText };
    });
  });
  await print('paper_open');
  assert.deepEqual(await tab.evaluate(() => window.table), {
    rows: 24,
    caption: 'Parameters (errors of the robot, base, targets): 24 of 80 rows, all are in the document',
  });
  assert.equal(await tab.evaluate(() => document.documentElement.className), '');
  assert.deepEqual(complaints, []);
  await close();
});

test('axe finds nothing serious, light or dark', async (t) => {
  const { tab, close } = await open(browser, write('axe', page(makePlan(12, 'cell', 60), makeEstimate({ errors: 8 }), makeStudy())));
  await drawn(tab);
  await tab.evaluate(() =>
    document.querySelectorAll('details').forEach((one) => {
      one.open = true;
    }),
  );
  // As a debugger would: the page's own policy lets no script in.
  const session = await tab.context().newCDPSession(tab);
  await session.send('Runtime.evaluate', { expression: createRequire(import.meta.url)('axe-core').source });
  for (const colorScheme of ['light', 'dark']) {
    await tab.emulateMedia({ colorScheme });
    const only = colorScheme === 'dark' ? { runOnly: ['color-contrast'] } : {};
    const { violations, passes } = await tab.evaluate((options) => window.axe.run(document, options), only);
    const text = violations.map(
      (one) =>
        `${one.impact}: ${one.id}: ${one.nodes
          .slice(0, 3)
          .map((node) => node.html.slice(0, 200))
          .join(' | ')}`,
    );
    t.diagnostic(`axe, ${colorScheme}: ${passes.length} rules passed, ${violations.length} violated ${text.join('; ')}`);
    assert.ok(passes.length > 0);
    assert.deepEqual(
      text.filter((line) => /^(serious|critical)/.test(line)),
      [],
    );
  }
  await close();
});
