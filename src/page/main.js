import { el } from './core/dom.js';
import { rowsOf } from './core/residuals.js';
import { watchTheme } from './core/theme.js';
import { footer, header } from './sections/frame.js';
import * as accuracy from './sections/accuracy_by_count.js';
import * as blocks from './sections/blocks_study.js';
import * as before from './sections/before_after.js';
import * as budget from './sections/budget.js';
import * as coverage from './sections/coverage.js';
import * as map from './sections/error_map.js';
import * as handEye from './sections/hand_eye.js';
import * as image from './sections/image.js';
import * as measured from './sections/measured.js';
import * as models from './sections/model_selection.js';
import * as optimality from './sections/optimality.js';
import * as parameters from './sections/parameters.js';
import * as poses from './sections/poses.js';
import * as printed from './sections/printed.js';
import * as readBack from './sections/read_back.js';
import * as residuals from './sections/residual_plots.js';
import * as verdict from './sections/verdict.js';

const sections = [
  verdict,
  poses,
  accuracy,
  blocks,
  before,
  map,
  residuals,
  image,
  handEye,
  parameters,
  models,
  coverage,
  budget,
  optimality,
  readBack,
  measured,
  printed,
];

/** What a document that was edited by hand breaks is said in its place; the rest of the page stands. */
function renderOf(section, part, parts) {
  try {
    return section.isShown(part) ? section.render(part, parts) : null;
  } catch (error) {
    return el('p', { class: 'warning' }, `Cannot be shown: the document in this page is not as posewise writes it (${error.message}).`);
  }
}

/** One section with all parts that have something to show, side by side where there are several. */
function sectionOf(section, parts) {
  const shown = parts.map((part) => [part, renderOf(section, part, parts)]).filter(([, content]) => content !== null);
  if (shown.length === 0) return null;
  const id = section.title.toLowerCase().replace(/[^a-z0-9]+/g, '-');
  const isAlone = parts.length === 1;
  return el(
    'section',
    { id, 'aria-labelledby': `${id}-title` },
    el('h2', { id: `${id}-title` }, section.title),
    el(
      'div',
      { class: shown.length > 1 ? 'parts parts-beside' : 'parts' },
      shown.map(([part, content]) => el('div', { class: 'part' }, isAlone ? null : el('h3', {}, part.name), content)),
    ),
  );
}

/** Residuals with their readings as `rows`; none if the document is not as posewise writes it. */
function withRows(part) {
  try {
    return part.residuals && { ...part.residuals, rows: rowsOf(part) };
  } catch {
    return undefined;
  }
}

/** Parts with names that differ. */
function namedParts(document) {
  const parts = (document.parts ?? []).map((part) => ({
    ...part,
    residuals: withRows(part),
    robot: part.document.campaign ?? part.title,
    title: part.title.replace(/^.*[/\\](?=.)/, ''),
    file: part.title === part.document.campaign ? null : part.title,
  }));
  const kindOf = (part) => part.document.kind.replace(/^posewise /, '');
  return parts.map((part, k) => {
    const plain = `${part.title} (${kindOf(part)})`;
    const isTwice = parts.some((other, i) => i !== k && `${other.title} (${kindOf(other)})` === plain);
    // Headings within a part follow that of the section, or of the part.
    return { ...part, sub: parts.length === 1 ? 'h3' : 'h4', kind: kindOf(part), name: isTwice ? `${k + 1}. ${plain}` : plain };
  });
}

function draw() {
  const source = document.getElementById('posewise').textContent;
  const page = JSON.parse(source);
  const parts = namedParts(page);
  const drawn = sections.map((section) => sectionOf(section, parts)).filter(Boolean);
  document.title = `posewise: ${[...new Set(parts.map((part) => part.robot))].join(', ')}`;
  document.body.append(
    el('a', { class: 'skip', href: '#verdict' }, 'Skip to the verdict'),
    header(page, parts, drawn),
    el('main', {}, drawn),
    footer(page, source),
  );
  watchTheme();
  document.documentElement.dataset.drawn = 'true';
}

draw();
