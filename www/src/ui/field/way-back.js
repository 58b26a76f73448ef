/** The button that returns from a file's or model's surface to the formula before it. */
import { givenOf } from '../../engine/given.js';
import { button } from '../button.js';
import { live } from '../dom.js';

/** @import { Description, Engine, Shape } from '../../engine/types.js' */

/**
 * @param {Engine} engine @param {Description} description
 * @param {HTMLElement} section  of the panel, as long as which the formula is remembered
 */
export function createWayBack(engine, description, section) {
  // The last formula, with its parameters and box.
  /** @type {Shape | null} */
  let left = null;
  live(section, () => {
    const { v: _, view: __, ...shape } = engine.state.value;
    const field = engine.field.value;
    const isFormula = description.surfaces.some(({ id }) => id === shape.surface);
    if (isFormula && !givenOf(field)) left = shape;
  });
  const press = () => {
    if (left) engine.restore({ ...left, settings: engine.state.peek().settings });
    else engine.setSurface(description.surfaces[0].id);
  };
  return button({ class: 'plain small', press }, 'Back to the formula');
}
