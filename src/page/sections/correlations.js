import { el } from '../core/dom.js';
import { figure } from '../core/figure.js';
import { fixed } from '../core/format.js';
import { correlationsOf } from '../core/parameters.js';
import { screenTable, table } from '../core/table.js';
import { colour, diverging } from '../core/theme.js';
import { colourBar } from '../draw/colour_bar.js';
import { apart, drawing } from '../draw/canvas.js';

const shown = 20;

/** Pairs of parameters, most correlated first. */
function strongest({ names, at }) {
  const pairs = [];
  for (let i = 0; i < names.length; ++i) {
    for (let j = 0; j < i; ++j) pairs.push({ first: names[j], second: names[i], value: at(i, j) });
  }
  return pairs.sort((a, b) => Math.abs(b.value) - Math.abs(a.value)).slice(0, shown);
}

/** Blocks of parameters that belong together: `name`, the first and the one after the last. */
const blocksOf = (blocks) =>
  blocks
    .flatMap((name, k) => (name === blocks[k - 1] ? [] : [{ name, first: k, end: blocks.findIndex((other, i) => i > k && other !== name) }]))
    .map((one) => (one.end < 0 ? { ...one, end: blocks.length } : one));

function matrix({ names, blocks, at }, text) {
  const n = names.length;
  const list = blocksOf(blocks);
  const room = 12 + 7 * Math.max(...list.map(({ name }) => name.length));
  const cellOf = (width) => Math.max(3, Math.min(16, (width - room - 2) / n));
  const { element } = drawing(
    text,
    (width) => cellOf(width) * n + room + 2,
    (context, width) => {
      const cell = cellOf(width);
      for (let i = 0; i < n; ++i) {
        for (let j = 0; j < n; ++j) {
          context.fillStyle = diverging(at(i, j));
          context.fillRect(room + j * cell, room + i * cell, cell, cell);
        }
      }
      context.strokeStyle = colour('ink-soft');
      context.lineWidth = 1;
      for (const edge of [0, ...list.map(({ end }) => end)]) {
        context.strokeRect(room + edge * cell, room, 0.01, n * cell);
        context.strokeRect(room, room + edge * cell, n * cell, 0.01);
      }
      context.fillStyle = colour('ink');
      const middle = ({ first, end }) => room + ((first + end) / 2) * cell + 4;
      for (const block of apart(list, middle, () => 5)) {
        context.textAlign = 'right';
        context.fillText(block.name, room - 6, middle(block));
        context.save();
        context.translate(middle(block), room - 6);
        context.rotate(-Math.PI / 2);
        context.textAlign = 'left';
        context.fillText(block.name, 0, 0);
        context.restore();
      }
    },
  );
  const canvas = element.querySelector('canvas');
  canvas.addEventListener('pointermove', (event) => {
    const [i, j] = [event.offsetY, event.offsetX].map((offset) => Math.floor((offset - room) / cellOf(canvas.clientWidth)));
    canvas.title = names[i] && names[j] ? `${names[i]} with ${names[j]}: ${fixed(at(i, j), 2)}` : '';
  });
  element.style.minWidth = `${Math.ceil(3 * n + room + 2)}px`;
  return el('div', { class: 'scroll scroll-all', tabindex: 0, role: 'group', 'aria-label': 'Correlation matrix' }, element);
}

function matrixTable({ names, at }) {
  return screenTable(
    'Correlation matrix',
    ['', ...names],
    names.map((name, i) => [name, ...names.map((unused, j) => (j <= i ? fixed(at(i, j), 2) : ''))]),
  );
}

export function correlationFigure(document) {
  const correlations = correlationsOf(document);
  if (!correlations || correlations.names.length < 2) return null;
  const pairs = strongest(correlations);
  const text = `Correlation matrix of ${correlations.names.length} parameters; strongest: ${pairs
    .slice(0, 5)
    .map((one) => `${one.first} with ${one.second} ${fixed(one.value, 3)}`)
    .join(', ')}`;
  return figure(
    'Correlations of the parameters, in blocks: the base, the errors of each joint, targets. Strong ones are what these poses can hardly tell apart.',
    el('div', {}, colourBar('correlation', '-1', '1', true), matrix(correlations, text)),
    [
      table(
        'Strongest correlations',
        ['parameter', 'parameter', 'correlation'],
        pairs.map((one) => [one.first, one.second, fixed(one.value, 3)]),
      ),
      correlations.names.length <= 80 ? matrixTable(correlations) : null,
    ],
  );
}
