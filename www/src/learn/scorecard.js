/** The scorecard: two scores side by side beside the ideal, with what each figure means and which one decides. */
import { signal } from '@preact/signals-core';
import { fill, h } from '../ui/dom.js';
import { MISSING } from '../ui/format.js';
import { bestOf, haveSameDiscs, ROWS } from './score.js';

/** @import { Score, ScoreFigures, ScorePlace, ScoreRow } from './types.js' */

/**
 * @typedef {object} ScoreWords
 * @property {string} [caption]
 * @property {keyof ScoreFigures} [decides]  the figure that decides between these two
 * @property {boolean} [isMarked]  whether the better figures are marked
 */

/**
 * @param {(place: ScorePlace | null, side: number) => void} show  shows a place of the particles on a side; null: none
 */
export function createScorecard(show) {
  const element = h('div', { class: 'compare-box' });
  const pressed = signal('');
  /** @param {readonly Score[]} scores @param {ScoreRow} row @param {number} side @param {boolean} isBest */
  function cellOf(scores, row, side, isBest) {
    const value = scores[side][row.key];
    const text = [isBest ? h('span', { class: 'best' }, 'better ') : null, value === null ? MISSING : row.write(value)];
    const place = row.key === 'hole' || row.key === 'pair' ? scores[side].places[row.key] : null;
    if (!place) return h('td', null, text);
    const own = `${row.key} ${side}`;
    const press = () => {
      pressed.value = pressed.peek() === own ? '' : own;
      show(pressed.peek() ? place : null, side);
    };
    const isPressed = () => String(pressed.value === own);
    return h(
      'td',
      null,
      h('button', { type: 'button', class: 'figure-place', 'aria-pressed': isPressed, on: { click: press } }, text),
    );
  }
  return {
    element,
    /** @param {readonly string[]} names @param {readonly Score[]} scores @param {ScoreWords} [how] */
    tell(names, scores, { caption, decides, isMarked = true } = {}) {
      pressed.value = '';
      const isOneDisc = haveSameDiscs(scores);
      const rows = ROWS.map((row) => {
        const values = scores.map((score) => score[row.key]);
        // What a sampling costs is marked only where that is what decides.
        const isJudged = isMarked && (row.ideal !== null || row.key === decides);
        const best = isJudged ? bestOf(values, row, isOneDisc) : -1;
        const kind = row.key === decides ? 'decides' : null;
        return [
          h(
            'tr',
            { class: kind },
            h(
              'th',
              { scope: 'row' },
              row.name,
              kind ? h('span', { class: 'visually-hidden' }, ', which decides here') : null,
            ),
            h('td', { class: 'ideal' }, row.ideal === null ? MISSING : row.write(row.ideal)),
            scores.map((_, side) => cellOf(scores, row, side, side === best)),
          ),
          h('tr', { class: 'means' }, h('td', { colspan: 2 + names.length }, row.means)),
        ];
      });
      const heads = ['Ideal', ...names].map((name) => h('th', { scope: 'col' }, name));
      fill(
        element,
        h(
          'table',
          { class: 'compare' },
          caption ? h('caption', null, caption) : null,
          h('thead', null, h('tr', null, h('td'), heads)),
          h('tbody', null, rows),
        ),
        isOneDisc
          ? null
          : h(
              'p',
              { class: 'quiet' },
              'The discs differ in size here, so that what lies outside them decides nothing.',
            ),
        h('p', { class: 'quiet press' }, 'Press a hole or a pair to turn to it.'),
      );
    },
  };
}
