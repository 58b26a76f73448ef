/** The sampling panel: the kind of sampling, the actions, the progress, and the settings that the core describes. */
import { computed } from '@preact/signals-core';
import { fill, h, live, once, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { plural } from '../format.js';
import { createSetting } from './setting.js';
import { arrange, countChanged } from './settings.js';

/**
 * @import { Description, Engine, SettingInfo } from '../../engine/types.js'
 * @import { ReadonlySignal } from '@preact/signals-core'
 */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {Description} description
 * @param {{ head: HTMLElement[] }} extras buttons at the end of the first line
 */
export function mountSampling(body, engine, { settings }, { head }) {
  const { kind, plain, advanced } = arrange(settings);
  const create = (/** @type {SettingInfo} */ info) => createSetting(engine, settings, info);
  const more = createAdvanced(engine, settings, advanced, create);
  fill(
    body,
    createTrack(engine),
    h('div', { class: 'sampling-head' }, kind ? create(kind) : null, createActions(engine), head),
    h('div', { class: 'settings', role: 'group', 'aria-label': 'Settings' }, plain.map(create), more.button),
    more.section,
  );
}

/** Creates the progress bar. @param {Engine} engine */
function createTrack({ busy, reveal, progress, loading }) {
  // The bar follows the reveal of the picture while it lasts, and otherwise the run.
  const growing = computed(() => busy.value || reveal.value !== null || loading.value !== null);
  const fraction = computed(() => {
    if (loading.value) return loading.value.fraction;
    const { particles, fraction: done } = progress.value;
    const share = reveal.value ? reveal.value.particles / Math.max(1, particles) : busy.value ? done : 0;
    return Math.round(Math.min(1, share) * 200) / 200;
  });
  const track = h('div', {
    class: 'progress',
    role: 'progressbar',
    'aria-label': 'Sampling',
    'aria-valuemin': 0,
    'aria-valuemax': 100,
    'aria-valuenow': () => Math.round(fraction.value * 100),
    data: { busy: () => growing.value },
  });
  live(track, () => track.style.setProperty('--fraction', String(fraction.value)));
  return track;
}

/** @param {Engine} engine */
function createActions(engine) {
  const { busy } = engine;
  const stoppable = computed(() => busy.value || engine.loading.value !== null);
  const always = computed(() => true);
  const some = computed(() => engine.progress.value.particles > 0);
  return h('div', { class: 'actions', role: 'group', 'aria-label': 'Run' }, [
    action('Run', 'Samples the surface from its first particle. Key R.', () => engine.run(), always, 'primary in-tabs'),
    action(
      'Stop',
      'Ends the run and keeps the particles placed so far. Key Escape.',
      () => engine.stop(),
      stoppable,
      'in-tabs',
    ),
    action(
      'Generate only',
      'Places the particles level by level and leaves them unrelaxed. Key G.',
      () => engine.generateOnly(),
      always,
    ),
    action(
      'Relax one step',
      'Moves the present particles one relaxation step further. Key E.',
      () => engine.relax(1),
      computed(() => some.value && !busy.value),
    ),
  ]);
}

/**
 * @param {string} label
 * @param {string} help
 * @param {() => void} act
 * @param {ReadonlySignal<boolean>} enabled
 * @param {string} [kind]
 */
function action(label, help, act, enabled, kind = '') {
  const press = once(act);
  // The button stays focusable while it is disabled, so that keyboard users do not lose their position.
  const button = h(
    'button',
    {
      type: 'button',
      class: `button ${kind}`,
      'aria-disabled': () => (enabled.value ? null : 'true'),
      on: {
        click: () => {
          if (enabled.peek()) press();
        },
      },
    },
    label,
  );
  explain(button, () => ({ text: help }), { side: 'above' });
  return button;
}

/**
 * Creates the advanced settings behind a button that shows how many of them were changed.
 * @param {Engine} engine
 * @param {SettingInfo[]} all
 * @param {SettingInfo[]} advanced
 * @param {(info: SettingInfo) => HTMLElement} create
 */
function createAdvanced(engine, all, advanced, create) {
  const id = uniqueId('advanced');
  const section = h(
    'div',
    { class: 'settings advanced', id, role: 'group', 'aria-label': 'Advanced settings', hidden: true },
    advanced.map(create),
  );
  const count = computed(() => countChanged(advanced, all, engine.state.value.settings));
  const changed = h('span', { class: 'unit', hidden: () => count.value === 0 }, () => `${count.value} changed`);
  const button = h(
    'button',
    {
      type: 'button',
      class: 'button plain disclose',
      'aria-controls': id,
      'aria-expanded': 'false',
      on: {
        click: () => {
          section.hidden = !section.hidden;
          button.setAttribute('aria-expanded', String(!section.hidden));
        },
      },
    },
    'Advanced',
    changed,
  );
  explain(
    button,
    () => ({
      text: count.peek()
        ? `${plural(count.peek(), 'setting')} changed. A double click on a slider takes its default back.`
        : 'Settings that few need.',
    }),
    { side: 'above' },
  );
  button.hidden = advanced.length === 0;
  return { button, section };
}
