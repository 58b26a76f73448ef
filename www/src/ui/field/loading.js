/** Shows the progress of a model or a file that is loading, a Cancel button, and advice after a refusal. */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { formatShare } from '../format.js';
import { describeLoadingError } from './files.js';

/** @import { Engine } from '../../engine/types.js' */

/** Step of the progress that is announced to assistive technology. */
const SPOKEN_SHARE = 0.25;

/** @param {Engine} engine */
export function createLoading(engine) {
  const title = h('h2');
  const stage = h('p', { class: 'quiet load-stage', 'aria-hidden': 'true' });
  const bar = h('div', { class: 'load-bar', role: 'progressbar', 'aria-valuemin': 0, 'aria-valuemax': 100 });
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' });
  const cancel = h(
    'button',
    { type: 'button', class: 'button small', on: { click: () => engine.cancelLoading() } },
    'Cancel',
  );
  const working = h(
    'div',
    { class: 'section loading' },
    h('div', { class: 'section-head' }, title, cancel),
    bar,
    stage,
  );
  const refused = h('div', { class: 'section refused', role: 'group' });

  const name = computed(() => engine.loading.value?.name ?? null);
  effect(() => {
    const present = name.value;
    // The Cancel button disappears, so the focus moves to the button that opens a file.
    if (present === null && document.activeElement === cancel)
      /** @type {HTMLElement | null} */ (document.querySelector('.open-file'))?.focus();
    working.hidden = present === null;
    title.textContent = present ?? '';
    bar.setAttribute('aria-label', `Loading ${present ?? ''}`);
  });
  effect(() => {
    const loading = engine.loading.value;
    if (!loading) return;
    bar.style.setProperty('--fraction', loading.fraction.toFixed(3));
    bar.setAttribute('aria-valuenow', String(Math.round(loading.fraction * 100)));
    bar.setAttribute('aria-valuetext', `${loading.label}, ${formatShare(loading.fraction, 0)}`);
    fill(stage, h('span', null, loading.label), h('span', { class: 'unit' }, formatShare(loading.fraction, 0)));
  });
  const heard = computed(() => {
    const {
      loading: { value: loading },
      loadingError: { value: error },
    } = engine;
    if (loading)
      return `${loading.name}: ${loading.label}, ${formatShare(Math.floor(loading.fraction / SPOKEN_SHARE) * SPOKEN_SHARE, 0)}`;
    if (!error) return '';
    const { title: what, line, text } = describeLoadingError(error);
    return [what, line, text].filter(Boolean).join('. ');
  });
  effect(() => {
    spoken.textContent = heard.value;
  });
  effect(() => {
    const error = engine.loadingError.value;
    refused.hidden = error === null;
    if (!error) return fill(refused);
    const { title: what, line, text, advice } = describeLoadingError(error);
    refused.setAttribute('aria-label', what);
    fill(
      refused,
      h('h2', null, what),
      h('p', null, line ? h('strong', null, `${line}: `) : null, text),
      h('p', { class: 'quiet' }, advice, advice ? ' ' : '', 'The surface before it stays.'),
      h(
        'div',
        { class: 'repairs' },
        h(
          'button',
          {
            type: 'button',
            class: 'button small',
            on: { click: () => /** @type {HTMLElement | null} */ (document.querySelector('.open-file'))?.click() },
          },
          'Choose another file',
        ),
      ),
    );
  });
  return [working, refused, spoken];
}
