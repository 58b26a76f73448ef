/**
 * Moves the first slider a little, once, after the first surface of a first visit is sampled: the surface follows, and
 * a hint says what can be dragged. Any press or key ends it.
 */
import { computed, effect, signal } from '@preact/signals-core';
import { remembered } from '../remembered.js';
import { snap } from '../scale.js';

/** @import { Engine, Parameter, ReadonlySignal, Signal } from '../../engine/types.js' */

/** Duration of the motion, there and back, and its length as a share of the range. */
const MOTION_MS = 1800;
const SHARE = 0.14;
/** Pause before the motion. */
const PAUSE_MS = 1200;

/**
 * Returns the name of the parameter that the hint invites to drag; null before, after any input, and if the surface has
 * no such parameter.
 * @param {Engine} engine
 * @returns {ReadonlySignal<string | null>}
 */
export function inviteToDrag(engine) {
  const was = remembered('invited', false);
  /** @type {Signal<string | null>} */
  const invited = signal(null);
  const names = computed(() => engine.field.value?.parameters.map(({ name }) => name) ?? []);
  const shown = computed(() => (names.value.includes(invited.value ?? '') ? invited.value : null));
  if (was.peek() || matchMedia('(prefers-reduced-motion: reduce)').matches) return shown;
  const has = computed(
    () =>
      engine.report.value !== null &&
      engine.reveal.value === null &&
      engine.status.value !== 'sampling' &&
      engine.frame.value > 0,
  );
  let hasGrown = false;
  const end = effect(() => {
    hasGrown ||= engine.reveal.value !== null;
    const [first] = engine.field.value?.parameters ?? [];
    if (!hasGrown || !has.value || !first || Object.keys(engine.state.value.parameters).length > 0) return;
    const timer = setTimeout(() => {
      end();
      // A user who has touched anything needs no invitation.
      if (was.peek() || names.peek()[0] !== first.name) return;
      was.value = true;
      invited.value = first.name;
      move(engine, first);
    }, PAUSE_MS);
    // A run during the pause restarts the pause.
    return () => clearTimeout(timer);
  });
  const touch = () => {
    for (const type of ['pointerdown', 'keydown', 'wheel']) removeEventListener(type, touch, true);
    was.value = true;
    invited.value = null;
  };
  for (const type of ['pointerdown', 'keydown', 'wheel']) addEventListener(type, touch, true);
  return shown;

  /** @param {Engine} of @param {Parameter} parameter */
  function move(of, { name, value, min, max, step }) {
    const fromMs = performance.now();
    const way = (max - value > value - min ? 1 : -1) * SHARE * (max - min);
    const go = (/** @type {number} */ nowMs) => {
      const share = (nowMs - fromMs) / MOTION_MS;
      if (shown.peek() === null || share >= 1) return of.resetParameter(name);
      // As when a parameter is played, a run longer than a frame delays the next step.
      if (of.status.peek() !== 'sampling') {
        const place = value + way * Math.sin(Math.PI * Math.max(0, share)) ** 2;
        of.setParameter(name, snap({ min, max, step }, place), { live: true });
      }
      requestAnimationFrame(go);
    };
    requestAnimationFrame(go);
  }
}
