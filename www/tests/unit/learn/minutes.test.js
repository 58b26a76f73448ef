/** How long the lesson takes, as its pages say: the words of a chapter, and what is done in it. */
import { readFileSync } from 'node:fs';
import { expect, test } from 'vitest';

const page = readFileSync(new URL('../../../learn/index.html', import.meta.url), 'utf8');
const guide = readFileSync(new URL('../../../../docs/page.md', import.meta.url), 'utf8');

/** A careful reader takes in so many words of such a text in a minute. */
const WORDS_A_MINUTE = 200;
/** Seconds for the questions of a chapter, with their answers, and for its figures, with their words. */
const SECONDS = {
  why: 80,
  // Eighteen slots of a plane, and those of the cap.
  plane: 250,
  circle: 140,
  first: 140,
  rings: 75,
  // Three questions.
  seams: 340,
  cost: 65,
  race: 165,
  sizes: 185,
  // Two comparisons, and some tries to make it fail.
  'what-if': 320,
  judge: 165,
  moving: 165,
};

/** The chapters with the minutes that they are said to take, and their number of words. */
const chapters = [
  ...page.matchAll(/<section class="chapter" id="([\w-]+)" data-stop data-minutes="(\d+)"(.*?)<\/section>/gs),
].map(([, id, minutes, content]) => {
  const read = content
    .replace(/<noscript>.*?<\/noscript>/gs, '')
    .replace(/<div class="(notes|what-if-stills)">.*?<\/div>/gs, '')
    .replace(/<[^>]*>/g, ' ');
  return { id, minutes: Number(minutes), words: read.split(/\s+/).filter(Boolean).length };
});

test('each chapter takes the minutes of its words and of what is done in it', () => {
  const told = chapters.map(({ id, minutes }) => [id, minutes]);
  const counted = chapters.map(({ id, words }) => [
    id,
    Math.round(words / WORDS_A_MINUTE + SECONDS[/** @type {keyof typeof SECONDS} */ (id)] / 60),
  ]);
  expect(told).toEqual(counted);
  expect(told.map(([id]) => id).sort()).toEqual(Object.keys(SECONDS).sort());
});

test('the contents, the opening and the guide say the same', () => {
  const listed = [...page.matchAll(/<a href="#([\w-]+)">[^<]*<\/a> <span class="quiet">(\d+) min<\/span>/g)];
  expect(Object.fromEntries(listed.map(([, id, minutes]) => [id, Number(minutes)]))).toEqual(
    Object.fromEntries(chapters.map(({ id, minutes }) => [id, minutes])),
  );
  const sum = chapters.reduce((all, { minutes }) => all + minutes, 0);
  expect(sum).toBeGreaterThanOrEqual(40);
  expect(sum).toBeLessThanOrEqual(50);
  expect(page).toContain(`it takes some ${sum} minutes`);
  expect(guide).toContain(`some ${sum} minutes`);
});
