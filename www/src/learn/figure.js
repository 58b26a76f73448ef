/**
 * Replaces a still by a live figure once it comes near the window, and says what is missing if the figure cannot be
 * made.
 */
import { h } from '../ui/dom.js';
import { NoSurface } from './lab.js';

/** Distance from the window, in pixels, at which a figure is made. */
const AHEAD_PX = 500;

/** @param {HTMLElement} stage  holds the still @param {() => Promise<(Node | null)[]>} build */
export function mountFigure(stage, build) {
  const status = h('p', { class: 'figure-status', role: 'status' });
  stage.after(status);
  async function make() {
    stage.dataset.state = 'running';
    status.textContent = 'Running the algorithm on the surface';
    try {
      const parts = await build();
      stage.replaceChildren(...parts.filter((part) => part !== null));
      stage.dataset.state = 'live';
      status.textContent = '';
    } catch (error) {
      stage.dataset.state = 'still';
      status.textContent = `${reasonOf(error)} This is a still picture of the ellipsoid.`;
    }
  }
  whenNear(stage, make);
}

/** Acts once an element comes near the window. @param {Element} element @param {() => Promise<void>} act */
export function whenNear(element, act) {
  const observer = new IntersectionObserver(
    (entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      observer.disconnect();
      void act();
    },
    { rootMargin: `${AHEAD_PX}px 0px` },
  );
  observer.observe(element);
}

/** @param {any} error */
export function reasonOf(error) {
  if (error instanceof NoSurface) return error.message;
  switch (error?.kind) {
    case 'bundle':
      return 'The part of the page that runs the algorithm did not load. The text is complete without it.';
    case 'refused':
      return `The algorithm cannot run on this surface: ${error.message}.`;
    default:
      return `The figure stopped on an error: ${error instanceof Error ? error.message : String(error)}.`;
  }
}
