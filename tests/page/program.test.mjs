// Pages of the program itself: what they say is what it prints.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { drawn, launch, open, output } from './browser.mjs';
import { documentOf } from './fixture.mjs';

const program = process.env.POSEWISE_PROGRAM;
const root = fileURLToPath(new URL('../../', import.meta.url));
const fanuc = ['designs/fanuc_r2000ic_165f/campaign.yaml', '-m', 'data/fanuc_r2000ic_165f_simulated/measurements.csv'];

const commands = {
  plan: [
    'plan',
    'designs/cell_demo/campaign.yaml',
    '--poses',
    '8',
    '--pool',
    '600',
    '--starts',
    '1',
    '--workspace-poses',
    '100',
    '--verify',
    '--verify-robots',
    '100',
    '--out',
    join(output, 'plan.json'),
  ],
  calibrate: ['calibrate', ...fanuc, '--folds', '5', '--out', join(output, 'estimate.json')],
  study: ['study', ...fanuc, '--poses', '8,12', '--random', '10', '--splits', '2'],
  select: ['select', ...fanuc, '--poses', '12', '--starts', '1', '--out', join(output, 'choice.json')],
};

/** Tables that each prints. */
const printedCount = { plan: 5, calibrate: 3, study: 1, select: 0 };

let browser;
before(async () => {
  if (program) browser = await launch();
});
after(() => browser?.close());

const run = (...words) => {
  const done = spawnSync(program, words, { cwd: root, encoding: 'utf8', maxBuffer: 1 << 28 });
  assert.equal(done.status, 0, done.stderr);
  return done.stdout;
};

/** Tables of a printed text: header cells and rows. */
function printedTables(text) {
  const lines = text.split('\n');
  return lines.flatMap((rule, k) => {
    if (!/^-+( {2}-+)*$/.test(rule) || k === 0) return [];
    let at = 0;
    const columns = rule.split('  ').map((one) => {
      const column = [at, at + one.length];
      at += one.length + 2;
      return column;
    });
    const cells = (row) => columns.map(([from, to], c) => row.slice(from, c === columns.length - 1 ? undefined : to).trim());
    const end = lines.findIndex((row, i) => i > k && row.trim() === '');
    return [
      {
        header: cells(lines[k - 1]),
        rows: lines
          .slice(k + 1, end < 0 ? undefined : end)
          .filter((row) => !row.includes(';'))
          .map(cells),
      },
    ];
  });
}

/** Tables of the page likewise. */
const shownTables = (tab) =>
  tab.evaluate(() =>
    [...document.querySelectorAll('.scroll > table')].map((one) => ({
      header: [...one.tHead.rows[0].cells].map((cell) => cell.textContent),
      rows: [...one.tBodies[0].rows].map((row) => [...row.cells].map((cell) => cell.textContent)),
    })),
  );

/** Where the page has a printed table: some columns more, or rows in it that are printed. */
function holds(shown, printed) {
  return shown.some(({ header, rows }) => {
    if (!printed.header.every((name, k) => header[k] === name)) return false;
    const texts = rows.map((row) => row.slice(0, printed.header.length).join('|'));
    return printed.rows.every((row) => texts.includes(row.join('|')));
  });
}

for (const [name, words] of Object.entries(commands)) {
  test(`the page of ${name} says what is printed, to the digit`, { skip: program ? false : 'POSEWISE_PROGRAM is not set' }, async () => {
    const path = join(output, `program_${name}.html`);
    const printed = run(...words, '--report', path);
    const { parts } = documentOf(readFileSync(path, 'utf8'));
    assert.equal(parts.length, 1);
    assert.equal(parts[0].printed, printed);
    const { tab, complaints, requests, close } = await open(browser, path);
    await drawn(tab);
    assert.deepEqual(requests, []);
    assert.deepEqual(complaints, []);
    const tables = printedTables(printed);
    assert.equal(tables.length, printedCount[name]);
    const shown = await shownTables(tab);
    for (const table of tables)
      assert.ok(holds(shown, table), `not on the page: ${table.header.join(' | ')}\n${table.rows.map((row) => row.join(' | ')).join('\n')}`);
    if (name === 'calibrate') {
      // The residuals behind the figures are those of the table.
      const accuracy = shown.find(({ header }) => header[0] === 'error/mm');
      const readings = shown.find(({ header }) => header[0] === 'of' && header[1] === 'readings');
      for (const [of, , rms, , p95, most] of readings.rows) {
        const column = accuracy.header.indexOf(of);
        assert.deepEqual(
          [rms, p95, most],
          ['distance RMS', 'distance 95 %', 'distance max'].map((row) => accuracy.rows.find((one) => one[0] === row)[column]),
          of,
        );
      }
      assert.equal(readings.rows.length, 3);
    }
    // What the sentence says, and that it is the document's.
    const sentence = await tab.locator('.verdict').textContent();
    assert.ok(printed.replace(/\s+/g, ' ').includes(sentence.slice(1, -1)), `not printed: ${sentence}`);
    await tab.screenshot({ path: join(output, `program_${name}.png`), fullPage: true });
    await close();
  });
}

test('exported files', { skip: program ? false : 'POSEWISE_PROGRAM is not set' }, async () => {
  const path = join(output, 'program_export.html');
  const [dh, saved] = [join(output, 'dh.yaml'), join(output, 'export.json')];
  const printed = JSON.parse(run('export', fanuc[0], join(output, 'estimate.json'), '--dh', dh, '--json'));
  writeFileSync(saved, JSON.stringify(printed));
  run('report', saved, '--out', path);
  const { tab, complaints, close } = await open(browser, path);
  await drawn(tab);
  assert.match(await tab.locator('.verdict').textContent(), /^1 file written and read back: the flange is where it should be within \d/);
  assert.deepEqual(
    await tab.locator('#exported-files-read-back tbody tr:last-child td:first-child, #exported-files-read-back tbody tr:last-child th').first().textContent(),
    dh,
  );
  assert.deepEqual(complaints, []);
  await close();
});

test('saved files side by side', { skip: program ? false : 'POSEWISE_PROGRAM is not set' }, async () => {
  const path = join(output, 'program_report.html');
  run('report', join(output, 'plan.json'), join(output, 'estimate.json'), '--out', path);
  const { tab, complaints, close } = await open(browser, path);
  await drawn(tab);
  assert.deepEqual(await tab.locator('#verdict h3').allTextContents(), ['plan.json (plan)', 'estimate.json (estimate)']);
  assert.equal(await tab.locator('.stage canvas').count(), 2);
  assert.deepEqual(complaints, []);
  await close();
});
