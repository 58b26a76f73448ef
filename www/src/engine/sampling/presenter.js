/**
 * What the page shows of the runs: writes the columns, the signals and the picture. It decides nothing; the client does.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { idleProgress } from '../store.js';
import { refusalNotice } from './faults.js';
import { timingOf, timingOfReport } from './pace.js';

/**
 * @typedef {import('./protocol.js').ColumnsMessage} ColumnsMessage
 * @typedef {import('./protocol.js').DoneMessage} DoneMessage
 * @typedef {import('./run-state.js').Run} Run
 * @typedef {import('./run-state.js').RunRequest} RunRequest
 * @typedef {import('../types.js').FieldAnswer} FieldAnswer
 */
/**
 * What is told of the picture.
 * @typedef {object} Picture
 * @property {(options: {grow: boolean, fit: boolean, bounds: import('../types.js').Bounds | null}) => void} begin  a new surface takes the place of the old one
 * @property {(first: number, last: number, onDrawn: () => void) => void} changed  columns first … last are new
 * @property {(from: number, last: number) => void} recolour  colours first … last may be new
 * @property {() => void} fit
 * @property {(dim: boolean) => void} dim
 */

export class Presenter {
  /** @param {{store: import('../store.js').Store, columns: import('../columns.js').Columns, picture: Picture}} page */
  constructor({ store, columns, picture }) {
    this.store = store;
    this.columns = columns;
    this.picture = picture;
  }

  /** The worker is at another job. @param {number} id @param {RunRequest} request */
  begin(id, request) {
    const phase = request.kind === 'relax' ? 'relaxation' : 'seeding';
    this.store.progress.value = { ...idleProgress(), run: id, live: request.live, phase };
  }

  /** @param {import('../types.js').CoreProgress} progress @param {Run} run */
  progress(progress, { id, request }) {
    this.store.progress.value = { ...progress, run: id, live: request.live };
  }

  /** Nothing is under way: what is on the page is all there is. @param {Partial<import('../types.js').Progress>} [more] */
  idle(more = {}) {
    this.store.progress.value = { ...idleProgress(), particles: this.columns.count, ...more };
  }

  /** The core took a field. @param {import('../types.js').FieldRequest} field @param {Extract<FieldAnswer, {ok: true}>} answer */
  field(field, answer) {
    const { store } = this;
    // Too many particles were asked for before: no longer.
    if (store.notice.value?.id === 'size') store.notice.value = null;
    store.field.value = field.points !== undefined ? { ...answer, surface: field.surface ?? null } : answer;
    store.model.value = answer.model ?? null;
    store.fieldError.value = null;
  }

  /** The core refused one. @param {Extract<FieldAnswer, {ok: false}>} answer */
  fault({ error }) {
    this.store.fieldError.value = error;
  }

  /** Dims a surface that is not the one asked for. An empty editor is no mistake: nothing is dimmed for it. @param {boolean} astray */
  dim(astray) {
    const fault = this.store.fieldError.value;
    this.picture.dim(astray || this.columns.stale || (fault !== null && fault.kind !== 'empty'));
  }

  /** The first particles of a run take the place of those on the page. @param {Run} run */
  first({ request, bounds }) {
    const { store } = this;
    store.report.value = null;
    if (request.kind !== 'sample') return;
    this.columns.clear(request.settings.sampling === 'adaptive');
    this.picture.begin({ grow: request.grow, fit: request.fit, bounds });
    batch(() => {
      store.hover.value = null;
      store.empty.value = false;
    });
  }

  /** @param {ColumnsMessage} message @param {Run} run @param {() => void} onDrawn */
  particles(message, run, onDrawn) {
    const { columns, picture, store } = this;
    if (!columns.write(message)) return onDrawn();
    columns.writeSlots(message.slotsFrom, message.slots);
    if (message.curvature.length > 0) {
      columns.writeCurvature(message.curvatureFrom, message.curvature);
      picture.recolour(message.curvatureFrom, columns.count);
    }
    const n = message.radii.length;
    if (n > 0) picture.changed(message.first, message.first + n, onDrawn);
    else onDrawn();
    picture.recolour(message.slotsFrom, columns.count);
    if (message.progress) this.progress(message.progress, run);
    store.revision.value += 1;
  }

  /** A run ended with a surface, or found that there is none. @param {DoneMessage} message @param {Run} run @param {number} particles */
  end({ outcome, progress, seconds, reportFollows }, { id, request }, particles) {
    const { store, columns } = this;
    if (particles === 0) {
      // The last surface stays until there is another, and is nothing to measure or to take away.
      columns.stale = columns.count > 0;
      store.report.value = null;
      store.hover.value = null;
    }
    store.empty.value = particles === 0;
    store.revision.value += 1;
    store.partial.value = outcome === 'stopped' || progress?.stop_reason === 'cap';
    if (progress) {
      store.progress.value = { ...progress, run: id, live: request.live, phase: reportFollows ? 'quality' : 'done' };
    }
    store.timing.value = timingOf(seconds, particles, request.live);
    if (request.fit && particles > 0) this.picture.fit();
  }

  /** A run came to nothing. @param {DoneMessage} message */
  failure({ id, outcome, message }) {
    this.idle({ run: id, phase: 'done', message: message || null });
    if (outcome === 'refused') this.store.notice.value = refusalNotice(message);
  }

  /** @param {import('./protocol.js').ReportMessage} message */
  report({ report, valence, nearest, residual, component }) {
    const { store, columns } = this;
    columns.writeFigures({ valence, nearest, residual, component });
    batch(() => {
      store.report.value = report;
      store.revision.value += 1;
      store.progress.value = { ...store.progress.value, phase: 'done' };
      store.timing.value = timingOfReport(report);
    });
    this.picture.recolour(0, columns.count);
  }
}
