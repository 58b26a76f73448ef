/** The toolbar beside the picture: zoom, fit, view options, link, picture, export. */

import { computed } from '@preact/signals-core';
import { DISC_SIZE } from '../../engine/constants.js';
import { isBareModel } from '../../engine/pulls.js';
import { button } from '../button.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { formatShare } from '../format.js';
import { attachMenu } from '../menu.js';
import { copyCode, copyLink, exportFile } from '../share.js';
import { createSlider } from '../slider.js';

/**
 * @import { Engine, Language, ViewState } from '../../engine/types.js'
 * @import { IconName } from '../icons.js'
 * @import { ButtonProps, Motion } from '../types.js'
 * @import { ToolbarOptions } from './types.js'
 */

const ZOOM = 1.25;
const TURN_RAD = Math.PI / 12;
/**
 * @param {Engine} engine
 * @param {ToolbarOptions} page
 */
export function createToolbar(engine, { hide, shortcuts, picture, makeMesh, motion, toast }) {
  const view = tool('options', 'View options', 'Turning, discs or mesh, theme.');
  const save = tool('save', 'Export', 'The particles, or the mesh over them, as a file.', undefined, ASIDE);
  const bar = h(
    'div',
    { class: 'toolbar', role: 'group', 'aria-label': 'View tools' },
    tool('fit', 'Fit', 'Brings the whole surface into view. Key F.', () => engine.fit()),
    view,
    pointsToggle(engine),
    tool('help', 'Help', 'What the page does, and its keys. Key ?', shortcuts),
    h('span', { class: 'rule aside', 'aria-hidden': 'true' }),
    tool('plus', 'Zoom in', 'Key +', () => engine.zoom(ZOOM), ASIDE),
    tool('minus', 'Zoom out', 'Key −', () => engine.zoom(1 / ZOOM), ASIDE),
    h('span', { class: 'rule aside', 'aria-hidden': 'true' }),
    tool(
      'link',
      'Copy link',
      'A link that holds the whole state and the camera.',
      () => copyLink(engine, toast),
      ASIDE,
    ),
    tool('picture', 'Save picture', 'The picture as a file, on paper, or as a film.', picture, ASIDE),
    save,
  );
  attachMenu(
    view,
    [
      turning(engine, motion),
      standing(engine),
      choices(engine, 'Projection', 'projection', [
        ['perspective', 'Perspective'],
        ['orthographic', 'Orthographic'],
      ]),
      ...drawing(engine),
      scale(engine),
      switches(engine, 'At rest', [
        ['flow', 'Keep flowing', 'Particles that followed a moving surface stay, without their order.'],
      ]),
      theme(engine),
      choice('Measure a distance', () => engine.setView({ measured: [] })),
      choice('Hide the panels', hide),
    ],
    {
      label: 'View options',
    },
  );
  attachMenu(
    save,
    [
      heading('Particles'),
      choice('Export PLY', () => exportFile(engine, toast, 'ply'), 'position, normal, radius, level, parent, valence'),
      choice('Export CSV', () => exportFile(engine, toast, 'csv'), 'one line per particle'),
      choice(
        'Export record',
        () => exportFile(engine, toast, 'json'),
        'formula, box and settings, as JSON; PLY includes it',
      ),
      heading('Mesh'),
      choice('Export mesh…', makeMesh, 'GLB, 3MF, STL, OBJ or PLY'),
      heading('Copy as code'),
      codes(engine, toast),
    ],
    { label: 'Export' },
  );
  return bar;
}

/** Of what is seen while the pointer is on the picture. */
const ASIDE = { class: 'square tool aside' };

/**
 * @param {IconName} icon @param {string} label @param {string} text
 * @param {() => void} [press]
 * @param {ButtonProps} [props]
 */
const tool = (icon, label, text, press, props) =>
  explain(
    button({ class: 'square tool', icon, 'aria-label': label, press, ...props }),
    () => ({ title: label, text }),
    { side: 'left' },
  );

/** Creates the switch that shows the points of a model. @param {Engine} engine */
function pointsToggle(engine) {
  const shown = computed(() => engine.state.value.view.points);
  const act = () => engine.setView({ points: !shown.peek() });
  return tool('points', 'Show points', 'The points that the surface is built from, as dots.', act, {
    hidden: () => !isBareModel(engine.field.value) || engine.state.value.pulls.length > 0,
    'aria-pressed': () => String(shown.value),
  });
}

/** @param {string} text */
const heading = (text) => h('p', { class: 'menu-head quiet' }, text);

/** Creates the buttons that copy a program. @param {Engine} engine @param {ToolbarOptions['toast']} toast */
function codes(engine, toast) {
  /** @type {[Language, string][]} */
  const languages = [
    ['python', 'Python'],
    ['js', 'JavaScript'],
    ['rust', 'Rust'],
    ['shell', 'Shell'],
  ];
  const buttons = languages.map(([language, name]) =>
    button({ class: 'small', data: { closes: '' }, press: () => copyCode(engine, toast, language, name) }, name),
  );
  return h('div', { class: 'menu-line codes', role: 'group', 'aria-label': 'Copy code' }, buttons);
}

/** @param {string} label @param {() => void} press @param {string} [note] */
const choice = (label, press, note) =>
  button({ data: { closes: '' }, press }, label, note && h('span', { class: 'unit note' }, note));

/**
 * Creates buttons that turn the picture, for users who cannot drag, and one that keeps it turning.
 * @param {Engine} engine @param {Motion} motion
 */
function turning(engine, motion) {
  /** @type {[IconName, string, number, number][]} */
  const turns = [
    ['left', 'Turn left', -1, 0],
    ['right', 'Turn right', 1, 0],
    ['up', 'Tilt up', 0, -1],
    ['down', 'Tilt down', 0, 1],
  ];
  return line('Turn', [
    ...turns.map(([icon, label, x, y]) =>
      button({
        class: 'square',
        icon,
        'aria-label': label,
        press: () => engine.orbit(x * TURN_RAD, y * TURN_RAD),
      }),
    ),
    button({
      class: 'square',
      icon: 'turntable',
      'aria-label': 'Turntable',
      'aria-pressed': () => String(motion.turning.value),
      press: motion.toggleTurning,
    }),
  ]);
}

/** Creates the buttons of the named views. @param {Engine} engine */
const standing = (engine) =>
  line(
    'View',
    /** @type {const} */ (['front', 'right', 'top', 'isometric']).map((name) =>
      button({ class: 'small', press: () => engine.lookFrom(name) }, name[0].toUpperCase() + name.slice(1)),
    ),
  );

/** @param {Engine} engine */
function discSize(engine) {
  return createSlider({
    name: 'Disc size',
    scale: DISC_SIZE,
    value: () => engine.state.value.view.size,
    describe: (value) => `${formatShare(value, 0)} of the repulsion radius`,
    change: (value) => engine.setView({ size: value }),
    reset: () => engine.setView({ size: DISC_SIZE.initial }),
    number: false,
  }).range;
}

/**
 * Creates a line of buttons for a value of the view, of which one is pressed.
 * @template {'draw' | 'faces' | 'projection' | 'theme'} K
 * @param {Engine} engine
 * @param {string} name
 * @param {K} key
 * @param {[ViewState[K], string][]} values
 * @param {() => boolean} [hidden]
 */
function choices(engine, name, key, values, hidden) {
  const chosen = computed(() => engine.state.value.view[key]);
  const buttons = values.map(([value, label]) =>
    press(
      label,
      () => chosen.value === value,
      () => engine.setView({ [key]: value }),
    ),
  );
  return line(name, buttons, hidden);
}

/**
 * Creates a line of buttons that switch parts of the view on and off.
 * @param {Engine} engine
 * @param {string} name
 * @param {['edges' | 'marks' | 'creases' | 'body' | 'axes' | 'box' | 'bar' | 'flow', string,
 *   string][]} parts  key, label, explanation
 * @param {() => boolean} [hidden]
 */
function switches(engine, name, parts, hidden) {
  const buttons = parts.map(([key, label, text]) => {
    const on = computed(() => engine.state.value.view[key]);
    const toggle = press(
      label,
      () => on.value,
      () => engine.setView({ [key]: !on.peek() }),
    );
    return explain(toggle, () => ({ title: label, text }), { side: 'left' });
  });
  return line(name, buttons, hidden);
}

/** @param {string} label @param {() => boolean} isOn @param {() => void} act */
const press = (label, isOn, act) => button({ class: 'small', 'aria-pressed': () => String(isOn()), press: act }, label);

/** @param {string} name @param {HTMLElement[]} buttons @param {() => boolean} [hidden] */
const line = (name, buttons, hidden) =>
  h(
    'div',
    { class: 'menu-line', role: 'group', 'aria-label': name, hidden },
    h('span', null, name),
    h('span', { class: 'pad' }, buttons),
  );

/** Creates the choice of the way of drawing, with what belongs to each way. @param {Engine} engine */
function drawing(engine) {
  const drawn = computed(() => engine.state.value.view.draw);
  const noDiscs = () => drawn.value !== 'discs';
  const noParticles = () => drawn.value === 'mesh';
  const noMesh = () => drawn.value !== 'mesh';
  const defects =
    'Dots on the vertices that do not have six neighbours, in the colours of “Neighbours”: blue for five, orange for seven.';
  const beneath = 'A body beneath the discs closes the gaps between them. Without it the far side shows through.';
  /** @type {Parameters<typeof switches>[2]} */
  const shown = [
    ['edges', 'Edges', 'The edges of the faces.'],
    ['marks', 'Defects', defects],
  ];
  return [
    choices(engine, 'Draw', 'draw', [
      ['discs', 'Discs'],
      ['spheres', 'Spheres'],
      ['mesh', 'Mesh'],
    ]),
    h('div', { class: 'menu-line', hidden: noDiscs }, h('span', null, 'Disc size'), discSize(engine)),
    switches(engine, 'Beneath', [['body', 'Body', beneath]], noParticles),
    choices(
      engine,
      'Faces',
      'faces',
      [
        ['smooth', 'Smooth'],
        ['flat', 'Flat'],
      ],
      noMesh,
    ),
    switches(engine, 'Show', shown, noMesh),
    switches(engine, 'Edges', [['creases', 'Creases', 'Lines along the sharp edges of the surface.']], () => {
      void engine.revision.value;
      return engine.columns.segments.length === 0;
    }),
  ];
}

/** @param {Engine} engine */
const scale = (engine) =>
  switches(engine, 'Scale', [
    ['axes', 'Axes', 'Axes with ticks around the surface.'],
    ['box', 'Box', 'The clip box with a handle on each face and, without axes, its lengths.'],
    ['bar', 'Bar', 'A scale bar. It holds in the middle of the picture; what is nearer looks longer.'],
  ]);

/** @param {Engine} engine */
const theme = (engine) =>
  choices(engine, 'Theme', 'theme', [
    ['auto', 'System'],
    ['light', 'Light'],
    ['dark', 'Dark'],
  ]);
