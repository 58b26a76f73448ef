/** Has the site's service worker store all of it, so that the lesson works without a network, too. */

const SCRIPT = '../service-worker.js';
const PATIENCE_MS = 10_000;

export function keepOffline() {
  if (!import.meta.env.PROD || !('serviceWorker' in navigator)) return;
  const begin = () =>
    navigator.serviceWorker
      .register(SCRIPT)
      .catch((error) => console.warn(`The page will not work without a network: ${error}`));
  if ('requestIdleCallback' in window) requestIdleCallback(begin, { timeout: PATIENCE_MS });
  else addEventListener('load', begin);
}
