/** Names what is lost when another surface replaces the present one. */
import { keptOf } from './kept.js';

/**
 * @import { Engine } from '../engine/types.js'
 * @import { Replace, Toast } from './types.js'
 */

/** Lower-cases the first letter, for use within a sentence. @param {string} text */
const within = (text) => text.charAt(0).toLowerCase() + text.slice(1);

/**
 * Returns a function that replaces the surface and names what was set for the one before.
 * @param {Pick<Engine, 'state' | 'field' | 'columns' | 'revision' | 'enlargement'>} engine
 * @param {Toast} toast
 * @returns {Replace}
 */
export function createReplace(engine, toast) {
  const told = () => keptOf(/** @type {Engine} */ (engine)).map(({ text }) => text);
  return (act) => {
    const before = told();
    act();
    const after = told();
    const gone = before.filter((text) => !after.includes(text));
    if (gone.length === 0) return;
    const text = `Ended with the surface before: ${gone.map(within).join('; ')}. Undo brings it back.`;
    toast({ id: 'ended', kind: 'info', text });
  };
}
