/**
 * The choices for the solid made of a surface: closed by the clip box, or a shell of some thickness. For a model from
 * points: whether its surface continues beyond them.
 */
import { computed, signal } from '@preact/signals-core';
import { h, live, marked, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { formatSignificant } from '../format.js';
import { millimetresOf } from '../print.js';

/**
 * @import { Description, Engine, SettingInfo } from '../../engine/types.js'
 * @import { Print } from '../types.js'
 */

const FACES = 'box_faces';
const THICKNESS = 'thickness';
const CLOSED = 'closed';
const CELL = 'box_cell';
const PERIODIC = 'periodic';
const BEYOND = 'beyond_points';
const KEPT = 'kept';
const NEGATIVE =
  'A thickness is a number from 0 on, in the units of x, y and z, a length of the printed part such as `2 mm`, or a formula such as `0.1 + 0.05z`.';

/** @param {Engine} engine @param {Description} description @param {Print} print */
export function createSolid(engine, { settings }, print) {
  const chosen = computed(() => engine.state.value.settings);
  const about = (/** @type {string} */ name) => {
    const { label, help } = /** @type {SettingInfo} */ (settings.find((info) => info.name === name));
    return { title: label, text: help };
  };
  const isClosed = () => chosen.value[FACES] === CLOSED;
  /** A switch between one value of a setting and the default. */
  const check = (/** @type {string} */ name, /** @type {string} */ value, /** @type {string} */ text) =>
    h(
      'label',
      { class: 'check' },
      h('input', {
        type: 'checkbox',
        prop: { checked: () => chosen.value[name] === value },
        on: {
          change: ({ currentTarget }) =>
            currentTarget.checked ? engine.setSetting(name, value) : engine.resetSetting(name),
        },
      }),
      text,
    );
  const closed = check(FACES, CLOSED, 'Closed');
  const periodic = h('div', { hidden: () => !isClosed() }, check(CELL, PERIODIC, 'Periodic'));
  const beyond = check(BEYOND, KEPT, 'Beyond points');
  const wrong = signal('');
  const told = uniqueId('thickness');
  const box = h('input', {
    type: 'text',
    class: 'box',
    placeholder: 'none',
    autocomplete: 'off',
    'aria-describedby': told,
    'aria-invalid': () => String(wrong.value !== ''),
    on: { change: () => void commit() },
  });
  const thickness = h('label', { class: 'check' }, 'Thickness', box);
  async function commit() {
    const text = box.value.trim();
    const wallMm = millimetresOf(text);
    const number = text === '' ? 0 : wallMm === null ? await engine.readNumber(text) : print.thickness(wallMm);
    if (wallMm !== null && number === null) {
      wrong.value = `A wall of ${formatSignificant(wallMm)} mm does not fit a part of ${formatSignificant(print.sizeMm.value)} mm.`;
      return;
    }
    if (number === null) wrong.value = (await engine.textFault('thickness', text)) ?? '';
    else wrong.value = number < 0 ? NEGATIVE : '';
    if (wrong.value !== '') return;
    if (number === 0) engine.resetSetting(THICKNESS);
    else engine.setSetting(THICKNESS, number ?? text);
  }
  live(box, () => {
    const given = chosen.value[THICKNESS];
    // Typed text stays as it is; a number from elsewhere is shown with six digits but keeps its value.
    box.value = typeof given === 'number' ? String(Number(given.toPrecision(6)) || '') : (given ?? '');
    wrong.value = '';
  });
  const aboutThickness = () => ({
    title: about(THICKNESS).title,
    text: `${about(THICKNESS).text} 2 mm is that of a part of ${formatSignificant(print.sizeMm.value)} mm, its size in the panel of the mesh.`,
  });
  const help = () => ({
    title: 'Closed',
    text: `${about(FACES).text} With a thickness the shell is closed.`,
  });
  return h(
    'div',
    {
      class: 'section solid',
      role: 'group',
      'aria-label': 'Solid',
      hidden: () =>
        engine.field.value?.model?.beyond_share === 0 || Boolean(engine.field.value?.image || engine.field.value?.mesh),
    },
    h(
      'div',
      { class: 'section-head', hidden: () => !engine.field.value?.model },
      explain(beyond, () => about(BEYOND), { side: 'above' }),
    ),
    h(
      'div',
      { class: 'section-head', hidden: () => Boolean(engine.field.value?.model) },
      explain(closed, help, { side: 'above' }),
      explain(periodic, () => ({ ...about(CELL), title: 'Periodic' }), { side: 'above' }),
      explain(thickness, aboutThickness, { side: 'above' }),
    ),
    h('p', { class: 'fault-line', id: told, role: 'alert', hidden: () => wrong.value === '' }, () =>
      marked(wrong.value),
    ),
  );
}
