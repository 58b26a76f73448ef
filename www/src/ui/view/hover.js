/** Shows a card for the particle under the pointer or the tapped one. */
import { effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { formatCount, formatFixed, formatSignificant } from '../format.js';
import { clamp } from '../scale.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {import('../../engine/types.js').Hover} Hover */

const OFFSET_PX = 16;

/** @param {HTMLElement} host @param {Engine} engine */
export function mountHover(host, engine) {
  const card = h('div', { class: 'hover-card', hidden: true });
  host.append(card);
  let index = -1;
  effect(() => {
    const hover = engine.hover.value;
    card.hidden = hover === null;
    if (!hover) return;
    if (hover.index !== index) index = hover.index;
    fill(card, rowsOf(hover));
    const { width, height } = card.getBoundingClientRect();
    const { left, top } = host.getBoundingClientRect();
    const right = hover.x + OFFSET_PX + width < innerWidth - 8;
    const x = right ? hover.x + OFFSET_PX : hover.x - OFFSET_PX - width;
    const y = clamp(hover.y + OFFSET_PX, 8, innerHeight - height - 8);
    card.style.transform = `translate(${Math.round(Math.max(8 - left, x))}px, ${Math.round(y - Math.min(0, top))}px)`;
  });
}

/** @param {Hover} hover */
function rowsOf(hover) {
  /** @type {[string, string][]} */
  const rows = [
    ['Particle', formatCount(hover.index)],
    ['Level', formatCount(hover.level)],
    ['Parent', hover.parent === null ? 'seed' : formatCount(hover.parent)],
    ['Position', hover.position.map((value) => formatFixed(value, 3)).join('  ')],
  ];
  if (hover.valence !== null) rows.push(['Neighbours', formatCount(hover.valence)]);
  if (hover.nearest !== null) rows.push(['Nearest', `${formatFixed(hover.nearest / (2 * hover.radius), 3)} · 2r`]);
  if (hover.residual !== null) rows.push(['Residual', formatSignificant(hover.residual, 2)]);
  return h(
    'dl',
    null,
    rows.flatMap(([label, value]) => [h('dt', null, label), h('dd', null, value)]),
  );
}
