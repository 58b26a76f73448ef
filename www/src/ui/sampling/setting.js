/** One setting of the sampler as a control, from the core's description of it. */
import { computed, effect } from '@preact/signals-core';
import { h, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatSignificant } from '../format.js';
import { wantsSlider } from '../scale.js';
import { createSlider } from '../slider.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */
/** @typedef {import('../../engine/types.js').SettingInfo} SettingInfo */

/**
 * @param {Engine} engine
 * @param {SettingInfo} info
 */
export function createSetting(engine, info) {
  const value = computed(() => engine.state.value.settings[info.name] ?? info.default);
  const label = h('span', { class: 'setting-label' }, info.label, info.unit ? h('span', { class: 'unit' }, ` ${info.unit}`) : null);
  const control = info.kind === 'choice' ? createChoice(engine, info, value) : createNumber(engine, info, value);
  const element = h('div', { class: 'setting', data: { setting: info.name, kind: info.kind === 'choice' ? 'choice' : wantsSlider(info) ? 'slider' : 'number' } }, label, control);
  const help = () => ({ title: info.label, text: info.help });
  explain(element, help);
  // A finger cannot hover: it taps the name.
  explain(label, help, { tap: true });

  const conditions = [info.when ?? []].flat();
  const holds = computed(() => conditions.every(({ name, value: wanted, equal = true }) => {
    const now = engine.state.value.settings[name] ?? engine.description.value?.settings.find((other) => other.name === name)?.default;
    return (now === wanted) === equal;
  }));
  effect(() => { element.hidden = !holds.value; });
  return element;
}

/**
 * @param {Engine} engine
 * @param {SettingInfo} info
 * @param {import('@preact/signals-core').ReadonlySignal<number | string>} value
 */
function createChoice(engine, info, value) {
  const select = h(
    'select',
    { class: 'select', id: uniqueId('setting'), 'aria-label': info.label, on: { change: () => engine.setSetting(info.name, select.value) } },
    (info.choices ?? []).map((choice) => h('option', { value: choice.value }, choice.label)),
  );
  effect(() => { select.value = String(value.value); });
  return select;
}

/**
 * @param {Engine} engine
 * @param {SettingInfo} info
 * @param {import('@preact/signals-core').ReadonlySignal<number | string>} value
 */
function createNumber(engine, info, value) {
  const integer = info.kind === 'integer';
  const factor = info.unit === '%' ? 100 : 1;
  const slider = createSlider({
    name: info.label,
    scale: { min: info.min, max: info.max, step: info.step, scale: info.scale, integer },
    value: Number(value.peek()),
    factor,
    describe: (now) => `${integer ? formatCount(now) : formatSignificant(now * factor)}${info.unit ? ` ${info.unit}` : ''}`,
    change: (now, live) => engine.setSetting(info.name, now, { live }),
    reset: () => engine.resetSetting(info.name),
  });
  effect(() => slider.set(Number(value.value)));
  return h('div', { class: 'setting-line' }, wantsSlider(info) ? slider.range : null, slider.box);
}
