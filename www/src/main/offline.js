/**
 * Makes the page work without a network, and says when there is a new version of it. The service worker fetches all
 * files of the site, so it starts when the first surface is there and nothing else is to be done.
 */
import { effect } from '@preact/signals-core';

/**
 * @import { Engine } from '../engine/types.js'
 * @import { Toast } from '../ui/types.js'
 */

const SCRIPT = './service-worker.js';
/** Longest time for which an idle moment is awaited. */
const PATIENCE_MS = 10_000;
/**
 * Time after which a page that is looked at again asks for a new version. A browser asks by itself whenever a page is
 * loaded.
 */
const ASK_MS = 3_600_000;

/** @param {Engine} engine @param {Toast} toast */
export function keepOffline(engine, toast) {
  // The development server has its files from the sources.
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return;
  const stop = effect(() => {
    if (engine.busy.value || (engine.report.value === null && !engine.empty.value)) return;
    queueMicrotask(() => stop());
    const begin = () =>
      start(toast).catch((error) => console.warn(`The page will not work without a network: ${error}`));
    if ('requestIdleCallback' in window) requestIdleCallback(begin, { timeout: PATIENCE_MS });
    else setTimeout(begin, 1000);
  });
}

/** @param {Toast} toast */
async function start(toast) {
  const { serviceWorker } = navigator;
  const isFirst = serviceWorker.controller === null;
  const registration = await serviceWorker.register(SCRIPT);

  /** Whether this page has asked the new version to take over. */
  let isAsked = false;
  const offer = () => {
    const { waiting } = registration;
    if (!waiting || !serviceWorker.controller) return;
    tell(toast, 'There is a new version of this page.', () => {
      isAsked = true;
      waiting.postMessage('take over');
    });
  };
  offer();
  registration.addEventListener('updatefound', () => registration.installing?.addEventListener('statechange', offer));

  let isOld = !isFirst;
  serviceWorker.addEventListener('controllerchange', () => {
    if (isAsked) location.reload();
    // Another page of this site has asked. This one goes on with what it has loaded.
    else if (isOld)
      tell(toast, 'There is a new version of this page. This one is no longer stored.', () => location.reload());
    isOld = true;
  });

  let askedMs = performance.now();
  document.addEventListener('visibilitychange', () => {
    if (document.hidden || performance.now() - askedMs < ASK_MS) return;
    askedMs = performance.now();
    // Without a network there is no answer, which changes nothing.
    registration.update().catch(() => {});
  });
}

/** @param {Toast} toast @param {string} text @param {() => void} reload */
const tell = (toast, text, reload) =>
  toast({ id: 'version', kind: 'info', text, action: { label: 'Reload', run: reload } });
