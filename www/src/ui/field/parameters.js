/** Creates a slider, a number box and a Play button for every parameter of the formula. */
import { batch, computed } from '@preact/signals-core';
import { canGrab, isBareModel } from '../../engine/pulls.js';
import { button } from '../button.js';
import { h } from '../dom.js';
import { explain } from '../explain.js';
import { formatStep, plural } from '../format.js';
import { createSegmented } from '../segmented.js';
import { createSelect } from '../select.js';
import { createSlider } from '../slider.js';
import { createHistogram } from './image.js';
import { inviteToDrag } from './invite.js';

/**
 * @import { Engine, Parameter, ReadonlySignal } from '../../engine/types.js'
 * @import { Motion, Pins } from '../types.js'
 */

/** Speeds of playing, as multiples of the usual one. */
const SPEEDS = [0.25, 0.5, 1, 2, 4];

/** @param {number} n */
const pullsOf = (n) => (n === 0 ? 'The surface can be pulled by hand.' : `${plural(n, 'pull')} on the surface.`);

/** @param {Engine} engine @param {{ motion: Motion, pins: Pins }} shared */
export function createParameters(engine, { motion, pins }) {
  const isModel = computed(() => isBareModel(engine.field.value));
  // The controls are rebuilt only when the set of parameters changes, not when their values do.
  const shape = computed(() =>
    JSON.stringify(
      (engine.field.value?.parameters ?? []).map(({ name, label, min, max, step }) => [name, label, min, max, step]),
    ),
  );
  const values = computed(() => engine.state.value.parameters);
  const invited = inviteToDrag(engine);
  return h(
    'div',
    {
      class: 'section parameters',
      hidden: () =>
        (!canGrab(engine.field.value) && !engine.field.value?.parameters.length) ||
        // If f does not depend on x, y or z, no slider makes a surface.
        (engine.result.value === 'none' && engine.progress.value.stop_reason === 'constant'),
    },
    h(
      'div',
      { class: 'section-head' },
      h('h2', null, () => (isModel.value ? 'Pulls' : 'Parameters')),
      h(
        'span',
        { class: 'invite', hidden: () => invited.value === null },
        'Drag ',
        h('var', null, () => invited.value),
      ),
      h('span', null, resetAll(engine), grabbing(engine, pins)),
    ),
    h('p', { class: 'quiet', hidden: () => !isModel.value }, () => pullsOf(engine.state.value.pulls.length)),
    h('div', { class: 'rows' }, () => {
      void shape.value;
      return engine.field.peek()?.parameters.map((parameter) => createRow(engine, parameter, { values, motion }));
    }),
    createCourse(motion),
  );
}

/** Creates the switch for dragging the surface itself. @param {Engine} engine @param {Pins} pins */
function grabbing(engine, pins) {
  const isOn = computed(() => pins.value !== null);
  const press = () => {
    pins.value = isOn.peek() ? null : [];
  };
  const hidden = () => !canGrab(engine.field.value);
  const grab = button({ class: 'plain small', hidden, 'aria-pressed': () => String(isOn.value), press }, 'Grab');
  return explain(grab, () => ({
    text: `Drag the surface${engine.field.value?.model ? '' : ': the parameters follow'}. Or Shift-drag without this mode.`,
  }));
}

/** The names of the sliders that were moved; other choices for a file are not reset. @param {Engine} engine */
const changedOf = ({ state, field }) =>
  Object.keys(state.value.parameters).filter(
    (name) =>
      !(field.value?.image || field.value?.mesh) || field.value.parameters.some((parameter) => parameter.name === name),
  );

/** @param {Engine} engine */
function resetAll(engine) {
  const changed = computed(() => {
    const { pulls } = engine.state.value;
    return changedOf(engine).length > 0 || pulls.length > 0;
  });
  const press = () =>
    batch(() => {
      if (engine.state.peek().pulls.length > 0) engine.setPulls([]);
      for (const name of changedOf(engine)) engine.resetParameter(name);
    });
  return button({ class: () => (changed.value ? 'plain small' : 'plain small invisible'), press }, 'Reset');
}

/**
 * @param {Engine} engine
 * @param {Parameter} parameter
 * @param {{ values: ReadonlySignal<Record<string, number>>, motion: Motion }} parts
 */
function createRow(engine, { name, label, value, min, max, step }, { values, motion }) {
  const title = label && label !== name ? label : `Parameter ${name}`;
  const answered = computed(() => engine.field.value?.parameters.find((parameter) => parameter.name === name));
  const slider = createSlider({
    // The accessible name includes the symbol, because a setting may have the same label, such as the radius.
    name: label && label !== name ? `${label} ${name}` : title,
    scale: { min, max, step },
    value: () => values.value[name] ?? answered.value?.value ?? value,
    describe: (now) => formatStep(now, step / 10),
    change: (now, live) => engine.setParameter(name, now, { live }),
    reset: () => engine.resetParameter(name),
    read: engine.readNumber,
  });
  const caption = h('span', { class: 'name' }, h('var', null, name));
  const isPlaying = computed(() => motion.playing.value === name);
  const play = explain(
    button({
      class: 'plain square play',
      icon: () => (isPlaying.value ? 'pause' : 'play'),
      'aria-label': () => `${isPlaying.value ? 'Pause' : 'Play'} ${name}`,
      press: () => motion.toggle({ name, min, max, step }),
    }),
    () => ({ text: `Moves ${name} from ${formatStep(min, step)} to ${formatStep(max, step)}.` }),
  );
  const row = h('div', { class: 'row', data: { parameter: name } }, caption, slider.range, slider.box, play);
  explain(caption, () => ({
    title,
    text: `From ${formatStep(min, step)} to ${formatStep(max, step)}. Shift drags ten times finer, a double click resets.`,
  }));
  if (name === 'iso' && engine.field.peek()?.image) {
    row.classList.add('has-histogram');
    row.append(createHistogram(engine, () => values.value.iso ?? answered.value?.value ?? value));
  }
  return row;
}

/** Creates the choice of how a parameter is played, shown during play. @param {Motion} motion */
function createCourse({ playing, course, speed }) {
  return h(
    'div',
    { class: 'course', hidden: () => playing.value === null },
    createSegmented({
      name: 'Course',
      choices: [
        { value: 'bounce', label: 'Bounce' },
        { value: 'loop', label: 'Loop' },
      ],
      value: () => course.value,
      change: (value) => {
        course.value = value;
      },
    }),
    createSelect({
      name: 'Speed',
      choices: SPEEDS.map((value) => ({ value, label: `${value}\u202f×` })),
      value: () => speed.value,
      change: (value) => {
        speed.value = value;
      },
    }),
  );
}
