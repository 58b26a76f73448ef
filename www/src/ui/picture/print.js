/** Lays out picture, formula and figures on a clean sheet, and prints it. */
import { givenOf } from '../../engine/given.js';
import { isBareModel } from '../../engine/pulls.js';
import { h } from '../dom.js';
import { formatSignificant } from '../format.js';
import { sliceOver } from '../view/marks/slice.js';
import { captionOf } from './compose.js';

/** @import { Engine } from '../../engine/types.js' */

/** Pixels of the printed picture: about 300 per inch. */
const PICTURE_PX = { width: 2100, height: 1500 };

/**
 * Prints the sheet. It is made first, because the picture must be read back from the graphics device.
 * @param {Engine} engine
 */
export async function printPage(engine) {
  const { element, free } = await createSheet(engine);
  document.querySelector('.sheet')?.remove();
  document.body.append(element);
  addEventListener(
    'afterprint',
    () => {
      element.remove();
      free();
    },
    { once: true },
  );
  print();
}

/** @param {Engine} engine */
async function createSheet(engine) {
  const { theme } = engine.state.peek().view;
  // A print is drawn in the light theme, for white paper.
  engine.setView({ theme: 'light' });
  const png = await engine
    .savePng({ ...PICTURE_PX, transparent: true, over: sliceOver(engine) })
    .finally(() => engine.setView({ theme }));
  const url = URL.createObjectURL(png);
  const [title, formula = '', credit = ''] = captionOf(engine);
  const picture = h('img', { src: url, alt: title, ...PICTURE_PX });
  await picture.decode();
  const math = copyOf('.preview');
  const parameters = (engine.field.peek()?.parameters ?? []).map(
    ({ name, label, value }) => `${label && label !== name ? `${label}: ` : ''}${name} = ${formatSignificant(value)}`,
  );
  const element = h(
    'section',
    { class: 'sheet' },
    h('h1', null, title),
    picture,
    isBareModel(engine.field.peek()) || ['voxels', 'faces'].includes(givenOf(engine.field.peek())?.holds ?? '')
      ? null
      : (math ?? h('p', null, formula)),
    parameters.length ? h('p', null, parameters.join(', ')) : null,
    copyOf('.figures'),
    credit && credit !== formula ? h('p', null, credit) : null,
    h('p', { class: 'sheet-foot' }, `Marching Particles ${engine.description.peek()?.version ?? ''}`),
  );
  return { element, free: () => URL.revokeObjectURL(url) };
}

/** Returns a copy of a part of the page, without its hidden elements. @param {string} part */
function copyOf(part) {
  const copy = /** @type {HTMLElement | undefined} */ (document.querySelector(part)?.cloneNode(true));
  for (const hidden of copy?.querySelectorAll('[hidden]') ?? []) hidden.remove();
  copy?.removeAttribute('tabindex');
  return copy;
}
