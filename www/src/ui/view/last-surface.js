/** The way back to the last surface that was there, for a formula that has none. */
import { button } from '../button.js';
import { live } from '../dom.js';

/** @import { CameraState, Engine, Shape } from '../../engine/types.js' */

/**
 * Remembers the last surface, as long as `node` exists.
 * @param {HTMLElement} node @param {Engine} engine
 * @returns creates the button that returns to it; where there was none, to the surface that was chosen last
 */
export function rememberSurface(node, engine) {
  /** @type {{ name: string, shape: Shape & { camera: CameraState } } | null} */
  let last = null;
  live(node, () => {
    const [field, hasSurface] = [engine.field.value, ['whole', 'partial'].includes(engine.result.value ?? '')];
    if (!field || !hasSurface || engine.status.value !== 'rest' || engine.fieldError.value) return;
    const { v: _, view, ...shape } = engine.state.peek();
    // What is typed already may have no surface.
    if (!field.model && field.formula !== shape.formula) return;
    last = { name: nameOf(engine, field.surface) ?? 'last surface', shape: { ...shape, camera: view.camera } };
  });
  return () => {
    const { surface } = engine.state.peek();
    if (!last)
      return button({ press: () => engine.setSurface(surface) }, `Back to the ${nameOf(engine, surface) ?? 'file'}`);
    const { name, shape } = last;
    return button(
      { press: () => engine.restore({ ...shape, settings: engine.state.peek().settings }) },
      `Back to the ${name}`,
    );
  };
}

/** The name of a surface of the gallery or of a model. @param {Engine} engine @param {string | null} id */
function nameOf({ description }, id) {
  const { surfaces = [], models = [] } = description.peek() ?? {};
  return [...surfaces, ...models].find((entry) => entry.id === id)?.name;
}
