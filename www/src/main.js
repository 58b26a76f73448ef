/** The page: an engine, and the interface over it. */
import './ui/trusted.js';
import { createEngine } from './engine/index.js';
import { mountInterface } from './ui/app.js';
import { byId } from './ui/dom.js';

const engine = createEngine({ canvasHost: byId('canvas-host') });
let mounted = false;
const mount = () => {
  if (!mounted) mountInterface(engine);
  mounted = true;
};
// The interface is measured; WebKit does not hold scripts back until the style sheet has come. Where it does not come, the window's
// load tells. (Not awaited: an entry that waits is cut into many small files.)
const link = /** @type {HTMLLinkElement | null} */ (document.querySelector('link[rel="stylesheet"]'));
if (!link || link.sheet || document.readyState === 'complete') {
  mount();
} else {
  link.onload = mount;
  addEventListener('load', mount);
}
