// Chromium, and pages in it.
import { mkdirSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { pageWith } from './fixture.mjs';

export const output = process.env.PAGE_TEST_OUTPUT ?? join(tmpdir(), 'posewise_page_test');
mkdirSync(output, { recursive: true });

export const launch = () =>
  chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    chromiumSandbox: false,
    args: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  });

/** A page file with these parts in it. */
export function write(name, document) {
  const path = join(output, `${name}.html`);
  writeFileSync(path, pageWith(document));
  return path;
}

/** Opens a file; `complaints` gets errors and warnings, `requests` what it asks for besides itself. */
export async function open(browser, path, { width = 1280, height = 900, scheme = 'light', before } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: 'reduce' });
  const tab = await context.newPage();
  const complaints = [];
  const requests = [];
  const url = pathToFileURL(path).href;
  tab.on('console', (message) => {
    // Chromium says so of every software renderer that is read back.
    if (['error', 'warning'].includes(message.type()) && !message.text().includes('GPU stall due to ReadPixels')) complaints.push(message.text());
  });
  tab.on('pageerror', (error) => complaints.push(error.message));
  tab.on('dialog', (dialog) => {
    complaints.push(`dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  tab.on('request', (request) => {
    if (request.url() !== url && !request.url().startsWith('data:') && !request.url().startsWith('blob:')) requests.push(request.url());
  });
  if (before) await tab.addInitScript(before);
  await tab.goto(url);
  return { tab, complaints, requests, close: () => context.close() };
}

/** Waits until each 3D view is drawn. */
export const drawn = (tab) =>
  tab.waitForFunction(() => {
    const stages = [...document.querySelectorAll('.stage')];
    return stages.every((stage) => stage.dataset.ready === 'true');
  });
