/** Shows the progress of a model or a file that is loading, a Cancel button, and advice after a refusal. */
import { computed } from '@preact/signals-core';
import { button } from '../button.js';
import { h, live, query } from '../dom.js';
import { formatShare } from '../format.js';
import { describeLoadingError } from './files.js';

/** @import { Engine } from '../../engine/types.js' */

/** Step of the progress that is announced to assistive technology. */
const SPOKEN_SHARE = 0.25;

/** The button that opens a file. */
const opener = () => query(document, '.open-file');

/** @param {Engine} engine */
export function createLoading(engine) {
  const name = computed(() => engine.loading.value?.name ?? null);
  const cancel = button({ class: 'small', press: () => engine.cancelLoading() }, 'Cancel');
  const working = h(
    'div',
    { class: 'section loading', hidden: () => name.value === null },
    h(
      'div',
      { class: 'section-head' },
      h('h2', null, () => name.value),
      cancel,
    ),
    createBar(engine.loading),
  );
  live(working, () => {
    // It may be out of sight below the gallery.
    if (name.value !== null) queueMicrotask(() => working.scrollIntoView({ block: 'nearest' }));
    // The Cancel button disappears, so the focus moves to the button that opens a file.
    if (name.value === null && document.activeElement === cancel) opener().focus();
  });
  const heard = computed(() => {
    const [loading, error] = [engine.loading.value, engine.loadingError.value];
    if (loading) {
      const share = Math.floor(loading.fraction / SPOKEN_SHARE) * SPOKEN_SHARE;
      return `${loading.name}: ${loading.label}, ${formatShare(share, 0)}`;
    }
    if (!error) return '';
    const { title, text } = describeLoadingError(error);
    return `${title}. ${text}`;
  });
  const spoken = h('p', { class: 'visually-hidden', role: 'status', 'aria-live': 'polite' }, () => heard.value);
  return [working, createRefusal(engine.loadingError), spoken];
}

/** Creates the bar and the line about the stage. They keep their last content. @param {Engine['loading']} present */
function createBar(present) {
  let last = present.peek();
  const loading = computed(() => {
    last = present.value ?? last;
    return last;
  });
  const fraction = () => loading.value?.fraction ?? 0;
  const share = () => formatShare(fraction(), 0);
  const bar = h('div', {
    class: 'load-bar',
    role: 'progressbar',
    'aria-valuemin': 0,
    'aria-valuemax': 100,
    'aria-label': () => `Loading ${loading.value?.name ?? ''}`,
    'aria-valuenow': () => Math.round(fraction() * 100),
    'aria-valuetext': () => loading.value && `${loading.value.label}, ${share()}`,
    style: { '--fraction': () => fraction().toFixed(3) },
  });
  const stage = h('p', { class: 'quiet load-stage', 'aria-hidden': 'true' }, () => [
    h('span', null, loading.value?.label),
    h('span', { class: 'unit' }, share()),
  ]);
  return [bar, stage];
}

/** Creates the message after a refusal. @param {Engine['loadingError']} error */
function createRefusal(error) {
  const told = computed(() => error.value && describeLoadingError(error.value));
  const refusal = h(
    'div',
    {
      class: 'section refused',
      role: 'group',
      hidden: () => told.value === null,
      'aria-label': () => told.value?.title,
    },
    () =>
      told.value && [
        h('h2', null, told.value.title),
        h('p', null, told.value.text),
        h('p', { class: 'quiet' }, told.value.advice, told.value.advice ? ' ' : '', 'The surface before it stays.'),
        h(
          'div',
          { class: 'repairs' },
          button({ class: 'small', press: () => opener().click() }, 'Choose another file'),
        ),
      ],
  );
  live(refusal, () => {
    if (told.value) queueMicrotask(() => refusal.scrollIntoView({ block: 'nearest' }));
  });
  return refusal;
}
