/** The scorecard: two scores side by side, with the better figure of each row marked. */
import { signal } from '@preact/signals-core';
import { fill, h } from '../ui/dom.js';
import { MISSING } from '../ui/format.js';
import { bestOf, COUNT_WORDS, ROWS } from './score.js';

/** @import { Score, ScorePlace, ScoreRow } from './types.js' */

/**
 * @param {(place: ScorePlace | null, side: number) => void} show  shows a place of the particles on a side; null: none
 */
export function createScorecard(show) {
  const element = h('div', { class: 'compare-box' });
  const pressed = signal('');
  return {
    element,
    /** @param {readonly string[]} names @param {readonly Score[]} scores */
    tell(names, scores) {
      pressed.value = '';
      const cellOf = (/** @type {ScoreRow} */ row, /** @type {number} */ side, /** @type {boolean} */ isBest) => {
        const value = scores[side][row.key];
        const text = [
          isBest ? h('span', { class: 'best' }, 'better ') : null,
          value === null ? MISSING : row.write(value),
        ];
        const place = row.key === 'hole' || row.key === 'pair' ? scores[side].places[row.key] : null;
        if (!place) return h('td', null, text);
        const own = `${row.key} ${side}`;
        const press = () => {
          pressed.value = pressed.peek() === own ? '' : own;
          show(pressed.peek() ? place : null, side);
        };
        return h(
          'td',
          null,
          h(
            'button',
            {
              type: 'button',
              class: 'figure-place',
              'aria-pressed': () => String(pressed.value === own),
              on: { click: press },
            },
            text,
          ),
        );
      };
      const rows = ROWS.map((row) => {
        const best = bestOf(
          scores.map((score) => score[row.key]),
          row,
        );
        return h(
          'tr',
          null,
          h('th', { scope: 'row' }, row.name),
          scores.map((_, side) => cellOf(row, side, side === best)),
        );
      });
      const heads = names.map((name) => h('th', { scope: 'col' }, name));
      fill(
        element,
        h('table', { class: 'compare' }, h('thead', null, h('tr', null, h('td'), heads)), h('tbody', null, rows)),
        h('p', { class: 'quiet press' }, 'Press a hole or a pair to turn to it.'),
        h('p', { class: 'quiet' }, COUNT_WORDS),
      );
    },
  };
}
