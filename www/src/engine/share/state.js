/**
 * The shareable state: its defaults, and the validation that turns any input into a valid state.
 *
 * @module
 */

import { readDabs } from '../brush.js';
import { FILE_SURFACE, MODEL, MOST_LINE_POINTS, MOST_PARAMETERS, MOST_PULLS } from '../constants.js';
import { LONGEST_PULL } from '../pulls.js';
import { scanOf } from '../scans.js';
import { size, vec } from '../vector.js';
import { finite, isRecord, vec3, within } from './valid.js';
import { homeView, validView } from './view.js';

/**
 * @import {
 *   Bounds, ChosenBounds, CuttingPlane, Description, FieldRequest, Limits, Line, Parameter, Pull, Settings, State,
 *   Shape, SurfaceInfo,
 * } from '../types.js'
 */

/** What a link does not hold: the surface of a file. */
export const IN_FILE = 'the surface, which is in a file';
/** What is lost with it. */
export const MARKED = 'the edges marked on it';

/** Largest number in a plane, since the graphics card uses single precision. */
const LARGEST_SINGLE = 3e38;

/** Returns the state before the core has described its surfaces. @returns {State} */
export const emptyState = () => ({
  v: 1,
  surface: '',
  formula: '',
  parameters: {},
  declared: [],
  centres: null,
  bounds: null,
  plane: null,
  pulls: [],
  lines: [],
  settings: {},
  view: homeView(),
});

/** @param {Description} description @returns {State} */
export function defaultState(description) {
  const surface = description.surfaces[0];
  return { ...emptyState(), surface: surface?.id ?? '', formula: surface?.formula ?? '' };
}

/** @param {Description | null} description @param {string} id @returns {SurfaceInfo | undefined} */
export const surfaceOf = (description, id) => description?.surfaces.find((s) => s.id === id);

/**
 * A surface's initial formula; for a surface from points it is the model.
 * @param {Description | null} description @param {string} id
 */
export const ownFormula = (description, id) =>
  fromPoints(description, id) ? MODEL : (surfaceOf(description, id)?.formula ?? '');

/**
 * Whether a formula uses the model as an operand: contains its name outside of comments.
 * @param {string} formula
 */
export function namesModel(formula) {
  const code = formula.replace(/\/\*[\s\S]*?(\*\/|$)|(\/\/|#).*/g, ' ');
  return code.match(/[\p{L}_][\p{L}\p{N}_]*/gu)?.includes(MODEL) ?? false;
}

/**
 * Returns every setting, with defaults for the missing ones.
 * @param {Description} description
 * @param {Settings} settings
 * @returns {Settings}
 */
export function completeSettings(description, settings) {
  /** @type {Settings} */
  const all = {};
  for (const info of description.settings) all[info.name] = settings[info.name] ?? info.default;
  return settings.brush ? { ...all, brush: settings.brush } : all;
}

/**
 * Returns the settings that stay when another surface is chosen; those of the box and formulas belong to one surface.
 * @param {Description} description
 * @param {Settings} settings
 * @returns {Settings}
 */
export function lastingSettings({ settings: known }, settings) {
  const lasts = (/** @type {string} */ name) =>
    known.some((info) => info.name === name && info.group !== 'Box' && info.kind !== 'text');
  return Object.fromEntries(Object.entries(settings).filter(([name]) => lasts(name)));
}

/**
 * Returns the initial shape for another surface.
 * @param {Description | null} description
 * @param {Settings} settings  the current ones
 * @param {string} surface
 * @param {string} [formula]  by default the surface's own
 * @returns {Shape}
 */
export function freshShape(description, settings, surface, formula = ownFormula(description, surface)) {
  const { v: _, view: __, ...shape } = emptyState();
  const parameters = { ...scanOf(surface)?.parameters };
  const lasting = description ? lastingSettings(description, settings) : settings;
  return { ...shape, surface, formula, parameters, settings: lasting };
}

/**
 * Limits every number to the range of its setting.
 * @param {Description} description
 * @param {Settings} settings
 * @returns {Settings}
 */
export function clampSettings(description, settings) {
  return Object.fromEntries(
    Object.entries(settings).map(([name, value]) => [name, validSetting(description, name, value) ?? value]),
  );
}

/** @param {Description | null} description @param {string} id */
export const modelOf = (description, id) => description?.models.find((model) => model.id === id);

/**
 * Whether a surface is made from points or voxels: a built-in model, a computed image or a file.
 * @param {Description | null} description
 * @param {string} id
 */
export const fromPoints = (description, id) =>
  id === FILE_SURFACE || scanOf(id) !== undefined || modelOf(description, id) !== undefined;

/** Only the box. @param {Bounds} bounds @returns {Bounds} */
const boxOf = ({ min, max }) => ({ min, max });

/**
 * Returns the request that sets the state's field in the core.
 * @param {State} state @param {Description} description
 * @param {string} [points]  key under which the state's solved model is kept
 * @returns {FieldRequest}
 */
export function fieldRequest(state, description, points) {
  /** @type {FieldRequest} */
  const request = { surface: state.surface };
  if (state.bounds) request.bounds = boxOf(state.bounds);
  if (points !== undefined) {
    request.points = points;
    if (state.pulls.length) request.pulls = state.pulls;
    if (state.lines.length) request.lines = state.lines;
    // A model alone needs no formula.
    if (state.formula.trim() === MODEL) {
      // Choices for an image are parameters.
      if (Object.keys(state.parameters).length > 0) request.parameters = { ...state.parameters };
      return request;
    }
  }
  request.parameters = { ...state.parameters };
  if (state.formula !== ownFormula(description, state.surface)) request.formula = state.formula;
  if (state.declared.length) request.declare = state.declared;
  return request;
}

/** A box that the core accepts. @param {unknown} v @param {Limits} limits @returns {ChosenBounds | undefined} */
export function validBounds(v, limits) {
  if (!isRecord(v)) return undefined;
  const [min, max] = [vec3(v.min), vec3(v.max)];
  if (!min || !max || !min.every((m, k) => m < max[k])) return undefined;
  const diagonal = Math.hypot(...max.map((m, k) => m - min[k]));
  const farthest = Math.max(...[...min, ...max].map(Math.abs));
  const fits = diagonal >= limits.diagonal_min && diagonal <= limits.diagonal_max;
  if (!fits || farthest > limits.farthest_corner * diagonal) return undefined;
  const { enlarged } = v;
  return { min, max, ...(enlarged === 'larger' || enlarged === 'endless' ? { enlarged } : {}) };
}

/** A plane with a unit normal. @param {unknown} v @returns {CuttingPlane | undefined} */
export function validPlane(v) {
  if (!isRecord(v)) return undefined;
  const [normal, offset] = [vec3(v.normal), within(v.offset, -LARGEST_SINGLE, LARGEST_SINGLE)];
  const length = normal ? Math.hypot(...normal) : 0;
  if (!normal || offset === undefined || !(length > 0 && length < Infinity)) return undefined;
  // Adding 0 turns −0 into 0, as a link does.
  return { normal: vec((k) => normal[k] / length + 0), offset: offset / length + 0 };
}

/** A pull that does not tear the surface. @param {unknown} v @returns {Pull | undefined} */
export function validPull(v) {
  if (!isRecord(v)) return undefined;
  const [at, by, reach] = [vec3(v.at), vec3(v.by), within(v.reach, 0, Number.MAX_VALUE)];
  return at && by && reach && size(by) <= LONGEST_PULL * reach ? { at, by, reach } : undefined;
}

/** At most this many pulls; each begins where those before it end. @param {unknown} v @param {number} most */
function validPulls(v, most) {
  const pulls = Array.isArray(v) && v.length <= most ? v.map(validPull) : [undefined];
  return pulls.every((pull) => pull !== undefined) ? pulls : undefined;
}

/** Lines of two points or more, with up to this many together. @param {unknown} v @param {number} most */
export function validLines(v, most) {
  const lines = Array.isArray(v) ? v.map((line) => (Array.isArray(line) ? line.map(vec3) : [])) : [[]];
  const isLine = (/** @type {unknown[]} */ line) => line.length > 1 && line.every(Boolean);
  return lines.every(isLine) && lines.flat().length <= most ? /** @type {Line[]} */ (lines) : undefined;
}

/**
 * Range of the number of centres for a model or a file; null for a formula's surface. The number of a file's points is
 * not known here.
 * @param {Description} description @param {string} id
 */
function centresOf({ limits, models }, id) {
  const most = id === FILE_SURFACE ? Infinity : models.find((model) => model.id === id)?.points;
  if (most === undefined) return null;
  const usual = Math.min(limits.centres, most);
  return { min: Math.min(limits.centres_min, usual), max: Math.min(limits.centres_max, most), usual };
}

/**
 * Returns the nearest valid number of centres; null for the default, undefined if the surface has none.
 * @param {unknown} v @param {Description} description @param {string} id  of the surface
 */
export function validCentres(v, description, id) {
  const range = centresOf(description, id);
  const count = range && within(v, range.min, range.max);
  if (!range || count === undefined || count === null) return undefined;
  return Math.round(count) === range.usual ? null : Math.round(count);
}

/**
 * A parameter with this name and the core's initial values.
 * @param {Description} description
 * @param {string} name
 * @returns {Parameter}
 */
export const newParameter = ({ new_parameter }, name) => ({ ...new_parameter, name, label: name });

/** Whether a parameter may have this name. @param {Description} description @param {string} name */
export const isName = ({ limits }, name) => new RegExp(limits.name_pattern).test(name);

/** @param {unknown} v @param {Description} description @returns {Parameter | undefined} */
function validParameter(v, description) {
  if (!isRecord(v) || typeof v.name !== 'string' || !isName(description, v.name)) return undefined;
  const usual = newParameter(description, v.name);
  const min = finite(v.min) ?? usual.min;
  const max = finite(v.max) ?? usual.max;
  const step = finite(v.step) ?? 0;
  if (!(max > min)) return undefined;
  return {
    name: v.name,
    label: typeof v.label === 'string' ? v.label.slice(0, 64) : usual.label,
    value: finite(v.value) ?? usual.value,
    min,
    max,
    step: step > 0 ? step : usual.step,
  };
}

/**
 * Makes a valid state from any input. An unusable value is replaced by its default and named in `reset`, in words for
 * the user.
 * @param {unknown} raw
 * @param {Description} description
 * @param {boolean} [hasFile]  whether a file is open that a state may need
 * @returns {{state: State, reset: string[]}}
 */
export function sanitize(raw, description, hasFile = false) {
  /** @type {string[]} */
  const reset = [];
  const state = defaultState(description);
  if (!isRecord(raw)) return { state, reset: ['everything'] };
  if (raw.surface === FILE_SURFACE && !hasFile) {
    // Formula, parameters and box belong to the unknown surface and are dropped. Settings and view apply to any
    // surface.
    const { camera: _, ...view } = isRecord(raw.view) ? raw.view : {};
    const rest = sanitize({ settings: raw.settings, view }, description);
    const marked = Array.isArray(raw.lines) && raw.lines.length > 0 ? [MARKED] : [];
    return { state: rest.state, reset: [IN_FILE, ...marked, ...rest.reset] };
  }

  const id = typeof raw.surface === 'string' ? raw.surface : '';
  const points = fromPoints(description, id);
  if (raw.surface !== undefined) {
    if (points || surfaceOf(description, id)) {
      state.surface = id;
      state.formula = ownFormula(description, id);
    } else reset.push('surface');
  }
  if (raw.formula !== undefined && !(points && raw.formula === '')) {
    const { formula } = raw;
    const isText = typeof formula === 'string' && formula.length <= description.limits.formula_bytes;
    // A formula without the model's name is not a formula of the model.
    if (isText && (!points || namesModel(formula))) state.formula = formula;
    else reset.push('formula');
  }
  if (raw.parameters !== undefined) {
    if (isRecord(raw.parameters)) {
      for (const [name, value] of Object.entries(raw.parameters).slice(0, MOST_PARAMETERS)) {
        const v = isName(description, name) ? finite(value) : undefined;
        if (v === undefined || v !== value) reset.push(`parameter ${name.slice(0, 32)}`);
        if (v !== undefined) state.parameters[name] = v;
      }
      if (Object.keys(raw.parameters).length > MOST_PARAMETERS)
        reset.push(`parameters beyond the ${MOST_PARAMETERS}th`);
    } else reset.push('parameters');
  }
  if (raw.declared !== undefined) {
    if (Array.isArray(raw.declared)) {
      for (const item of raw.declared.slice(0, MOST_PARAMETERS)) {
        const parameter = validParameter(item, description);
        if (parameter && !state.declared.some((p) => p.name === parameter.name)) state.declared.push(parameter);
        else reset.push('a declared parameter');
      }
      if (raw.declared.length > MOST_PARAMETERS) reset.push(`declared parameters beyond the ${MOST_PARAMETERS}th`);
    } else reset.push('declared parameters');
  }
  /**
   * Reads an optional part of a state, if it is valid.
   * @template T
   * @param {unknown} part @param {(part: unknown) => T | undefined} valid @param {string} words
   * @returns {T | null}
   */
  const optional = (part, valid, words) => {
    if (part === undefined || part === null) return null;
    const value = valid(part);
    if (value === undefined) reset.push(words);
    return value ?? null;
  };
  state.centres = optional(raw.centres, (v) => validCentres(v, description, state.surface), 'number of centres');
  state.bounds = optional(raw.bounds, (v) => validBounds(v, description.limits), 'clip box');
  state.plane = optional(raw.plane, validPlane, 'cutting plane');
  state.pulls = optional(raw.pulls, (v) => validPulls(v, points ? MOST_PULLS : 0), 'pulls') ?? [];
  const mostPoints = id === FILE_SURFACE ? MOST_LINE_POINTS : 0;
  state.lines = optional(raw.lines, (v) => validLines(v, mostPoints), 'marked edges') ?? [];
  if (raw.settings !== undefined) {
    if (isRecord(raw.settings)) {
      for (const [name, value] of Object.entries(raw.settings)) {
        const valid = validSetting(description, name, value);
        if (valid === undefined || valid !== value) reset.push(`setting ${name.slice(0, 32)}`);
        if (valid !== undefined) state.settings[name] = valid;
      }
    } else reset.push('settings');
  }
  if (raw.view !== undefined) {
    if (isRecord(raw.view)) state.view = validView(raw.view, state.view, reset);
    else reset.push('view');
  }
  return { state, reset };
}

/** The initial choices for a computed image. @param {unknown} surface */
const beginningOf = (surface) => ({ parameters: { ...scanOf(String(surface))?.parameters } });

/**
 * Applies a patch to a state. Another surface, or a formula without a model's name instead of the model, brings its own
 * parameters and box. The surface null means the default one.
 * @param {State} now
 * @param {Record<string, unknown>} given
 * @param {Description} description
 * @param {boolean} hasFile
 * @returns {{state: State, reset: string[]}}
 */
export function mergeState(now, given, description, hasFile) {
  const patch = given.surface === null ? { ...given, surface: defaultState(description).surface } : given;
  const another =
    typeof patch.surface === 'string'
      ? patch.surface !== now.surface
      : typeof patch.formula === 'string' && fromPoints(description, now.surface) && !namesModel(patch.formula);
  const base = another
    ? {
        ...defaultState(description),
        ...beginningOf(patch.surface),
        view: now.view,
        settings: lastingSettings(description, now.settings),
      }
    : now;
  const raw = {
    ...base,
    // A surface in the patch brings its own formula.
    formula: patch.surface ? undefined : now.formula,
    ...patch,
    view: { ...now.view, .../** @type {object} */ (patch.view ?? {}) },
  };
  return sanitize(raw, description, hasFile);
}

/**
 * Returns the valid value of a setting that is nearest to `value`; undefined if the setting or the value is unknown.
 * @param {Description} description @param {string} name @param {unknown} value
 * @returns {number | string | undefined}
 */
export function validSetting(description, name, value) {
  // What is painted is a setting of the page alone.
  if (name === 'brush') return readDabs(value) ? /** @type {string} */ (value) : undefined;
  const info = description.settings.find((s) => s.name === name);
  if (!info) return undefined;
  if (info.kind === 'choice')
    return info.choices?.some((c) => c.value === value) ? /** @type {string} */ (value) : undefined;
  if (info.kind === 'text')
    return typeof value === 'string' && value.length <= description.limits.formula_bytes ? value.trim() : undefined;
  if (info.kind === 'formula' && typeof value === 'string')
    return value.trim() !== '' && value.length <= description.limits.formula_bytes ? value : undefined;
  const v = within(value, info.min, info.max);
  return v !== undefined && info.kind === 'integer' ? Math.round(v) : v;
}
