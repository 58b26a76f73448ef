/**
 * The panel that follows one particle through the paper's algorithm, event by event. It takes the place of the report, and on a
 * phone that of the sheet; it is loaded when it is first asked for.
 */
import { effect } from '@preact/signals-core';
import { momentAt } from '../../figures/moment.js';
import { inRadii, transcript } from '../../figures/words.js';
import { bindText, fill, h, uniqueId } from '../dom.js';
import { explain } from '../explain.js';
import { formatCount, formatSignificant } from '../format.js';
import { icon } from '../icons.js';
import { download } from '../share.js';
import { Follower } from './follower.js';
import sheet from './lesson.css?url';
import { createStepper } from './stepper.js';
import { createViews } from './views.js';

/** @typedef {import('../../engine/types.js').Engine} Engine */

/** Loads the styles of the panel. @returns {Promise<void>} */
function loadStyles() {
  return new Promise((resolve, reject) => {
    const failed = () => {
      link.remove();
      reject(new Error('the styles of the panel did not load'));
    };
    const link = h('link', { rel: 'stylesheet', href: sheet, on: { load: () => resolve(), error: failed } });
    document.head.append(link);
  });
}

/** @param {HTMLElement} shell @param {Engine} engine */
export async function mountFollow(shell, engine) {
  await loadStyles();
  const follower = new Follower(engine);
  const id = uniqueId('follow');
  const title = h('h2', { id }, 'Particle');
  const stepper = createStepper(follower);
  const ready = h('div', { class: 'follow-ready' }, createAbout(follower), stepper.element, createViews(follower));
  ready.append(createFoot(follower, engine));
  // What was pressed goes away with what it offered, so the panel itself takes the focus.
  const held = () => element.focus({ preventScroll: true });
  const element = h(
    'section',
    { class: 'panel panel-follow', 'aria-labelledby': id, tabindex: -1, hidden: true },
    createHead(title, follower, () => close()),
    h('div', { class: 'panel-body' }, createStale(follower, engine, held), createStatus(follower, held), ready),
  );
  shell.append(element);
  bindText(title, () => {
    const opened = follower.opened.value;
    return opened ? `Particle ${formatCount(opened.subject.particle)}` : 'Particle';
  });
  effect(() => {
    ready.hidden = follower.opened.value === null;
    // The keys work at once: from the panel itself the focus goes to the range.
    if (!ready.hidden && document.activeElement === element) stepper.focus();
  });
  element.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !press(event)) return;
    event.preventDefault();
    event.stopPropagation();
  });

  /** @param {KeyboardEvent} event @returns {boolean} whether the key means something here */
  function press({ key, shiftKey }) {
    if (key === 'Escape') close();
    else if (key === 'ArrowLeft' && shiftKey) follower.turn(-1);
    else if (key === 'ArrowRight' && shiftKey) follower.turn(1);
    else if (key === 'ArrowLeft') follower.step(-1);
    else if (key === 'ArrowRight') follower.step(1);
    else if (key === 'Home') follower.seek(0);
    else if (key === 'End') follower.seek(follower.last);
    else return false;
    return true;
  }

  /** Where the focus was before. @type {HTMLElement | null} */
  let before = null;
  function close() {
    follower.close();
    element.hidden = true;
    if (engine.spot.peek()) engine.pointOut(null);
    (before?.isConnected && before.offsetParent ? before : document.getElementById('canvas-host'))?.focus();
  }

  return {
    /** @param {number} index  of a particle of the picture */
    follow(index) {
      if (element.hidden) before = document.activeElement instanceof HTMLElement ? document.activeElement : null;
      element.hidden = false;
      held();
      void follower.follow(index);
    },
  };
}

/** @param {HTMLElement} title @param {Follower} follower @param {() => void} close */
function createHead(title, follower, close) {
  const turn = (/** @type {1 | -1} */ by, /** @type {string} */ label, /** @type {'left' | 'right'} */ name) => {
    const button = h(
      'button',
      { type: 'button', class: 'button plain square', 'aria-label': label, on: { click: () => follower.turn(by) } },
      icon(name),
    );
    effect(() => {
      const to = (follower.opened.value?.subject.particle ?? -Infinity) + by;
      const count = follower.run.value?.end.radii.length ?? 0;
      button.setAttribute('aria-disabled', String(!(to >= 0 && to < count)));
    });
    explain(button, () => ({ title: label, text: `Key Shift ${by < 0 ? '←' : '→'}` }));
    return button;
  };
  return h(
    'header',
    { class: 'panel-head' },
    title,
    turn(-1, 'Previous particle', 'left'),
    turn(1, 'Next particle', 'right'),
    h(
      'button',
      { type: 'button', class: 'button plain square', 'aria-label': 'Close', on: { click: close } },
      icon('close'),
    ),
  );
}

/** Says where the particle belongs, and which one of the picture it stands for. @param {Follower} follower */
function createAbout(follower) {
  const element = h('p', { class: 'quiet follow-about' });
  bindText(element, () => {
    const opened = follower.opened.value;
    if (!opened) return '';
    const { subject, picture } = opened;
    const from = subject.parent === null ? 'a seed' : `child of particle ${formatCount(subject.parent)}`;
    const words = [`Level ${formatCount(subject.level)}, ${from}.`];
    if (picture) {
      const number = `particle ${formatCount(picture.index)}`;
      const far = `${inRadii(picture.distance, subject.radius, 2)} away`;
      words.push(
        picture.index === subject.particle
          ? `It is ${number} of the picture, too, ${far}.`
          : `It is the nearest to ${number} of the picture, ${far}.`,
      );
    }
    return words.join(' ');
  });
  return element;
}

/**
 * Says that the surface has changed, and offers the particle at the same place.
 * @param {Follower} follower @param {Engine} engine @param {() => void} held
 */
function createStale(follower, engine, held) {
  const words = 'The surface has changed. This panel still shows the one before.';
  const again = () => {
    held();
    void follower.again();
  };
  const button = h(
    'button',
    { type: 'button', class: 'button', on: { click: again } },
    'Follow the particle at the same place',
  );
  const text = h('p');
  const element = h('div', { class: 'follow-notice', role: 'status' }, text, button);
  effect(() => {
    const stale = follower.stale.value;
    element.hidden = !stale;
    text.textContent = stale ? words : '';
    button.disabled = engine.busy.value || engine.empty.value || engine.loading.value !== null;
  });
  return element;
}

/**
 * Says how far the run is, or why there is nothing to follow.
 * @param {Follower} follower @param {() => void} held
 */
function createStatus(follower, held) {
  const text = h('p');
  const action = h('div');
  const element = h('div', { class: 'follow-status', role: 'status' }, text, action);
  const again = (/** @type {string} */ label, /** @type {number | null} */ radius) =>
    h(
      'button',
      {
        type: 'button',
        class: 'button',
        on: {
          click: () => {
            held();
            if (follower.wanted) void follower.follow(follower.wanted.index, radius);
          },
        },
      },
      label,
    );
  effect(() => {
    const status = follower.status.value;
    element.hidden = status.kind === 'ready';
    if (status.kind === 'running')
      text.textContent = `Running the paper’s algorithm: ${formatCount(status.particles)} particles`;
    else if (status.kind !== 'ready') text.textContent = status.text;
    if (status.kind === 'too_many')
      fill(action, again(`Follow at a coarser radius, ${formatSignificant(status.radius, 2)}`, status.radius));
    else if (status.kind === 'failed') fill(action, again('Try again', null));
    else fill(action);
  });
  return element;
}

/** @param {Follower} follower @param {Engine} engine */
function createFoot(follower, engine) {
  const about = h('p', { class: 'quiet follow-note' });
  bindText(about, () => {
    const run = follower.run.value;
    if (!run) return '';
    const count = formatCount(run.end.radii.length);
    const sizes = run.adaptive ? ' The picture sizes its particles by the curvature; here all have this radius.' : '';
    return `Algorithm 2 of the paper on this surface, child by child and before relaxation: ${count} particles with r = ${formatSignificant(run.radius, 3)}.${sizes} Matched particles stay among the neighbours, as in the picture; the paper removes them.`;
  });
  /** @param {boolean} turns  whether the camera turns there */
  const mark = (turns) => {
    const opened = follower.opened.peek();
    if (!opened) return;
    const { place, normal, subject } = opened;
    // The name that the drawings give it: its number in the picture may be another one.
    engine.pointOut({ places: [place], radius: subject.radius, normal, text: 'p' }, { turns });
  };
  effect(() => {
    if (follower.opened.value) mark(false);
  });
  return h(
    'div',
    { class: 'follow-foot' },
    h(
      'div',
      { class: 'follow-actions' },
      h('button', { type: 'button', class: 'button', on: { click: () => mark(true) } }, 'Show in the picture'),
      h('button', { type: 'button', class: 'button', on: { click: () => save(follower) } }, 'Save transcript'),
    ),
    about,
  );
}

/** @param {Follower} follower */
function save(follower) {
  const opened = follower.opened.peek();
  const run = follower.run.peek();
  if (!opened || !run) return;
  const { subject, events } = opened;
  const head = [
    `Particle ${subject.particle}, level ${subject.level}`,
    `Algorithm 2, r = ${run.radius}`,
    `Surface: ${run.words}`,
  ];
  const text = transcript(
    events.map((_, at) => momentAt(events, at)),
    subject,
    head,
  );
  download(new Blob([text], { type: 'text/plain;charset=utf-8' }), `particle-${subject.particle}.txt`);
}
