/** Shows the caption and the hint on the picture, has the empty state shown, and hides the poster. */

import { computed } from '@preact/signals-core';
import { h, live } from '../dom.js';
import { explain } from '../explain.js';
import { verdictOf } from '../mesh-words.js';
import { createTrack } from '../track.js';
import { captionOf, loadingOf, revealOf } from './caption.js';
import { createKept } from './kept.js';

/**
 * @import { Engine, ReadonlySignal } from '../../engine/types.js'
 * @import { OverlayParts } from './types.js'
 */

const HINT_MS = 9000;
/** Shortest interval between announcements of a run to assistive technology. */
const ANNOUNCE_MS = 3000;

/**
 * @param {HTMLElement} view
 * @param {Engine} engine
 * @param {OverlayParts} parts
 */
export function mountOverlay(view, engine, { stage, poster, start, told }) {
  const hint = h('p', { class: 'hint' }, 'Drag to turn');
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
  // An error in the formula is shown beside the formula instead.
  const lost = computed(() => engine.result.value === 'none' && engine.fieldError.value === null);
  const empty = h('div', { class: 'empty', role: 'status', hidden: () => !lost.value });
  import('./empty.js').then(
    ({ fillEmpty }) => fillEmpty(empty, engine, lost),
    () => {},
  );
  const text = computed(() =>
    told.value
      ? told.value.title
      : engine.reveal.value
        ? revealOf(engine.reveal.value)
        : captionOf(engine.progress.value, {
            partial: engine.result.value === 'partial',
            empty: engine.result.value === 'none',
            busy: engine.status.value === 'sampling',
            seconds: engine.timing.value?.sampling ?? null,
            steps: engine.timing.value?.steps ?? 0,
          }),
  );
  // The field panel announces the loading.
  const mesh = computed(() => (told.value ? '' : meshOf(engine)));
  const whole = computed(() => [text.value, told.value?.text, mesh.value].filter(Boolean).join('. '));
  // The panel of the mesh covers these, and shows the same.
  const isAlone = () => engine.meshing.value === null;
  const caption = h('p', { class: 'caption', 'aria-hidden': 'true', hidden: () => !isAlone() });
  view.append(
    empty,
    h('div', { class: 'foot' }, createKept(engine, isAlone), createChip(engine), caption, hint),
    // In a frame of another page no panel shows the progress.
    h('div', { class: 'framed-track' }, createTrack(engine)),
    spoken,
  );
  caption.append(
    h('span', null, () => (engine.loading.value ? loadingOf(engine.loading.value) : text.value)),
    h('span', { class: 'detail' }, () => (engine.loading.value ? '' : told.value?.text)),
    h('span', { class: 'detail joined' }, () => (engine.loading.value ? '' : mesh.value)),
  );
  announce(
    spoken,
    whole,
    computed(() => engine.status.value === 'sampling' || engine.reveal.value !== null),
  );

  // The poster is shown until the first particles are drawn.
  const drawn = computed(
    () => engine.frame.value > 0 && engine.progress.value.particles > 0 && engine.reveal.value?.particles !== 0,
  );
  const settled = computed(() => drawn.value || engine.result.value === 'none');
  live(poster, () => poster.classList.toggle('gone', poster.matches('.gone') || settled.value));
  live(start, () => {
    if (settled.value || engine.description.value || engine.notice.value?.id === 'load') start.hidden = true;
  });
  hintUntilUsed(hint, stage, settled);
}

/** Creates the chip that says that no graphics card draws. @param {Engine} engine */
const createChip = ({ backend }) =>
  explain(h('p', { class: 'chip', hidden: () => backend.value !== 'canvas2d' }, 'No graphics card'), () => ({
    text: 'The processor paints the picture, with fewer pixels while it moves. Particles and files are the same.',
  }));

/** Returns the text about the mesh while it is drawn. @param {Engine} engine */
function meshOf(engine) {
  if (engine.state.value.view.draw !== 'mesh' || engine.result.value === 'none') return '';
  const mesh = engine.mesh.value;
  return mesh && engine.status.value !== 'sampling' && !engine.reveal.value ? verdictOf(mesh) : '';
}

/**
 * @param {HTMLElement} hint
 * @param {HTMLElement} stage
 * @param {ReadonlySignal<boolean>} settled
 */
function hintUntilUsed(hint, stage, settled) {
  const end = () => {
    hint.classList.add('gone');
    stage.removeEventListener('pointerdown', end);
  };
  stage.addEventListener('pointerdown', end);
  live(hint, () => {
    if (!settled.value || hint.matches('.shown')) return;
    hint.classList.add('shown');
    setTimeout(end, HINT_MS);
  });
}

/**
 * Announces the caption at most once per interval, and always at the end of a run.
 * @param {HTMLElement} spoken
 * @param {ReadonlySignal<string>} text
 * @param {ReadonlySignal<boolean>} busy
 */
function announce(spoken, text, busy) {
  let last = -Infinity;
  let timer = 0;
  const say = () => {
    last = performance.now();
    spoken.textContent = text.peek();
  };
  live(spoken, () => {
    void text.value;
    clearTimeout(timer);
    const wait = busy.value ? Math.max(0, last + ANNOUNCE_MS - performance.now()) : 300;
    timer = window.setTimeout(say, wait);
  });
}
