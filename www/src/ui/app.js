/** Mounts the interface on an engine. */

import { computed, effect, signal, untracked } from '@preact/signals-core';
import { isBoxDrawn } from './box.js';
import { button } from './button.js';
import { byId, h, live, once, query } from './dom.js';
import { explain } from './explain.js';
import { mountDrop } from './field/drop.js';
import { mountField } from './field/panel.js';
import { createHistory } from './history.js';
import { mountLayout } from './layout.js';
import { createMeshButton } from './mesh/button.js';
import { createMotion } from './motion.js';
import { createPrint } from './print.js';
import { createReplace } from './replacing.js';
import { mountReport } from './report/panel.js';
import { mountSampling } from './sampling/panel.js';
import { isDue } from './sampling/settings.js';
import { COMMAND_KEY, mountShortcuts } from './shortcuts.js';
import { keepTheme, keptTheme, showTheme } from './theme.js';
import { mountToasts } from './toasts.js';
import { mountHover } from './view/hover.js';
import { createLegend } from './view/legend.js';
import { mountOverlay } from './view/overlay.js';
import { createToolbar } from './view/toolbar.js';

/**
 * @import { Description, Engine, ReadonlySignal, Signal, ViewState } from '../engine/types.js'
 * @import { Told } from './levels/types.js'
 * @import { Dialog, Hands, Motion, Shortcut, ShortcutTargets, Toast } from './types.js'
 */

/**
 * @param {Engine} engine @param {{ grabs?: boolean }} [how]  `grabs`: the surface can be dragged from the beginning
 * @returns shows a notice of the page
 */
export function mountInterface(engine, { grabs = false } = {}) {
  const [shell, view, stage] = [byId('shell'), byId('view'), byId('stage')];
  const [field, levels, sampling, report] = ['field', 'levels', 'sampling', 'report'].map((id) => byId(`panel-${id}`));
  const { toast, dismiss } = mountToasts(
    byId('toasts'),
    engine,
    ({ id, details }) => id === 'file' && !details && byId('field-body').checkVisibility(),
  );
  const samplingTools = h('div', { class: 'sampling-tools' });
  const head = (/** @type {HTMLElement} */ panel) => query(panel, '.panel-head');
  const layout = mountLayout({
    shell,
    view,
    nav: byId('tabs'),
    notices: byId('toasts'),
    panels: [
      { id: 'field', title: 'Surface', panel: field, head: head(field) },
      { id: 'sampling', title: 'Sampling', panel: sampling, head: samplingTools, folded: true },
      { id: 'levels', title: 'Levels', panel: levels },
      { id: 'report', title: 'Report', panel: report, head: head(report), folded: true },
    ],
    covered: () => (isBoxDrawn(engine) ? (view.querySelector('.empty')?.clientHeight ?? 0) : 0),
    inset: (insets) => engine.setInsets(insets),
  });
  const motion = createMotion(engine, stage);
  const { pins, brush, marking } = handsOf(grabs);
  const history = createHistory(
    engine,
    computed(
      () => motion.playing.value !== null || motion.turning.value || motion.filming.value || engine.dragging.value,
    ),
  );
  /** The generation level that the timeline shows, in words. @type {Signal<Told | null>} */
  const told = signal(null);
  /** @type {Promise<Description>} */
  const described = new Promise((resolve) => {
    live(shell, () => void (engine.description.value && resolve(engine.description.value)));
  });
  const timeline = described.then(() => loadTimeline(engine, told, toast));
  const { picture, print } = pictureOf(engine, motion, toast);
  const shortcuts = mountShortcuts(
    shortcutsOf(engine, {
      history,
      motion,
      pins,
      brush,
      marking,
      print,
      timeline,
      hide: layout.hideMore,
      open: () => shortcuts.open(),
    }),
  );
  endByEscape(engine, { motion, dismiss });

  followTheme(engine);
  nameTab(engine);
  query(field, '.fold').before(...historyButtons(history));
  mountDrop(engine, toast);
  mountOverlay(view, engine, { stage, poster: byId('poster'), start: byId('start'), told });
  // The layout counts the message that there is no surface as covered area, so that the message does not hide the box.
  for (const part of ['.empty', '.foot']) layout.follow(query(view, part));
  const boxDrawn = computed(() => isBoxDrawn(engine));
  live(view, () => {
    void boxDrawn.value;
    untracked(layout.measure);
  });
  linkLearn(engine);
  mountHover(stage, engine, { view, explainIt: (index) => void explainIt(engine, index) });
  byId('tabs').append(goButton(engine));

  void described.then(async (description) => {
    const shared = { motion, pins, marking, replace: createReplace(engine, toast), print: createPrint(engine) };
    const mesh = createMeshButton(engine, toast, shared.print);
    const [hide, makeMesh] = [layout.hideMore, () => void mesh.open()];
    const tools = { hide, shortcuts: shortcuts.open, picture, makeMesh, motion, toast };
    // Parts that cover the picture come first, because the camera's fit avoids them.
    const legend = createLegend(engine, description);
    view.prepend(legend, createToolbar(engine, tools));
    layout.follow(legend);
    for (const mountPart of [
      () => mountField(byId('field-body'), engine, description, shared),
      () => mountSampling(byId('sampling-body'), engine, description, { head: [mesh.element, samplingTools], brush }),
      () => mountReport(byId('report-body'), engine, description, byId('report-title')),
      () => loadMarks(engine, { stage, view, pins, brush, marking }),
    ]) {
      // Between two parts the browser can handle input and draw.
      await new Promise((resolve) => setTimeout(resolve));
      mountPart();
    }
  });
  void timeline.then((made) => {
    levels.hidden = made === null;
  });
  return toast;
}

/**
 * What a drag over the surface does in place of turning it, and what a press chooses in place of a particle.
 * @param {boolean} grabs @returns {Hands}
 */
const handsOf = (grabs) => ({
  pins: signal(grabs ? [] : null),
  brush: { on: signal(false), times: signal('0.5'), share: signal(0.06) },
  marking: signal(false),
});

/**
 * Loads the marks on the picture. The picture works without them.
 * @param {Engine} engine
 * @param {{ stage: HTMLElement, view: HTMLElement } & Hands} parts
 */
function loadMarks(engine, parts) {
  import('./view/marks/index.js').then(
    ({ mountAllMarks }) => mountAllMarks(engine, { ...parts, host: byId('canvas-host') }),
    () => {},
  );
}

/**
 * Loads the timeline; null if that fails, and the rest of the page still works.
 * @param {Engine} engine @param {Signal<Told | null>} told @param {Toast} toast
 */
async function loadTimeline(engine, told, toast) {
  try {
    const { createTimeline } = await import('./levels/timeline.js');
    const say = (/** @type {string} */ text) => toast({ id: 'link', kind: 'warn', text });
    return createTimeline(byId('levels-body'), engine, { told, say });
  } catch {
    return null;
  }
}

/**
 * Puts the surface into the link to the learn page. If that fails, the link leads there without it.
 * @param {Engine} engine
 */
function linkLearn(engine) {
  const link = query(document, '#learn-link', HTMLAnchorElement);
  import('./learn-link.js').then(
    ({ bindLearnLink }) => bindLearnLink(link, engine),
    () => {},
  );
}

/** Opens the lesson at a particle. @param {Engine} engine @param {number} index */
const explainIt = async (engine, index) =>
  location.assign((await import('./learn-link.js')).particleLink(engine, index));

/** Names the browser's tab after the surface. @param {Engine} engine */
function nameTab(engine) {
  effect(() => {
    const id = engine.field.value?.surface;
    const surface = engine.description.value?.surfaces.find((entry) => entry.id === id);
    document.title = surface ? `${surface.name} · Marching Particles` : 'Marching Particles';
  });
}

/** Applies the chosen theme to the page and the browser's frame, and stores the choice. @param {Engine} engine */
function followTheme(engine) {
  let isRead = false;
  // Waits for the first state, because a link may set the theme.
  const theme = computed(() => engine.state.value.surface && engine.state.value.view.theme);
  effect(() => {
    if (!theme.value) return;
    if (isRead) keepTheme(theme.value);
    else if (theme.value === 'auto' && keptTheme)
      engine.setView({ theme: /** @type {ViewState['theme']} */ (keptTheme) });
    isRead = true;
    showTheme(theme.value);
  });
  effect(() => {
    void engine.theme.value;
    // The browser's frame gets the background colour, even if the theme differs from the system's.
    const { backgroundColor } = getComputedStyle(document.documentElement);
    for (const meta of document.querySelectorAll('meta[name="theme-color"]'))
      meta.setAttribute('content', backgroundColor);
  });
}

/**
 * Returns the functions that open the dialog for saving the picture and print it. Both are loaded on first use.
 * @param {Engine} engine
 * @param {Motion} motion
 * @param {Toast} toast
 */
function pictureOf(engine, motion, toast) {
  const failed = () =>
    toast({ id: 'save', kind: 'error', text: 'A part of the page could not be loaded. Load it again.' });
  /** @type {Promise<Dialog> | null} */
  let dialog = null;
  return {
    picture() {
      dialog ??= import('./picture/dialog.js').then(({ createPictureDialog }) =>
        createPictureDialog(engine, { motion, toast }),
      );
      dialog.then(
        ({ open }) => open(),
        () => {
          dialog = null;
          failed();
        },
      );
    },
    print() {
      import('./picture/print.js').then(({ printPage }) => printPage(engine)).catch(failed);
    },
  };
}

/**
 * Makes Escape stop a run, or the growth that is shown after it, wherever the focus is; else it closes a notice. A
 * drag, a dialog and a list of completions come first.
 * @param {Engine} engine
 * @param {{ motion: Motion, dismiss: () => boolean }} page
 */
function endByEscape(engine, { motion, dismiss }) {
  const end = (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== 'Escape' || event.isComposing || engine.dragging.peek()) return;
    const within = event.composedPath();
    const isCompleting = within.some(
      (node) => node instanceof ShadowRoot && node.querySelector('.cm-tooltip-autocomplete'),
    );
    if (isCompleting || document.querySelector('dialog[open]')) return;
    if (engine.status.peek() === 'sampling' || engine.loading.peek() || engine.reveal.peek()) {
      if (!motion.stop()) engine.stop();
    } else if (!dismiss()) return;
    event.preventDefault();
    event.stopPropagation();
  };
  // Capturing, so that it runs before the focused element's own handler.
  addEventListener('keydown', end, true);
}

/**
 * Returns the shortcuts of the page.
 * @param {Engine} engine
 * @param {ShortcutTargets} page
 * @returns {Shortcut[]}
 */
function shortcutsOf(engine, { history, motion, pins, brush, marking, print, timeline, hide, open }) {
  const along = (/** @type {'toggle' | 'back' | 'forward' | 'first' | 'all'} */ command) => () =>
    void timeline.then((made) => made?.[command]());
  return [
    { keys: ['r', 'R'], shown: 'R', label: 'Run', act: () => engine.run() },
    {
      keys: ['Escape'],
      shown: 'Esc',
      label: 'Stop; close a notice; leave Grab, the brush, measuring or marking',
      act: () => {
        if (motion.stop()) return;
        if (pins.peek()) pins.value = null;
        else if (brush.on.peek()) brush.on.value = false;
        else if (marking.peek()) marking.value = false;
        else if (engine.state.peek().view.measured) engine.setView({ measured: null });
        else engine.pointOut(null);
      },
    },
    { keys: ['z', 'Z'], ctrl: true, shown: `${COMMAND_KEY} Z`, label: 'Undo', act: history.undo },
    { keys: ['z', 'Z'], ctrl: true, shift: true, shown: `${COMMAND_KEY} Shift Z`, label: 'Redo', act: history.redo },
    { keys: ['p', 'P'], ctrl: true, shown: `${COMMAND_KEY} P`, label: 'Print', act: print },
    { keys: ['g', 'G'], shown: 'G', label: 'Without relaxing', act: () => engine.generateOnly() },
    {
      keys: ['e', 'E'],
      shown: 'E',
      label: 'Relax one step',
      act: () => {
        if (engine.status.peek() !== 'sampling') engine.relax(1);
      },
    },
    { keys: ['p', 'P'], shown: 'P', label: 'Play or pause the timeline', act: along('toggle') },
    { keys: [','], shown: ',', label: 'Level back', act: along('back') },
    { keys: ['.'], shown: '.', label: 'Level forward', act: along('forward') },
    { keys: ['<'], shown: '<', label: 'First level', act: along('first') },
    { keys: ['>'], shown: '>', label: 'All levels', act: along('all') },
    { keys: ['o', 'O'], shown: 'O', label: 'Turntable', act: () => motion.toggleTurning() },
    { keys: ['f', 'F'], shown: 'F', label: 'Fit', act: () => engine.fit() },
    { keys: ['+', '='], shown: '+', label: 'Zoom in', act: () => engine.zoom(1.25) },
    { keys: ['-', '_'], shown: '−', label: 'Zoom out', act: () => engine.zoom(0.8) },
    {
      keys: ['m', 'M'],
      shown: 'M',
      label: 'Discs or mesh',
      act: () => engine.setView({ draw: engine.state.peek().view.draw === 'mesh' ? 'discs' : 'mesh' }),
    },
    {
      keys: ['d', 'D'],
      shown: 'D',
      label: 'Measure a distance',
      act: () => engine.setView({ measured: engine.state.peek().view.measured ? null : [] }),
    },
    { keys: ['c', 'C'], shown: 'C', label: 'Next colouring', act: () => nextColouring(engine) },
    {
      keys: ['t', 'T'],
      shown: 'T',
      label: 'Light or dark',
      act: () => engine.setView({ theme: engine.theme.peek() === 'dark' ? 'light' : 'dark' }),
    },
    { keys: ['h', 'H'], shown: 'H', label: 'Hide the panels; then the timeline, too; then show all', act: hide },
    { keys: ['?'], shown: '?', label: 'This help', act: open },
  ];
}

/** Creates the Run/Stop button that is always visible on a phone. @param {Engine} engine */
function goButton(engine) {
  const active = computed(() => engine.status.value === 'sampling' || engine.loading.value !== null);
  const press = once(() => {
    if (active.peek()) engine.stop();
    else engine.run();
  });
  const due = isDue(engine);
  const look = () => (due.value ? 'primary go due' : active.value ? 'go works' : 'go');
  return button({ class: look, press }, () => (active.value ? 'Stop' : 'Run'));
}

/** @param {ReturnType<typeof createHistory>} history */
const historyButtons = ({ canUndo, undo, canRedo, redo }) => [
  historyButton('undo', 'Undo', `${COMMAND_KEY} Z`, canUndo, undo, [canUndo, canRedo]),
  historyButton('redo', 'Redo', `${COMMAND_KEY} Shift Z`, canRedo, redo, [canUndo, canRedo]),
];

/**
 * @param {'undo' | 'redo'} name
 * @param {string} label
 * @param {string} keys
 * @param {ReadonlySignal<boolean>} can
 * @param {() => void} act
 * @param {ReadonlySignal<boolean>[]} either  without any of them neither button is shown
 */
function historyButton(name, label, keys, can, act, either) {
  const look = () => (either.some(({ value }) => value) ? 'plain square' : 'plain square invisible');
  return explain(button({ icon: name, class: look, 'aria-label': label, off: () => !can.value, press: act }), () => ({
    title: label,
    text: `Surface, formula, clip box, settings and camera. Keys ${keys}.`,
  }));
}

/** @param {Engine} engine */
function nextColouring(engine) {
  const colours = engine.description.peek()?.colours ?? [];
  const at = colours.findIndex(({ id }) => id === engine.state.peek().view.colour);
  const next = colours[(at + 1) % Math.max(1, colours.length)];
  if (next) engine.setView({ colour: next.id });
}
