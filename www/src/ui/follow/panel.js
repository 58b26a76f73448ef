/**
 * The panel that follows one particle through the paper's algorithm, event by event. It takes the place of the report,
 * and on a phone that of the sheet; it is loaded when it is first asked for.
 */

import { computed, signal, untracked } from '@preact/signals-core';
import { momentAt } from '../../figures/moment.js';
import { inRadii, transcript } from '../../figures/words.js';
import { button } from '../button.js';
import { h, live, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatSignificant } from '../format.js';
import { download } from '../share.js';
import { loadSheet } from '../sheet.js';
import { placedBefore } from './find.js';
import sheet from './follow.css?url';
import { Follower } from './follower.js';
import { childrenMark } from './mark.js';
import { settingOf } from './run.js';
import { createTold } from './told.js';
import { eventTrack, particleTrack } from './tracks.js';
import { createViews } from './views.js';

/**
 * @import { Engine, ReadonlySignal } from '../../engine/types.js'
 * @import { FollowPanel, Track } from '../types.js'
 * @import { FollowOptions } from './types.js'
 */

/** Distance in radii up to which two particles are at one place, but for rounding. */
const SAME_PLACE = 0.005;

/**
 * @param {HTMLElement} shell @param {Engine} engine
 * @param {FollowOptions} page
 * @returns {Promise<FollowPanel>}
 */
export async function mountFollow(shell, engine, { say, mount }) {
  await loadSheet(sheet);
  const follower = new Follower(engine, say);
  const [particles, events] = [particleTrack(follower), eventTrack(follower)];
  const open = signal(false);
  const element = createPanel(engine, follower, { particles, open, close: () => close() });
  shell.append(element);
  live(element, () => {
    const follow = follower.place.value;
    if (follow) untracked(() => engine.setView({ follow }));
  });
  drawFront(element, follower, engine);
  follower.rest.watch(element);
  mount(childrenMark(engine, follower));

  /**
   * The focus and the place of the timeline before the panel opened.
   * @type {{ focus: HTMLElement | null, level: number | null, step: number | null }}
   */
  let before = { focus: null, level: null, step: null };
  function show() {
    if (open.peek()) return;
    const { level, step } = engine.state.peek().view;
    before = { focus: document.activeElement instanceof HTMLElement ? document.activeElement : null, level, step };
    open.value = true;
  }
  function close() {
    open.value = false;
    follower.close();
    const { focus, ...place } = before;
    engine.setView({ ...place, grain: 'level', follow: null });
    if (engine.spot.peek()) engine.pointOut(null);
    (focus?.isConnected && focus.offsetParent ? focus : document.getElementById('canvas-host'))?.focus();
  }
  /** Goes from the level to the finer grains, where the picture shows the front as it was. */
  function refine() {
    const { grain } = engine.state.peek().view;
    if (grain === 'level') engine.setView({ grain: 'event', level: null, step: null });
  }

  return {
    open,
    level: computed(() => follower.opened.value?.subject.level ?? null),
    place: follower.place,
    particles,
    events,
    follow(index) {
      show();
      refine();
      element.focus({ preventScroll: true });
      void follower.follow(index);
    },
    goTo(place) {
      show();
      void follower.goTo(place);
    },
    goToLevel(level) {
      const first = follower.run.peek()?.end.levels.indexOf(level) ?? -1;
      if (first >= 0) void follower.open(first);
    },
    close,
    onKey: (listener) => element.addEventListener('keydown', listener),
  };
}

/**
 * @param {Engine} engine @param {Follower} follower
 * @param {{ particles: Track, open: ReadonlySignal<boolean>, close: () => void }} parts
 */
function createPanel(engine, follower, { particles, open, close }) {
  const id = uniqueId('follow');
  // A pressed button may vanish with its choice, so the panel itself takes the focus.
  const held = () => element.focus({ preventScroll: true });
  const title = h('h2', { id }, () => {
    const opened = follower.opened.value;
    return opened ? `Particle ${formatCount(opened.subject.particle)}` : 'Particle';
  });
  const onKey = (/** @type {KeyboardEvent} */ event) => {
    if (event.key !== 'Escape') return;
    event.preventDefault();
    event.stopPropagation();
    close();
  };
  const element = h(
    'section',
    {
      class: 'panel panel-follow',
      'aria-labelledby': id,
      tabindex: -1,
      hidden: () => !open.value,
      on: { keydown: onKey },
    },
    createHead({ title, follower, particles, close }),
    h(
      'div',
      { class: 'panel-body' },
      createStale(follower, engine, held),
      createStatus(follower, held),
      h(
        'div',
        { class: 'follow-ready', hidden: () => follower.opened.value === null },
        createAbout(follower),
        createTold(follower),
        createViews(follower),
        createFoot(follower, engine),
      ),
    ),
  );
  return element;
}

/**
 * Draws the front as it was at the event, unless whole levels are looked at. It needs the particles of the picture to
 * be those of the run.
 * @param {HTMLElement} element @param {Follower} follower @param {Engine} engine
 */
function drawFront(element, { opened, at, run, stale }, engine) {
  const grain = computed(() => engine.state.value.view.grain);
  const count = computed(() => {
    if (grain.value === 'level' || stale.value || !opened.value || !run.value) return null;
    const { subject, events } = opened.value;
    const added = events.slice(0, at.value + 1).filter(({ type }) => type === 'added').length;
    const there = placedBefore(run.value.end.parents, subject.particle) + added;
    return there <= run.value.alike ? there : null;
  });
  live(element, () => {
    const there = count.value;
    untracked(() => engine.showFirst(there));
  });
}

/** @param {{ title: HTMLElement, follower: Follower, particles: Track, close: () => void }} parts */
function createHead({ title, follower, particles, close }) {
  const turn = (/** @type {1 | -1} */ by, /** @type {string} */ label, /** @type {'left' | 'right'} */ name) => {
    const to = () => particles.at.value + by;
    return explain(
      button({
        icon: name,
        'aria-label': label,
        off: () => follower.opened.value === null || to() < 0 || to() > particles.last.value,
        // Several presses at once go as many particles further.
        press: () => void follower.open(follower.target.peek() + by),
      }),
      () => ({ title: label, text: `Key Shift ${by < 0 ? '←' : '→'}` }),
    );
  };
  return h(
    'header',
    { class: 'panel-head' },
    title,
    turn(-1, 'Previous particle', 'left'),
    turn(1, 'Next particle', 'right'),
    button({ icon: 'close', 'aria-label': 'Close', press: close }),
  );
}

/** Says where the particle belongs, and which one of the picture it stands for. @param {Follower} follower */
function createAbout(follower) {
  return h('p', { class: 'quiet follow-about' }, () => {
    const opened = follower.opened.value;
    if (!opened) return '';
    const { subject, picture } = opened;
    const from = subject.parent === null ? 'a seed' : `child of particle ${formatCount(subject.parent)}`;
    const words = [`Level ${formatCount(subject.level)}, ${from}.`];
    if (picture) {
      const number = `particle ${formatCount(picture.index)}`;
      const isSame = picture.distance < SAME_PLACE * subject.radius;
      const far = isSame ? '' : `, ${inRadii(picture.distance, subject.radius, 2)} away`;
      words.push(
        picture.index === subject.particle
          ? `It is ${number} of the picture, too${far}.`
          : `It is the nearest to ${number} of the picture${far}.`,
      );
    }
    return words.join(' ');
  });
}

/**
 * Says that the surface has changed, and offers the particle at the same place.
 * @param {Follower} follower @param {Engine} engine @param {() => void} held
 */
function createStale(follower, engine, held) {
  const isStale = () => follower.stale.value;
  const again = () => {
    held();
    void follower.anew();
  };
  return h(
    'div',
    { class: 'follow-notice', role: 'status', hidden: () => !isStale() },
    h('p', null, () => isStale() && 'The surface has changed. This panel still shows the one before.'),
    button(
      { disabled: () => engine.busy.value || engine.empty.value || engine.loading.value !== null, press: again },
      'Follow the particle at the same place',
    ),
  );
}

/**
 * Says how far the run is, or why there is nothing to follow.
 * @param {Follower} follower @param {() => void} held
 */
function createStatus(follower, held) {
  const { status, engine } = follower;
  const words = () => {
    if (status.value.kind === 'ready') return '';
    if (status.value.kind !== 'running') return status.value.text;
    return `Running the paper’s algorithm: ${formatCount(status.value.particles)} particles`;
  };
  const again = (/** @type {string} */ label, /** @type {number | null} */ radius) => {
    const press = () => {
      held();
      follower.again(radius);
    };
    return button({ press }, label);
  };
  return h(
    'div',
    { class: 'follow-status', role: 'status', hidden: () => status.value.kind === 'ready' },
    h('p', null, words),
    h('div', null, () => {
      if (status.value.kind === 'failed') return again('Try again', null);
      if (status.value.kind !== 'too_many') return null;
      return again(coarserWords(status.value.radius, engine.columns.adaptive), status.value.radius);
    }),
  );
}

/** @param {number} radius  or, with particles of many sizes, the factor on them @param {boolean} adaptive */
const coarserWords = (radius, adaptive) =>
  adaptive
    ? `Follow with sizes ${formatSignificant(radius, 2)} times as large`
    : `Follow at a coarser radius, ${formatSignificant(radius, 2)}`;

/** @param {Follower} follower @param {Engine} engine */
function createFoot(follower, engine) {
  const about = h('p', { class: 'quiet follow-note' }, () => {
    const run = follower.run.value;
    if (!run) return '';
    const count = formatCount(run.end.radii.length);
    if (follower.rest.status.value)
      return 'The steps of that run, from its own particles. Where the picture’s front went another way, its particles move otherwise.';
    if (run.adaptive) {
      const [least, most] = run.end.radii.reduce(([a, b], r) => [Math.min(a, r), Math.max(b, r)], [Infinity, 0]);
      const r = `r from ${formatSignificant(least, 3)} to ${formatSignificant(most, 3)}`;
      return [
        '§5 of the paper on this surface, child by child and before relaxation:',
        `${count} particles, ${r}, by the radius law of the settings.`,
        'The picture solves for the places that are found here by pushes, and its sizes change gradually,',
        'so that its particles lie elsewhere.',
      ].join(' ');
    }
    return [
      'Algorithm 2 of the paper on this surface, child by child and before relaxation:',
      `${count} particles with r = ${formatSignificant(run.radius, 3)}.`,
      'Matched particles stay among the neighbours, as in the picture; the paper removes them.',
    ].join(' ');
  });
  /** @param {boolean} turns  whether the camera turns there */
  const mark = (turns) => {
    const opened = follower.opened.peek();
    if (!opened) return;
    const { subject } = opened;
    const { place, normal } = follower.rest.status.peek()?.rest ?? opened;
    // The name that the drawings give it: its number in the picture may be another one.
    engine.pointOut({ places: [place], radius: subject.radius, normal, text: 'p' }, { turns });
  };
  live(about, () => {
    void follower.rest.status.value;
    if (follower.opened.value) mark(false);
  });
  return h(
    'div',
    { class: 'follow-foot' },
    h(
      'div',
      { class: 'follow-actions' },
      createTurn(follower, engine),
      button({ press: () => mark(true) }, 'Show in the picture'),
      button({ press: () => void save(follower) }, 'Save transcript'),
    ),
    about,
  );
}

/**
 * Leads from the events of the particle to its relaxation, and back.
 * @param {Follower} follower
 * @param {Engine} engine
 */
function createTurn({ rest }, engine) {
  const turn = () => {
    const isResting = rest.status.peek() !== null;
    engine.setView(isResting ? { grain: 'event', level: null, step: null } : { grain: 'level', level: null, step: 1 });
  };
  const hidden = () => Number(settingOf(engine, 'relax_steps')) === 0;
  return button({ hidden, press: turn }, () => (rest.status.value ? 'Its events' : 'Its relaxation'));
}

/** @param {Follower} follower */
async function save(follower) {
  const opened = follower.opened.peek();
  const run = follower.run.peek();
  if (!opened || !run) return;
  const { subject, events } = opened;
  const head = [
    `Particle ${subject.particle}, level ${subject.level}`,
    run.adaptive ? `§5, particles of many sizes, r = ${subject.radius}` : `Algorithm 2, r = ${run.radius}`,
    `Surface: ${run.words}`,
  ];
  const text = transcript(
    events.map((_, at) => momentAt(events, at)),
    subject,
    head,
  );
  const rest = await follower.rest.told(subject.particle);
  const all = rest.length > 0 ? `${text}\nRelaxation\n${rest.join('\n').replace(/\u00a0/g, ' ')}\n` : text;
  download(new Blob([all], { type: 'text/plain;charset=utf-8' }), `particle-${subject.particle}.txt`);
}
