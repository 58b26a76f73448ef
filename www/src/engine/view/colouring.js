/**
 * Computes a colour for each particle, and the legend of the colours.
 *
 * @module
 */
import { FATE } from '../columns.js';
import { hexFromPacked } from './oklab.js';
import { COMPONENT_COLOURS, CYCLE, PALETTES } from './palettes.js';

/**
 * @typedef {import('../columns.js').Columns} Columns
 * @typedef {import('../types.js').ColourMode} ColourMode
 * @typedef {import('../types.js').Legend} Legend
 * @typedef {import('./palettes.js').Theme} Theme
 */

/** Number of slots of a particle in a uniform run. In an adaptive run it varies. */
const SLOTS = 6;
const MOST_SLOTS = 10;

/**
 * Class of a particle by its slots, with the worst fate first: a slot that failed, one that met the limit on particles,
 * one outside the clip box, one still open, or all filled.
 * @typedef {'trouble' | 'capped' | 'border' | 'front' | 'interior'} SlotsClass
 */

/** @param {number} slots @param {boolean} adaptive @returns {SlotsClass} */
export function classOfSlots(slots, adaptive) {
  let seen = 0;
  for (let k = 0; k < (adaptive ? MOST_SLOTS : SLOTS); k += 1) seen |= 1 << ((slots >>> (3 * k)) & 7);
  // The number of slots of an adaptive particle is known once the front has processed it. Slots still open then are
  // unused.
  if (adaptive && slots >>> 3 !== 0) seen &= ~(1 << FATE.open);
  if (seen & ((1 << FATE.notConverged) | (1 << FATE.undefined))) return 'trouble';
  if (seen & (1 << FATE.capped)) return 'capped';
  if (seen & (1 << FATE.outside)) return 'border';
  return seen & (1 << FATE.open) ? 'front' : 'interior';
}

/** @param {number} valence @returns {'none' | 'four' | 'five' | 'six' | 'seven' | 'eight'} */
export function classOfValence(valence) {
  if (valence === 0) return 'none';
  if (valence <= 4) return 'four';
  if (valence >= 8) return 'eight';
  return valence === 5 ? 'five' : valence === 6 ? 'six' : 'seven';
}

/** Range of nearest distances that the ramp covers, as shares of the ideal distance 2r. */
const NEAREST_SHARE = /** @type {const} */ ([0.6, 1.2]);

/** Range of energies that the ramp covers; 1 is that of a perfect lattice. */
const ENERGY_RANGE = /** @type {const} */ ([0.6, 1.4]);

/** Range of residuals over the radius that the ramp covers, by powers of ten. */
const RESIDUAL_SHARE = /** @type {const} */ ([1e-8, 1e-2]);

/** Component index of a particle that the report excludes. */
const NO_COMPONENT = 0xffffffff;

/**
 * Share of the curvatures within the diverging ramp. Without it, a few sharp features would make the rest look flat.
 */
const CURVATURE_QUANTILE = 0.95;
/** Number of curvatures sampled for that quantile. */
const CURVATURE_SAMPLES = 4096;

/**
 * Returns the values at both ends of a ramp whose range depends on the particles: the smallest and largest radius, or ±
 * the 95 % quantile of the absolute mean curvature. It is null for other modes and before there is a value.
 * @param {ColourMode} mode @param {Columns} columns
 * @returns {[number, number] | null}
 */
export function rangeOf(mode, columns) {
  if (mode === 'radius' && columns.count > 0) {
    let low = Infinity;
    let high = 0;
    for (let i = 0; i < columns.count; i += 1) {
      const r = columns.radii[i];
      if (r < low) low = r;
      if (r > high) high = r;
    }
    return [low, high];
  }
  if (mode === 'curvature' && columns.curved > 0) {
    const step = Math.ceil(columns.curved / CURVATURE_SAMPLES);
    const sizes = [];
    for (let i = 0; i < columns.curved; i += step) {
      const size = Math.abs(meanCurvature(columns, i));
      if (size < Infinity) sizes.push(size);
    }
    if (sizes.length === 0) return null;
    sizes.sort((a, b) => a - b);
    const most = sizes[Math.floor(CURVATURE_QUANTILE * (sizes.length - 1))];
    return [-most, most];
  }
  return null;
}

/** @param {Columns} columns @param {number} i */
const meanCurvature = ({ curvature }, i) => 0.5 * (curvature[2 * i] + curvature[2 * i + 1]);

/**
 * Returns the colour of `v` on a ramp from `low` to `high`, and the first colour for NaN.
 * @param {Uint32Array} ramp
 * @param {number} v
 * @param {number} low
 * @param {number} high
 */
function onRamp(ramp, v, low, high) {
  const t = high > low ? Math.min(1, Math.max(0, (v - low) / (high - low))) : 0.5;
  return ramp[Math.round(t * (ramp.length - 1)) || 0];
}

/**
 * Returns the colours of particles `first … last`, as `0xAABBGGRR`.
 *
 * While the figures of a mode (of the report, or the curvature) are missing, the colour is the plain one.
 * @param {ColourMode} mode
 * @param {Theme} theme
 * @param {Columns} columns
 * @param {number} first
 * @param {number} last
 * @param {[number, number] | null} [range]  from {@link rangeOf}
 */
export function coloursOf(mode, theme, columns, first, last, range = rangeOf(mode, columns)) {
  const palette = PALETTES[theme];
  const out = new Uint32Array(last - first);
  const { levels, slots, normals, valence, nearest, energy, residual, radii, component, curved, adaptive } = columns;
  switch (mode) {
    case 'level':
      for (let i = first; i < last; i += 1) out[i - first] = palette.levels[levels[i] % CYCLE];
      return out;
    case 'fate':
      for (let i = first; i < last; i += 1) out[i - first] = palette.fate[classOfSlots(slots[i], adaptive)];
      return out;
    case 'valence':
      if (!valence) break;
      for (let i = first; i < last; i += 1) out[i - first] = palette.valence[classOfValence(valence[i])];
      return out;
    case 'nearest':
      if (!nearest) break;
      for (let i = first; i < last; i += 1)
        out[i - first] = onRamp(palette.sequential, nearest[i] / (2 * radii[i]), ...NEAREST_SHARE);
      return out;
    case 'energy':
      if (!energy) break;
      for (let i = first; i < last; i += 1) out[i - first] = onRamp(palette.sequential, energy[i], ...ENERGY_RANGE);
      return out;
    case 'residual': {
      if (!residual) break;
      const [low, high] = RESIDUAL_SHARE.map(Math.log10);
      for (let i = first; i < last; i += 1)
        out[i - first] = onRamp(palette.sequential, Math.log10(residual[i] / radii[i]), low, high);
      return out;
    }
    case 'radius':
      if (!range) break;
      for (let i = first; i < last; i += 1) out[i - first] = onRamp(palette.sequential, radii[i], ...range);
      return out;
    case 'curvature':
      if (!range) break;
      for (let i = first; i < last; i += 1) {
        const mean = i < curved ? meanCurvature(columns, i) : NaN;
        out[i - first] = Number.isNaN(mean) ? palette.plain : onRamp(palette.diverging, mean, ...range);
      }
      return out;
    case 'component':
      if (!component) break;
      for (let i = first; i < last; i += 1)
        out[i - first] =
          component[i] === NO_COMPONENT ? palette.plain : palette.components[component[i] % COMPONENT_COLOURS];
      return out;
    case 'normal':
      for (let i = first; i < last; i += 1) {
        // The range is 0.15 … 0.9 instead of 0 … 1, so that no direction is black or too bright.
        const channel = (/** @type {number} */ k) => Math.round(255 * (0.525 + 0.375 * normals[3 * i + k])) & 255;
        out[i - first] = ((255 << 24) | (channel(2) << 16) | (channel(1) << 8) | channel(0)) >>> 0;
      }
      return out;
    default:
  }
  return out.fill(palette.plain);
}

/** Labels of the classes of slots and of valence, in the order of the legend. */
const FATE_LABELS = /** @type {const} */ ([
  ['interior', 'all slots filled'],
  ['border', 'at the clip box'],
  ['trouble', 'a slot without a point'],
  ['capped', 'limit reached'],
  ['front', 'still on the front'],
]);
const VALENCE_LABELS = /** @type {const} */ ([
  ['four', '4 or fewer'],
  ['five', '5'],
  ['six', '6'],
  ['seven', '7'],
  ['eight', '8 or more'],
  ['none', 'none'],
]);

/**
 * Returns the legend entries of the classes, with the number of particles in each.
 * @template {string} K
 * @param {readonly (readonly [K, string])[]} labels
 * @param {Record<K, number>} colours
 * @param {number} count
 * @param {(i: number) => K} classOf
 */
function categories(labels, colours, count, classOf) {
  const counts = new Map();
  for (let i = 0; i < count; i += 1) {
    const k = classOf(i);
    counts.set(k, (counts.get(k) ?? 0) + 1);
  }
  return labels
    .map(([key, label]) => ({ label, colour: hexFromPacked(colours[key]), count: counts.get(key) ?? 0, key }))
    .filter((entry) => entry.count > 0 || entry.key === 'six' || entry.key === 'interior')
    .map(({ label, colour, count: n }) => ({ label, colour, count: n }));
}

/**
 * Returns the legend of the colours from {@link coloursOf}.
 * @param {ColourMode} mode
 * @param {Theme} theme
 * @param {Columns} columns
 * @param {[number, number] | null} [range]  from {@link rangeOf}
 * @returns {Legend}
 */
export function legendOf(mode, theme, columns, range = rangeOf(mode, columns)) {
  const palette = PALETTES[theme];
  /**
   * The legend of a sequential ramp, pending while there are no `values`.
   * @param {Pick<Legend, 'title' | 'range' | 'mark'> & {unit?: string}} legend @param {unknown} values
   * @returns {Legend}
   */
  const ramp = (legend, values) => ({
    unit: '',
    kind: 'sequential',
    colours: [...palette.sequential].map(hexFromPacked),
    pending: values === null,
    ...legend,
  });
  switch (mode) {
    case 'level':
      return {
        title: 'Generation level',
        unit: 'rings around the seed',
        kind: 'cyclic',
        range: [0, columns.lastLevel],
        colours: [...palette.levels].map(hexFromPacked),
      };
    case 'fate': {
      const entries = categories(FATE_LABELS, palette.fate, columns.count, (i) =>
        classOfSlots(columns.slots[i], columns.adaptive),
      );
      return { title: 'Slots', unit: '', kind: 'categories', entries, colours: entries.map((e) => e.colour) };
    }
    case 'valence': {
      const { valence } = columns;
      if (!valence)
        return {
          title: 'Neighbours',
          unit: '',
          kind: 'categories',
          entries: [],
          colours: [hexFromPacked(palette.plain)],
          pending: true,
        };
      const entries = categories(VALENCE_LABELS, palette.valence, columns.count, (i) => classOfValence(valence[i]));
      return { title: 'Neighbours', unit: '', kind: 'categories', entries, colours: entries.map((e) => e.colour) };
    }
    case 'nearest':
      return ramp({ title: 'Nearest distance', unit: '× 2r', range: [...NEAREST_SHARE], mark: 1 }, columns.nearest);
    case 'energy':
      return ramp({ title: 'Energy', range: [...ENERGY_RANGE], mark: 1 }, columns.energy);
    case 'residual':
      return ramp({ title: 'Residual', unit: '× r', range: [...RESIDUAL_SHARE] }, columns.residual);
    case 'radius':
      return ramp({ title: 'Radius', range: range ?? undefined }, range);
    case 'curvature':
      return {
        title: 'Mean curvature',
        unit: '1/length',
        kind: 'diverging',
        range: range ?? undefined,
        mark: 0,
        colours: [...palette.diverging].map(hexFromPacked),
        pending: range === null || columns.curved < columns.count,
      };
    case 'component': {
      if (!columns.component)
        return {
          title: 'Connected components',
          unit: '',
          kind: 'categories',
          entries: [],
          colours: [hexFromPacked(palette.plain)],
          pending: true,
        };
      const entries = componentEntries(columns.component, palette);
      return {
        title: 'Connected components',
        unit: '',
        kind: 'categories',
        entries,
        colours: entries.map((e) => e.colour),
      };
    }
    case 'normal':
      return {
        title: 'Normal',
        unit: '',
        kind: 'normal',
        entries: normalAxes(),
        colours: normalAxes().map((e) => e.colour),
      };
    default:
      return { title: 'Plain', unit: '', kind: 'plain', colours: [hexFromPacked(palette.plain)] };
  }
}

/**
 * Returns a legend entry for each of the largest components, and one for all others.
 * @param {Uint32Array} component @param {import('./palettes.js').Palette} palette
 * @returns {import('../types.js').LegendEntry[]}
 */
function componentEntries(component, palette) {
  /** @type {number[]} */
  const counts = [];
  for (const k of component) if (k !== NO_COMPONENT) counts[k] = (counts[k] ?? 0) + 1;
  const named = Math.min(COMPONENT_COLOURS, counts.length);
  const entries = counts.slice(0, named).map((count, k) => ({
    label: `component ${k + 1}`,
    colour: hexFromPacked(palette.components[k]),
    count: count ?? 0,
  }));
  if (counts.length > named) {
    const rest = counts.slice(named);
    entries.push({
      label: `${rest.length} more, in the same colours`,
      colour: hexFromPacked(palette.plain),
      count: rest.reduce((sum, n) => sum + (n ?? 0), 0),
    });
  }
  return entries;
}

/** Returns the colours of the six axis directions, as in `coloursOf`. */
function normalAxes() {
  const byte = (/** @type {number} */ v) => Math.round(255 * (0.525 + 0.375 * v));
  return /** @type {[string, number, number, number][]} */ ([
    ['+x', 1, 0, 0],
    ['−x', -1, 0, 0],
    ['+y', 0, 1, 0],
    ['−y', 0, -1, 0],
    ['+z', 0, 0, 1],
    ['−z', 0, 0, -1],
  ]).map(([label, x, y, z]) => ({
    label,
    colour: hexFromPacked(((255 << 24) | (byte(z) << 16) | (byte(y) << 8) | byte(x)) >>> 0),
  }));
}
