/**
 * Entry point of the page: creates the engine, connects it to the address and the console, and mounts the interface on
 * it. ARCHITECTURE.md defines the words of the page.
 */
import '../ui/trusted.js';
import { createEngine } from '../engine/index.js';
import { BACKENDS } from '../engine/view/backends.js';
import { mountInterface } from '../ui/app.js';
import { byId } from '../ui/dom.js';
import { keepAddress } from './address.js';
import { createConsole } from './console.js';
import { keepOffline } from './offline.js';

const query = new URLSearchParams(location.search);
const wanted = query.get('backend');
const backend = BACKENDS.find((kind) => kind === wanted) ?? null;
const engine = createEngine({ host: byId('canvas-host'), link: location.hash, backend });
const p = createConsole(engine);
Object.assign(window, { marchingParticles: p });
const parts = query.get('embed');
// In a frame, Back belongs to the page around it.
keepAddress(engine, { hasEntries: parts === null });
if (parts !== null) {
  // Hidden at once, so that the panels do not flash before the rest is loaded.
  byId('shell').dataset.hidden = 'all';
  void import('./embed.js').then(({ embed }) => embed(p, parts));
}

let mounted = false;
const mount = () => {
  if (!mounted) keepOffline(engine, mountInterface(engine, { grabs: query.has('grab') }));
  mounted = true;
};
// The interface measures its elements, so it needs the style sheet, and WebKit does not delay scripts until it has
// loaded. If the style sheet fails, the window's load event starts the interface. (A top-level await would make the
// bundler split the entry into many small files.)
const link = /** @type {HTMLLinkElement | null} */ (document.querySelector('link[rel="stylesheet"]'));
if (!link || link.sheet || document.readyState === 'complete') {
  mount();
} else {
  link.onload = mount;
  addEventListener('load', mount);
}
