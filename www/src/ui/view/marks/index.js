/** Puts all kinds of marks on the picture. This folder is loaded once the page is ready. */
import { axesMark, createScaleBar } from './axes.js';
import { boxMark } from './box.js';
import { brushMark, createBrushCard, createMiddle, Painter } from './brush.js';
import { mountMarks } from './layer.js';
import { createMarkCard, Marker, markMark } from './marking.js';
import { createMeasureCard, measureMark } from './measure.js';
import { createPinCard, pinMark } from './pins.js';
import { planeMark } from './plane.js';
import { sliceMark } from './slice.js';
import { spotMark } from './spot.js';

/**
 * @import { Engine } from '../../../engine/types.js'
 * @import { Hands } from '../../types.js'
 */

/**
 * @param {Engine} engine
 * @param {{ stage: HTMLElement, host: HTMLElement, view: HTMLElement } & Hands} parts  `host` holds the picture and
 *   lies in `stage`; `view` is the part that no panel covers
 */
export function mountAllMarks(engine, { stage, host, view, pins, brush, marking }) {
  const painter = new Painter(engine, brush);
  const middle = createMiddle(painter);
  const painted = brushMark(engine, { stage, host, brush, pins, painter, middle });
  const pinned = pinMark(engine, stage, pins);
  const marker = new Marker(engine, marking);
  engine.takeWith(
    (at, shift) => painter.take(at) ?? pinned.take?.(at, shift) ?? null,
    (at, tapped) => marker.notices(at, tapped),
  );
  mountMarks(stage, engine, [
    sliceMark(engine),
    axesMark(engine),
    boxMark(engine, stage),
    planeMark(engine, stage),
    measureMark(engine, host),
    pinned,
    painted,
    markMark(engine, { stage, host, marker, pins, brush }),
    spotMark(engine),
  ]);
  view.append(
    createScaleBar(engine),
    createMeasureCard(engine),
    createPinCard(engine, pins),
    createBrushCard(brush, painter, middle),
    createMarkCard(marker),
  );
}
