// A picture of the top of a page: picture.mjs PAGE.html PICTURE.png [HEIGHT]; Chromium as for the tests.
import { resolve } from 'node:path';
import { drawn, launch, open } from './browser.mjs';

const [page, picture, height = '1000'] = process.argv.slice(2);
const browser = await launch();
const { tab } = await open(browser, resolve(page), { width: 1180, height: Number(height) });
await drawn(tab);
await tab.waitForTimeout(500);
await tab.screenshot({ path: picture });
await browser.close();
