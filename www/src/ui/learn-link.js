/** The link to the learn page, which carries the surface of the picture over. */
import { explain } from './explain.js';
import { packCarried } from './surface-link.js';

/** @import { Engine } from '../engine/types.js' */

const PAGE = './learn/';

/** @param {HTMLAnchorElement} link  of the page's markup @param {Engine} engine */
export function bindLearnLink(link, engine) {
  /** Says where the link leads just before it is followed or copied. */
  const write = () => {
    const surface = engine.lessonSurface();
    const formula = surface && 'formula' in surface ? surface : null;
    link.href = `${PAGE}#surface=${packCarried({ surface: formula, from: location.hash })}`;
  };
  for (const type of ['pointerdown', 'focus', 'click']) link.addEventListener(type, write);
  explain(link, () => {
    // A model from points is too large for a link.
    const isOwn = !engine.field.peek()?.model;
    const on = isOwn ? 'this surface' : 'an ellipsoid: a link cannot hold a model from points';
    return { title: 'The lesson', text: `The paper’s idea in ten short chapters, with figures on ${on}.` };
  });
}
