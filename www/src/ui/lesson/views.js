/** The linked views of a particle at one event: the two drawings, the slots in words, the numbers, and the algorithm. */
import { effect } from '@preact/signals-core';
import { isSearched, lens, profileOf, tangentPlane } from '../../figures/drawings.js';
import { fateShape, s } from '../../figures/svg.js';
import { ALGORITHM, FATES, inDegrees, inRadii, lineOf } from '../../figures/words.js';
import { fill, h, uniqueId } from '../dom.js';
import { formatCount, formatSignificant, MISSING } from '../format.js';

/**
 * @typedef {import('./follower.js').Follower} Follower
 * @typedef {import('./follower.js').Opened} Opened
 * @typedef {import('../../figures/moment.js').Moment} Moment
 * @typedef {import('../../figures/moment.js').Child} Child
 */

/** @param {Follower} follower */
export function createViews(follower) {
  const parts = [
    view('Tangent plane', tangentView),
    view('Profile', profileView),
    view('Numbers', numbersView),
    view('Algorithm 2', algorithmView),
  ];
  effect(() => {
    const [opened, moment] = [follower.opened.value, follower.moment.value];
    for (const { element, draw } of parts) {
      element.hidden = moment === null;
      if (opened && moment) draw(opened, moment);
    }
  });
  return h(
    'div',
    { class: 'follow-views' },
    parts.map(({ element }) => element),
  );
}

/** @param {string} title @param {(opened: Opened, moment: Moment) => import('../dom.js').Child[]} contentOf */
function view(title, contentOf) {
  const id = uniqueId('view');
  const body = h('div', { class: 'follow-view' });
  return {
    element: h(
      'section',
      { class: 'section', 'aria-labelledby': id },
      h('h3', { id, class: 'section-title' }, title),
      body,
    ),
    draw: (/** @type {Opened} */ opened, /** @type {Moment} */ moment) => fill(body, ...contentOf(opened, moment)),
  };
}

/** @param {Opened} opened @param {Moment} moment */
const tangentView = (opened, moment) => [
  tangentPlane(opened, moment),
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
    { 'aria-current': isNow ? 'step' : null },
    h('span', { class: 'slot-name' }, String(slot)),
    shape,
    h('span', null, fate === 'open' ? MISSING : `${FATES[fate]}${other}`),
  );
}

/** @param {Opened} opened @param {Moment} moment */
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
      : inRadii(profile.newtonDistance, subject.radius, 4);
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
      h('p', { class: 'quiet' }, 'Where the two searches land: the distances to the particle. The ideal is 2r.'),
      enlarged ? h('div', { class: 'lens-box' }, enlarged, h('p', { class: 'quiet' }, magnification(profile))) : null,
    ),
  ];
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

/** How much larger a lens with a half size of one radius shows things than the profile: 7.5 rem for 2 r against 16.25 rem for 5.3 r. */
const LENS_SCALE = 7.5 / 2 / (16.25 / 5.3);

/** @param {NonNullable<Opened['profiles'][number]>} profile */
const magnification = ({ lens: about }) =>
  about ? `The search, enlarged about ${formatSignificant(LENS_SCALE / about.half, 2)} times` : '';

/** @param {Opened} opened @param {Moment} moment */
function numbersView({ subject }, { event, slot, isNow, children, evaluations }) {
  const child = isNow && slot !== null ? children[slot] : null;
  const last = child?.iterates.at(-1) ?? null;
  const compared = child?.compared ?? null;
  /** @type {[string, string][]} */
  const rows = [
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

/** @param {Opened} _opened @param {Moment} moment */
function algorithmView(_opened, { event }) {
  const now = lineOf(event);
  return [
    h(
      'ol',
      { class: 'algorithm' },
      ALGORITHM.map(({ depth, text }, k) =>
        h('li', { 'data-depth': depth, 'aria-current': k === now ? 'step' : null }, text),
      ),
    ),
  ];
}
