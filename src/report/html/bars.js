// The file before and after: two bars on one scale, and the same as a table.
import { bytes } from './format.js';

const COLOURS = { meshes: 'meshes', images: 'images', keys: 'keys', 'animation JSON': 'json', networks: 'networks', other: 'other' };
export const ANIMATION = ['keys', 'animation JSON', 'networks'];

function element(tag, text, attributes = {}) {
  const made = document.createElement(tag);
  if (text !== null) made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

export function drawBars(container, parts) {
  const sum = (which) => parts.reduce((total, part) => total + part[which], 0);
  const most = Math.max(sum('before'), sum('after'), 1);
  for (const which of ['before', 'after']) {
    const total = sum(which);
    const shown = parts.filter((part) => part[which] > 0);
    const words = shown.map((part) => `${part.name} ${bytes(part[which])}`).join(', ');
    const bar = element('div', null, { class: 'bar', role: 'img', 'aria-label': `${which}: ${bytes(total)} bytes. ${words}` });
    const track = element('div', null, { class: 'track' });
    for (const part of shown) {
      const style = `width: ${(100 * part[which]) / most}%; background: var(--${COLOURS[part.name]})`;
      track.append(element('i', null, { style, title: `${part.name}: ${bytes(part[which])} bytes` }));
    }
    bar.append(element('span', which), track, element('span', `${bytes(total)} B`, { class: 'sum' }));
    container.append(bar);
  }
  const table = element('table', null, { class: 'parts' });
  const head = element('thead', null);
  const titles = element('tr', null);
  for (const title of ['bytes of', 'before', 'after']) titles.append(element('th', title, { scope: 'col' }));
  head.append(titles);
  const body = element('tbody', null);
  for (const part of parts.filter(({ before, after }) => before + after > 0)) {
    const row = element('tr', null, { 'data-part': part.name });
    const name = element('th', null, { scope: 'row' });
    name.append(element('span', null, { class: 'swatch', style: `background: var(--${COLOURS[part.name]})` }), part.name);
    row.append(name, element('td', bytes(part.before)), element('td', bytes(part.after)));
    body.append(row);
  }
  table.append(head, body);
  container.append(table);
}
