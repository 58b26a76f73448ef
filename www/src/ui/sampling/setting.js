/** Creates the control of one setting from the core's description. */
import { computed, signal } from '@preact/signals-core';
import { button } from '../button.js';
import { h, live, marked, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatSignificant } from '../format.js';
import { wantsSlider } from '../scale.js';
import { createSegmented } from '../segmented.js';
import { createSelect } from '../select.js';
import { createSlider } from '../slider.js';
import { isSegmented, isShown } from './settings.js';

/**
 * @import { Engine, ReadonlySignal, SettingInfo } from '../../engine/types.js'
 * @import { createPaint } from './paint.js'
 */

/**
 * @param {Engine} engine
 * @param {SettingInfo[]} all
 * @param {SettingInfo} info
 * @param {ReturnType<typeof createPaint> | null} [paint]  what stands beside the box of a text
 */
export function createSetting(engine, all, info, paint = null) {
  const value = computed(() => engine.state.value.settings[info.name] ?? info.default);
  const label = h(
    'span',
    { class: 'setting-label' },
    info.label,
    info.unit ? h('span', { class: 'unit' }, ` ${info.unit}`) : null,
  );
  const create = { choice: createChoice, text: createText }[String(info.kind)] ?? createNumber;
  const control = create(engine, info, value, paint);
  const holds = computed(() => isShown(info, all, engine.state.value.settings));
  const element = h(
    'div',
    { class: 'setting', hidden: () => !holds.value, data: { setting: info.name, kind: kindOf(info) } },
    label,
    control,
  );
  const help = () => ({ title: info.label, text: `${info.help}${defaultOf(info)}` });
  // The popover is above, since below it would cover the next row.
  explain(element, help, { side: 'above' });
  // Touch has no hover, so a tap on the label shows the explanation.
  explain(label, help, { tap: true, side: 'above' });
  return element;
}

/** Returns the sentence on the value that a setting has by itself. @param {SettingInfo} info */
function defaultOf({ kind, choices, unit, default: own }) {
  if (kind === 'text') return '';
  if (kind === 'choice') return ` Default: ${choices?.find(({ value }) => value === own)?.label}.`;
  return ` Default: ${inWords({ kind, unit }, Number(own))}.`;
}

/** Returns a value in words, with its unit. @param {Pick<SettingInfo, 'kind' | 'unit'>} info @param {number} value */
const inWords = ({ kind, unit }, value) =>
  `${kind === 'integer' ? formatCount(value) : formatSignificant(value * (unit === '%' ? 100 : 1))}${unit ? ` ${unit}` : ''}`;

/** @param {SettingInfo} info */
const kindOf = (info) =>
  isSegmented(info)
    ? 'segmented'
    : info.kind === 'choice' || info.kind === 'text'
      ? info.kind
      : wantsSlider(info)
        ? 'slider'
        : 'number';

/**
 * @param {Engine} engine
 * @param {SettingInfo} info
 * @param {ReadonlySignal<number | string>} value
 */
function createChoice(engine, info, value) {
  const options = {
    name: info.label,
    choices: info.choices ?? [],
    value: () => String(value.value),
    change: (/** @type {string} */ next) => engine.setSetting(info.name, next),
  };
  if (isSegmented(info)) return createSegmented(options);
  return createSelect(options);
}

/**
 * @param {Engine} engine
 * @param {SettingInfo} info
 * @param {ReadonlySignal<number | string>} value
 */
function createNumber(engine, info, value) {
  const integer = info.kind === 'integer';
  const factor = info.unit === '%' ? 100 : 1;
  const slider = createSlider({
    name: info.label,
    scale: { min: info.min, max: info.max, step: info.step, scale: info.scale, integer },
    value: () => Number(value.value),
    factor,
    describe: (now) => inWords(info, now),
    change: (now, live) => engine.setSetting(info.name, now, { live }),
    reset: () => engine.resetSetting(info.name),
    read: engine.readNumber,
  });
  return h('div', { class: 'setting-line' }, wantsSlider(info) && slider.range, slider.box);
}

/**
 * Creates the text box of a formula, which the core checks before it is used.
 * @param {Engine} engine
 * @param {SettingInfo} info
 * @param {ReadonlySignal<number | string>} value
 * @param {ReturnType<typeof createPaint> | null} paint
 */
function createText(engine, info, value, paint) {
  const wrong = signal('');
  const told = uniqueId(info.name);
  const box = h('input', {
    type: 'text',
    class: 'box formula-box',
    placeholder: 'none',
    autocomplete: 'off',
    autocapitalize: 'off',
    spellcheck: false,
    'aria-label': info.label,
    'aria-describedby': told,
    'aria-invalid': () => String(wrong.value !== ''),
    on: { change: () => void commit() },
  });
  async function commit() {
    const text = box.value.trim();
    wrong.value = text === '' ? '' : ((await engine.textFault('spacing', text)) ?? '');
    if (wrong.value !== '') return;
    if (text === '') engine.resetSetting(info.name);
    else engine.setSetting(info.name, text);
  }
  live(box, () => {
    box.value = String(value.value);
    wrong.value = '';
  });
  const isShown = () => engine.state.value.view.colour === 'radius';
  const colour = button(
    {
      class: 'plain small',
      hidden: () => (value.value === '' && !paint?.isSeen()) || isShown(),
      press: () => engine.setView({ colour: 'radius' }),
    },
    'Show as colours',
  );
  return h(
    'div',
    { class: 'setting-text' },
    h('div', { class: 'setting-line' }, box, paint?.paint),
    h('div', { class: 'setting-more' }, paint?.clear, colour),
    h('p', { class: 'fault-line', id: told, role: 'alert', hidden: () => wrong.value === '' }, () =>
      marked(wrong.value),
    ),
  );
}
