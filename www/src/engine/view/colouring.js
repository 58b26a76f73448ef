/**
 * A colour per particle and the legend that explains it.
 *
 * @module
 */
import { hexFromPacked } from './oklab.js';
import { CYCLE, PALETTES, RAMP } from './palettes.js';

/**
 * @typedef {import('../columns.js').Columns} Columns
 * @typedef {import('../types.js').ColourMode} ColourMode
 * @typedef {import('../types.js').Legend} Legend
 * @typedef {import('./palettes.js').Theme} Theme
 */

/** Slot fates as the core numbers them. */
export const FATE = { open: 0, parent: 1, added: 2, matched: 3, notConverged: 4, outside: 5, undefined: 6, capped: 7 };

/**
 * What the six slots of a particle say together, the worst first: a slot that failed, one that met the limit on particles,
 * one outside the clip box, one not decided yet, or six that are filled.
 * @typedef {'trouble' | 'capped' | 'border' | 'front' | 'interior'} SlotsClass
 */

/** @param {number} slots @returns {SlotsClass} */
export function classOfSlots(slots) {
  let seen = 0;
  for (let k = 0; k < 6; k += 1) seen |= 1 << ((slots >> (3 * k)) & 7);
  if (seen & ((1 << FATE.notConverged) | (1 << FATE.undefined))) return 'trouble';
  if (seen & (1 << FATE.capped)) return 'capped';
  if (seen & (1 << FATE.outside)) return 'border';
  return seen & (1 << FATE.open) ? 'front' : 'interior';
}

/** @param {number} valence @returns {'none' | 'four' | 'five' | 'six' | 'seven' | 'eight'} */
export function classOfValence(valence) {
  if (valence === 0 || valence === 255) return 'none';
  if (valence <= 4) return 'four';
  if (valence >= 8) return 'eight';
  return valence === 5 ? 'five' : valence === 6 ? 'six' : 'seven';
}

/** Range of the nearest distance that the ramp covers, as shares of the ideal distance 2r. */
const NEAREST_SHARE = /** @type {const} */ ([0.6, 1.2]);

/** The ramp's ends: the ideal distance 2r lies at two thirds. @param {number} radius @returns {[number, number]} */
const nearestRange = (radius) => [2 * radius * NEAREST_SHARE[0], 2 * radius * NEAREST_SHARE[1]];

/**
 * Colours of particles `first … last`, as `0xAABBGGRR`.
 *
 * A mode that needs the report's figures (valence, nearest distance) gives the plain colour until they are there.
 * @param {ColourMode} mode
 * @param {Theme} theme
 * @param {Columns} columns
 * @param {number} first
 * @param {number} last
 */
export function coloursOf(mode, theme, columns, first, last) {
  const palette = PALETTES[theme];
  const out = new Uint32Array(last - first);
  const { levels, slots, normals, valence, nearest, radii } = columns;
  switch (mode) {
    case 'level':
      for (let i = first; i < last; i += 1) out[i - first] = palette.levels[levels[i] % CYCLE];
      return out;
    case 'fate':
      for (let i = first; i < last; i += 1) out[i - first] = palette.fate[classOfSlots(slots[i])];
      return out;
    case 'valence':
      if (!valence) break;
      for (let i = first; i < last; i += 1) out[i - first] = palette.valence[classOfValence(valence[i])];
      return out;
    case 'nearest':
      if (!nearest) break;
      for (let i = first; i < last; i += 1) {
        const share = nearest[i] / (2 * radii[i]);
        const t = Math.min(1, Math.max(0, (share - NEAREST_SHARE[0]) / (NEAREST_SHARE[1] - NEAREST_SHARE[0])));
        out[i - first] = palette.sequential[Math.round(t * (RAMP - 1)) || 0];
      }
      return out;
    case 'normal':
      for (let i = first; i < last; i += 1) {
        // 0.15 … 0.9 instead of 0 … 1, so that no direction is black or blinding.
        const channel = (/** @type {number} */ k) => Math.round(255 * (0.525 + 0.375 * normals[3 * i + k])) & 255;
        out[i - first] = ((255 << 24) | (channel(2) << 16) | (channel(1) << 8) | channel(0)) >>> 0;
      }
      return out;
    default:
  }
  return out.fill(palette.plain);
}

/** What a level, a class of slots or of valence is called, in the legend's order. */
const FATE_LABELS = /** @type {const} */ ([
  ['interior', 'all six slots filled'],
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
  ['none', 'at a border'],
]);

/**
 * How many particles fall in each class.
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
 * The legend of what {@link coloursOf} paints.
 * @param {ColourMode} mode
 * @param {Theme} theme
 * @param {Columns} columns
 * @returns {Legend}
 */
export function legendOf(mode, theme, columns) {
  const palette = PALETTES[theme];
  switch (mode) {
    case 'level':
      return { title: 'Generation level', unit: '', kind: 'cyclic', range: [0, lastLevel(columns)], colours: [...palette.levels].map(hexFromPacked) };
    case 'fate': {
      const entries = categories(FATE_LABELS, palette.fate, columns.count, (i) => classOfSlots(columns.slots[i]));
      return { title: 'Slots', unit: '', kind: 'categories', entries, colours: entries.map((e) => e.colour) };
    }
    case 'valence': {
      const { valence } = columns;
      if (!valence) return { title: 'Neighbours', unit: '', kind: 'categories', entries: [], colours: [hexFromPacked(palette.plain)], pending: true };
      const entries = categories(VALENCE_LABELS, palette.valence, columns.count, (i) => classOfValence(valence[i]));
      return { title: 'Neighbours', unit: '', kind: 'categories', entries, colours: entries.map((e) => e.colour) };
    }
    case 'nearest': {
      const radius = columns.count ? columns.radii[0] : 0;
      return {
        title: 'Nearest distance', unit: '', kind: 'sequential', range: nearestRange(radius), mark: 2 * radius,
        colours: [...palette.sequential].map(hexFromPacked), pending: columns.nearest === null,
      };
    }
    case 'normal':
      return { title: 'Normal', unit: '', kind: 'normal', entries: normalAxes(), colours: normalAxes().map((e) => e.colour) };
    default:
      return { title: 'Plain', unit: '', kind: 'plain', colours: [hexFromPacked(palette.plain)] };
  }
}

/** @param {Columns} columns */
function lastLevel({ levels, count }) {
  let last = 0;
  for (let i = 0; i < count; i += 1) if (levels[i] > last) last = levels[i];
  return last;
}

/** The colours of the three axes, up and down, as `coloursOf` paints them. */
function normalAxes() {
  const byte = (/** @type {number} */ v) => Math.round(255 * (0.525 + 0.375 * v));
  return /** @type {[string, number, number, number][]} */ ([
    ['+x', 1, 0, 0], ['−x', -1, 0, 0], ['+y', 0, 1, 0], ['−y', 0, -1, 0], ['+z', 0, 0, 1], ['−z', 0, 0, -1],
  ]).map(([label, x, y, z]) => ({ label, colour: hexFromPacked(((255 << 24) | (byte(z) << 16) | (byte(y) << 8) | byte(x)) >>> 0) }));
}
