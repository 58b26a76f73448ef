/** Makes the site's service worker store the whole site, so that the pages work without a network. */

/** Longest wait for an idle moment. */
const PATIENCE_MS = 10_000;

/**
 * Registers the service worker at the next idle moment, because it fetches all files of the site. As soon as it is
 * active, it serves this page, too.
 *
 * The page asks for that, and the worker does not take over every page by itself: in WebKit a request that has begun
 * just before never ends, and a page that is loading has begun many.
 * @param {string} script
 * @param {(registration: ServiceWorkerRegistration, isFirst: boolean) => void} [then]  `isFirst`: no version was stored
 */
export function storeSite(script, then = () => {}) {
  // The development server serves the source files themselves.
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
