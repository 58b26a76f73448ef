/**
 * The linked views of a particle at one event: the tangent plane with its slots in words,
 * the algorithm, the profile and the numbers.
 */
import { adaptivePlane } from '../../figures/adaptive.js';
import { algorithmList } from '../../figures/algorithm.js';
import { asideWords, isSearched, lens, profileOf, tangentPlane } from '../../figures/drawings.js';
import { isAdaptive } from '../../figures/moment.js';
import { fateShape } from '../../figures/svg.js';
import { ADAPTIVE, ALGORITHM, FATES, inDegrees, inRadii, lineOf } from '../../figures/words.js';
import { h, live, s, uniqueId } from '../dom.js';
import { formatCount, formatSignificant, MISSING } from '../format.js';
import { createRestViews } from './rest.js';

/**
 * @import { Child, Moment } from '../../figures/types.js'
 * @import { Follower, Opened, ViewContent } from './types.js'
 */

/** @param {Follower} follower */
export function createViews(follower) {
  const element = h(
    'div',
    { class: 'follow-views' },
    view(follower, 'Tangent plane', tangentView),
    view(follower, 'Algorithm', algorithmView),
    view(follower, 'Profile', profileView, true),
    view(follower, 'Numbers', numbersView, true),
    createRestViews(follower),
  );
  linkHover(element, follower);
  return element;
}

/**
 * The moment as if it spoke of a slot: what is shown while a child is pointed at.
 * @param {Moment} moment
 * @param {number} slot
 * @returns {Moment}
 */
const pointedAt = (moment, slot) => ({ ...moment, slot, isNow: true });

/**
 * Lets a child that is pointed at in one view stand out in all.
 * @param {HTMLElement} element
 * @param {Follower} follower
 */
function linkHover(element, { pointed, hot, opened, moment }) {
  element.addEventListener('pointerover', ({ target }) => {
    const slot = target instanceof Element ? target.closest('[data-slot]')?.getAttribute('data-slot') : null;
    pointed.value = slot ? Number(slot) : null;
  });
  element.addEventListener('pointerleave', () => {
    pointed.value = null;
  });
  live(element, () => {
    void opened.value;
    void moment.value;
    for (const part of element.querySelectorAll('[data-slot]'))
      part.classList.toggle('hot', part.getAttribute('data-slot') === String(hot.value));
  });
}

/**
 * @param {Follower} follower
 * @param {string} title @param {ViewContent} contentOf
 * @param {boolean} [isPointed]  whether it shows one child, which may be pointed at elsewhere
 */
function view({ opened, moment, hot, rest }, title, contentOf, isPointed = false) {
  const id = uniqueId('view');
  return h(
    'section',
    {
      class: 'section',
      'aria-labelledby': id,
      hidden: () => moment.value === null || rest.status.value !== null,
    },
    h('h3', { id, class: 'section-title' }, title),
    h('div', { class: 'follow-view' }, () => {
      const slot = isPointed ? hot.value : null;
      if (!opened.value || !moment.value) return null;
      return contentOf(opened.value, slot === null ? moment.value : pointedAt(moment.value, slot));
    }),
  );
}

/** @type {ViewContent} */
const tangentView = (opened, moment) => [
  isAdaptive(opened.events) ? adaptivePlane(opened, moment) : tangentPlane(opened, moment),
  h(
    'ol',
    { class: 'slots', start: 0, 'aria-label': 'Slots' },
    moment.children.map((child) => slotRow(child, moment)),
  ),
];

/** @param {Child} child @param {Moment} moment */
function slotRow({ slot, fate, particle }, moment) {
  const isNow = moment.isNow && moment.slot === slot;
  const shape = s('svg', { class: 'shape', viewBox: '-1.4 -1.4 2.8 2.8', 'aria-hidden': 'true' });
  shape.append(fateShape(fate, [0, 0], 1));
  const other = particle === null || fate === 'open' ? '' : ` ${formatCount(particle)}`;
  return h(
    'li',
    { 'aria-current': isNow ? 'step' : null, 'data-slot': slot },
    h('span', { class: 'slot-name' }, String(slot)),
    shape,
    h('span', null, fate === 'open' ? MISSING : `${FATES[fate]}${other}`),
  );
}

/** @type {ViewContent} */
function profileView(opened, moment) {
  const { profiles, subject } = opened;
  const slot = moment.slot ?? profiles.findIndex((profile) => profile !== null);
  const profile = profiles[slot];
  if (!profile) return [h('p', { class: 'quiet' }, 'This slot holds the parent. Nothing is looked for in its plane.')];
  const child = moment.children[slot];
  const enlarged = lens(opened, profile, child);
  const newton = !isSearched(child)
    ? MISSING
    : profile.newtonDistance === null
      ? 'no landing'
      : inRadii(profile.newtonDistance, subject.radius, 4) + asideWords(profile);
  return [
    profileOf(opened, profile, child),
    h(
      'div',
      { class: 'follow-key' },
      h('p', null, `Slot ${slot} from the side`),
      h(
        'dl',
        { class: 'facts' },
        h('dt', null, mark('landed'), 'Circle'),
        h('dd', null, child.landed ? inRadii(child.landed.distance, subject.radius, 4) : MISSING),
        h('dt', null, mark('newton'), 'Newton'),
        h('dd', null, newton),
      ),
      h('p', { class: 'quiet' }, ideal(opened, profile)),
      enlarged ? h('div', { class: 'lens-box' }, enlarged, h('p', { class: 'quiet' }, magnification(profile))) : null,
    ),
  ];
}

/** @param {Opened} opened @param {NonNullable<Opened['profiles'][number]>} profile */
function ideal({ subject, events }, { reach }) {
  const best = isAdaptive(events) ? `that at which they touch, ${inRadii(reach, subject.radius)}` : '2r';
  return `Where the two searches land: the distances to the particle. The ideal is ${best}.`;
}

/** @param {'landed' | 'newton'} kind */
function mark(kind) {
  const svg = s('svg', { class: 'shape', viewBox: '-1.4 -1.4 2.8 2.8', 'aria-hidden': 'true' });
  svg.append(
    kind === 'landed'
      ? s('circle', { class: 'landed', r: 0.9 })
      : s('path', { class: 'newton-end', d: 'M-.8-.8 .8 .8M-.8 .8 .8-.8' }),
  );
  return svg;
}

/**
 * Enlargement by a lens whose half size is one radius, relative to the profile: the lens shows 2 r on 7.5 rem, the
 * profile 5.3 r on 16.25 rem.
 */
const LENS_SCALE = 7.5 / 2 / (16.25 / 5.3);

/** @param {NonNullable<Opened['profiles'][number]>} profile */
const magnification = ({ lens: about }) =>
  about ? `The search, enlarged about ${formatSignificant(LENS_SCALE / about.half, 2)} times` : '';

/** @type {ViewContent} */
function numbersView({ subject }, { event, slot, isNow, children, evaluations }) {
  const child = isNow && slot !== null ? children[slot] : null;
  const last = child?.iterates.at(-1) ?? null;
  const compared = child?.compared ?? null;
  const pushed = child?.pushes.at(-1) ?? null;
  /** @type {[string, string][]} */
  const rows = [
    ...numbersOfPush(child, subject.radius, pushed),
    ['f', last ? formatSignificant(last.value, 3) : MISSING],
    ['|∇f|', last ? formatSignificant(last.slope, 3) : MISSING],
    ['θ', last && last.theta_rad !== null ? inDegrees(last.theta_rad, 3) : MISSING],
    ['Distance to the nearest', compared?.distance != null ? inRadii(compared.distance, subject.radius) : MISSING],
    ['Evaluations of f for this particle', formatCount(evaluations)],
  ];
  if (event.type === 'done') rows.push(['Evaluations in the run so far', formatCount(event.evaluations)]);
  return [
    h(
      'dl',
      { class: 'facts' },
      rows.flatMap(([name, value]) => [h('dt', null, name), h('dd', null, value)]),
    ),
  ];
}

/**
 * The numbers of an adaptive child on its way.
 * @param {Child | null} child @param {number} radius  of its parent @param {Child['pushes'][number] | null} pushed
 * @returns {[string, string][]}
 */
function numbersOfPush(child, radius, pushed) {
  if (!child || !pushed) return [];
  const { room } = child;
  return [
    ['Radius of the child', inRadii(pushed.radius, radius)],
    ['Pushes', formatCount(child.pushes.length - 1)],
    ['φ, the angle that it takes', room ? inDegrees(room.phi_rad, 1) : MISSING],
    ['τ, the free angle', room ? inDegrees(room.tau_rad, 1) : MISSING],
  ];
}

/** @type {ViewContent} */
function algorithmView({ events }, { event }) {
  const lines = isAdaptive(events) ? ADAPTIVE : ALGORITHM;
  const now = lineOf(event, lines);
  return [algorithmList(now, lines)];
}
