import { el } from '../core/dom.js';
import { figure } from '../core/figure.js';
import { fixed } from '../core/format.js';
import { correlationsOf } from '../core/parameters.js';
import { screenTable, table } from '../core/table.js';
import { colour, diverging } from '../core/theme.js';
import { colourBar } from '../draw/colour_bar.js';
import { drawing } from '../draw/canvas.js';

const shown = 20;

/** Pairs of parameters, most correlated first. */
function strongest({ names, at }) {
  const pairs = [];
  for (let i = 0; i < names.length; ++i) {
    for (let j = 0; j < i; ++j) pairs.push({ first: names[j], second: names[i], value: at(i, j) });
  }
  return pairs.sort((a, b) => Math.abs(b.value) - Math.abs(a.value)).slice(0, shown);
}

function matrix({ names, at }, text) {
  const n = names.length;
  const room = 10 + 6.2 * Math.max(...names.map((name) => name.length));
  const picture = drawing(text, (width) => Math.max(11, Math.min(22, (width - room) / n)) * n + room, (context, width) => {
    const cell = Math.max(11, Math.min(22, (width - room) / n));
    context.font = `${Math.min(12, cell)}px system-ui, sans-serif`;
    for (let i = 0; i < n; ++i) {
      for (let j = 0; j < n; ++j) {
        context.fillStyle = diverging(at(i, j));
        context.fillRect(room + j * cell, room + i * cell, cell - 0.5, cell - 0.5);
      }
    }
    context.fillStyle = colour('ink');
    names.forEach((name, k) => {
      context.textAlign = 'right';
      context.fillText(name, room - 5, room + (k + 0.5) * cell + 0.35 * cell, room - 5);
      context.save();
      context.translate(room + (k + 0.5) * cell + 0.35 * cell, room - 5);
      context.rotate(-Math.PI / 2);
      context.textAlign = 'left';
      context.fillText(name, 0, 0, room - 5);
      context.restore();
    });
  });
  // Never so narrow that names could not be read.
  picture.element.style.minWidth = `${Math.ceil(11 * n + room)}px`;
  return el('div', { class: 'scroll scroll-all', tabindex: 0, role: 'group', 'aria-label': 'Correlation matrix' }, picture.element);
}

function matrixTable({ names, at }) {
  return screenTable('Correlation matrix', ['', ...names], names.map((name, i) => [name, ...names.map((unused, j) => (j <= i ? fixed(at(i, j), 2) : ''))]));
}

export function correlationFigure(document) {
  const correlations = correlationsOf(document);
  if (!correlations || correlations.names.length < 2) return null;
  const pairs = strongest(correlations);
  const text = `Correlation matrix of ${correlations.names.length} parameters; strongest: ${pairs.slice(0, 5).map((one) => `${one.first} with ${one.second} ${fixed(one.value, 3)}`).join(', ')}`;
  return figure('Correlations of the parameters: strong ones are what these poses can hardly tell apart.',
    el('div', {}, colourBar('correlation', '-1', '1', true), matrix(correlations, text)),
    [table('Strongest correlations', ['parameter', 'parameter', 'correlation'], pairs.map((one) => [one.first, one.second, fixed(one.value, 3)])),
      correlations.names.length <= 80 ? matrixTable(correlations) : null]);
}
