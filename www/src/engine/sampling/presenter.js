/**
 * Shows the runs on the page: writes the columns, the signals and the picture. The sampler makes the decisions.
 *
 * @module
 */
import { batch } from '@preact/signals-core';
import { MOST_STEPPED } from '../constants.js';
import { patternOf } from '../patterns.js';
import { VIEW } from '../share/view.js';
import { change, changeView, idleProgress } from '../store.js';
import { refusalNotice } from './faults.js';
import { KINDS } from './kinds.js';
import { timingOf } from './pace.js';

/**
 * @import { Store } from '../store.js'
 * @import { Columns, FieldAnswer, FieldRequest, Mesh, Progress, ToldProgress } from '../types.js'
 * @import {
 *   ColumnsMessage, DoneMessage, FromWorker, PastMessage, PictureLike, RecordMessage, ReportMessage, Job,
 *   Run,
 * } from './types.js'
 */

/** The figures in the report that come from the mesh. @param {Mesh} mesh */
const figuresOfMesh = ({ about: { volume, smallest_angle } }) => ({ volume, smallest_angle });

export class Presenter {
  /** Whether the particles on the page have followed the surface. */
  #followed;

  /** Whether the particles on the page belong to a run that has not ended. */
  #isUnfinished;

  /** Whether the last surface had colours of its own. */
  #isOwn = false;

  /** @param {{store: Store, columns: Columns, picture: PictureLike}} page */
  constructor({ store, columns, picture }) {
    this.store = store;
    this.columns = columns;
    this.picture = picture;
    this.#followed = false;
    this.#isUnfinished = false;
  }

  /**
   * Shows that the worker has started another job; whether the last one found a surface no longer matters. Runs during
   * a drag are so short that a text would flicker, so the old text stays until particles are counted.
   * @param {number} id @param {Job} job
   */
  begin(id, job) {
    const { kind } = job;
    if (kind === 'backdrop') return;
    const live = KINDS[kind].isLive === true;
    if (!live) this.#found();
    const phase = kind === 'relax' ? 'relaxation' : 'seeding';
    this.store.progress.value = { ...idleProgress(), run: id, live, phase };
  }

  /** Forgets that the last run found no surface. */
  #found() {
    const { result } = this.store;
    if (result.value === 'none') result.value = null;
  }

  /** Shows how far the field of a run is. @param {Run} run @param {number} fraction */
  making({ id }, fraction) {
    this.store.progress.value = { ...idleProgress(), run: id, phase: 'making', fraction };
  }

  /** @param {ToldProgress} progress @param {Run} run */
  progress(progress, { id, job }) {
    if (job.kind === 'backdrop') return;
    if (progress.particles > 0) this.#found();
    this.store.progress.value = { ...progress, run: id, live: KINDS[job.kind].isLive === true };
  }

  /**
   * Shows that no run is active. The progress then describes the particles on the page, unless a later run found no
   * surface. Particles of an interrupted run are partial.
   * @param {Partial<Progress>} [more]
   */
  idle(more = {}) {
    const { columns, store } = this;
    if (this.#isUnfinished) store.result.value = 'partial';
    store.progress.value = { ...idleProgress(), particles: columns.stale ? 0 : columns.particles, ...more };
  }

  /**
   * Shows a field that the core has accepted.
   * @param {FieldRequest} field
   * @param {Extract<FieldAnswer, {ok: true}>} answer
   * @param {boolean} [restoring]  whether another field was requested, whose error stays
   */
  field(field, answer, restoring = false) {
    const { store } = this;
    // The question about too many particles belongs to the previous field.
    if (store.notice.value?.id === 'size') store.notice.value = null;
    store.field.value = field.points !== undefined ? { ...answer, surface: field.surface ?? null } : answer;
    store.model.value = answer.model ?? null;
    const { grip } = answer;
    // The sliders follow a surface that is pulled.
    if (grip) change(store, { parameters: { ...field.parameters, ...grip.changed } });
    store.grip.value = grip;
    if (!restoring) store.fieldError.value = null;
  }

  /** Shows the box that was found for the field. @param {Extract<FieldAnswer, {ok: true}>} answer */
  box({ bounds, reach }) {
    const { field } = this.store;
    if (!field.value || JSON.stringify([bounds, reach]) === JSON.stringify([field.value.bounds, field.value.reach]))
      return;
    field.value = { ...field.value, bounds, reach };
  }

  /** Shows the error of a field that the core has refused. @param {Extract<FieldAnswer, {ok: false}>} answer */
  fault({ error }) {
    this.store.fieldError.value = error;
  }

  /**
   * Dims the surface if it is not the requested one. An empty formula is not an error and dims nothing.
   * @param {boolean} astray
   */
  dim(astray) {
    const fault = this.store.fieldError.value;
    this.picture.dim(astray || this.columns.stale || (fault !== null && fault.kind !== 'empty'));
  }

  /** Replaces the particles on the page by the first ones of a run. @param {Run} run */
  first({ job, bounds }) {
    const { store } = this;
    this.#isUnfinished = true;
    store.report.value = null;
    store.mesh.value = null;
    store.change.value = null;
    if (job.kind === 'relax') return;
    const { grows = false, fits = false, isLive = false } = KINDS[job.kind];
    this.columns.clear(job.settings.sampling === 'adaptive', patternOf(job.settings));
    this.columns.stale = job.kind === 'backdrop';
    // The new particles replace those that followed the surface there.
    this.picture.begin({ grow: grows, fit: fits, bounds, meets: this.#followed && !isLive });
    batch(() => {
      store.hover.value = null;
      if (this.columns.stale) store.result.value = 'none';
      else this.#found();
    });
  }

  /** @param {ColumnsMessage} message @param {Run} run @param {() => void} onDrawn */
  particles(message, run, onDrawn) {
    const { columns, picture, store } = this;
    if (!columns.write(message)) return onDrawn();
    columns.writeSlots(message.slotsFrom, message.slots);
    if (message.mesh) {
      columns.mesh = message.mesh;
      picture.meshed();
    }
    store.mesh.value = columns.mesh?.about ?? null;
    // The mesh may have been requested after the report.
    if (store.report.value && columns.mesh)
      store.report.value = { ...store.report.value, ...figuresOfMesh(columns.mesh) };
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

  /** Receives the positions before a run's relaxation steps. @param {PastMessage} message @param {Run} run */
  past({ positions }, { job }) {
    const { columns } = this;
    // Later steps continue the earlier ones if all of those were kept.
    const earlier = job.kind === 'relax' ? columns.past : [];
    const isWhole = earlier.length === 0 || columns.count <= MOST_STEPPED;
    columns.past = isWhole ? [...earlier, ...positions] : earlier;
    this.picture.remembered();
    this.store.revision.value += 1;
  }

  /**
   * Shows the end of a run, with or without a surface.
   * @param {DoneMessage} message
   * @param {Run} run
   * @param {number} particles
   */
  end({ outcome, progress, seconds, reportFollows, followed }, { id, job }, particles) {
    const { store, columns } = this;
    this.#followed = followed;
    this.#isUnfinished = false;
    const { isLive = false, fits = false } = KINDS[job.kind];
    if (job.kind === 'backdrop') return;
    if (particles === 0) {
      // The last surface stays visible until there is another, but it cannot be measured or exported.
      columns.stale = columns.count > 0;
      store.report.value = null;
      store.hover.value = null;
    }
    const isPartial = outcome === 'stopped' || progress?.stop_reason === 'cap';
    store.result.value = particles === 0 ? 'none' : isPartial ? 'partial' : 'whole';
    store.revision.value += 1;
    if (progress) {
      store.progress.value = { ...progress, run: id, live: isLive, phase: reportFollows ? 'quality' : 'done' };
    }
    store.timing.value = timingOf(seconds, particles, job.kind === 'relax' ? job.steps : 0);
    if (fits && particles > 0) this.picture.fit();
  }

  /** Shows the end of a run that has failed. @param {DoneMessage} message */
  failure({ id, outcome, message }) {
    this.idle({ run: id, phase: 'done', message: message || null });
    if (outcome === 'refused') this.store.notice.value = refusalNotice(message);
  }

  /** Receives the record of the particles on the page. @param {RecordMessage} message */
  record({ record }) {
    const { columns } = this;
    if (columns.count > 0 && !columns.stale) columns.record = record;
  }

  /** @param {Extract<FromWorker, {type: 'value'}>} message */
  valued({ values, fault }) {
    const { columns, store } = this;
    columns.writeValue(values);
    store.valueFault.value = fault;
    store.revision.value += 1;
    this.picture.recolour(0, columns.count);
  }

  /** @param {Extract<FromWorker, {type: 'change'}>} message */
  compared({ change }) {
    this.store.change.value = change;
  }

  /**
   * Shows the colours that a surface has as soon as it has some, unless another colouring was chosen.
   * @param {boolean} isOwn
   */
  #showOwn(isOwn) {
    const { store } = this;
    const [usual, now] = [VIEW.colour.home(), store.state.value.view.colour];
    if (isOwn && !this.#isOwn && now === usual) changeView(store, { colour: 'own' });
    if (!isOwn && now === 'own') changeView(store, { colour: usual });
    this.#isOwn = isOwn;
  }

  /** @param {ReportMessage} message */
  report({ report, own, ...figures }) {
    const { store, columns } = this;
    columns.writeFigures(figures);
    columns.writeOwn(own);
    batch(() => {
      this.#showOwn(Object.keys(own).length > 0);
      store.report.value = report;
      store.revision.value += 1;
      store.progress.value = { ...store.progress.value, phase: 'done' };
      store.timing.value = timingOf(report.seconds, report.count, store.timing.value?.steps ?? 0);
    });
    this.picture.recolour(0, columns.count);
  }
}
