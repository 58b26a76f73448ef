/**
 * Makes the page work without a network, and announces new versions of it. The service worker fetches all files of the
 * site, so it starts only once the first surface is sampled and the page is idle.
 */
import { effect } from '@preact/signals-core';
import { storeSite } from '../ui/offline.js';

/**
 * @import { Engine } from '../engine/types.js'
 * @import { Toast } from '../ui/types.js'
 */

/**
 * A page that is looked at again after this time asks for a new version. Browsers themselves ask only when a page is
 * loaded.
 */
const ASK_MS = 3_600_000;

/** @param {Engine} engine @param {Toast} toast */
export function keepOffline(engine, toast) {
  const stop = effect(() => {
    if (engine.status.value === 'sampling' || (engine.report.value === null && engine.result.value !== 'none')) return;
    queueMicrotask(() => stop());
    storeSite('./service-worker.js', (registration, isFirst) => follow(registration, isFirst, toast));
  });
}

/**
 * Announces a new version, and asks for one now and then.
 * @param {ServiceWorkerRegistration} registration @param {boolean} isFirst @param {Toast} toast
 */
function follow(registration, isFirst, toast) {
  const { serviceWorker } = navigator;
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
    // Another page of this site has asked for the new version. This page keeps running with the files it has loaded.
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
