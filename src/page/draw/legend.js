import { el } from '../core/dom.js';

/** Names of what is drawn, before the picture so that they never lie on it. */
export function legend(series, bands = []) {
  const item = (kind, name, label, dash) => {
    const key = el('span', { class: `key key-${kind}${dash ? ' key-dashed' : ''}` });
    key.style.setProperty('--key', `var(--${name})`);
    return el('li', {}, key, label);
  };
  return el(
    'ul',
    { class: 'legend' },
    bands.map((one) => item('band', one.colour, one.label)),
    series.filter((one) => one.label).map((one) => item(one.kind ?? 'line', one.colour, one.label, one.dash)),
  );
}
