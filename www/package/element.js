/**
 * The element `<marching-particles>`: a surface with one tag.
 *
 * @module
 */
import { homeView } from '../src/engine/share/view.js';
import { InputError } from './errors.js';
import { createView } from './view.js';

/** @import { BackendKind, View } from './view.js' */

/** The options that attributes stand for. @type {Record<string, (value: string) => unknown>} */
const OPTIONS = {
  count: (value) => numberOf('count', value),
  radius: (value) => value,
  method: (value) => value,
  seed: (value) => numberOf('seed', value),
  adaptive: () => true,
};
const VIEW = /** @type {const} */ (['colour', 'draw', 'theme']);
const TEXTS = [
  ...['formula', 'surface', 'params', 'backend', ...VIEW],
  ...Object.keys(OPTIONS).filter((name) => name !== 'adaptive'),
];
const FLAGS = ['adaptive', 'controls'];
/** A motion is over after this time without a change of `params`. */
const STILL_MS = 250;

const TWICE =
  'marching-particles/element is on this page twice, and the first one draws every <marching-particles>. Load one ' +
  'version of it, from one address.';

const SHEET = `:host { display: block; position: relative; aspect-ratio: 4 / 3; overflow: hidden; }
:host([hidden]) { display: none; }
div { position: absolute; inset: 0; }
div:focus-visible { outline: 2px solid Highlight; outline-offset: -2px; }
:host(:not([controls])) div { pointer-events: none; }
/* What takes longer than a moment shows how far it is. */
:host([aria-busy='true']) div::after {
  content: ''; position: absolute; inset: auto auto 0 0; height: 2px; width: calc(100% * var(--done, 0));
  background: CanvasText; opacity: 0; animation: shown 0s 0.4s forwards;
}
@keyframes shown { to { opacity: 0.4; } }`;
/** What a screen reader says about a picture with `controls`. */
const KEYS = 'Arrow keys turn it, plus and minus zoom.';

/** @param {string} name @param {string} value */
function numberOf(name, value) {
  const number = Number(value);
  if (value.trim() === '' || !Number.isFinite(number)) throw new InputError(`${name}="${value}": a number.`);
  return number;
}

/** Values of parameters, as in `a=0.5, b=2`. @param {string} text */
function paramsOf(text) {
  const pairs = text.split(',').filter((part) => part.trim() !== '');
  return Object.fromEntries(
    pairs.map((pair) => {
      const [name, value, ...more] = pair.split('=').map((part) => part.trim());
      if (!value || more.length > 0) throw new InputError(`params="${text}": names and numbers, as in a=0.5, b=2.`);
      return [name, numberOf(`params ${name}`, value)];
    }),
  );
}

// Node has no elements, but may import a module that imports this one.
const Base = globalThis.HTMLElement ?? class {};

/** A surface, sampled and drawn while it is near the visible part of the page. */
export class MarchingParticles extends Base {
  static observedAttributes = [...TEXTS, ...FLAGS];

  #host;
  /** @type {View | null} */
  #view = null;
  /** Whether it has been visible since it was added to the page. */
  #isSeen = false;
  #isDue = false;
  /** The attributes that the element has set by itself. @type {Record<string, string | null>} */
  #given = {};
  #visible;
  /** The last parameters that were given to the picture. @type {Record<string, number>} */
  #params = {};
  /** The timer that ends a motion. @type {ReturnType<typeof setTimeout> | undefined} */
  #still;

  constructor() {
    super();
    // The picture inside handles the keys, so the focus of the element passes to it.
    const root = this.attachShadow({ mode: 'open', delegatesFocus: true });
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(SHEET);
    root.adoptedStyleSheets = [sheet];
    this.#host = root.appendChild(document.createElement('div'));
    this.#visible = new IntersectionObserver((entries) => {
      if (!entries.some(({ isIntersecting }) => isIntersecting)) return;
      this.#visible.disconnect();
      this.#isSeen = true;
      this.#show();
    });
  }

  /** The picture; null before the element becomes visible. */
  get view() {
    return this.#view;
  }

  /** The last report; null while particles are being placed. */
  get report() {
    return this.#view?.report ?? null;
  }

  /** The mesh as a file. @param {import('./index.js').MeshFormat} format */
  async toFile(format) {
    if (!this.#view) throw new InputError('toFile(): the element has not come into sight yet.');
    return this.#view.toFile(format);
  }

  connectedCallback() {
    this.#describe();
    this.#visible.observe(this);
  }

  disconnectedCallback() {
    this.#visible.disconnect();
    this.#isSeen = false;
    clearTimeout(this.#still);
    this.#view?.destroy();
    this.#view = null;
    this.#host.replaceChildren();
  }

  /** @param {string} name @param {string | null} _before @param {string | null} value */
  attributeChangedCallback(name, _before, value) {
    this.#describe();
    // A picture keeps its way of drawing.
    if (name === 'controls' || (name === 'backend' && this.#view) || !this.#isSeen || this.#isDue) return;
    if (name === 'params' && value !== null && this.#view) {
      this.#try(() => this.#move(paramsOf(value)));
      return;
    }
    // Attributes that change together are handled as one change.
    this.#isDue = true;
    queueMicrotask(() => {
      this.#isDue = false;
      this.#show();
    });
  }

  /**
   * Names the picture for screen readers, unless the page does, and lets keys reach it if it has `controls`. Only
   * without them its role is an image, since nothing inside an image can have the focus.
   */
  #describe() {
    const text = this.getAttribute('formula') ?? this.getAttribute('surface');
    const controls = this.hasAttribute('controls');
    this.#give('role', controls ? 'group' : 'img');
    this.#give('aria-label', this.hasAttribute('aria-labelledby') ? null : text || null);
    if (!controls) {
      for (const name of ['role', 'tabindex', 'aria-label']) this.#host.removeAttribute(name);
      return;
    }
    this.#host.tabIndex = 0;
    this.#host.role = 'application';
    this.#host.ariaLabel = text ? `${text}. ${KEYS}` : KEYS;
  }

  /**
   * Sets an attribute that the page has not set, or removes it again.
   * @param {string} name
   * @param {string | null} value
   */
  #give(name, value) {
    const present = this.getAttribute(name);
    if (present !== null && present !== this.#given[name]) return;
    this.#given[name] = value;
    if (value === null) this.removeAttribute(name);
    else if (present !== value) this.setAttribute(name, value);
  }

  /**
   * Lets the particles follow the surface to other parameters.
   * @param {Record<string, number>} params
   */
  #move(params) {
    // A slider cannot remove a parameter.
    if (Object.keys(this.#params).some((name) => !Object.hasOwn(params, name))) return this.#show();
    this.#params = params;
    const give = (/** @type {boolean} */ live) => {
      for (const [name, value] of Object.entries(params)) this.#view?.setParameter(name, value, { live });
    };
    give(true);
    clearTimeout(this.#still);
    this.#still = setTimeout(() => give(false), STILL_MS);
    return undefined;
  }

  /** Draws what the attributes ask for. If one is wrong, the next change tries again. */
  #show() {
    if (!this.#isSeen) return undefined;
    return this.#try(() => {
      const state = this.#state();
      this.#params = state.params;
      // Otherwise the end of a motion would restore older parameters.
      clearTimeout(this.#still);
      if (this.#view) return this.#view.set(state);
      const backend = /** @type {BackendKind | null} */ (this.getAttribute('backend')) ?? undefined;
      this.#view = createView(this.#host, state, { backend });
      this.ariaBusy = 'true';
      // By default a picture can have the focus; here it may only with `controls`.
      this.#describe();
      for (const name of /** @type {const} */ (['progress', 'report', 'error']))
        this.#view.on(name, (/** @type {unknown} */ detail) => this.#tell(name, detail));
      return undefined;
    });
  }

  /** @param {string} name @param {any} detail */
  #tell(name, detail) {
    this.ariaBusy = String(name === 'progress');
    if (name === 'progress') this.#host.style.setProperty('--done', String(detail.fraction));
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  /**
   * Does what an attribute asks for. An error in an attribute becomes an event; the picture reports errors of the
   * surface itself.
   * @param {() => Promise<unknown> | undefined} act
   */
  async #try(act) {
    try {
      await act();
    } catch (error) {
      if (error instanceof InputError) this.#tell('error', error);
    }
  }

  /** The state according to the attributes. Whatever they do not mention has its default. */
  #state() {
    const state = {
      surface: this.getAttribute('surface'),
      formula: this.getAttribute('formula') ?? undefined,
      params: paramsOf(this.getAttribute('params') ?? ''),
    };
    const options = Object.entries(OPTIONS).map(([name, optionOf]) => {
      const value = this.getAttribute(name);
      return [name, value === null ? null : optionOf(value)];
    });
    const home = homeView();
    const view = Object.fromEntries(VIEW.map((name) => [name, this.getAttribute(name) ?? home[name]]));
    return { ...state, ...Object.fromEntries(options), view };
  }
}

// Each attribute is also a property: a text or null, or a flag.
for (const name of TEXTS)
  Object.defineProperty(MarchingParticles.prototype, name, {
    get() {
      return this.getAttribute(name);
    },
    set(value) {
      if (value === null || value === undefined) this.removeAttribute(name);
      else this.setAttribute(name, String(value));
    },
  });
for (const name of FLAGS)
  Object.defineProperty(MarchingParticles.prototype, name, {
    get() {
      return this.hasAttribute(name);
    },
    set(value) {
      this.toggleAttribute(name, Boolean(value));
    },
  });

if (globalThis.customElements) {
  // An element is defined once: a second version on the page leaves the definition to the first.
  if (customElements.get('marching-particles')) console.warn(String(new InputError(TWICE)));
  else customElements.define('marching-particles', MarchingParticles);
}
