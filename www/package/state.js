/**
 * The state of a view in the words of `sample`, from and to the state of the page's engine.
 *
 * @module
 */
import { mergeState } from '../src/engine/share/state.js';
import { InputError } from './errors.js';
import { checkSizes, isVarying, meant, optionOf, paramsOf, SETTINGS, settingsOf } from './options.js';

/**
 * @import { Description, Settings, State } from '../src/engine/types.js'
 * @import { ViewState } from './view.js'
 */

/** Entries that the engine knows by the same name. */
const PLAIN = ['surface', 'formula', 'bounds', 'plane', 'centres', 'pulls', 'declared', 'view'];
const KNOWN = [...PLAIN, 'params', ...Object.keys(SETTINGS)];
/** The settings that determine the size, of which a new one replaces the others. */
const SIZES = ['size_mode', 'count', 'radius_share', 'spacing'];

/** @param {string} name @returns {never} */
function refuseLength(name) {
  throw new InputError(
    `${name}: a share of the box diagonal such as '1%' in a view, whose box changes with its surface; not a length.`,
  );
}

/**
 * The engine's settings that options set, and those that go back to their defaults.
 * @param {Record<string, unknown>} options
 * @returns {{set: Settings, reset: string[]}}
 */
function changeOf(options) {
  const given = Object.fromEntries(Object.entries(options).filter(([, value]) => value !== null && value !== false));
  checkSizes(given);
  const { settings, given: sources } = settingsOf(given);
  if (settings.radius !== undefined) refuseLength(sources.radius_share);
  const [length] = Object.keys(settings.lengths ?? {});
  if (length !== undefined) refuseLength(sources[length]);
  const set = /** @type {Settings} */ (settings);
  if (isVarying(given.spacing)) {
    if (typeof given.spacing !== 'string') throw new InputError('spacing: a share or a formula in a view.');
    set.spacing = given.spacing;
  }
  const names = Object.keys(options);
  const isSized = names.some((name) => ['count', 'radius', 'spacing'].includes(name));
  return { set, reset: [...names.map((name) => SETTINGS[name].setting), ...(isSized ? SIZES : [])] };
}

/**
 * A change in the words of `sample`, in those of the engine: `rest` is the change without its settings.
 * @param {ViewState} patch
 * @throws {InputError} if an entry is unknown or not valid
 */
export function engineChange(patch) {
  const entries = Object.entries(patch).filter(([, value]) => value !== undefined);
  const unknown = entries.find(([name]) => !KNOWN.includes(name))?.[0];
  if (unknown !== undefined) throw new InputError(`${unknown}: there is no such entry. ${meant(unknown, KNOWN)}`);
  /** @type {Record<string, unknown>} */
  const rest = Object.fromEntries(entries.filter(([name]) => PLAIN.includes(name)));
  if (patch.params !== undefined) rest.parameters = paramsOf(patch.params);
  return { rest, ...changeOf(Object.fromEntries(entries.filter(([name]) => name in SETTINGS))) };
}

/**
 * A change of the engine's present state, which replaces all settings.
 * @param {ReturnType<typeof engineChange>} change @param {State} now @param {Description} description
 * @returns {Record<string, unknown>}
 */
export function appliedTo({ rest, set, reset }, now, description) {
  if (reset.length === 0) return rest;
  // Another surface drops some settings.
  const { settings } = mergeState(now, rest, description, false).state;
  const kept = Object.entries(settings).filter(([name]) => !reset.includes(name));
  return { ...rest, settings: { ...Object.fromEntries(kept), ...set } };
}

/** A share as a text, in per cent to ten digits. @param {number} share */
const percent = (share) => `${Number((100 * share).toPrecision(10))}%`;

/**
 * The state of the engine in the words of `sample`; of the options, only those that differ from their defaults.
 * @param {State} state @param {Description | null} description
 * @returns {ViewState}
 */
export function viewState({ surface, formula, parameters, bounds, plane, settings, view, ...more }, description) {
  const { centres, pulls, declared } = more;
  const usual = (/** @type {string} */ name) => description?.settings.find((row) => row.name === name)?.default;
  /** @type {Record<string, unknown>} */
  const options = {};
  for (const [name, { setting, kind, values = [] }] of Object.entries(SETTINGS)) {
    const value = settings[setting];
    if (name === 'spacing' || value === undefined || value === usual(setting)) continue;
    if (kind === 'flag') options[name] = value === values[0];
    else options[name] = kind === 'size' ? percent(Number(value)) : value;
  }
  if (settings.spacing) options.spacing = settings.spacing;
  if (settings.size_mode === 'count') options.count = settings.count ?? usual('count');
  else delete options.count;
  if (options.count !== undefined || options.spacing !== undefined) delete options.radius;
  return structuredClone({
    surface,
    formula,
    params: parameters,
    bounds,
    plane,
    ...options,
    ...(centres === null ? {} : { centres }),
    ...(pulls.length > 0 ? { pulls } : {}),
    ...(declared.length > 0 ? { declared } : {}),
    view,
  });
}

/** The engine's words for what is not valid, in those of `sample`. @param {string[]} reset */
export const namesOf = (reset) =>
  reset.map((words) => words.replace(/^setting (.+)$/, (_, setting) => optionOf(setting))).join(', ');
