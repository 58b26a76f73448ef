/** Things of a surface that stay when its formula changes, in words, each with the action that removes it. */
import { dot, triple } from '../engine/vector.js';
import { formatSignificant } from './format.js';
import { equationOf } from './space.js';

/** @import { Columns, CuttingPlane, Engine } from '../engine/types.js' */

/** @typedef {{ text: string, end: string, act: () => void }} Kept */

/**
 * Returns whether a plane hides every particle.
 * @param {Pick<Columns, 'count' | 'positions'>} columns @param {CuttingPlane} plane
 */
export function hidesAll({ count, positions }, { normal, offset }) {
  for (let i = 0; i < count; i += 1) if (dot(normal, triple(positions, i)) <= offset) return false;
  return count > 0;
}

/** What stays, and the action that removes it. @param {Engine} engine @returns {Kept[]} */
export function keptOf(engine) {
  const { plane, bounds, settings } = engine.state.value;
  void engine.revision.value;
  /** @type {Kept[]} */
  const kept = [];
  if (plane) {
    const equation = equationOf(plane);
    kept.push({
      text: `${equation ? `Cut at ${equation}` : 'Cut by a plane'}${hidesAll(engine.columns, plane) ? ', which hides everything' : ''}`,
      end: 'End the cut',
      act: () => engine.setPlane(null),
    });
  }
  if (settings.thickness !== undefined)
    kept.push({
      text: `Thickness ${typeof settings.thickness === 'string' ? settings.thickness : formatSignificant(settings.thickness, 3)}`,
      end: 'End the thickness',
      act: () => engine.resetSetting('thickness'),
    });
  if (settings.spacing)
    kept.push({
      text: `Spacing ${settings.spacing}`,
      end: 'End the spacing',
      act: () => engine.resetSetting('spacing'),
    });
  if (settings.box_faces !== undefined)
    kept.push({
      text: 'Closed by the box',
      end: 'Open it again',
      act: () => engine.resetSetting('box_faces'),
    });
  if (settings.box_faces !== undefined && settings.box_cell !== undefined)
    kept.push({
      text: 'Opposite faces alike',
      end: 'Do not make opposite faces alike',
      act: () => engine.resetSetting('box_cell'),
    });
  if (settings.beyond_points !== undefined && engine.field.value?.model)
    kept.push({
      text: 'Kept beyond its points',
      end: 'End the surface where its points end',
      act: () => engine.resetSetting('beyond_points'),
    });
  if (bounds !== null || settings.box_mode !== undefined)
    kept.push({
      text: engine.enlargement() ? 'Enlarged box' : 'Box set by hand',
      end: 'Put the box around the surface',
      act: () => engine.fitBox(),
    });
  return kept;
}
