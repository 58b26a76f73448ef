/** How long the lesson takes, as its pages say: the words of a chapter, and what is done in it. */
import { readFileSync } from 'node:fs';
import { expect, test } from 'vitest';
import { QUESTIONS } from '../../../src/learn/questions.js';

const page = readFileSync(new URL('../../../learn/index.html', import.meta.url), 'utf8');
const guide = readFileSync(new URL('../../../../docs/page.md', import.meta.url), 'utf8');

/*
 * Rates between those of two students who tried everything. Tables and what figures say are part of
 * the time for words: with an earlier text of 1,355 words, 11 questions and as many figures they
 * give 50 minutes.
 */
const WORDS_A_MINUTE = 97;
/** The answer of a question has about so many words. */
const ANSWER_WORDS = 45;
/** Seconds to think about a question, and to try a figure. */
const QUESTION_S = 30;
const FIGURE_S = 90;
/**
 * Seconds for what takes longer: seeds, slots of the plane and of the cap, a comparison and *Make it
 * fail*, three pairs that are drawn, events.
 */
const MORE_S = /** @type {Record<string, number>} */ ({ why: 30, plane: 120, 'what-if': 180, judge: 240, first: 150 });
/** Chapters that the lesson can do without. */
const APPENDIX = ['circle', 'first', 'sizes', 'cost'];

/** @param {string} text @param {RegExp} what */
const count = (text, what) => [...text.matchAll(what)].length;

/**
 * The chapters with the minutes that they are said to take, and those of their words and of what is
 * done.
 */
const chapters = [
  ...page.matchAll(/<section class="chapter" id="([\w-]+)" data-stop data-minutes="(\d+)"(.*?)<\/section>/gs),
].map(([, id, minutes, content]) => {
  const read = content
    .replace(/<noscript>.*?<\/noscript>/gs, '')
    .replace(/<div class="what-if-stills">.*?<\/div>/gs, '')
    .replace(/<[^>]*>/g, ' ');
  const asked = [...content.matchAll(/class="predict" id="([\w-]+)"/g)].map(
    ([, question]) => QUESTIONS[question].question,
  );
  const questions = asked.length;
  const words = [read, ...asked].join(' ').split(/\s+/).filter(Boolean).length + ANSWER_WORDS * questions;
  const figures = count(content, /data-figure=|class="bench"/g);
  const seconds = QUESTION_S * questions + FIGURE_S * figures + (MORE_S[id] ?? 0);
  return { id, minutes: Number(minutes), exact: words / WORDS_A_MINUTE + seconds / 60 };
});

test('each chapter takes the minutes of its words and of what is done in it', () => {
  const told = chapters.map(({ id, minutes }) => [id, minutes]);
  expect(told).toEqual(chapters.map(({ id, exact }) => [id, Math.round(exact)]));
});

test('without the appendix it is under forty minutes, and contents, opening and guide say how many', () => {
  const listed = [...page.matchAll(/<a href="#([\w-]+)">[^<]*<\/a> <span class="quiet">(\d+) min<\/span>/g)];
  expect(Object.fromEntries(listed.map(([, id, minutes]) => [id, Number(minutes)]))).toEqual(
    Object.fromEntries(chapters.map(({ id, minutes }) => [id, minutes])),
  );
  const main = chapters.filter(({ id }) => !APPENDIX.includes(id));
  const sum = Math.round(main.reduce((all, { exact }) => all + exact, 0));
  expect(sum).toBeLessThan(40);
  expect(main.reduce((all, { minutes }) => all + minutes, 0)).toBe(sum);
  expect(page).toContain(`it takes some ${sum} minutes, without the appendix`);
  expect(guide).toContain(`some ${sum} minutes`);
});
