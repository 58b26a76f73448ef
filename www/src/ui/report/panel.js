/** The report: how good the particles are, how long it took, how their distances spread. */
import { computed, effect } from '@preact/signals-core';
import { fill, h } from '../dom.js';
import { createTable } from './table.js';
import { createTiming } from './timing.js';
import { createHistogram } from './histogram.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

/**
 * @param {HTMLElement} body
 * @param {Engine} engine
 * @param {import('../../engine/types.js').Description} description
 */
export function mountReport(body, engine, description) {
  // While a run is under way the figures of the one before stay, dimmed.
  let kept = engine.report.peek();
  const report = computed(() => {
    kept = engine.report.value ?? kept;
    return kept;
  });
  effect(() => { body.classList.toggle('stale', engine.report.value === null); });

  const warnings = h('ul', { class: 'section warnings' });
  effect(() => {
    const list = report.value?.warnings ?? [];
    warnings.hidden = list.length === 0;
    fill(warnings, list.map((text) => h('li', null, text)));
  });
  const waiting = h('p', { class: 'quiet waiting' }, 'The figures appear when the first run is done.');
  effect(() => { waiting.hidden = report.value !== null; });
  const backend = h('p', { class: 'section quiet backend' });
  effect(() => {
    const names = { starting: 'Graphics starting', webgpu: 'Drawn with WebGPU', webgl2: 'Drawn with WebGL2', canvas2d: 'Drawn as dots, without graphics acceleration' };
    const adapter = engine.adapter.value;
    fill(backend, `${names[engine.backend.value]}${adapter ? `, ${adapter}` : ''}. Version ${description.version}.`);
  });
  fill(body, waiting, warnings, createTable(report, description.report), createTiming(engine), createHistogram(report, engine.theme), backend);
}
