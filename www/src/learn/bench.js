/** The bench for comparing two runs. */
import { signal } from '@preact/signals-core';
import { fill, h } from '../ui/dom.js';
import { offerNumber, toleranceNumber } from './drag.js';
import { createPair } from './pair.js';
import { createSelectRow } from './parts.js';
import { COMMON, FAIL, partsOf, setupOf, sidesOf, TOLERANCE, turned, USUAL, whatIfOf } from './whatifs.js';

/** @import { ReadonlySignal } from '@preact/signals-core' */
/** @import { Control, Lab, Setup, WhatIf } from './types.js' */

/**
 * @param {HTMLElement} host
 * @param {Lab} lab
 * @param {{ setup?: Setup, locks?: readonly Control[], onChoice?: (setup: Setup) => void }} [how]
 * `locks`: controls that cannot be changed; `onChoice` receives the learner's choices
 */
export async function createBench(
  host,
  lab,
  { setup: first = setupOf(COMMON[0].id), locks = [], onChoice = () => {} } = {},
) {
  const { choices, labOn } = await surfacesOf(lab);
  const pair = createPair();
  const look = h('p', { class: 'look' });
  const chosen = h('div', { class: 'controls' });
  const [above, below] = [h('div', { class: 'beside' }), h('div', { class: 'beside' })];
  let setup = first;
  let shown = Promise.resolve();
  /** The knob values on the right; the lesson's values if the choice has no knobs. */
  const knobs = signal(USUAL);
  /** The choice whose controls are shown. */
  let standing = '';
  /** Updates the controls to show a setup. */
  let follow = (/** @type {Setup} */ _next) => {};
  /** The knobs and the stored tries. @type {ReturnType<typeof import('./fail.js').createFail> | null} */
  let fail = null;
  const what = createSelectRow({
    name: 'What changes',
    choices: COMMON.map(({ id, name }) => ({ value: id, label: name })),
    value: setup.what,
    change: (id) => open(id, { on: setup.on }, choose),
  });
  const surface = createSelectRow({
    name: 'Surface',
    choices,
    value: setup.on,
    change: (on) => open(setup.what, whatIfOf(setup.what).knobs ? { on } : { ...setup, on }, choose),
  });
  for (const { select } of [what, surface]) select.disabled = locks.includes('what');

  /** @param {Setup} next */
  function choose(next) {
    void show(next);
    onChoice(next);
  }

  /**
   * Shows a choice with the given values. Without values, a choice with knobs shows its stored tries.
   * @param {string} id @param {{ on?: unknown, left?: unknown, right?: unknown }} given
   * @param {(next: Setup) => unknown} [act]
   */
  async function open(id, given, act = show) {
    const values = whatIfOf(id).knobs ? (await import('./fail.js')).keptSides(labOn(String(given.on ?? ''))) : {};
    await act(setupOf(id, { ...values, ...given }));
  }

  /** Creates the controls of a choice. @param {WhatIf} whatIf */
  async function stand({ id, values, knobs, look: words }) {
    const { on } = setup;
    const own = `${id} ${on}`;
    if (standing === own) return;
    const module = knobs ? await import('./fail.js') : null;
    if (`${setup.what} ${setup.on}` !== own || standing === own) return;
    standing = own;
    // Elements removed from the page are disposed of, so they are created again.
    fail = module?.createFail(labOn(on), { choose, isLocked: locks.includes('right'), on }) ?? null;
    look.textContent = words;
    fill(above, fail?.kept, fail?.said);
    fill(below, fail?.verdict);
    if (fail) {
      follow = fail.follow;
      fill(chosen, what.element, surface.element, fail.controls);
      return;
    }
    const sides = createSides(values, locks, (side, value) => choose({ ...setup, [side]: value }));
    follow = sides.follow;
    fill(chosen, what.element, surface.element, sides.controls);
  }

  /** @param {Setup} next */
  function show(next) {
    shown = compare(next);
    return shown;
  }

  /** @param {Setup} asked */
  async function compare(asked) {
    const next = { ...asked, on: choices.some(({ value }) => value === asked.on) ? asked.on : '' };
    setup = next;
    const whatIf = whatIfOf(setup.what);
    knobs.value = whatIf.knobs ? setup.right : USUAL;
    what.set(whatIf.id, whatIf.name);
    surface.set(next.on);
    await stand(whatIf);
    if (setup !== next) return;
    follow(next);
    const isPicked = whatIf.knobs && !locks.includes('right');
    pair.pickWith(isPicked ? (place) => fail?.seed(place) : null);
    await pair.show({ lab: labOn(next.on), sides: sidesOf(whatIf, [next.left, next.right]), whatIf });
    if (setup === next) await fail?.tell(next);
  }

  if (locks.length === 0) offerTolerance(host, knobs, (right) => void open(FAIL, { on: setup.on, right }, choose));
  fill(host, chosen, above, look, pair.element, below);
  return {
    show,
    open,
    setup: () => setup,
    /** Resolves once the runs shown are measured. */
    settled: () => shown,
    /** The runs shown and the stored runs, each once, with names, once they are measured. */
    runs() {
      const { runs, scores } = pair;
      const whatIf = whatIfOf(setup.what);
      const names = sidesOf(whatIf, [setup.left, setup.right]);
      const sides = (runs ?? []).map((run, k) => ({ label: names[k].label, run, score: scores()?.[k] }));
      const all = [...(fail?.runs() ?? []), ...sides];
      return all.filter(({ run }, k) => all.findIndex((one) => one.run === run) === k);
    },
  };
}

/**
 * Links the tolerance in the text to the sampling on the right.
 * @param {HTMLElement} host @param {ReadonlySignal<string>} knobs @param {(knobs: string) => void} turn
 */
function offerTolerance(host, knobs, turn) {
  const about = toleranceNumber({
    value: () => Number(partsOf(knobs.value)[TOLERANCE]),
    change: (to) => turn(turned(knobs.peek(), TOLERANCE, String(to))),
    stage: () => host,
  });
  offerNumber('knob', about);
}

/**
 * The surfaces on which runs can be compared, and a lab for each: the lesson's surface, and those of the gallery.
 * @param {Lab} lab
 */
async function surfacesOf(lab) {
  const gallery = (await lab.gallery().catch(() => [])).filter(({ formula }) => formula);
  return {
    choices: [
      { value: '', label: 'That of this lesson' },
      ...gallery.map(({ id, name }) => ({ value: id, label: name })),
    ],
    /** @param {string} on */
    labOn(on) {
      const entry = gallery.find(({ id }) => id === on);
      if (!entry) return lab;
      const { formula, parameters, bounds } = entry;
      return lab.on({ formula, parameters, bounds });
    },
  };
}

/**
 * The controls for one choice, with a value on the left and one on the right.
 * @param {WhatIf['values']} choices @param {readonly Control[]} locks
 * @param {(side: 'left' | 'right', value: string) => void} change
 */
function createSides(choices, locks, change) {
  const sides = /** @type {const} */ (['left', 'right']).map((side, k) => {
    const name = k === 0 ? 'Left' : 'Right';
    const control = createSelectRow({ name, choices, change: (value) => change(side, value) });
    control.select.disabled = locks.includes(side);
    return { side, ...control };
  });
  return {
    controls: sides.map(({ element }) => element),
    follow(/** @type {Setup} */ setup) {
      for (const { side, set } of sides) set(setup[side]);
    },
  };
}
