/** Creates a slider, a number box and a button that plays it for every parameter of the formula. */
import { computed, effect } from '@preact/signals-core';
import { fill, h, live } from '../dom.js';
import { explain } from '../explain.js';
import { formatStep } from '../format.js';
import { icon } from '../icons.js';
import { createSegmented } from '../segmented.js';
import { createSlider } from '../slider.js';

/**
 * @import { Engine, Parameter } from '../../engine/types.js'
 * @import { Course, Motion } from '../motion.js'
 * @import { ReadonlySignal } from '@preact/signals-core'
 */

/** Speeds at which a parameter is played, as multiples of the usual one. */
const SPEEDS = [0.25, 0.5, 1, 2, 4];

/** @param {Engine} engine @param {Motion} motion */
export function createParameters(engine, motion) {
  const rows = h('div', { class: 'rows' });
  const section = h(
    'div',
    { class: 'section parameters' },
    h('div', { class: 'section-head' }, h('h2', null, 'Parameters'), resetAll(engine)),
    rows,
    createCourse(motion),
  );
  // The controls are rebuilt only when the set of parameters changes, not when their values do.
  const shape = computed(() =>
    JSON.stringify(
      (engine.field.value?.parameters ?? []).map(({ name, label, min, max, step }) => [name, label, min, max, step]),
    ),
  );
  const values = computed(() => engine.state.value.parameters);
  effect(() => {
    void shape.value;
    const parameters = engine.field.peek()?.parameters ?? [];
    section.hidden = parameters.length === 0;
    fill(
      rows,
      parameters.map((parameter) => createRow(engine, parameter, { values, motion })),
    );
  });
  return section;
}

/** @param {Engine} engine */
function resetAll(engine) {
  const changed = computed(() => Object.keys(engine.state.value.parameters).length > 0);
  return h(
    'button',
    {
      type: 'button',
      class: () => (changed.value ? 'button plain small' : 'button plain small invisible'),
      on: {
        click: () => {
          for (const name of Object.keys(engine.state.peek().parameters)) engine.resetParameter(name);
        },
      },
    },
    'Reset',
  );
}

/**
 * @param {Engine} engine
 * @param {Parameter} parameter
 * @param {object} parts
 * @param {ReadonlySignal<Record<string, number>>} parts.values
 * @param {Motion} parts.motion
 */
function createRow(engine, { name, label, value, min, max, step }, { values, motion }) {
  const title = label && label !== name ? label : `Parameter ${name}`;
  const slider = createSlider({
    // The accessible name includes the symbol, because a sampling setting may have the same label, such as the radius.
    name: label && label !== name ? `${label} ${name}` : title,
    scale: { min, max, step },
    value: values.peek()[name] ?? value,
    describe: (now) => formatStep(now, step / 10),
    change: (now, live) => engine.setParameter(name, now, { live }),
    reset: () => engine.resetParameter(name),
  });
  live(slider.range, () => {
    const held = values.value[name];
    const answered = engine.field.value?.parameters.find((parameter) => parameter.name === name)?.value;
    slider.set(held ?? answered ?? value);
  });
  const caption = h('span', { class: 'name' }, h('var', null, name));
  const isPlaying = computed(() => motion.playing.value === name);
  const play = h('button', {
    type: 'button',
    class: 'button plain square play',
    'aria-label': () => `${isPlaying.value ? 'Pause' : 'Play'} ${name}`,
    on: { click: () => motion.toggle({ name, min, max, step }) },
  });
  live(play, () => fill(play, icon(isPlaying.value ? 'pause' : 'play')));
  explain(play, () => ({ text: `Moves ${name} from ${formatStep(min, step)} to ${formatStep(max, step)}.` }));
  const row = h('div', { class: 'row', data: { parameter: name } }, caption, slider.range, slider.box, play);
  explain(caption, () => ({
    title,
    text: `From ${formatStep(min, step)} to ${formatStep(max, step)}. Shift drags ten times finer, a double click resets.`,
  }));
  return row;
}

/** Creates the choice of how a parameter is played, which is shown while one is. @param {Motion} motion */
function createCourse({ playing, course, speed }) {
  const courses = createSegmented({
    name: 'Course',
    choices: [
      { value: 'bounce', label: 'Bounce' },
      { value: 'loop', label: 'Loop' },
    ],
    change: (value) => {
      course.value = /** @type {Course} */ (value);
    },
  });
  effect(() => courses.set(course.value));
  const speeds = h(
    'select',
    {
      class: 'select',
      'aria-label': 'Speed',
      on: {
        change: () => {
          speed.value = Number(speeds.value);
        },
      },
    },
    SPEEDS.map((value) => h('option', { value }, `${value}\u202f×`)),
  );
  effect(() => {
    speeds.value = String(speed.value);
  });
  return h('div', { class: 'course', hidden: () => playing.value === null }, courses.element, speeds);
}
