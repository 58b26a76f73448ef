/** Mounts the interface on an engine. */
import { computed, effect, signal } from '@preact/signals-core';
import { byId, h, once } from './dom.js';
import { explain } from './explain.js';
import { mountDrop } from './field/drop.js';
import { mountField } from './field/panel.js';
import { createHistory } from './history.js';
import { icon } from './icons.js';
import { mountLayout } from './layout.js';
import { mountReport } from './report/panel.js';
import { mountSampling } from './sampling/panel.js';
import { COMMAND_KEY, mountShortcuts } from './shortcuts.js';
import { mountToasts } from './toasts.js';
import { mountHover } from './view/hover.js';
import { createLegend } from './view/legend.js';
import { mountOverlay } from './view/overlay.js';
import { createToolbar } from './view/toolbar.js';

/** @typedef {import('../engine/types.js').Engine} Engine */

/** @param {Engine} engine */
export function mountInterface(engine) {
  const [shell, view, stage] = [byId('shell'), byId('view'), byId('stage')];
  const [field, levels, sampling, report] = ['field', 'levels', 'sampling', 'report'].map((id) => byId(`panel-${id}`));
  const toast = mountToasts(
    byId('toasts'),
    engine,
    ({ id, details }) => id === 'file' && !details && byId('field-body').checkVisibility(),
  );
  const samplingTools = h('div', { class: 'sampling-tools' });
  const head = (/** @type {HTMLElement} */ panel) => /** @type {HTMLElement} */ (panel.querySelector('.panel-head'));
  const layout = mountLayout({
    shell,
    view,
    nav: byId('tabs'),
    panels: [
      { id: 'field', title: 'Field', panel: field, head: head(field) },
      { id: 'sampling', title: 'Sampling', panel: sampling, head: samplingTools },
      { id: 'levels', title: 'Levels', panel: levels },
      { id: 'report', title: 'Report', panel: report, head: head(report) },
    ],
    inset: (insets) => engine.setInsets(insets),
  });
  const history = createHistory(engine);
  /** @type {import('./levels/timeline.js').Timeline | null} */
  let timeline = null;
  /** The generation level chosen on the timeline, in words. */
  const told = signal(/** @type {import('./levels/timeline.js').Told | null} */ (null));
  const shortcuts = mountShortcuts([
    { keys: ['r', 'R'], shown: 'R', label: 'Run', act: () => engine.run() },
    {
      keys: ['Escape'],
      shown: 'Esc',
      label: 'Stop',
      act: () => {
        if (engine.busy.peek() || engine.loading.peek()) engine.stop();
      },
    },
    { keys: ['z', 'Z'], ctrl: true, shown: `${COMMAND_KEY} Z`, label: 'Undo', act: history.undo },
    { keys: ['z', 'Z'], ctrl: true, shift: true, shown: `${COMMAND_KEY} Shift Z`, label: 'Redo', act: history.redo },
    { keys: ['g', 'G'], shown: 'G', label: 'Generate only', act: () => engine.generateOnly() },
    {
      keys: ['e', 'E'],
      shown: 'E',
      label: 'Relax one step',
      act: () => {
        if (!engine.busy.peek()) engine.relax(1);
      },
    },
    { keys: ['p', 'P'], shown: 'P', label: 'Play or pause the levels', act: () => timeline?.toggle() },
    { keys: [','], shown: ',', label: 'Level back', act: () => timeline?.back() },
    { keys: ['.'], shown: '.', label: 'Level forward', act: () => timeline?.forward() },
    { keys: ['<'], shown: '<', label: 'First level', act: () => timeline?.first() },
    { keys: ['>'], shown: '>', label: 'All levels', act: () => timeline?.all() },
    { keys: ['f', 'F'], shown: 'F', label: 'Fit', act: () => engine.fit() },
    { keys: ['+', '='], shown: '+', label: 'Zoom in', act: () => engine.zoom(1.25) },
    { keys: ['-', '_'], shown: '−', label: 'Zoom out', act: () => engine.zoom(0.8) },
    {
      keys: ['m', 'M'],
      shown: 'M',
      label: 'Discs or mesh',
      act: () => engine.setView({ draw: engine.state.peek().view.draw === 'mesh' ? 'discs' : 'mesh' }),
    },
    { keys: ['c', 'C'], shown: 'C', label: 'Next colouring', act: () => nextColouring(engine) },
    {
      keys: ['t', 'T'],
      shown: 'T',
      label: 'Light or dark',
      act: () => engine.setView({ theme: engine.theme.peek() === 'dark' ? 'light' : 'dark' }),
    },
    { keys: ['h', 'H'], shown: 'H', label: 'Hide or show the panels', act: () => layout.toggleHidden() },
    { keys: ['?'], shown: '?', label: 'This sheet', act: () => shortcuts.open() },
  ]);

  effect(() => {
    const { theme } = engine.state.value.view;
    if (theme === 'auto') delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = theme;
  });
  effect(() => {
    void engine.theme.value;
    // The browser's frame gets the background colour, even if the theme differs from the system's.
    const { backgroundColor } = getComputedStyle(document.documentElement);
    for (const meta of document.querySelectorAll('meta[name="theme-color"]'))
      meta.setAttribute('content', backgroundColor);
  });
  effect(() => {
    const id = engine.field.value?.surface;
    const surface = engine.description.value?.surfaces.find((entry) => entry.id === id);
    document.title = surface ? `${surface.name} · Marching Particles` : 'Marching Particles';
  });

  head(field)
    .querySelector('.fold')
    ?.before(
      historyButton('undo', 'Undo', `${COMMAND_KEY} Z`, history.canUndo, history.undo),
      historyButton('redo', 'Redo', `${COMMAND_KEY} Shift Z`, history.canRedo, history.redo),
    );
  mountDrop(engine, toast);
  mountOverlay(view, engine, { stage, poster: byId('poster'), start: byId('start'), told });
  mountHover(stage, engine);
  byId('tabs').append(goButton(engine));

  let mounted = false;
  effect(() => {
    const description = engine.description.value;
    if (!description || mounted) return;
    mounted = true;
    mountField(byId('field-body'), engine, description);
    mountSampling(byId('sampling-body'), engine, description, { head: [samplingTools] });
    mountReport(byId('report-body'), engine, description);
    const legend = createLegend(engine, description);
    view.prepend(legend, createToolbar(engine, { hide: layout.toggleHidden, shortcuts: shortcuts.open, toast }));
    layout.follow(legend);
    shell.dataset.ready = '';
    import('./levels/timeline.js').then(
      ({ createTimeline }) => {
        timeline = createTimeline(byId('levels-body'), engine, told);
      },
      // If the timeline fails to load, the rest of the page still works.
      () => {
        levels.hidden = true;
      },
    );
  });
}

/** Creates the Run/Stop button that is always visible on a phone. @param {Engine} engine */
function goButton(engine) {
  const active = computed(() => engine.busy.value || engine.loading.value !== null);
  const press = once(() => {
    if (active.peek()) engine.stop();
    else engine.run();
  });
  const button = h('button', { type: 'button', class: 'button primary go', on: { click: press } });
  effect(() => {
    button.textContent = active.value ? 'Stop' : 'Run';
  });
  return button;
}

/**
 * @param {'undo' | 'redo'} name
 * @param {string} label
 * @param {string} keys
 * @param {import('@preact/signals-core').ReadonlySignal<boolean>} can
 * @param {() => void} act
 */
function historyButton(name, label, keys, can, act) {
  const button = h(
    'button',
    {
      type: 'button',
      class: 'button plain square',
      'aria-label': label,
      on: {
        click: () => {
          if (can.peek()) act();
        },
      },
    },
    icon(name),
  );
  effect(() => button.setAttribute('aria-disabled', String(!can.value)));
  explain(button, () => ({ title: label, text: `Surface, formula, clip box and settings. Keys ${keys}.` }));
  return button;
}

/** @param {Engine} engine */
function nextColouring(engine) {
  const colours = engine.description.peek()?.colours ?? [];
  const at = colours.findIndex(({ id }) => id === engine.state.peek().view.colour);
  const next = colours[(at + 1) % Math.max(1, colours.length)];
  if (next) engine.setView({ colour: /** @type {import('../engine/types.js').ColourMode} */ (next.id) });
}
