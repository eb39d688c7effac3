import { el } from '../core/dom.js';

export const title = 'As printed';

export const isShown = (part) => Boolean(part.printed);

export function render(part) {
  return el(
    'details',
    {},
    el('summary', {}, 'What the command printed'),
    el('pre', { tabindex: 0, role: 'group', 'aria-label': `What the command printed, ${part.name}` }, part.printed),
  );
}
