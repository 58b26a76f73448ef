/** Links to the learn page, which pass on the surface of the picture, and a particle to be explained there. */

import { NO_PARENT } from '../engine/core-numbers.js';
import { givenOf } from '../engine/given.js';
import { triple } from '../engine/vector.js';
import { explain } from './explain.js';
import { packCarried, packParticle } from './surface-link.js';

/** @import { Engine } from '../engine/types.js' */

const PAGE = './learn/';

/** The picture's surface and the link back, for the address of the learn page. @param {Engine} engine */
function carried(engine) {
  const surface = engine.lessonSurface();
  const formula = surface && 'formula' in surface ? surface : null;
  return `surface=${packCarried({ surface: formula, from: location.hash })}`;
}

/** @param {HTMLAnchorElement} link  of the page's markup @param {Engine} engine */
export function bindLearnLink(link, engine) {
  /** Sets the link's target just before it is followed or copied. */
  const write = () => {
    link.href = `${PAGE}#${carried(engine)}`;
  };
  for (const type of ['pointerdown', 'focus', 'click']) link.addEventListener(type, write);
  explain(link, () => {
    // The contents of a file are too large for a link.
    const given = givenOf(engine.field.peek());
    const on = given ? `an ellipsoid: a link cannot hold the ${given.holds} of ${given.name}` : 'this surface';
    return { title: 'The lesson', text: `The paper’s idea in one sitting, with figures on ${on}.` };
  });
}

/**
 * Returns the link to the lesson's explanation of a particle. The lesson follows only particles of uniform size; for
 * varying sizes it shows how children find room.
 * @param {Engine} engine @param {number} index
 */
export function particleLink(engine, index) {
  const { columns } = engine;
  if (columns.adaptive) return `${PAGE}#angles&${carried(engine)}`;
  const seeds = [];
  for (let i = 0; i < columns.count; i += 1)
    if (columns.parents[i] === NO_PARENT) seeds.push(triple(columns.placed, i));
  const particle = { place: triple(columns.placed, index), radius: columns.radii[index], seeds };
  return `${PAGE}#first&${carried(engine)}&particle=${packParticle(particle)}`;
}
