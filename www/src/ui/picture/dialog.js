/** The dialog that saves the picture: as a file, on paper, as a film or as a sequence of pictures. */
import { signal } from '@preact/signals-core';
import { button } from '../button.js';
import { createDialog } from '../dialog.js';
import { h, uniqueId } from '../dom.js';
import { createSelect } from '../select.js';
import { download, stem } from '../share.js';
import { captionOf } from './compose.js';
import { canFilm, drawOn, makeFilm, makeSequence } from './film.js';
import { printPage } from './print.js';
import { createRecorderBar } from './recorder-bar.js';
import { FILM_SIZES, sizesOf, sizeWords } from './sizes.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Motion, Toast } from '../types.js'
 * @import { Shared, Size, Subject, Wish } from './types.js'
 */

/** @typedef {{ id: string, label: string, size: Size }} SizeEntry */

/** Lengths of a film, in seconds. */
const LENGTHS_S = [2, 4, 8, 12];
const USUAL_S = 4;
/** Values of two choices: a film of what the user does, and the turntable. */
const FREE = 'free';
const TURN = 'turn';

/**
 * @param {Engine} engine
 * @param {{ motion: Motion, toast: Toast }} page
 */
export function createPictureDialog(engine, page) {
  const transparent = check('Transparent background', false);
  const legend = check('Legend', false);
  const caption = check('Caption', false);
  const parts = () => ({
    legend: legend.input.checked ? engine.legend.peek() : null,
    caption: caption.input.checked ? captionOf(engine) : [],
    colours: coloursOf(engine),
  });
  const shared = { engine, page, parts, transparent: transparent.input };
  const dialog = createDialog(
    'Save the picture',
    h('div', { class: 'picture-line' }, transparent.label, legend.label, caption.label),
    ...pictureSection({ ...shared, close: () => dialog.close() }),
    ...filmSection({ ...shared, close: () => dialog.close() }),
  );
  dialog.element.classList.add('picture-dialog');
  return dialog;
}

/** @param {string} text @param {boolean} checked */
function check(text, checked) {
  const input = h('input', { type: 'checkbox', prop: { checked } });
  return { input, label: h('label', { class: 'check' }, input, text) };
}

/** @param {string} label @param {HTMLSelectElement} select */
function choice(label, select) {
  select.id = uniqueId('choice');
  return h('div', { class: 'picture-choice' }, h('label', { for: select.id }, label), select);
}

/** @param {readonly SizeEntry[]} entries */
const sizeChoices = (entries) => entries.map((entry) => ({ value: entry.id, label: sizeWords(entry) }));

/** The selected entry. @param {readonly SizeEntry[]} entries @param {HTMLSelectElement} select */
const chosen = (entries, { value }) => entries.find(({ id }) => id === value) ?? entries[0];

/** @param {string} text @param {() => void} press @param {string} [look] */
const action = (text, press, look = '') => button({ class: look, press }, text);

/** @param {Shared} shared */
function pictureSection({ engine, page, parts, transparent, close }) {
  const ofWindow = () => sizesOf({ width: innerWidth, height: innerHeight, ratio: devicePixelRatio });
  const sizes = signal(ofWindow());
  addEventListener('resize', () => {
    sizes.value = ofWindow();
  });
  const select = createSelect({ choices: () => sizeChoices(sizes.value) });
  const save = async () => {
    const { size } = chosen(sizes.peek(), select);
    try {
      const canvas = new OffscreenCanvas(size.width, size.height);
      const context = canvas.getContext('2d');
      if (!context) throw new Error('no canvas');
      const image = await engine.picture({ ...size, transparent: transparent.checked });
      // A device may draw fewer pixels than requested.
      Object.assign(canvas, { width: image.width, height: image.height });
      await drawOn(
        { ...wishOf(engine, { width: image.width, height: image.height }), parts },
        context,
        transparent.checked,
      );
      download(await canvas.convertToBlob({ type: 'image/png' }), `${stem(engine)}.png`);
      close();
    } catch {
      page.toast({ id: 'save', kind: 'error', text: 'The picture could not be drawn. Choose a smaller size.' });
    }
  };
  return [
    h('h3', null, 'Picture'),
    choice('Size', select),
    h('div', { class: 'picture-actions' }, [
      action('Save PNG', save, 'primary'),
      action('Print', () => {
        close();
        void printPage(engine);
      }),
    ]),
  ];
}

/** @param {Engine} engine @param {Size} size @returns {Omit<Wish, 'parts'>} */
const wishOf = (engine, size) => ({
  engine,
  size,
  subject: { kind: FREE },
  seconds: 0,
  signal: new AbortController().signal,
  tell: () => {},
});

/** @param {Shared} shared */
function filmSection({ engine, page, parts, transparent, close }) {
  const subjects = createSelect({
    choices: () => [
      { value: TURN, label: 'Turntable' },
      ...(engine.field.value?.parameters ?? []).map(({ name }) => ({ value: name, label: `Parameter ${name}` })),
      { value: FREE, label: 'My own moves' },
    ],
  });
  const sizes = createSelect({ choices: sizeChoices(FILM_SIZES) });
  const length = createSelect({ choices: LENGTHS_S.map((value) => ({ value, label: `${value}\u202fs` })) });
  length.value = String(USUAL_S);
  /** @returns {Subject} */
  const subject = () => {
    const { value } = subjects;
    const range = engine.field.peek()?.parameters.find(({ name }) => name === value);
    if (range) return { kind: 'parameter', range, course: page.motion.course.peek() };
    return { kind: value === FREE ? FREE : TURN };
  };
  /** @param {(wish: Wish) => Promise<Blob | null>} make */
  const record = async (make) => {
    const { filming } = page.motion;
    if (filming.peek()) return;
    filming.value = true;
    close();
    page.motion.stop();
    const { size } = chosen(FILM_SIZES, sizes);
    const abort = new AbortController();
    const bar = createRecorderBar(() => abort.abort());
    try {
      const seconds = Number(length.value);
      const film = await make({
        engine,
        size,
        parts,
        subject: subject(),
        seconds,
        signal: abort.signal,
        tell: bar.tell,
      });
      if (film) download(film, `${stem(engine)}.${film.type.split('/')[1]}`);
    } catch (error) {
      const details = error instanceof Error ? error.message : String(error);
      page.toast({ id: 'film', kind: 'error', text: 'The film could not be made. Choose a smaller size.', details });
    } finally {
      filming.value = false;
      bar.remove();
    }
  };
  const sequence = () => record((wish) => makeSequence({ ...wish, transparent: transparent.checked }));
  return [
    h('h3', null, 'Film'),
    choice('Motion', subjects),
    choice('Size', sizes),
    choice('Length', length),
    h('div', { class: 'picture-actions' }, [
      canFilm() ? action('Make film', () => record(makeFilm), 'primary') : null,
      action('Picture sequence', () => {
        // A recording of what the user does has no known end, and its pictures are not finished runs.
        if (subject().kind !== FREE) void sequence();
        else
          page.toast({
            id: 'film',
            kind: 'info',
            text: 'A picture sequence is made of the turntable or of a parameter.',
          });
      }),
    ]),
    h(
      'p',
      { class: 'quiet' },
      canFilm() ? '' : 'This browser encodes no films. ',
      'Both have 30 pictures a second, each of a finished run, without the panels; a sequence is a ZIP file of PNGs. ',
      'Your own moves are recorded as you make them, until you stop.',
    ),
  ];
}

/** Returns the text colours for the picture. @param {Engine} engine */
const coloursOf = (engine) =>
  engine.theme.peek() === 'dark' ? { ink: '#eceef2', quiet: '#aeb4be' } : { ink: '#14171d', quiet: '#4a505b' };
