// src/page/page.html is what src/page/build makes of the sources.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, statSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const source = fileURLToPath(new URL('../../src/page/', import.meta.url));

test('the page is the one that its sources make', (t) => {
  const folder = mkdtempSync(join(tmpdir(), 'posewise_page_'));
  const made = join(folder, 'page.html');
  const { status, stderr } = spawnSync(join(source, 'build'), [made], { encoding: 'utf8' });
  if (/npm error (code (E404|ENOTFOUND|ECONN|ETIMEDOUT|EAI_AGAIN|E5..)|network)/.test(stderr)) {
    t.skip('npm cannot install what src/page/package-lock.json names');
    return;
  }
  assert.equal(status, 0, stderr);
  assert.ok(readFileSync(made).equals(readFileSync(join(source, 'page.html'))), 'run src/page/build and commit page.html');
  rmSync(folder, { recursive: true });
});

test('the page is small, holds the licences and knows no other place', (t) => {
  const text = readFileSync(join(source, 'page.html'), 'utf8');
  t.diagnostic(`${statSync(join(source, 'page.html')).size} bytes`);
  assert.ok(statSync(join(source, 'page.html')).size < 1.1e6);
  for (const words of ['three.js authors', 'Leon Sorokin', 'THE SOFTWARE IS PROVIDED "AS IS"']) assert.ok(text.includes(words), words);
  assert.doesNotMatch(text, /<(script|link|img|iframe)[^>]*\b(src|href)=/i);
  for (const name of ['src/page', 'tests/page']) {
    const lock = readFileSync(new URL(`../../${name}/package-lock.json`, import.meta.url), 'utf8');
    assert.doesNotMatch(lock, /"resolved"/);
  }
});
