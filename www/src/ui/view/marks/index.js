/** Puts all kinds of marks on the picture. This folder is loaded once the page is ready. */
import { axesMark, createScaleBar } from './axes.js';
import { boxMark } from './box.js';
import { brushMark, createBrushCard, createMiddle, Painter } from './brush.js';
import { mountMarks } from './layer.js';
import { createMeasureCard, measureMark } from './measure.js';
import { createPinCard, pinMark } from './pins.js';
import { planeMark } from './plane.js';
import { sliceMark } from './slice.js';
import { spotMark } from './spot.js';

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Brush, Pins } from '../../types.js'
 */

/**
 * @param {Engine} engine
 * @param {{ stage: HTMLElement, host: HTMLElement, view: HTMLElement, pins: Pins, brush: Brush }} parts  `host` holds
 *   the picture and lies in `stage`; `view` is the part that no panel covers
 */
export function mountAllMarks(engine, { stage, host, view, pins, brush }) {
  const painter = new Painter(engine, brush);
  const middle = createMiddle(painter);
  const painted = brushMark(engine, { stage, host, brush, pins, painter, middle });
  const pinned = pinMark(engine, stage, pins);
  engine.takeWith((at, shift) => painter.take(at) ?? pinned.take?.(at, shift) ?? null);
  mountMarks(stage, engine, [
    sliceMark(engine),
    axesMark(engine),
    boxMark(engine, stage),
    planeMark(engine, stage),
    measureMark(engine, host),
    pinned,
    painted,
    spotMark(engine),
  ]);
  view.append(
    createScaleBar(engine),
    createMeasureCard(engine),
    createPinCard(engine, pins),
    createBrushCard(brush, painter, middle),
  );
}
