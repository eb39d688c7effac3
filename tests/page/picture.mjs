// A picture of a page's section, else of its top: picture.mjs PAGE.html PICTURE.png [SECTION]; Chromium as for the tests.
import { resolve } from 'node:path';
import { drawn, launch, open } from './browser.mjs';

const [page, picture, section] = process.argv.slice(2);
const browser = await launch();
const { tab } = await open(browser, resolve(page), { width: 1000, height: 1000 });
await drawn(tab);
await tab.waitForTimeout(500);
await (section ? tab.locator(`#${section}`) : tab).screenshot({ path: picture });
await browser.close();
