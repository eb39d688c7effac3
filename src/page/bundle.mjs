// Bundles scripts and styles into template.html, with the hashes that its security policy lets run.
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { build } from 'esbuild';

const here = (name) => new URL(name, import.meta.url);
const read = (name) => readFileSync(here(name), 'utf8');
const hash = (text) => `'sha256-${createHash('sha256').update(text, 'utf8').digest('base64')}'`;

async function bundle(entry, options = {}) {
  const { outputFiles } = await build({
    entryPoints: [entry],
    absWorkingDir: here('.').pathname,
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: 'es2022',
    charset: 'utf8',
    legalComments: 'none',
    ...options,
  });
  return outputFiles[0].text.trimEnd();
}

const script = await bundle('main.js');
const style = await bundle('style.css', { format: undefined, target: 'chrome110' });
if (/<\/(script|style)/i.test(script + style)) throw new Error('ends its own element');

const policy = [
  "default-src 'none'",
  `script-src ${hash(script)}`,
  `style-src ${hash(style)}`,
  'img-src data: blob:',
  "base-uri 'none'",
  "form-action 'none'",
].join('; ');
const licences = ['three', 'uplot']
  .map((name) => `${name} ${JSON.parse(read(`node_modules/${name}/package.json`)).version}\n\n` + read(`node_modules/${name}/LICENSE`).trim())
  .join('\n\n');
if (licences.includes('--')) throw new Error('a licence ends its comment');

const page = read('template.html')
  .replace('{{policy}}', () => policy)
  .replace('{{licences}}', () => licences)
  .replace('{{style}}', () => style)
  .replace('{{script}}', () => script);
writeFileSync(process.argv[2], page);
