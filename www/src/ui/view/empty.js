/** Says over the picture why there is no surface, and what can be done. Not loaded for the first picture. */
import { enlarge } from '../box.js';
import { button } from '../button.js';
import { fill, h, live, marked } from '../dom.js';
import { meantBy, questionOf } from '../meant.js';
import { createKept } from './kept.js';

/** @import { CameraState, Engine, ReadonlySignal, Shape } from '../../engine/types.js' */

/**
 * Fills the empty state while there is no surface.
 * @param {HTMLElement} empty @param {Engine} engine @param {ReadonlySignal<boolean>} lost
 */
export function fillEmpty(empty, engine, lost) {
  const createBack = rememberSurface(empty, engine);
  live(empty, () => {
    // The next formula may lack a surface for another reason.
    void engine.field.value;
    void engine.revision.value;
    fill(empty, lost.value ? [emptyState(engine, createBack()), createKept(engine)] : null);
  });
}

/** Title and advice of the empty state, by the reason for it. @type {Record<string, [string, string] | undefined>} */
const EMPTY = {
  constant: ['There is no x, y or z in it', 'Write x, y or z into the formula.'],
  undefined: ['Undefined in the whole box', 'Look for the root or logarithm of a negative number, or move the box.'],
};

/** @param {Engine} engine @param {HTMLElement} back  the button that returns to the last surface */
function emptyState(engine, back) {
  const { message, stop_reason } = engine.progress.peek();
  const nowhere = engine.field.peek()?.reach === 'nowhere';
  const { formula } = engine.state.peek();
  const stays = engine.columns.stale ? ' The last surface stays, dimmed, until there is another.' : '';
  const about = engine.description.peek();
  const meant = about ? meantBy(about, formula) : [];
  if (meant.length > 0)
    return [
      h('h2', null, questionOf(meant)),
      h('p', { class: 'quiet' }, `A surface is a formula in x, y and z.${stays}`),
      h(
        'div',
        { class: 'empty-actions' },
        meant.map(({ id, name }) => button({ press: () => engine.setSurface(id) }, `Show the ${name}`)),
        back,
      ),
    ];
  const [title, remedy] =
    EMPTY[stop_reason ?? ''] ??
    (nowhere
      ? ['No surface within ±10,000', 'Change the formula: the two sides are never equal there.']
      : ['No surface inside the box', 'Change the formula, or widen the box.']);
  return [
    h('h2', null, title),
    message && !nowhere
      ? h('p', { class: `quiet ${stop_reason === 'constant' ? '' : 'reason'}` }, marked(message))
      : null,
    h('p', { class: 'quiet' }, `${remedy}${stays}`),
    h(
      'div',
      { class: 'empty-actions' },
      stop_reason === 'no_surface' && !nowhere ? button({ press: () => enlarge(engine) }, 'Double the box') : null,
      back,
    ),
  ];
}

/**
 * Remembers the last surface, as long as `node` exists.
 * @param {HTMLElement} node @param {Engine} engine
 * @returns creates the button that returns to it; where there was none, to the surface that was chosen last
 */
function rememberSurface(node, engine) {
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
