/**
 * The service worker, which makes the page work without a network: Workbox stores all files of a version and answers
 * from them.
 *
 * A page is answered from one version alone. The next one is stored beside it and waits until no page of the old one is
 * left, or until a page asks for it and loads again.
 *
 * @module
 */
import { precacheAndRoute } from 'workbox-precaching';

const worker = /** @type {any} */ (self);

// The build writes the files of the site here. Parameters of the address, such as `backend`, do not change a file.
precacheAndRoute(import.meta.env.SITE_FILES, { ignoreURLParametersMatching: [/./], cleanURLs: false });

worker.addEventListener('message', (/** @type {any} */ event) => {
  if (event.data === 'take over') worker.skipWaiting();
  // The page that has stored the first version works without a network at once, not only when it is loaded again.
  if (event.data === 'answer') event.waitUntil(worker.clients.claim());
});
