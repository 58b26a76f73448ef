/** The panel of a mesh: the verdict on it, where it is open, and how it is saved. */
import { computed } from '@preact/signals-core';
import { button } from '../button.js';
import { h, uniqueId } from '../dom.js';
import { verdictOf } from '../mesh-words.js';
import { numberBox } from '../number.js';
import { createSelect } from '../select.js';
import { saveMesh } from '../share.js';
import { borderOf } from './borders.js';

/**
 * @import { Engine, MeshAnswer, MeshFormat } from '../../engine/types.js'
 * @import { Toast } from '../types.js'
 */

/** File formats, with what is in them. @type {[MeshFormat, string][]} */
const FORMATS = [
  ['glb', 'For viewers. Includes normals and level colours; units are metres'],
  ['3mf', 'For printers. Includes the unit'],
  ['stl', 'Triangles only, no record of what they were made from'],
  ['obj', 'Triangles and normals, as text'],
  ['ply', 'Triangles and normals'],
];
/** Units by their symbols; without one numbers stay what they are. */
const UNITS = ['', 'mm', 'cm', 'm', 'in'];
const AXES = ['z', 'y', 'x'];

/**
 * @param {Engine} engine
 * @param {{ toast: Toast, close: () => void }} page
 */
export function createMeshPanel(engine, { toast, close }) {
  const made = computed(() => (engine.busy.value || engine.empty.value ? null : engine.mesh.value));
  const verdict = () => {
    if (made.value) return verdictOf(made.value);
    if (engine.partial.value && !engine.busy.value) return 'Stopped before the mesh was complete.';
    return engine.busy.value || !engine.empty.value ? 'Making the mesh …' : 'There is no surface to make a mesh of.';
  };
  const note = h('p', { class: 'quiet' });
  const format = createSelect({
    choices: FORMATS.map(([value]) => ({ value, label: value.toUpperCase() })),
    change: () => tell(),
  });
  const ways = engine.description.value?.vertices ?? [];
  const vertices = createSelect({ choices: ways, change: () => tell() });
  const verticesNote = h('p', { class: 'quiet' });
  const verticesLine = line('Vertices', vertices);
  /** Says what is in the file, and offers the ways to write its vertices. */
  const tell = () => {
    const [id, text] = FORMATS[format.selectedIndex];
    note.textContent = text;
    const fits = ways.map(({ formats }) => formats.includes(id));
    [...vertices.options].forEach((option, k) => {
      option.hidden = option.disabled = !fits[k];
    });
    if (!fits[vertices.selectedIndex]) vertices.selectedIndex = Math.max(0, fits.indexOf(true));
    verticesLine.hidden = verticesNote.hidden = !fits.includes(true);
    verticesNote.textContent = ways[vertices.selectedIndex]?.help ?? '';
  };
  tell();
  const scale = numberBox({ name: 'Length of a unit of the formula', value: '1' });
  const unit = createSelect({
    name: 'Unit',
    choices: UNITS.map((value) => ({ value, label: value || 'unspecified' })),
  });
  const up = createSelect({ choices: AXES.map((value) => ({ value, label: value })) });
  const save = async () => {
    const factor = await engine.readNumber(scale.value);
    if (factor === null || !(factor > 0 && factor < Infinity)) {
      scale.focus();
      toast({ id: 'save', kind: 'warn', text: 'The length of a unit must be a positive number.' });
      return;
    }
    const chosen = FORMATS[format.selectedIndex][0];
    const placement = {
      scale: factor,
      unit: /** @type {'mm' | 'cm' | 'm' | 'in' | null} */ (unit.value || null),
      up: /** @type {'x' | 'y' | 'z'} */ (up.value),
    };
    void saveMesh(engine, toast, chosen, { placement, vertices: ways[vertices.selectedIndex]?.value ?? 'joined' });
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
    h('p', { class: 'verdict', role: 'status' }, verdict),
    showing(engine, made),
    line('1 unit =', scale, unit),
    line('Up axis', up),
    line('Format', format),
    note,
    verticesLine,
    verticesNote,
    h(
      'div',
      { class: 'mesh-ends' },
      button({ press: close }, 'Back to particles'),
      button({ class: 'save', off: () => !made.value, press: save }, 'Save mesh'),
    ),
  );
}

/**
 * Creates the button that shows the open borders, one after the other.
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
  return button({ hidden: () => !made.value?.loops.length, press }, () =>
    (made.value?.loops.length ?? 0) > 1 ? 'Show the next border' : 'Show them',
  );
}

/** @param {string} label @param {...HTMLElement} inputs */
function line(label, ...inputs) {
  const [first] = inputs;
  first.id = uniqueId('mesh');
  return h('div', { class: 'mesh-line' }, h('label', { for: first.id }, label), h('span', { class: 'pad' }, inputs));
}
