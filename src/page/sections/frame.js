import { el, saveFile } from '../core/dom.js';
import { warningsOf } from './verdict.js';

const kinds = { plan: 'Plan', estimate: 'Calibration', study: 'Study', 'blocks study': 'Study of plain blocks', export: 'Export' };

/** What was warned of while the page was made and no part has. */
const ownWarnings = (page, parts) => warningsOf(page).filter((text) => !parts.some((part) => warningsOf(part.document).includes(text)));

const recorded = { operator: 'Operator', instrument: 'Instrument', serial: 'Serial number', date: 'Date', temperature_C: 'Temperature/\u00b0C' };

/** Who measured with what and when, where a document says. */
const recordOf = ({ record }) =>
  Object.entries(recorded)
    .filter(([key]) => record?.[key])
    .map(([key, name]) => `${name}: ${record[key]}`)
    .join(' \u00b7 ');

export function header(page, parts, sections) {
  const names = [...new Set(parts.map((part) => part.robot))];
  const what = [...new Set(parts.map((part) => kinds[part.kind] ?? part.kind))].join(', ');
  return el(
    'header',
    {},
    el('p', { class: 'kind' }, `posewise \u00b7 ${what}`),
    el('h1', {}, names.join(' \u00b7 ')),
    [...new Set(parts.map((part) => recordOf(part.document)))].filter(Boolean).map((text) => el('p', { class: 'record' }, text)),
    ownWarnings(page, parts).map((text) => el('p', { class: 'warning', role: 'note' }, text)),
    el(
      'nav',
      { 'aria-label': 'Sections' },
      el(
        'ul',
        {},
        sections.map((section) => el('li', {}, el('a', { href: `#${section.id}` }, section.querySelector('h2').textContent))),
      ),
    ),
  );
}

export function footer(page, source) {
  return el(
    'footer',
    {},
    el('p', {}, `Made by posewise ${page.posewise_version ?? ''}. Nothing on this page comes from elsewhere.`),
    el('button', { type: 'button', onclick: () => saveFile('posewise.json', source, 'application/json') }, 'Save all numbers as JSON'),
  );
}
