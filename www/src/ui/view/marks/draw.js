/** Draws lines, rings and figures at places of the surface. Its SVG elements are reused for every picture. */

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Pen } from '../types.js'
 */

const SVG = 'http://www.w3.org/2000/svg';

/** @param {HTMLElement} layer @param {Engine} engine @returns {Pen} */
export function drawn(layer, engine) {
  const svg = document.createElementNS(SVG, 'svg');
  svg.setAttribute('aria-hidden', 'true');
  layer.append(svg);
  /** @type {SVGElement[]} */
  let kept = [];
  let used = 0;
  /**
   * Returns the next element, in the order of drawing.
   * @param {string} tag
   * @param {string} kind
   * @param {Record<string, string | number>} attributes
   */
  const next = (tag, kind, attributes) => {
    let element = kept[used];
    if (element?.tagName !== tag) {
      const made = document.createElementNS(SVG, tag);
      if (element) element.replaceWith(made);
      else svg.append(made);
      kept[used] = made;
      element = made;
    }
    used += 1;
    element.setAttribute('class', kind);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
    return element;
  };
  return {
    begin() {
      used = 0;
    },
    end() {
      for (const element of kept.slice(used)) element.remove();
      kept = kept.slice(0, used);
      svg.toggleAttribute('hidden', used === 0);
    },
    polygon(places, kind) {
      const spots = places.map((place) => engine.project(place));
      if (spots.length < 3 || spots.some((spot) => spot === null)) return false;
      next('polygon', kind, {
        points: spots.map((spot) => (spot ? `${spot.x.toFixed(1)},${spot.y.toFixed(1)}` : '')).join(' '),
      });
      return true;
    },
    line(from, to, kind) {
      const [x1, y1, x2, y2] = [from.x, from.y, to.x, to.y].map((v) => v.toFixed(1));
      next('line', kind, { x1, y1, x2, y2 });
    },
    ring(at, radiusPx, kind) {
      next('circle', kind, { cx: at.x.toFixed(1), cy: at.y.toFixed(1), r: Math.max(0, radiusPx).toFixed(1) });
    },
    text(at, text, kind, anchor = 'middle') {
      const element = next('text', kind, { x: at.x.toFixed(1), y: at.y.toFixed(1), 'text-anchor': anchor });
      if (element.textContent !== text) element.textContent = text;
    },
  };
}
