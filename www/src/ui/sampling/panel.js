/** The sampling bar: what to do, how far it is, and the settings that the core describes. */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { explain } from '../explain.js';
import { createSetting } from './setting.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 * @param {{ head: HTMLElement[] }} extras buttons at the end of the first line
 */
export function mountSampling(body, engine, description, { head }) {
  const busy = engine.busy;
  const some = computed(() => engine.progress.value.particles > 0);
  // The bar follows the picture while that still grows, and the run otherwise.
  const growing = computed(() => busy.value || engine.reveal.value !== null);
  const fraction = computed(() => {
    const reveal = engine.reveal.value;
    const { particles, fraction: done } = engine.progress.value;
    const share = reveal ? reveal.particles / Math.max(1, particles) : busy.value ? done : 0;
    return Math.round(Math.min(1, share) * 200) / 200;
  });

  const track = h('div', { class: 'progress', role: 'progressbar', 'aria-label': 'Sampling', 'aria-valuemin': 0, 'aria-valuemax': 100 });
  effect(() => {
    track.style.setProperty('--fraction', String(fraction.value));
    track.dataset.busy = String(growing.value);
    track.setAttribute('aria-valuenow', String(Math.round(fraction.value * 100)));
  });

  const actions = h('div', { class: 'actions', role: 'group', 'aria-label': 'Run' }, [
    action('Run', 'Samples the surface from its first particle. Key R.', () => engine.run(), computed(() => true), 'primary in-tabs'),
    action('Stop', 'Ends the run and keeps the particles placed so far. Key Escape.', () => engine.stop(), busy, 'in-tabs'),
    action('Generate only', 'Places the particles level by level and leaves them unrelaxed. Key G.', () => engine.generateOnly(), computed(() => true)),
    action('Relax one step', 'Moves the present particles one relaxation step further. Key E.', () => engine.relax(1), computed(() => some.value && !busy.value)),
  ]);
  const settings = h('div', { class: 'settings', role: 'group', 'aria-label': 'Settings' }, description.settings.map((info) => createSetting(engine, info)));
  fill(body, track, h('div', { class: 'sampling-head' }, actions, head), settings);
}

/**
 * @param {string} label
 * @param {string} help
 * @param {() => void} act
 * @param {import('@preact/signals-core').ReadonlySignal<boolean>} enabled
 * @param {string} [kind]
 */
function action(label, help, act, enabled, kind = '') {
  // It stays focusable while it can do nothing, so that a keyboard user does not lose the place.
  const button = h('button', { type: 'button', class: `button ${kind}`, on: { click: () => { if (enabled.peek()) act(); } } }, label);
  effect(() => {
    if (enabled.value) button.removeAttribute('aria-disabled');
    else button.setAttribute('aria-disabled', 'true');
  });
  explain(button, () => ({ text: help }));
  return button;
}
