/**
 * Commands that change what is sampled: surface, formula, parameters, clip box, settings.
 *
 * @module
 */

import { batch } from '@preact/signals-core';
import { FILE_SURFACE, MOST_LINE_POINTS } from '../constants.js';
import { scanOf } from '../scans.js';
import {
  freshShape,
  fromPoints,
  isName,
  modelOf,
  namesModel,
  newParameter,
  surfaceOf,
  validBounds,
  validCentres,
  validLines,
  validPlane,
  validSetting,
} from '../share/state.js';
import { change, changeView, description, showAll } from '../store.js';

/**
 * @import { Parts } from '../parts.js'
 * @import { EngineCommands, Shape, State } from '../types.js'
 */

/**
 * @typedef {Pick<EngineCommands, 'setSurface' | 'openFile' | 'takeFileFor' | 'setCentres' | 'cancelLoading' |
 *   'setFormula' | 'restore'>} SurfaceCommands
 */
/**
 * @typedef {Pick<EngineCommands, 'setParameter' | 'resetParameter' | 'chooseOfFile' | 'pull' | 'setPulls' |
 *   'setLines' | 'meshFaces' | 'declareParameter' | 'readNumber' | 'textFault' | 'section' | 'setBounds' |
 *   'enlargement' | 'setPlane' | 'fitBox' | 'setSetting' | 'resetSetting'>} InputCommands
 */

/**
 * Whether a text replaces another one rather than editing it: less than half of the old text remains.
 * @param {string} old @param {string} text
 */
export function replaces(old, text) {
  const most = Math.min(old.length, text.length);
  let start = 0;
  while (start < most && old[start] === text[start]) start += 1;
  let end = 0;
  while (end < most - start && old.at(-1 - end) === text.at(-1 - end)) end += 1;
  return 2 * (start + end) < old.length;
}

/** The part of a state that is sampled, as a text for comparisons. @param {Shape} shape */
const sampledOf = ({ surface, formula, parameters, declared, centres, bounds, pulls, lines, settings }) =>
  JSON.stringify([surface, formula, parameters, declared, centres, bounds, pulls, lines, settings]);

/** @param {Parts} parts @returns {SurfaceCommands} */
export function surfaceCommands({ store, sampler, loader, framing, picture: { viewer } }) {
  const { state } = store;
  /**
   * The model before a formula was typed that does not name it, and the last formula typed since. While a text is
   * edited letter by letter, the model's name may disappear and return.
   * @type {{ shape: Shape, formula: string } | null}
   */
  let left = null;
  /**
   * Returns how a typed formula changes the state.
   * @param {string} text
   * @param {boolean} whole  whether it replaces the previous formula completely
   * @returns {{ shape: Partial<State>, another: boolean }}
   */
  function typed(text, whole) {
    const about = description(store);
    const { v: _, view: __, ...shape } = state.value;
    const { surface, formula, bounds, settings } = shape;
    const isModel = fromPoints(about, surface);
    if (whole && !isModel) {
      left = null;
      return { shape: freshShape(about, settings, surface, text), another: true };
    }
    if (isModel && !namesModel(text)) {
      left = { shape, formula: text };
      return { shape: freshShape(about, settings, about.surfaces[0].id, text), another: true };
    }
    const before = left?.formula === formula && !isModel ? left.shape : null;
    if (before && namesModel(text)) {
      left = null;
      return { shape: { ...before, settings, formula: text }, another: true };
    }
    left = before && { shape: before, formula: text };
    // Values of the gallery's parameters belong to its formula; in another formula these names start with defaults.
    const isOwn = surfaceOf(about, surface)?.formula === formula;
    const own = isOwn ? { parameters: {} } : {};
    // An enlarged box is also reset, since nobody set it for another formula.
    const next = { ...own, formula: text, bounds: bounds?.enlarged ? null : bounds };
    // Cuts of a model stay where they were.
    return { shape: next, another: !isModel && replaces(formula, text) };
  }
  return {
    setSurface(id) {
      const about = store.description.value;
      const surface = surfaceOf(about, id);
      const isKnown = surface || scanOf(id) || modelOf(about, id);
      if (!isKnown && !(id === FILE_SURFACE && loader.hasFile)) return;
      showAll(store);
      const fresh = freshShape(description(store), state.value.settings, id);
      change(store, { ...fresh, ...(id === FILE_SURFACE ? { parameters: loader.beginning() } : {}) });
      // The camera fits another surface, even if a pointer or a link has moved it.
      viewer.linked = null;
      const { camera } = viewer;
      if (!camera.state.fit) {
        camera.set({ ...camera.state, fit: true });
        changeView(store, { camera: camera.state });
      }
      sampler.choose('new');
    },
    openFile(file, beside) {
      // A formula that is still waiting for a pause would replace the file.
      sampler.forgetLater();
      return loader.openFile(file, beside);
    },
    takeFileFor(what) {
      sampler.forgetLater();
      return loader.takeFor(what);
    },
    setCentres(count) {
      const centres = validCentres(count, description(store), state.value.surface);
      if (centres === undefined || centres === state.value.centres) return;
      change(store, { centres });
      sampler.choose();
    },
    cancelLoading: () => loader.cancel(),
    setFormula(text, { typing = false, whole = false } = {}) {
      if (text !== state.value.formula) {
        const { shape, another } = typed(text, whole);
        change(store, shape);
        framing.written({ typed: true, another });
      } else if (store.trial.value !== 'typing') {
        if (!typing) sampler.commit();
        return;
      }
      if (typing) sampler.chooseTyped();
      else sampler.choose();
    },
    restore({ camera, ...shape }) {
      const another = shape.surface !== state.value.surface;
      const sampled = sampledOf(shape) !== sampledOf(state.value);
      if (another) showAll(store);
      change(store, shape);
      if (camera) {
        framing.restored();
        viewer.camera.set(camera);
        changeView(store, { camera });
        viewer.frames.ask();
      }
      if (sampled) sampler.choose(another ? ((camera?.fit ?? true) ? 'new' : 'grow') : 'change');
    },
  };
}

/** @param {Parts} parts @returns {InputCommands} */
export function inputCommands({ store, sampler, framing }) {
  const { state } = store;
  /**
   * Changes the state and the dragging flag together, so that the history records a drag once.
   * @param {boolean} dragging @param {Partial<State>} patch
   */
  const take = (dragging, patch) =>
    batch(() => {
      store.dragging.value = dragging;
      change(store, patch);
    });
  /** @param {boolean} live @param {Partial<State>} patch */
  const resample = (live, patch) => {
    take(live, patch);
    if (live) sampler.resampleLive();
    else sampler.resample({ kind: 'move' });
  };
  return {
    setParameter(name, value, { live = false } = {}) {
      const about = store.description.value;
      if (!about || !isName(about, name) || !Number.isFinite(value)) return;
      resample(live, { parameters: { ...state.value.parameters, [name]: value } });
    },
    chooseOfFile(parameters) {
      change(store, { parameters });
      sampler.resample({ kind: 'new' });
    },
    resetParameter(name) {
      const { [name]: _, ...parameters } = state.value.parameters;
      change(store, { parameters });
      sampler.resample();
    },
    pull(parameters, pins, { live = false } = {}) {
      const pulled = { parameters, pins: [...pins] };
      // A pull ends when the core returns its parameters.
      store.dragging.value = true;
      if (live) sampler.resampleLive(pulled);
      else sampler.resample({ kind: 'move', pulled });
    },
    setPulls: (pulls, { live = false } = {}) => resample(live, { pulls: [...pulls] }),
    setLines(lines) {
      if (!validLines(lines, MOST_LINE_POINTS)) return;
      // A mesh with sharp edges is no scan, which alone can be smoothed.
      const { smooth: _, ...parameters } = state.value.parameters;
      change(store, { parameters, lines: [...lines] });
      sampler.resample();
    },
    meshFaces: () => sampler.client.meshFaces(),
    declareParameter(name) {
      const { declared } = state.value;
      if (declared.some((p) => p.name === name)) return;
      change(store, { declared: [...declared, newParameter(description(store), name)] });
      sampler.resample();
    },
    async readNumber(text) {
      const plain = Number(text.trim().replace(/^([-+]?\d+),(\d+)$/, '$1.$2'));
      if (text.trim() !== '' && Number.isFinite(plain)) return plain;
      return sampler.client.number(text);
    },
    section({ corner, sides, size }) {
      // The points are the middles of the pixels.
      const steps = sides.map((side, k) => side.map((length) => length / size[k]));
      const first = corner.map((c, k) => c + 0.5 * (steps[0][k] + steps[1][k]));
      return sampler.client.section([...first, ...steps[0], ...steps[1]], size);
    },
    textFault: (what, text) => sampler.client.textFault(what, text),
    setBounds(bounds, { live = false, enlarges = false } = {}) {
      const valid = bounds === null ? null : validBounds(bounds, description(store).limits);
      if (valid === undefined) return;
      if (valid) delete valid.enlarged;
      if (valid && enlarges) {
        const isEndless = store.report.value?.cut === 'endless' || state.value.bounds?.enlarged === 'endless';
        valid.enlarged = isEndless ? 'endless' : 'larger';
        framing.enlarged();
      }
      resample(live, { bounds: valid });
    },
    enlargement: () => state.value.bounds?.enlarged ?? null,
    setPlane(plane, { live = false } = {}) {
      const valid = plane === null ? null : validPlane(plane);
      if (valid === undefined) return;
      take(live, { plane: valid });
    },
    fitBox() {
      const { box_mode: _, ...settings } = state.value.settings;
      resample(false, { bounds: null, settings });
    },
    setSetting(name, value, { live = false } = {}) {
      const about = store.description.value;
      const valid = about ? validSetting(about, name, value) : undefined;
      if (valid === undefined) return;
      resample(live, { settings: { ...state.value.settings, [name]: valid } });
    },
    resetSetting(name) {
      const { [name]: _, ...settings } = state.value.settings;
      change(store, { settings });
      sampler.resample();
    },
  };
}
