/**
 * The panel of a mesh: its purpose, the verdict, the settings kept for the surface, its size in a file, and how to save
 * it.
 */

import { computed, signal } from '@preact/signals-core';
import { givenOf } from '../../engine/given.js';
import { button } from '../button.js';
import { h, live, uniqueId } from '../dom.js';
import { formatCount, formatSignificant, plural } from '../format.js';
import { keptOf } from '../kept.js';
import { figuresOf, verdictOf } from '../mesh-words.js';
import { numberBox } from '../number.js';
import { millimetresOf } from '../print.js';
import { createSegmented } from '../segmented.js';
import { createSelect } from '../select.js';
import { saveMesh } from '../share.js';
import { borderOf } from './borders.js';

/**
 * @import { Engine, MeshAnswer, MeshFormat } from '../../engine/types.js'
 * @import { Print, Toast } from '../types.js'
 */

/** What a mesh is saved for. @typedef {'print' | 'view'} Use */
/** @type {{ value: Use, label: string }[]} */
const USES = [
  { value: 'print', label: 'For printing' },
  { value: 'view', label: 'For viewers' },
];
/**
 * File formats for each use, with a note on their contents; the default first.
 * @type {Record<Use, [MeshFormat, string][]>}
 */
const FORMATS = {
  print: [
    ['3mf', 'With its unit'],
    ['stl', 'Triangles only. Programs take its numbers for millimetres'],
  ],
  view: [
    ['glb', 'Normals, and levels as colours; in metres'],
    ['obj', 'Triangles and normals, as text'],
    ['ply', 'Triangles and normals'],
    ['stl', 'Triangles only, no record of what they were made from'],
    ['3mf', 'Triangles with their unit'],
  ],
};
/** Symbols of units; without a unit, numbers are not converted. */
const UNITS = ['', 'mm', 'cm', 'm', 'in'];
const AXES = ['z', 'y', 'x'];

/** Whether the surface comes from a file or a model. @param {Engine} engine */
const isOfFile = ({ field: { value: field } }) => givenOf(field) !== null;

/**
 * @param {Engine} engine
 * @param {{ toast: Toast, close: () => void, print: Print }} page
 */
export function createMeshPanel(engine, { toast, close, print }) {
  /** @type {import('../../engine/types.js').Signal<Use>} */
  const use = signal('print');
  const made = computed(() =>
    engine.status.value === 'sampling' || engine.result.value === 'none' ? null : engine.mesh.value,
  );
  const isPrint = () => use.value === 'print';
  const next = () => nextOf(made.value, isOfFile(engine));
  const lines = viewLines(engine);
  /** Scale and unit of the file. */
  const ofFile = () => (isPrint() ? { scale: print.scale() ?? 1, unit: 'mm' } : lines.ofFile());
  const verdict = () => {
    if (made.value) return verdictOf(made.value, ofFile());
    if (engine.result.value === 'partial' && engine.status.value !== 'sampling')
      return 'Stopped before the mesh was complete.';
    return engine.status.value === 'sampling' || engine.result.value !== 'none'
      ? 'Making the mesh …'
      : 'There is no surface to make a mesh of.';
  };
  const up = createSelect({ choices: AXES.map((value) => ({ value, label: value })) });
  const formats = {
    print: createFormat(engine, FORMATS.print),
    view: createFormat(engine, FORMATS.view),
  };
  const chosen = () => formats[use.value];
  const save = async () => {
    const scale = isPrint() ? print.scale() : await lines.read();
    if (scale === null) {
      if (!isPrint()) toast({ id: 'save', kind: 'warn', text: 'The length of a unit must be a positive number.' });
      return;
    }
    const placement = {
      scale,
      unit: /** @type {'mm' | 'cm' | 'm' | 'in' | null} */ (ofFile().unit || null),
      up: /** @type {'x' | 'y' | 'z'} */ (up.value),
    };
    const { format, vertices } = chosen();
    void saveMesh(engine, toast, format.value, { placement, vertices: vertices() });
  };
  const id = uniqueId('mesh');
  return h(
    'section',
    { class: 'mesh-panel', 'aria-labelledby': id },
    h(
      'div',
      { class: 'dialog-head' },
      h('h2', { id }, 'Mesh'),
      button({ icon: 'close', 'aria-label': 'Close', press: close }),
    ),
    createSegmented({
      name: 'What the mesh is for',
      choices: USES,
      value: () => use.value,
      change: (value) => {
        use.value = value;
      },
    }),
    h('p', { class: 'verdict', role: 'status' }, verdict),
    h('p', { class: 'quiet', hidden: () => !isPrint() || !next() }, next),
    h('div', { class: 'mesh-steps' }, showing(engine, made), leavingOut(engine, made)),
    keptLines(engine),
    h('div', { hidden: () => !isPrint() }, printLines(engine, { print, toast, made })),
    h('div', { hidden: isPrint }, lines.elements),
    line('Up axis', up),
    h('div', { hidden: () => !isPrint() }, formats.print.elements),
    h('div', { hidden: isPrint }, formats.view.elements),
    h(
      'details',
      { class: 'details', hidden: () => !made.value },
      h('summary', { class: 'disclose' }, 'Details'),
      h('dl', { class: 'facts' }, () =>
        made.value
          ? figuresOf(made.value, ofFile()).map(([name, value]) => [h('dt', null, name), h('dd', null, value)])
          : null,
      ),
    ),
    h(
      'div',
      { class: 'mesh-ends' },
      button({ press: close }, 'Back to particles'),
      button(
        { class: 'save', off: () => !made.value, press: save },
        () => `Save ${chosen().format.value.toUpperCase()}`,
      ),
    ),
  );
}

/**
 * Returns advice for a mesh that cannot be printed; empty for one that can.
 * @param {MeshAnswer | null} mesh
 * @param {boolean} isOfPoints  whether it is of a surface through points, which takes no wall and no box
 */
function nextOf(mesh, isOfPoints) {
  if (!mesh?.components.some(({ open_edges }) => open_edges > 0)) return '';
  const needs = 'A printer needs a closed surface';
  if (mesh.unfilled > 0) return `${needs}: try smaller particles.`;
  return isOfPoints
    ? `${needs}; this one ends with its points.`
    : `${needs}: give it a wall, or close it with the box.`;
}

/**
 * Creates the choice of a format and of the vertices in it.
 * @param {Engine} engine
 * @param {[MeshFormat, string][]} formats
 */
function createFormat(engine, formats) {
  const format = signal(formats[0][0]);
  const ways = engine.description.value?.vertices ?? [];
  const way = signal(ways[0]);
  const fits = () => ways.filter((one) => one.formats.includes(format.value));
  const select = createSelect({
    choices: formats.map(([value]) => ({ value, label: value.toUpperCase() })),
    value: () => format.value,
    change: (value) => {
      format.value = value;
      if (!fits().includes(way.value)) way.value = ways[0];
    },
  });
  const vertices = createSelect({
    choices: () => fits(),
    value: () => way.value?.value ?? '',
    change: (value) => {
      way.value = ways.find((one) => one.value === value) ?? ways[0];
    },
  });
  const verticesLine = line('Vertices', vertices);
  live(verticesLine, () => {
    verticesLine.hidden = fits().length === 0;
  });
  return {
    format,
    vertices: () => way.value?.value ?? 'joined',
    elements: [
      line('Format', select),
      h('p', { class: 'quiet' }, () => formats.find(([value]) => value === format.value)?.[1]),
      verticesLine,
      h('p', { class: 'quiet', hidden: () => fits().length === 0 }, () => way.value?.help),
    ],
  };
}

/**
 * Creates the lines of a part that is printed: its size, and its wall.
 * @param {Engine} engine
 * @param {{ print: Print, toast: Toast, made: { readonly value: MeshAnswer | null } }} parts
 */
function printLines(engine, { print, toast, made }) {
  const refuse = (/** @type {HTMLInputElement} */ box, /** @type {string} */ text) => {
    box.focus();
    toast({ id: 'size', kind: 'warn', text });
  };
  /** Reads a typed length, in millimetres unless it has another unit. @param {HTMLInputElement} box */
  const read = async ({ value }) =>
    value.trim() === '' ? 0 : (millimetresOf(value) ?? (await engine.readNumber(value)));
  /**
   * Shows a length in its box, unless another one is being typed there.
   * @param {HTMLInputElement} box
   * @param {string} text
   */
  const show = (box, text) => {
    if (box.matches(':focus') && box.value !== (box.dataset.shown ?? '')) return;
    box.value = text;
    box.dataset.shown = text;
  };
  /** Marks the content of a box as no longer being typed. @param {HTMLInputElement} box */
  const taken = (box) => {
    box.dataset.shown = box.value;
  };
  const size = numberBox({ name: 'Longest side in millimetres' });
  const showSize = () => show(size, formatSignificant(print.sizeMm.value, 4));
  live(size, showSize);
  size.addEventListener('change', async () => {
    const { value } = size;
    const given = await read(size);
    // The text has changed meanwhile.
    if (size.value !== value) return;
    if (given !== null && given > 0 && given < Infinity) print.sizeMm.value = given;
    else refuse(size, 'The size is a positive length, such as 40 or 1.5 in.');
    taken(size);
    showSize();
  });
  const wall = numberBox({ name: 'Wall in millimetres', placeholder: 'none' });
  /** The wall of the last mesh, shown until the next mesh is made. */
  let last = { text: '', placeholder: 'none' };
  const shown = computed(() => {
    if (!made.value) return last;
    const present = print.wall();
    last = {
      text: present ? formatSignificant(present, 2) : '',
      placeholder: present === null ? 'varies' : 'none',
    };
    return last;
  });
  const showWall = () => {
    show(wall, shown.value.text);
    wall.placeholder = shown.value.placeholder;
  };
  live(wall, showWall);
  wall.addEventListener('change', async () => {
    const { value } = wall;
    const given = await read(wall);
    if (wall.value !== value) return;
    const thickness = given === null || !(given >= 0) ? null : given === 0 ? 0 : print.thickness(given);
    taken(wall);
    if (thickness === null) {
      refuse(wall, `The wall is a length that fits a part of ${formatSignificant(print.sizeMm.value)} mm, such as 2.`);
      showWall();
    } else if (thickness === 0) engine.resetSetting('thickness');
    else engine.setSetting('thickness', thickness);
  });
  const wallLine = line('Wall', wall, h('span', { class: 'unit' }, 'mm'));
  // A surface from points or of an image takes no thickness.
  live(wallLine, () => {
    wallLine.hidden = isOfFile(engine);
  });
  return [line('Size', size, h('span', { class: 'unit' }, 'mm along the longest side')), wallLine];
}

/** Creates the lines of the scale and the unit of a file for viewers. @param {Engine} engine */
function viewLines(engine) {
  const factor = signal(1);
  const unit = signal('');
  const scale = numberBox({ name: 'Length of a unit of the formula', value: '1' });
  /** The length in the box; null if it is invalid. */
  const read = async () => {
    const given = await engine.readNumber(scale.value);
    if (given === null || !(given > 0 && given < Infinity)) {
      scale.focus();
      return null;
    }
    factor.value = given;
    return given;
  };
  scale.addEventListener('change', () => void read());
  const units = createSelect({
    name: 'Unit',
    choices: UNITS.map((value) => ({ value, label: value || 'unspecified' })),
    value: () => unit.value,
    change: (value) => {
      unit.value = value;
    },
  });
  return { elements: line('1 unit =', scale, units), read, ofFile: () => ({ scale: factor.value, unit: unit.value }) };
}

/** Creates a line for each thing kept for the surface, with a button to remove it. @param {Engine} engine */
function keptLines(engine) {
  const kept = computed(() => keptOf(engine));
  const texts = computed(() => JSON.stringify(kept.value.map(({ text }) => text)));
  return h(
    'ul',
    { class: 'mesh-kept', 'aria-label': 'Set for this surface', hidden: () => kept.value.length === 0 },
    () => {
      void texts.value;
      return kept
        .peek()
        .map(({ text, end, act }) =>
          h('li', null, h('span', null, text), button({ icon: 'close', 'aria-label': end, title: end, press: act })),
        );
    },
  );
}

/**
 * Creates the button that leaves out loose chips.
 * @param {Engine} engine
 * @param {{ readonly value: MeshAnswer | null }} made
 */
function leavingOut(engine, made) {
  const chips = () => made.value?.bodies.filter((body) => body.is_chip).length ?? 0;
  return button(
    { hidden: () => chips() === 0, press: () => engine.leaveOutChips() },
    () => `Leave out ${plural(chips(), 'loose chip')}`,
  );
}

/**
 * Creates the button that shows the open borders in turn.
 * @param {Engine} engine
 * @param {{ readonly value: MeshAnswer | null }} made
 */
function showing(engine, made) {
  /** @type {{ mesh: MeshAnswer | null, next: number }} */
  let last = { mesh: null, next: 0 };
  const press = () => {
    const mesh = made.value;
    if (!mesh?.loops.length) return;
    const index = last.mesh === mesh ? last.next : 0;
    engine.pointOut(borderOf(mesh, index, engine.columns));
    last = { mesh, next: (index + 1) % mesh.loops.length };
  };
  return button({ hidden: () => !made.value?.loops.length, press }, () => {
    const count = made.value?.loops.length ?? 0;
    return count > 1 ? `Show the next of ${formatCount(count)} borders` : 'Show the border';
  });
}

/** @param {string} label @param {...HTMLElement} inputs */
function line(label, ...inputs) {
  const [first] = inputs;
  first.id = uniqueId('mesh');
  return h('div', { class: 'mesh-line' }, h('label', { for: first.id }, label), h('span', { class: 'pad' }, inputs));
}
