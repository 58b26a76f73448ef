/** One particle within the front, event by event. */
import { signal } from '@preact/signals-core';
import { nearest } from '../../engine/vector.js';
import { asideWords, isSearched, lens, profileOf, tangentPlane } from '../../figures/drawings.js';
import { openParticle } from '../../figures/particle.js';
import { fateShape } from '../../figures/svg.js';
import { FATES, inRadii } from '../../figures/words.js';
import { fill, h, queryAll, s } from '../../ui/dom.js';
import { formatCount, MISSING, plural } from '../../ui/format.js';
import { loadSheet } from '../../ui/sheet.js';
import { unpackParticle } from '../../ui/surface-link.js';
import { readAddress } from '../address.js';
import { offerNumber, toleranceNumber } from '../drag.js';
import { reasonOf } from '../figure.js';
import { latest } from '../latest.js';
import { createSteps, facts } from '../parts.js';
import sheet from '../plane.css?url';

/**
 * @import { Moment, Opened } from '../../figures/types.js'
 * @import { Context, Lab } from '../types.js'
 */

/** The match tolerance of the lesson. */
const USUAL_TOLERANCE = 0.7;
/** The fates that are always explained. */
const USUAL_FATES = ['parent', 'added', 'matched'];

/** The shapes of fates, explained. @param {Opened} opened */
function keyOf({ events }) {
  const met = events.flatMap((event) => (event.type === 'fate' ? [event.fate] : []));
  return h(
    'ul',
    { class: 'key' },
    [...new Set([...USUAL_FATES, ...met])].map((fate) => {
      const svg = s('svg', { class: 'shape', viewBox: '-1.4 -1.4 2.8 2.8', 'aria-hidden': 'true' });
      svg.append(fateShape(fate, [0, 0], 1));
      return h('li', null, svg, FATES[fate]);
    }),
  );
}

/**
 * Views of a particle at one of its events: its tangent plane, the event in words, the line of the algorithm, and the
 * slot from the side with both landing points.
 * @param {Opened} opened
 * @param {{ at: number, go: (by: 1 | -1) => void }} how  `at`: the event that is shown first; −1 for the
 * last; `go` shows the previous or the next particle
 */
function viewsOf(opened, { at, go }) {
  const { events, subject } = opened;
  const { moment, elements } = createSteps({
    name: 'Event',
    events: () => events,
    first: at < 0 ? events.length - 1 : at,
    subject: () => subject,
    beyond: go,
  });
  const parent = subject.parent === null ? 'a seed' : `child of particle ${formatCount(subject.parent)}`;
  const name = `Particle ${formatCount(subject.particle)} on level ${formatCount(subject.level)}, ${parent}.`;
  return [
    h(
      'div',
      { class: 'two' },
      h('div', { class: 'drawing-box' }, () => tangentPlane(opened, moment.value)),
      h('div', { class: 'side' }, h('p', { class: 'quiet' }, name), elements),
    ),
    h('div', { class: 'two', hidden: () => profileAt(opened, moment.value) === null }, () =>
      sideOf(opened, moment.value),
    ),
    keyOf(opened),
  ];
}

/**
 * The plane of an event's slot; null if the slot holds the parent.
 * @param {Opened} opened @param {Moment} moment
 */
const profileAt = ({ profiles }, { slot }) =>
  profiles[slot ?? profiles.findIndex((profile) => profile !== null)] ?? null;

/** The slot from the side, with the landing points of both searches. @param {Opened} opened @param {Moment} moment */
function sideOf(opened, moment) {
  const profile = profileAt(opened, moment);
  if (!profile) return null;
  const slot = opened.profiles.indexOf(profile);
  const child = moment.children[slot];
  const { radius } = opened.subject;
  const enlarged = lens(opened, profile, child);
  const newton = profile.newtonDistance === null ? 'no landing' : inRadii(profile.newtonDistance, radius, 3);
  return [
    h('div', { class: 'drawing-box' }, profileOf(opened, profile, child)),
    h(
      'div',
      { class: 'side' },
      h('p', null, `Slot ${slot} from the side`),
      facts([
        ['The circle lands at', child.landed ? inRadii(child.landed.distance, radius, 3) : MISSING],
        ['Newton’s method would', isSearched(child) ? newton + asideWords(profile) : MISSING],
        ['Evaluations of f so far', formatCount(moment.evaluations)],
      ]),
      enlarged && h('div', { class: 'lens-box' }, enlarged, h('p', { class: 'quiet' }, 'The search, enlarged')),
    ),
  ];
}

/**
 * The run to show, and its first particle as a share of all: the particle in the address, in a run with its radius and
 * the same seeds; else a middle one of a coarse run.
 * @param {Lab} own
 */
async function asked(own) {
  const wanted = unpackParticle(readAddress(location.hash).parts.particle ?? '');
  const coarse = await own.coarse();
  if (!wanted) return { usual: coarse, first: 0.5 };
  const { place, radius, seeds } = wanted;
  // With such small particles there may be too many for an event log.
  const usual = await own.run({ relax_steps: 0, radius, seeds }, { keep: true }).catch(() => coarse);
  const { positions, radii } = usual.placed;
  const found = nearest(positions, radii.length, place);
  return { usual, first: ((found?.index ?? 0) + 0.5) / radii.length };
}

/** A particle of a run, event by event. @param {Context} context */
export async function whoWasFirst({ lab }) {
  await loadSheet(sheet);
  const own = await lab;
  const { usual, first } = await asked(own);
  const run = signal(usual);
  const tolerance = signal(USUAL_TOLERANCE);
  const place = h('div', { class: 'particle' });
  const runAt = async (/** @type {number} */ to) =>
    to === USUAL_TOLERANCE ? usual : own.run({ ...usual.settings, match_tolerance: to }, { keep: true });
  /** The particle shown, as a share of all. */
  let share = first;
  const status = h('p', { class: 'figure-status', role: 'status' });
  /** Shows the previous or the next particle. @param {1 | -1} by */
  function go(by) {
    const { length } = run.peek().end.radii;
    const to = Math.floor(share * length) + by;
    if (to < 0 || to >= length) return;
    share = (to + 0.5) / length;
    isBackwards = by < 0;
    void show(tolerance.peek());
  }
  /** Whether a particle is reached backwards, at its last event. */
  let isBackwards = false;
  let isFirst = true;
  const show = latest(async (/** @type {number} */ to, isOld) => {
    const next = await runAt(to).catch((error) => {
      status.textContent = reasonOf(error);
      return null;
    });
    if (!next) return;
    const old = isOld() ? next : run.peek();
    if (!isOld()) {
      run.value = next;
      status.textContent = '';
      const opened = await openParticle(next.client, next, Math.floor(share * next.end.radii.length));
      // The chapter is about comparing, so the drawing begins with the comparison of the first child.
      const compared = opened.events.findIndex(({ type }) => type === 'compared');
      const at = isBackwards ? -1 : isFirst || old !== next ? compared : 0;
      isFirst = false;
      const held = place.contains(document.activeElement) ? document.activeElement?.getAttribute('aria-label') : null;
      fill(place, viewsOf(opened, { at, go }));
      // The pressed button has been replaced.
      if (held)
        queryAll(place, 'button')
          .find((one) => one.getAttribute('aria-label') === held)
          ?.focus();
    }
    if (old !== usual && old !== run.peek()) own.drop(old);
  });
  await show(tolerance.peek());
  const turn = (/** @type {number} */ to) => {
    if (to === tolerance.peek()) return;
    tolerance.value = to;
    void show(to);
  };
  offerNumber(
    'tolerance',
    toleranceNumber({ value: () => tolerance.value, change: turn, stage: () => place.closest('.stage') }),
  );
  return [
    place,
    h('p', { class: 'figure-count' }, () => `A run of ${plural(run.value.end.radii.length, 'particle')}.`),
    status,
  ];
}
