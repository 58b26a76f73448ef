/** Has the site's service worker store all of it, so that the pages work without a network. */

/** Longest time for which an idle moment is awaited. */
const PATIENCE_MS = 10_000;

/**
 * Registers the service worker at the next idle moment, because it fetches all files of the site, and has it answer
 * this page, too, as soon as it is active.
 *
 * The page asks for that, and the worker does not take every page over by itself: a request that WebKit has begun just
 * before a page is taken over never ends, and a page that loads has begun many.
 * @param {string} script
 * @param {(registration: ServiceWorkerRegistration, isFirst: boolean) => void} [then]  `isFirst`: no version was stored
 */
export function storeSite(script, then = () => {}) {
  // The development server has its files from the sources.
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return;
  const { serviceWorker } = navigator;
  const begin = async () => {
    const isFirst = serviceWorker.controller === null;
    try {
      const registration = await serviceWorker.register(script);
      then(registration, isFirst);
      if (isFirst) (await serviceWorker.ready).active?.postMessage('answer');
    } catch (error) {
      console.warn(`The page will not work without a network: ${error}`);
    }
  };
  if ('requestIdleCallback' in window) requestIdleCallback(begin, { timeout: PATIENCE_MS });
  else setTimeout(begin, 1000);
}
