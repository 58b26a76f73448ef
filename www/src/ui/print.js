/**
 * A part to be printed: its size in millimetres, and the thickness in the formula's units that gives a wall of so many
 * millimetres.
 */
import { signal } from '@preact/signals-core';

/**
 * @import { Body, Bounds, Engine, Vec3 } from '../engine/types.js'
 * @import { Print, Span } from './types.js'
 */

/** Default of a part's longest side: it fits every printer, and prints within hours. */
const USUAL_MM = 40;
/** Distance from a face of the box, as a share of the side, within which the face cuts the part. */
const AT_FACE = 1e-3;
/** Millimetres in each unit of a typed length. @type {Record<string, number>} */
const MM = { mm: 1, cm: 10, m: 1000, in: 25.4 };

/** A length with its unit, in millimetres; null for any other text. @param {string} text */
export function millimetresOf(text) {
  const [, digits, unit] = /^\s*(\d+(?:[.,]\d*)?|[.,]\d+)\s*(mm|cm|m|in)\s*$/.exec(text) ?? [];
  if (!unit) return null;
  return Number(digits.replace(',', '.')) * MM[unit];
}

/**
 * The sides of the bounding box of some bodies.
 * @param {readonly Pick<Body, 'min' | 'max'>[]} bodies
 * @returns {Vec3}
 */
export const sidesOf = (bodies) =>
  /** @type {Vec3} */ (
    [0, 1, 2].map((k) =>
      bodies.length === 0
        ? 0
        : Math.max(...bodies.map(({ max }) => max[k])) - Math.min(...bodies.map(({ min }) => min[k])),
    )
  );

/**
 * The longest side of a shell's bounding box, and how many of its two ends are not cut by the clip box, so that a
 * thicker shell reaches farther there.
 * @param {Pick<Bounds, 'min' | 'max'>} around
 * @param {Bounds | null} box  that cuts the surface
 * @returns {Span}
 */
export function spanOf({ min, max }, box) {
  const sides = [0, 1, 2].map((k) => max[k] - min[k]);
  const side = Math.max(...sides);
  const k = sides.indexOf(side);
  const isFree = (/** @type {number} */ end, /** @type {number | undefined} */ face) =>
    face === undefined || Math.abs(end - face) > AT_FACE * side;
  return { side, free: Number(isFree(min[k], box?.min[k])) + Number(isFree(max[k], box?.max[k])) };
}

/**
 * The thickness of a shell that gives the wanted wall once its longest side is scaled to the wanted size: each free end
 * moves by half the thickness. Null if the wall alone is larger than the size.
 * @param {number} wallMm @param {number} sizeMm
 * @param {Span & { thickness: number }} present
 */
export function thicknessOf(wallMm, sizeMm, { side, free, thickness }) {
  const rest = sizeMm - (free / 2) * wallMm;
  const base = side - (free / 2) * thickness;
  return rest > 0 && base > 0 ? (wallMm * base) / rest : null;
}

/** @param {Engine} engine @returns {Print} */
export function createPrint(engine) {
  const sizeMm = signal(USUAL_MM);
  /** The bounding box of the mesh, or else of the particles, which lie on the same surface. */
  const around = () => {
    const bodies = engine.mesh.value?.bodies ?? [];
    void engine.revision.value;
    const { positions, count } = engine.columns;
    /** @type {{ min: number[], max: number[] }} */
    const box = { min: [Infinity, Infinity, Infinity], max: [-Infinity, -Infinity, -Infinity] };
    const add = (/** @type {number} */ k, /** @type {number} */ low, /** @type {number} */ high) => {
      box.min[k] = Math.min(box.min[k], low);
      box.max[k] = Math.max(box.max[k], high);
    };
    for (const { min, max } of bodies) for (let k = 0; k < 3; k += 1) add(k, min[k], max[k]);
    if (bodies.length === 0) for (let i = 0; i < 3 * count; i += 1) add(i % 3, positions[i], positions[i]);
    return /** @type {Bounds} */ (box);
  };
  const span = () => spanOf(around(), engine.field.value?.bounds ?? null);
  /** The thickness setting; null for a formula. */
  const thickness = () => {
    const set = engine.state.value.settings.thickness ?? 0;
    return typeof set === 'number' ? set : null;
  };
  return {
    sizeMm,
    scale() {
      const { side } = span();
      return side > 0 ? sizeMm.value / side : null;
    },
    wall() {
      const [set, { side }] = [thickness(), span()];
      return set !== null && side > 0 ? (set * sizeMm.value) / side : null;
    },
    thickness(wallMm) {
      const present = span();
      if (!(present.side > 0)) return null;
      return thicknessOf(wallMm, sizeMm.value, { ...present, thickness: thickness() ?? 0 });
    },
  };
}
