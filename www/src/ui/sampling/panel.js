/** The sampling panel: the kind of sampling, the actions, the progress, and the settings that the core describes. */
import { computed, signal } from '@preact/signals-core';
import { patternOf, unrelaxed } from '../../engine/patterns.js';
import { button } from '../button.js';
import { fill, h, once, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { plural } from '../format.js';
import { createTrack } from '../track.js';
import { createPaint } from './paint.js';
import { createSetting } from './setting.js';
import { arrange, countChanged, isDue } from './settings.js';

/**
 * @import { Description, Engine, SettingInfo } from '../../engine/types.js'
 * @import { Brush, ButtonProps } from '../types.js'
 */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {Description} description
 * @param {{ head: HTMLElement[], brush: Brush }} extras `head`: buttons at the end of the first line
 */
export function mountSampling(body, engine, { settings }, { head, brush }) {
  const { kind, plain, advanced } = arrange(settings);
  const create = (/** @type {SettingInfo} */ info) =>
    createSetting(engine, settings, info, info.name === 'spacing' ? createPaint(engine, brush) : null);
  const [more, section] = createAdvanced(engine, settings, advanced, create);
  fill(
    body,
    createTrack(engine),
    h(
      'div',
      { class: 'sampling-head' },
      h('h2', { class: 'sampling-title fold-title' }, 'Sampling'),
      kind ? create(kind) : null,
      createActions(engine),
      head,
    ),
    h('div', { class: 'settings', role: 'group', 'aria-label': 'Settings' }, plain.map(create), more),
    section,
  );
}

/** @param {Engine} engine */
function createActions(engine) {
  const { status, loading, progress } = engine;
  const due = isDue(engine);
  const idle = () => status.value !== 'sampling' && loading.value === null;
  /** Why the present particles, and those of the next run, are not relaxed; empty if they can be. */
  const pinned = computed(() => {
    void engine.revision.value;
    return unrelaxed(engine.columns.pattern);
  });
  const stiff = computed(() => unrelaxed(patternOf(engine.state.value.settings)));
  const fixed = () => status.value === 'sampling' || progress.value.particles === 0 || pinned.value !== '';
  /** @type {[string, string | (() => string), ButtonProps][]} */
  const actions = [
    [
      'Run',
      'Samples the surface from its first particle. Key R.',
      { class: () => (due.value ? 'primary in-tabs due' : 'in-tabs'), press: () => engine.run() },
    ],
    [
      'Stop',
      'Ends the run and keeps the particles placed so far. Key Escape.',
      { class: () => (idle() ? 'in-tabs' : 'in-tabs works'), off: idle, press: () => engine.stop() },
    ],
    [
      'Without relaxing',
      () => stiff.value || 'Places the particles level by level and leaves them unrelaxed. Key G.',
      { off: () => stiff.value !== '', press: () => engine.generateOnly() },
    ],
    [
      'Relax one step',
      () => pinned.value || 'Moves the present particles one relaxation step further. Key E.',
      { off: fixed, press: () => engine.relax(1) },
    ],
  ];
  return h(
    'div',
    { class: 'actions', role: 'group', 'aria-label': 'Run' },
    actions.map(([label, text, { press = () => {}, ...props }]) =>
      explain(
        button({ ...props, press: once(press) }, label),
        () => ({ text: text instanceof Function ? text() : text }),
        { side: 'above' },
      ),
    ),
  );
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
  const isOpen = signal(false);
  const section = h(
    'div',
    { class: 'settings advanced', id, role: 'group', 'aria-label': 'Advanced settings', hidden: () => !isOpen.value },
    advanced.map(create),
  );
  const count = computed(() => countChanged(advanced, all, engine.state.value.settings));
  const changed = h('span', { class: 'unit', hidden: () => count.value === 0 }, () => `${count.value} changed`);
  const more = explain(
    button(
      {
        class: 'plain disclose',
        hidden: advanced.length === 0,
        'aria-controls': id,
        'aria-expanded': () => String(isOpen.value),
        press: () => {
          isOpen.value = !isOpen.peek();
        },
      },
      'Advanced',
      changed,
    ),
    () => ({
      text: count.peek()
        ? `${plural(count.peek(), 'setting')} changed. A double click on a slider takes its default back.`
        : 'Settings that few need.',
    }),
    { side: 'above' },
  );
  return [more, section];
}
