/**
 * The report panel: four figures, and behind them all figures, the timing and the distribution of the
 * nearest distances.
 */
import { computed } from '@preact/signals-core';
import { term } from '../button.js';
import { fill, h, live } from '../dom.js';
import { plural, withCounts } from '../format.js';
import { remembered } from '../remembered.js';
import { createWarning } from '../warning.js';
import { createHistogram } from './histogram.js';
import { listOf, placeOf } from './places.js';
import { PLAIN } from './plain.js';
import { createTable } from './table.js';
import { createTiming } from './timing.js';

/** @import { Description, Engine, ReadonlySignal, Report, ReportRow } from '../../engine/types.js' */

const DRAWN = {
  starting: 'Graphics starting',
  webgpu: 'Drawn with WebGPU',
  webgl2: 'Drawn with WebGL2',
  canvas2d: 'Painted without a graphics card',
};

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {Description} description
 * @param {HTMLElement} title  next to which a folded report shows its summary
 */
export function mountReport(body, engine, description, title) {
  // During a run the previous figures stay, dimmed, except for the count, which is that of the caption.
  let kept = engine.report.peek();
  const report = computed(() => {
    kept = engine.result.value === 'none' ? null : (engine.report.value ?? kept);
    return kept;
  });
  const counted = computed(() =>
    engine.status.value === 'sampling' || !engine.report.value ? engine.progress.value.particles : 0,
  );
  const stale = computed(() => engine.report.value === null);
  live(body, () => {
    body.classList.toggle('stale', stale.value || counted.value > 0);
  });

  const warningsOf = (/** @type {boolean} */ areNotes) =>
    computed(() => report.value?.warnings.filter(({ severity }) => (severity === 'note') === areNotes) ?? []);
  const [told, noted] = [warningsOf(false), warningsOf(true)];
  // The line of a folded report.
  const line = h('span', { class: 'quiet now' }, () => {
    if (!report.value) return '';
    const particles = plural(counted.value || report.value.count, 'particle');
    return told.value.length > 0 ? `${particles}\n${plural(told.value.length, 'warning')}` : particles;
  });
  title.after(line);
  const items = (/** @type {typeof told} */ list) => () =>
    list.value.map(({ message }) => createWarning(withCounts(message)));
  const warnings = h('ul', { class: 'section warnings', hidden: () => told.value.length === 0 }, items(told));
  // Properties of the surface itself, which need no action.
  const notes = h(
    'details',
    { class: 'section notes quiet', hidden: () => noted.value.length === 0 },
    h('summary', null, () => plural(noted.value.length, 'note')),
    h('ul', { class: 'warnings' }, items(noted)),
  );
  const isWhoseHidden = () => report.value === null || whoseFigures(engine) === '';
  const whose = h('p', { class: 'quiet whose', hidden: isWhoseHidden }, () => whoseFigures(engine));
  // The mesh's own figures, and the line under the picture, include the border.
  const excluded = computed(() => report.value?.quality?.boundary_excluded ?? 0);
  const border = h(
    'p',
    { class: 'quiet', hidden: () => excluded.value === 0 },
    () =>
      `Order, triangles and spacing leave out ${plural(excluded.value, 'particle')} at the border; the figures of the mesh do not.`,
  );
  const waiting = h('p', { class: 'quiet waiting', hidden: () => report.value !== null }, () =>
    engine.result.value === 'none'
      ? 'Nothing to measure: there is no surface inside the box.'
      : 'The figures appear when a run is done.',
  );
  const drawn = term(
    () => ({ title: 'Graphics adapter', text: engine.adapter.peek() || 'Not named by the browser.' }),
    { side: 'left' },
    () => DRAWN[engine.backend.value],
  );
  const said = h('p', { class: 'visually-hidden', role: 'status' });
  const backend = h('p', { class: 'section quiet backend' }, drawn, h('span', null, `Version ${description.version}`));
  fill(
    body,
    waiting,
    whose,
    warnings,
    createPlain(report, counted),
    notes,
    createAll(
      border,
      createTable(report, description.report, { counted, stale, show: createShow(engine, said) }),
      said,
      createTiming(engine, report),
      createHistogram(report, engine),
      backend,
    ),
  );
}

/**
 * @param {ReadonlySignal<Report | null>} report
 * @param {ReadonlySignal<number>} counted  particles of a run without a report yet, or 0
 */
function createPlain(report, counted) {
  return h(
    'dl',
    { class: 'section facts plain-figures', hidden: () => report.value === null },
    PLAIN.map(({ label, help, write }) => [
      h(
        'dt',
        null,
        term(() => ({ title: label, text: help }), { side: 'left' }, label),
      ),
      h(
        'dd',
        null,
        () => report.value && write(counted.value ? { ...report.value, count: counted.value } : report.value),
      ),
    ]),
  );
}

/** Creates the fold of the rest of the report; its state is stored. @param {...HTMLElement} parts */
function createAll(...parts) {
  const isOpen = remembered('report', false);
  return h(
    'details',
    {
      class: 'section all-figures',
      prop: { open: () => isOpen.value },
      on: {
        toggle: ({ currentTarget }) => {
          isOpen.value = /** @type {HTMLDetailsElement} */ (currentTarget).open;
        },
      },
    },
    h('summary', { class: 'disclose' }, 'All figures'),
    ...parts,
  );
}

/**
 * Says that the figures are those of all particles, if the picture shows fewer or earlier ones.
 * @param {Engine} engine
 */
function whoseFigures(engine) {
  const { level, step } = engine.state.value.view;
  if (level === null && step === null) return '';
  return 'Figures describe the finished run; the picture shows an earlier step.';
}

/**
 * Returns a function that shows the places of a figure in the picture, one per press.
 * @param {Engine} engine
 * @param {HTMLElement} said  tells assistive technology what is shown
 */
function createShow(engine, said) {
  /** The list shown last, and the index of its next place. @type {{ list: unknown, next: number }} */
  let last = { list: null, next: 0 };
  return (/** @type {ReportRow} */ row) => {
    const list = listOf(engine.report.peek(), row.places);
    if (list.length === 0) return;
    const index = last.list === list ? last.next : 0;
    const place = placeOf(list, index, engine.columns);
    engine.pointOut(place);
    said.textContent = `${row.label}: ${place.text}, in the middle of the picture`;
    last = { list, next: (index + 1) % list.length };
  };
}
