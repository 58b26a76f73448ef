/** Shows a card for the particle under the pointer or the tapped one. */

import { givenOf } from '../../engine/given.js';
import { clamp } from '../../engine/vector.js';
import { button } from '../button.js';
import { h, live, query } from '../dom.js';
import { formatCount, formatFixed, formatSignificant } from '../format.js';

/**
 * @import { Engine, Hover } from '../../engine/types.js'
 * @import { Edges, Point } from './types.js'
 */

const OFFSET_PX = 16;

/**
 * @param {HTMLElement} host @param {Engine} engine
 * @param {{ view: HTMLElement, explainIt: (index: number) => void }} parts  `view` is the part of the picture that no
 *   panel covers; `explainIt` opens the lesson at a particle
 */
export function mountHover(host, engine, { view, explainIt }) {
  const { hover } = engine;
  // A link cannot hold a model from points, an image or a mesh.
  const isTold = () => givenOf(engine.field.value) === null;
  const go = (/** @type {number} */ index) => {
    if (!isTold()) return;
    engine.dismissHover();
    explainIt(index);
  };
  const card = h(
    'div',
    { class: 'hover-card', hidden: () => hover.value === null, 'data-tapped': () => hover.value?.tapped },
    () => {
      const { value: now } = hover;
      if (!now) return null;
      return [rowsOf(now), now.tapped && isTold() && leadOf(engine.columns.adaptive, () => go(now.index))];
    },
  );
  host.append(card);
  // The card of a pressed particle stays beside it while the picture turns.
  live(card, () => {
    const hover = engine.hover.value;
    if (!hover) return;
    if (hover.tapped) void engine.frame.value;
    put(card, hover.tapped ? (engine.project(hover.position) ?? hover) : hover, {
      host: host.getBoundingClientRect(),
      within: hover.tapped ? freeOf(view) : { left: 8, right: innerWidth - 8, top: 8, bottom: innerHeight - 8 },
    });
  });
  host.addEventListener('keydown', (event) => press(event), true);

  /** @param {KeyboardEvent} event */
  function press(event) {
    const hover = engine.hover.peek();
    if (!hover?.tapped) return;
    if (event.key === 'Escape') {
      engine.dismissHover();
      query(host, '.canvas-host').focus();
    } else if (event.key === 'Enter' && !(event.target instanceof HTMLButtonElement)) {
      // Enter chooses the particle in the middle of the picture. Pressed again, it explains that particle.
      const middle = engine.project(engine.state.peek().view.camera.target);
      if (!middle || engine.pick(middle.x, middle.y) !== hover.index) return;
      go(hover.index);
    } else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

/** Creates the link to the lesson. @param {boolean} isAdaptive @param {() => void} press */
function leadOf(isAdaptive, press) {
  if (!isAdaptive) return button({ class: 'small', press }, 'Explain this particle');
  return [
    h('p', { class: 'quiet' }, 'The lesson explains single particles only where all have one size.'),
    button({ class: 'small', press }, 'How many sizes find room'),
  ];
}

/** @param {HTMLElement} view @returns {Edges} the part of the view beside the toolbar */
function freeOf(view) {
  const { left, right, top, bottom } = view.getBoundingClientRect();
  const toolbar = view.querySelector('.toolbar')?.getBoundingClientRect();
  return { left, right: toolbar ? Math.min(right, toolbar.left - 4) : right, top, bottom };
}

/** @param {HTMLElement} card @param {Point} at @param {{ host: DOMRect, within: Edges }} room */
function put(card, at, { host, within }) {
  const { width, height } = card.getBoundingClientRect();
  const fits = at.x + OFFSET_PX + width < within.right;
  const x = Math.max(within.left, fits ? at.x + OFFSET_PX : at.x - OFFSET_PX - width);
  const y = clamp(at.y + OFFSET_PX, within.top, Math.max(within.top, within.bottom - height));
  card.style.transform = `translate(${Math.round(x - host.left)}px, ${Math.round(y - Math.min(0, host.top))}px)`;
}

/** @param {Hover} hover */
function rowsOf(hover) {
  /** @type {[string, string][]} */
  const rows = [
    ['Particle', formatCount(hover.index)],
    ['Level', formatCount(hover.level)],
    hover.curve
      ? ['Lies on', `a ${hover.curve}`]
      : ['Parent', hover.parent === null ? 'seed' : formatCount(hover.parent)],
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
