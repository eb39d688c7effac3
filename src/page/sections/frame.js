import { el, saveFile } from '../core/dom.js';

const kinds = { plan: 'Plan', estimate: 'Calibration', study: 'Study', export: 'Export' };

export function header(parts, sections) {
  const names = [...new Set(parts.map((part) => part.robot))];
  const what = [...new Set(parts.map((part) => kinds[part.kind] ?? part.kind))].join(', ');
  return el('header', {},
    el('p', { class: 'kind' }, `posewise \u00b7 ${what}`),
    el('h1', {}, names.join(' \u00b7 ')),
    el('nav', { 'aria-label': 'Sections' }, el('ul', {}, sections.map((section) =>
      el('li', {}, el('a', { href: `#${section.id}` }, section.querySelector('h2').textContent))))));
}

export function footer(page, source) {
  return el('footer', {},
    el('p', {}, `Made by posewise ${page.posewise_version ?? ''}. Nothing on this page comes from elsewhere.`),
    el('button', { type: 'button', onclick: () => saveFile('posewise.json', source, 'application/json') }, 'Save all numbers as JSON'));
}
