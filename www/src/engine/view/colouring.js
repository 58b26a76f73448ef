/**
 * Computes a colour for each particle, and the legend of the colours.
 *
 * @module
 */
import { fateOf } from '../columns.js';
import { FATE, MOST_SLOTS, NO_COMPONENT, SLOT_BITS } from '../core-numbers.js';
import { hexFromPacked } from './oklab.js';
import { COMPONENT_COLOURS, PALETTES } from './palettes.js';

/**
 * @import { ColourMode, Columns, Legend, LegendEntry } from '../types.js'
 * @import { Colouring, Palette, Theme } from './types.js'
 */

/** Number of slots of a particle in a uniform run: a hexagon. In an adaptive run it varies. */
const SLOTS = 6;

/**
 * Class of a particle by the worst fate of its slots: a slot failed, met the limit on particles, is outside the clip
 * box, is still open, or all are filled.
 * @typedef {'trouble' | 'capped' | 'border' | 'front' | 'interior'} SlotsClass
 */

/** @param {number} slots @param {boolean} adaptive @returns {SlotsClass} */
export function classOfSlots(slots, adaptive) {
  let seen = 0;
  for (let k = 0; k < (adaptive ? MOST_SLOTS : SLOTS); k += 1) seen |= 1 << fateOf(slots, k);
  // The number of slots of an adaptive particle is known once the front has processed it; slots that are still open
  // then are unused.
  if (adaptive && slots >>> SLOT_BITS !== 0) seen &= ~(1 << FATE.open);
  if (seen & ((1 << FATE.not_converged) | (1 << FATE.undefined))) return 'trouble';
  if (seen & (1 << FATE.capped)) return 'capped';
  if (seen & (1 << FATE.outside)) return 'border';
  return seen & (1 << FATE.open) ? 'front' : 'interior';
}

/** @param {number} valence */
export function classOfValence(valence) {
  if (valence === 0) return 'none';
  if (valence <= 4) return 'four';
  if (valence >= 8) return 'eight';
  return valence === 5 ? 'five' : valence === 6 ? 'six' : 'seven';
}

/** Range of nearest distances that the ramp covers, as shares of the ideal distance 2r. */
const NEAREST_SHARE = /** @type {const} */ ([0.6, 1.2]);

/** Range of energies that the ramp covers; a perfect lattice has 1. */
const ENERGY_RANGE = /** @type {const} */ ([0.6, 1.4]);

/** Range of residuals divided by the radius that the ramp covers, on a logarithmic scale. */
const RESIDUAL_SHARE = /** @type {const} */ ([1e-8, 1e-2]);

/**
 * Share of the curvatures that the diverging ramp covers; sharp features would make the rest look flat.
 */
const CURVATURE_QUANTILE = 0.95;
/** Number of curvatures sampled for that quantile. */
const CURVATURE_SAMPLES = 4096;

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

const AT_BOX = 'at the clip box';
/** Labels of the classes of slots and of valence, in the order of the legend. */
const FATE_LABELS = /** @type {const} */ ([
  ['interior', 'all slots filled'],
  ['border', AT_BOX],
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
 * @param {Columns} columns
 * @param {(i: number) => K} classOf
 */
function categories(labels, colours, columns, classOf) {
  const counts = new Map();
  for (let i = 0; i < columns.count; i += 1) {
    if (columns.isFurther(i)) continue;
    const k = classOf(i);
    counts.set(k, (counts.get(k) ?? 0) + 1);
  }
  return labels
    .map(([key, label]) => ({ label, colour: hexFromPacked(colours[key]), count: counts.get(key) ?? 0, key }))
    .filter((entry) => entry.count > 0 || entry.key === 'six' || entry.key === 'interior')
    .map(({ label, colour, count: n }) => ({ label, colour, count: n }));
}

/** @param {ArrayLike<number>} packed */
const hexes = (packed) => Array.from(packed, hexFromPacked);

/** The smallest and the largest radius. @param {Columns} columns @returns {[number, number] | null} */
function radiusRange({ count, radii }) {
  let low = Infinity;
  let high = 0;
  for (let i = 0; i < count; i += 1) {
    if (radii[i] < low) low = radii[i];
    if (radii[i] > high) high = radii[i];
  }
  return count > 0 ? [low, high] : null;
}

/**
 * ± the 95 % quantile of the absolute values.
 * @param {number} count @param {(i: number) => number} valueAt @returns {[number, number] | null}
 */
function evenRange(count, valueAt) {
  const step = Math.ceil(count / CURVATURE_SAMPLES);
  const sizes = [];
  for (let i = 0; i < count; i += step) {
    const size = Math.abs(valueAt(i));
    if (size < Infinity) sizes.push(size);
  }
  if (sizes.length === 0) return null;
  sizes.sort((a, b) => a - b);
  const most = sizes[Math.floor(CURVATURE_QUANTILE * (sizes.length - 1))];
  return [-most, most];
}

/** @param {Columns} columns */
const curvatureRange = (columns) => evenRange(columns.curved, (i) => meanCurvature(columns, i));

/**
 * The smallest and the largest value; for values of both signs a range symmetric around 0.
 * @param {Float32Array | null | undefined} value @returns {[number, number] | null}
 */
function valueRange(value) {
  if (!value) return null;
  let [low, high] = [Infinity, -Infinity];
  for (const v of value) {
    if (!Number.isFinite(v)) continue;
    low = Math.min(low, v);
    high = Math.max(high, v);
  }
  if (low > high) return null;
  return low < 0 && high > 0 ? evenRange(value.length, (i) => value[i]) : [low, high];
}

/**
 * A colouring by a number of each particle, plain where it is NaN.
 * @param {string} title @param {(columns: Columns) => Float32Array | null | undefined} valuesIn @returns {Colouring}
 */
const byValues = (title, valuesIn) => ({
  range: (columns) => valueRange(valuesIn(columns)),
  colour({ palette, columns, range }) {
    const values = valuesIn(columns);
    if (!range || !values) return null;
    const [low, high] = range;
    const colours = low < 0 && high > 0 ? palette.diverging : palette.sequential;
    return (i) => (Number.isNaN(values[i]) ? palette.plain : onRamp(colours, values[i], low, high));
  },
  legend({ palette, range }) {
    const isDiverging = range !== null && range[0] < 0 && range[1] > 0;
    return {
      title,
      kind: isDiverging ? 'diverging' : 'sequential',
      range: range ?? undefined,
      ...(isDiverging ? { mark: 0 } : {}),
      colours: hexes(isDiverging ? palette.diverging : palette.sequential),
    };
  },
});

/** The colouring by `colour = …` in a formula. */
const OWN_NUMBER = byValues('Its own colour', ({ own }) => own?.colour);

/** Labels for the border class if the surface has edges, and if it has smooth joins. */
const BESIDE_EDGES = 'at an edge or the box';
const BESIDE_SEAMS = 'at an edge, a smooth join or the box';

/**
 * A colouring by classes. `classOf` returns the class of a particle; it is null until the classes are known.
 * @template {string} K
 * @param {string} title @param {readonly (readonly [K, string])[]} labels
 * @param {(palette: Palette) => Record<K, number>} coloursOf
 * @param {(columns: Columns) => ((i: number) => K) | null} classesOf
 * @returns {Colouring}
 */
const classes = (title, labels, coloursOf, classesOf) => ({
  colour({ palette, columns }) {
    const [colours, classOf] = [coloursOf(palette), classesOf(columns)];
    return classOf && ((i) => colours[classOf(i)]);
  },
  legend({ palette, columns }) {
    const classOf = classesOf(columns);
    const entries = classOf && categories(labels, coloursOf(palette), columns, classOf);
    const beside = columns.seams.length > 0 ? BESIDE_SEAMS : BESIDE_EDGES;
    if (columns.twins.length > 0) for (const entry of entries ?? []) if (entry.label === AT_BOX) entry.label = beside;
    return byEntries(title, palette, entries);
  },
});

/**
 * A legend of entries, pending until they are known.
 * @param {string} title @param {Palette} palette @param {LegendEntry[] | null} entries
 */
const byEntries = (title, palette, entries) => ({
  title,
  kind: /** @type {const} */ ('categories'),
  entries: entries ?? [],
  colours: entries ? entries.map(({ colour }) => colour) : [hexFromPacked(palette.plain)],
});

/**
 * A colouring by a sequential ramp. `valuesIn` returns the value of a particle; it is null until the values are known.
 * @param {Pick<Legend, 'title' | 'mark'> & {unit?: string}} legend
 * @param {readonly [number, number] | ((columns: Columns) => [number, number] | null)} span
 * @param {(columns: Columns) => ((i: number) => number) | null} valuesIn
 * @param {(value: number) => number} [scale]  gives the quantity that is linear along the ramp
 * @returns {Colouring}
 */
const ramp = (legend, span, valuesIn, scale = (value) => value) => ({
  range: typeof span === 'function' ? span : undefined,
  colour({ palette: { sequential }, columns, range }) {
    const ends = typeof span === 'function' ? range : span;
    const valueAt = valuesIn(columns);
    if (!ends || !valueAt) return null;
    const [low, high] = ends.map(scale);
    return (i) => onRamp(sequential, scale(valueAt(i)), low, high);
  },
  legend: ({ palette, range }) => ({
    kind: 'sequential',
    range: typeof span === 'function' ? (range ?? undefined) : [...span],
    colours: hexes(palette.sequential),
    ...legend,
  }),
});

/** Labels where a pattern has no levels, and no slots. */
const UNRANKED = 'independent points: no levels';
const SLOTLESS = 'points of a pattern: no slots';

/** Where the rings begin. Pinned particles without a curve are at tips. @param {Columns} columns */
const unitOfLevels = ({ curves, twins, pattern }) => {
  if (pattern === 'blue') return 'rounds of darts';
  if (curves.length > 0) return `rings from the ${curves.join(' and ')}`;
  return twins.length > 0 ? 'rings from the tips' : 'rings around the seed';
};

const BY_SLOTS = classes(
  'Slots',
  FATE_LABELS,
  ({ fate }) => fate,
  ({ slots, adaptive }) =>
    (i) =>
      classOfSlots(slots[i], adaptive),
);

/** @type {Record<ColourMode, Colouring>} */
export const COLOURINGS = {
  level: {
    isTinted: true,
    range: ({ lastLevel }) => [0, lastLevel],
    colour({ palette, columns: { levels, twins }, range }) {
      const last = range?.[1] ?? 0;
      const colours = palette.levels(last, twins.length > 0);
      return (i) => colours[Math.min(levels[i], last)];
    },
    legend({ palette, columns }) {
      const colours = hexes(palette.levels(columns.lastLevel, columns.twins.length > 0));
      const title = 'Generation level';
      if (columns.pattern === 'random')
        return { title, kind: 'categories', entries: [{ label: UNRANKED, colour: colours[0] }], colours };
      return { title, unit: unitOfLevels(columns), kind: 'sequential', range: [0, columns.lastLevel], colours };
    },
  },
  fate: {
    colour: (context) =>
      context.columns.pattern === 'hexagonal' ? BY_SLOTS.colour(context) : () => context.palette.plain,
    legend(context) {
      if (context.columns.pattern === 'hexagonal') return BY_SLOTS.legend(context);
      const { palette } = context;
      return byEntries('Slots', palette, [{ label: SLOTLESS, colour: hexFromPacked(palette.plain) }]);
    },
  },
  valence: classes(
    'Neighbours',
    VALENCE_LABELS,
    (palette) => palette.valence,
    ({ valence }) => valence && ((i) => classOfValence(valence[i])),
  ),
  nearest: ramp(
    { title: 'Nearest distance', unit: '× 2r', mark: 1 },
    NEAREST_SHARE,
    ({ nearest, radii }) => nearest && ((i) => nearest[i] / (2 * radii[i])),
  ),
  energy: ramp({ title: 'Energy', mark: 1 }, ENERGY_RANGE, ({ energy }) => energy && ((i) => energy[i])),
  residual: ramp(
    { title: 'Residual', unit: '× r' },
    RESIDUAL_SHARE,
    ({ residual, radii }) => residual && ((i) => residual[i] / radii[i]),
    Math.log10,
  ),
  radius: ramp(
    { title: 'Radius' },
    radiusRange,
    ({ radii }) =>
      (i) =>
        radii[i],
  ),
  curvature: {
    range: curvatureRange,
    colour({ palette, columns, range }) {
      if (!range) return null;
      const [low, high] = range;
      return (i) => {
        const mean = i < columns.curved ? meanCurvature(columns, i) : NaN;
        return Number.isNaN(mean) ? palette.plain : onRamp(palette.diverging, mean, low, high);
      };
    },
    legend: ({ palette, columns, range }) => ({
      title: 'Mean curvature',
      unit: '1/length',
      kind: 'diverging',
      range: range ?? undefined,
      mark: 0,
      colours: hexes(palette.diverging),
      pending: range === null || columns.curved < columns.count,
    }),
  },
  value: byValues('A formula', ({ value }) => value),
  own: {
    ...OWN_NUMBER,
    colour(context) {
      const { red, green, blue } = context.columns.own ?? {};
      if (!red) return OWN_NUMBER.colour(context);
      const { palette } = context;
      return (i) => (Number.isNaN(red[i] + green[i] + blue[i]) ? palette.plain : packed([red[i], green[i], blue[i]]));
    },
    legend(context) {
      const { own } = context.columns;
      if (own?.colour) return OWN_NUMBER.legend(context);
      const title = own && !own.red ? 'This surface has no colours of its own' : 'Its own colours';
      return { title, kind: 'plain', colours: [], pending: own === null };
    },
  },
  component: {
    colour: ({ palette, columns: { component } }) =>
      component &&
      ((i) => (component[i] === NO_COMPONENT ? palette.plain : palette.components[component[i] % COMPONENT_COLOURS])),
    legend: ({ palette, columns: { component } }) =>
      byEntries('Connected components', palette, component && componentEntries(component, palette)),
  },
  normal: {
    colour({ columns: { normals } }) {
      return (i) => colourOfDirection(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
    },
    legend: () => ({
      title: 'Normal',
      kind: 'normal',
      entries: NORMAL_AXES,
      colours: NORMAL_AXES.map(({ colour }) => colour),
    }),
  },
  plain: {
    isTinted: true,
    colour({ palette }) {
      return () => palette.plain;
    },
    legend: ({ palette }) => ({ title: 'Plain', kind: 'plain', colours: [hexFromPacked(palette.plain)] }),
  },
};

/**
 * Returns the values at both ends of a ramp whose range depends on the particles; null for other modes and before
 * values are known.
 * @param {ColourMode} mode @param {Columns} columns
 */
export const rangeOf = (mode, columns) => COLOURINGS[mode].range?.(columns) ?? null;

/**
 * Returns the colours of particles `first … last`, as `0xAABBGGRR`. Until a mode's values are known, the colour is
 * plain.
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
  const colour = COLOURINGS[mode].colour({ palette, columns, range });
  if (!colour) return out.fill(palette.plain);
  for (let i = first; i < last; i += 1) out[i - first] = colour(i);
  return out;
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
  const { colour, legend } = COLOURINGS[mode];
  const context = { palette: PALETTES[theme], columns, range };
  return { unit: '', pending: colour(context) === null, ...legend(context) };
}

/** Returns the legend entries of the dots on the vertices of a mesh. @param {Theme} theme @returns {LegendEntry[]} */
export const legendOfDots = (theme) =>
  VALENCE_LABELS.filter(([key]) => key !== 'six' && key !== 'none').map(([key, label]) => ({
    label,
    colour: hexFromPacked(PALETTES[theme].valence[key]),
  }));

/**
 * Returns a legend entry for each of the largest components, and one for all others.
 * @param {Uint32Array} component @param {Palette} palette
 * @returns {LegendEntry[]}
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

/**
 * Returns the colour of a unit vector. Channels range over 0.15 … 0.9 instead of 0 … 1, so that no direction is black
 * or too bright.
 * @param {number} x @param {number} y @param {number} z
 */
const colourOfDirection = (x, y, z) =>
  packed(/** @type {[number, number, number]} */ ([x, y, z].map((v) => 0.525 + 0.375 * v)));

/** Returns a colour of three channels from 0 to 1 as `0xAABBGGRR`. @param {[number, number, number]} channels */
function packed(channels) {
  const [r, g, b] = channels.map((v) => Math.round(255 * Math.min(1, Math.max(0, v))));
  return ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

/** The six directions along the axes, for the legend. */
const NORMAL_AXES = /** @type {const} */ ([
  ['+x', 1, 0, 0],
  ['−x', -1, 0, 0],
  ['+y', 0, 1, 0],
  ['−y', 0, -1, 0],
  ['+z', 0, 0, 1],
  ['−z', 0, 0, -1],
]).map(([label, x, y, z]) => ({ label, colour: hexFromPacked(colourOfDirection(x, y, z)) }));
