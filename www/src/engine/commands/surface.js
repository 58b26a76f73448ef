/**
 * Commands that change what is sampled: surface, formula, parameters, clip box, settings.
 *
 * @module
 */

import { FILE_SURFACE } from '../constants.js';
import { freshShape } from '../points/loader.js';
import {
  fromPoints,
  modelOf,
  newParameter,
  surfaceOf,
  validBounds,
  validCentres,
  validPlane,
  validSetting,
} from '../share/state.js';
import { change, description, showAll } from '../store.js';

/**
 * @import { Parts } from '../parts.js'
 * @import { EngineCommands, Shape } from '../types.js'
 */

/** Pause in typing after which a name counts as finished, although it could be the beginning of a longer one. */
const NAME_MS = 1000;

/**
 * @typedef {Pick<EngineCommands, 'setSurface' | 'openFile' | 'setCentres' | 'cancelLoading' | 'setFormula' |
 *   'restore'>} SurfaceCommands
 */
/**
 * @typedef {Pick<EngineCommands, 'setParameter' | 'resetParameter' | 'declareParameter' | 'setBounds' | 'setPlane' |
 *   'fitBox' | 'setSetting' | 'resetSetting'>} InputCommands
 */

/** Returns what of a state is sampled, as a text to compare. @param {Shape} shape */
const sampledOf = ({ surface, formula, parameters, declared, centres, bounds, settings }) =>
  JSON.stringify([surface, formula, parameters, declared, centres, bounds, settings]);

/** @param {Parts} parts @returns {SurfaceCommands} */
export function surfaceCommands({ store, runs, framing }) {
  const { state } = store;
  return {
    setSurface(id) {
      const about = store.description.value;
      const surface = surfaceOf(about, id);
      if (!surface && !modelOf(about, id) && !(id === FILE_SURFACE && runs.loader.hasFile)) return;
      showAll(store);
      change(store, freshShape(id, surface?.formula));
      runs.choose({ grow: true, fit: true });
    },
    openFile(file) {
      // A formula still waiting for its pause would replace the file.
      runs.forgetLater();
      return runs.loader.openFile(file);
    },
    setCentres(count) {
      const centres = validCentres(count, description(store), state.value.surface);
      if (centres === undefined || centres === state.value.centres) return;
      change(store, { centres });
      runs.choose();
    },
    cancelLoading: () => runs.loader.cancel(),
    setFormula(text, { unfinished = false } = {}) {
      const { surface, formula } = state.value;
      if (text === formula) return;
      // A model has no formula. A formula typed in its place starts from the default surface.
      const fresh = fromPoints(store.description.value, surface);
      change(store, fresh ? freshShape(description(store).default_surface, text) : { formula: text });
      framing.written({ typed: true });
      framing.hold();
      if (unfinished) runs.chooseLater(NAME_MS);
      else runs.choose();
    },
    restore(shape) {
      const another = shape.surface !== state.value.surface;
      const sampled = sampledOf(shape) !== sampledOf(state.value);
      if (another) showAll(store);
      change(store, shape);
      if (sampled) runs.choose({ grow: another, fit: another });
    },
  };
}

/** @param {Parts} parts @returns {InputCommands} */
export function inputCommands({ store, runs }) {
  const { state } = store;
  /** @param {boolean} live */
  const resample = (live) => (live ? runs.resampleLive() : runs.resample());
  return {
    setParameter(name, value, { live = false } = {}) {
      if (!Number.isFinite(value)) return;
      change(store, { parameters: { ...state.value.parameters, [name]: value } });
      resample(live);
    },
    resetParameter(name) {
      const { [name]: _, ...parameters } = state.value.parameters;
      change(store, { parameters });
      runs.resample();
    },
    declareParameter(name) {
      const { declared } = state.value;
      if (declared.some((p) => p.name === name)) return;
      change(store, { declared: [...declared, newParameter(description(store), name)] });
      runs.resample();
    },
    setBounds(bounds, { live = false } = {}) {
      const valid = bounds === null ? null : validBounds(bounds, description(store).limits);
      if (valid === undefined) return;
      change(store, { bounds: valid });
      resample(live);
    },
    setPlane(plane) {
      const valid = plane === null ? null : validPlane(plane);
      if (valid === undefined) return;
      change(store, { plane: valid });
    },
    fitBox() {
      const { box_mode: _, ...settings } = state.value.settings;
      change(store, { bounds: null, settings });
      resample(false);
    },
    setSetting(name, value, { live = false } = {}) {
      const about = store.description.value;
      const valid = about ? validSetting(about, name, value) : undefined;
      if (valid === undefined) return;
      change(store, { settings: { ...state.value.settings, [name]: valid } });
      resample(live);
    },
    resetSetting(name) {
      const { [name]: _, ...settings } = state.value.settings;
      change(store, { settings });
      runs.resample();
    },
  };
}
