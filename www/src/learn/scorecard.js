/**
 * The scorecard: two scores side by side, with the ideal and the chance of each figure, and the deciding figure.
 */
import { signal } from '@preact/signals-core';
import { fill, h } from '../ui/dom.js';
import { MISSING } from '../ui/format.js';
import { bestOf, chanceOf, DECIDING, ROWS, rowOf, verdictOf } from './score.js';

/** @import { Score, ScorePlace, ScoreRow, ScoreWords } from './types.js' */

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
    /** Marks its figures as outdated until new ones are given. */
    wait() {
      element.ariaBusy = 'true';
    },
    /** @param {readonly string[]} names @param {readonly Score[]} scores @param {ScoreWords} [how] */
    tell(names, scores, { keys = DECIDING, also = [], isMarked = true } = {}) {
      pressed.value = '';
      element.ariaBusy = 'false';
      const verdict = isMarked ? verdictOf(scores, keys) : null;
      const rows = ROWS.filter(({ key, isRare }) => !isRare || [...keys, ...also].includes(key)).map((row) => {
        // Costs are marked only if they decide, or may decide.
        const isJudged = row.ideal !== null || [...keys, ...also].includes(row.key);
        const chance = isJudged ? chanceOf(row, scores) : null;
        const best = isMarked && isJudged ? bestOf(scores, row) : -1;
        const kind = row.key === verdict?.key ? 'decides' : null;
        return h(
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
          h('td', { class: 'ideal chance' }, chance === null ? MISSING : (row.writeChance ?? row.write)(chance)),
        );
      });
      const heads = ['Ideal', ...names, 'Chance'].map((name) => h('th', { scope: 'col' }, name));
      fill(
        element,
        h('table', { class: 'compare' }, h('thead', null, h('tr', null, h('td'), heads)), h('tbody', null, rows)),
        isMarked ? h('p', { class: 'outcome' }, outcomeOf(names, verdict)) : null,
        h(
          'p',
          { class: 'quiet press' },
          'Another seed may make a difference up to “Chance”. Press a hole or a pair to turn to it.',
        ),
      );
    },
  };
}

/** The conclusion from the figures. @param {readonly string[]} names @param {ReturnType<typeof verdictOf>} verdict */
const outcomeOf = (names, verdict) =>
  verdict
    ? `Better: ${names[verdict.side]}, by the row “${rowOf(verdict.key).name}”.`
    : 'No difference beyond chance: the two cannot be told apart.';
