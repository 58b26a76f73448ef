/**
 * Charts of the generation levels and the relaxation, above the timeline. A press or a drag on one moves the timeline
 * there. Loaded on demand.
 */

import { computed, signal } from '@preact/signals-core';
import { MOST_STEPPED } from '../../engine/constants.js';
import { clamp } from '../../engine/vector.js';
import { draw, floorOf, footOf, scaleOf } from '../chart.js';
import { h } from '../dom.js';
import { formatCount, formatFixed, formatShare, formatSignificant, MISSING, plural } from '../format.js';
import { spread as statisticsOf } from '../neighbours.js';
import { loadSheet } from '../sheet.js';
import { tableOf } from '../table.js';
import sheet from './charts.css?url';
import { fatesOf, movesOf } from './figures.js';
import { BINS, degreeBins, hexagonalCount, NEIGHBOURS, nearestBins, nearestOver, SPAN } from './spread.js';

/**
 * @import { Columns, Engine, Report } from '../../engine/types.js'
 * @import { Chart, LevelTable, Player } from './types.js'
 */

/**
 * Distances of the shown particles to their nearest neighbours, over 2r, and a description of these particles.
 * @typedef {{ nearest: ArrayLike<number>, words: string } | null} Spread
 */

/** @param {Engine} engine @param {Player} player */
export async function createCharts(engine, player) {
  await loadSheet(sheet);
  const { levels } = player;
  const { table, kept, level, newest, relaxed, whole } = levels;
  const shown = signal(true);
  const moves = computed(() => {
    const { past, positions, radii } = engine.columns;
    // With many particles only the first positions are kept. The move from those to the last is not one step.
    const steps = engine.report.value?.energy?.length ?? 0;
    return kept.value > 1 || steps === 2 ? movesOf(past, positions, radii) : [];
  });
  const energy = computed(() => engine.report.value?.energy ?? []);
  const atLevel = computed(() => (level.value === null ? null : newest.value));
  const atStep = computed(() => {
    if (level.value !== null && newest.value < table.value.last) return null;
    if (level.value !== null) return 0;
    return whole.value ? Math.max(0, energy.value.length - 1) : (relaxed.value ?? null);
  });
  const spread = computed(() => {
    void [engine.report.value, kept.value, table.value];
    if (!shown.value) return null;
    const upTo = level.value === null ? null : newest.value;
    return spreadOf(engine.columns, { upTo, step: upTo === null ? relaxed.value : null });
  });
  const degree = computed(() => {
    void engine.report.value;
    return degreeBins(engine.columns.valence);
  });
  /** @param {number} step */
  const seekStep = (step) => player.seek(step === 0 ? table.peek().last : table.peek().last + step);
  const charts = [
    chartOf(
      () => freshChart(table.value, atLevel.value),
      (k) => player.seek(k),
    ),
    chartOf(
      () => fateChart(table.value, atLevel.value),
      (k) => player.seek(k),
    ),
    chartOf(() => energyChart(energy.value, atStep.value), seekStep),
    chartOf(() => moveChart(moves.value, atStep.value), seekStep),
    chartOf(() => nearestChart(spread.value), null),
    chartOf(() => degreeChart(degree.value), null),
  ];
  const isOpen = signal(false);
  const details = h(
    'details',
    {
      class: 'charts-twin',
      on: {
        toggle: ({ currentTarget }) => {
          isOpen.value = currentTarget.open;
        },
      },
    },
    h('summary', null, 'As tables'),
    h(
      'div',
      { class: 'charts-tables', role: 'region', 'aria-label': 'Tables of the charts', tabindex: 0 },
      () =>
        isOpen.value && [
          ...tables(table.value, energy.value, moves.value),
          ...spreadTables(spread.value, degree.value),
        ],
    ),
  );
  const bound = h('p', { class: 'charts-bound quiet' }, () => boundWords(engine.report.value, engine.columns.adaptive));
  const element = h('div', { class: 'levels-charts', role: 'group', 'aria-label': 'Charts' }, charts, bound, details);
  return { element, shown };
}

/**
 * Compares the number of particles with that of a perfect lattice of spacing 2r: neighbours that are nearer give more,
 * and holes give fewer.
 * @param {Report | null} report
 * @param {boolean} adaptive
 */
function boundWords(report, adaptive) {
  const area = report?.quality?.area ?? 0;
  if (!report || adaptive || !(area > 0)) return '';
  const bound = hexagonalCount(area, report.radius);
  const lattice = `A hexagonal lattice of these discs would have ${formatCount(Math.round(bound))} on this area, A/(2√3 r²)`;
  return `${plural(report.count, 'particle')}. ${lattice}: there are ${formatShare(report.count / bound, 1)} of that.`;
}

/**
 * The distances of the shown particles: as placed up to a level, before a relaxation step, or at the end of the run.
 * @param {Columns} columns @param {{ upTo: number | null, step: number | null }} place
 * @returns {Spread}
 */
function spreadOf(columns, { upTo, step }) {
  const { count, levels, positions, radii, placed, past, nearest } = columns;
  if (count === 0) return null;
  if (upTo === null && step === null) {
    if (!nearest) return null;
    return {
      nearest: nearest.map((far, i) => far / (2 * radii[i])),
      words: `all ${plural(columns.particles, 'particle')}`,
    };
  }
  const chosen = Array.from({ length: count }, (_, i) => i).filter((i) => upTo === null || levels[i] <= upTo);
  if (chosen.length > MOST_STEPPED || chosen.length < 2) return null;
  const at = upTo === null ? (past[step ?? 0] ?? positions) : placed;
  const words =
    upTo === null
      ? `all particles after ${plural(step ?? 0, 'step')}`
      : `the particles up to level ${formatCount(upTo)}`;
  return { nearest: nearestOver(at, radii, chosen), words };
}

/** @param {Spread} spread @returns {Chart} */
function nearestChart(spread) {
  const counts = spread ? nearestBins(spread.nearest) : [];
  const { mean, deviation } = statisticsOf(spread?.nearest ?? []);
  const value = spread ? `${formatFixed(mean, 3)} ± ${formatFixed(deviation, 3)}` : '';
  const [low, high] = SPAN;
  const ends = [formatFixed(low, 1), formatFixed(high, 1)];
  const bars = `${formatCount(Math.max(...counts))} at most in one of ${BINS} bars from ${ends[0]} to ${ends[1]}`;
  return {
    title: 'Nearest, in 2r',
    kind: 'bars',
    rows: [{ fate: 'new', name: 'particles', counts }],
    first: 0,
    at: null,
    value,
    label: spread ? `Distance of ${spread.words} to their nearest, in 2r: ${value}; ${bars}` : '',
    format: formatCount,
    ends,
    ideal: (1 - low) / (high - low),
    missing: `Known of two to ${formatCount(MOST_STEPPED)} particles, and of all at the end of a run.`,
  };
}

/** @param {ReturnType<typeof degreeBins>} degree @returns {Chart} */
function degreeChart(degree) {
  const [least, most] = NEIGHBOURS;
  const counts = degree?.counts ?? [];
  const six = degree ? `six: ${formatShare(degree.six, 1)}` : '';
  const all = counts.map((n, k) => `${formatCount(n)} with ${k + least}`).join(', ');
  return {
    title: 'Neighbours',
    kind: 'bars',
    rows: [{ fate: 'new', name: 'particles', counts }],
    first: least,
    at: degree ? 6 : null,
    value: six,
    label: `Particles by their neighbours at the end of the run: ${all}; ${six}`,
    format: formatCount,
    ends: [`≤ ${least}`, 'at the end', `≥ ${most}`],
    missing: 'Known once a run has ended and been measured.',
  };
}

/** @param {Spread} spread @param {ReturnType<typeof degreeBins>} degree */
function spreadTables(spread, degree) {
  const [low, high] = SPAN;
  const at = (/** @type {number} */ k) => formatFixed(low + ((high - low) * k) / BINS, 3);
  const bins = spread ? nearestBins(spread.nearest) : [];
  const nearest = bins.flatMap((n, k) => (n > 0 ? [[`${at(k)} to ${at(k + 1)}`, formatCount(n)]] : []));
  const degrees = (degree?.counts ?? []).map((n, k) => [formatCount(k + NEIGHBOURS[0]), formatCount(n)]);
  return [
    ...(nearest.length > 0 ? [tableOf({ caption: 'Nearest', head: ['In 2r', 'Particles'], rows: nearest })] : []),
    ...(degrees.length > 0 ? [tableOf({ caption: 'Neighbours', head: ['Number', 'Particles'], rows: degrees })] : []),
  ];
}

/** @param {LevelTable} table @param {number | null} at @returns {Chart} */
function freshChart({ fresh, last }, at) {
  const counts = [...fresh];
  const most = Math.max(...counts);
  return {
    title: 'New per level',
    kind: 'bars',
    rows: [{ fate: 'new', name: 'new', counts }],
    first: 0,
    at,
    value: at === null ? `${formatCount(most)} at most` : formatCount(counts[at]),
    label: `New particles in each of ${plural(last + 1, 'level')}, ${formatCount(most)} at most`,
    format: formatCount,
  };
}

/** @param {LevelTable} table @param {number | null} at @returns {Chart} */
function fateChart(table, at) {
  const rows = fatesOf(table);
  const words = rows.map(({ name, counts }) => {
    const count = at === null ? counts.reduce((a, b) => a + b, 0) : counts[at];
    return `${formatCount(count)} ${name}`;
  });
  return {
    title: 'Fates per level',
    kind: 'bars',
    rows,
    first: 0,
    at,
    value: '',
    label: `Fates of the proposed children: ${words.join(', ')}`,
    format: formatCount,
  };
}

/** @param {readonly number[]} energy @param {number | null} at @returns {Chart} */
function energyChart(energy, at) {
  const [from, to] = [energy[0], energy.at(-1)];
  // The differences are small compared with the values, so the scale begins at the least value.
  const floor = Math.min(...energy);
  const of = energy.length > 1 ? `from ${formatSignificant(from, 3)} to ${formatSignificant(to, 3)}` : '';
  return {
    title: 'Energy per step',
    kind: 'line',
    rows: [{ fate: 'energy', name: 'energy', counts: [...energy] }],
    floor: floor < Math.max(...energy) ? floor : undefined,
    first: 0,
    at,
    value: at === null || energy[at] === undefined ? '' : formatSignificant(energy[at], 3),
    label: `Energy per particle over ${plural(Math.max(0, energy.length - 1), 'relaxation step')}, ${of}`,
    format: (value) => formatSignificant(value, 3),
  };
}

/** @param {readonly number[]} moves @param {number | null} at @returns {Chart} */
function moveChart(moves, at) {
  const value = at === null || at === 0 ? undefined : moves[at - 1];
  return {
    title: 'Largest move per step',
    kind: 'bars',
    rows: [{ fate: 'new', name: 'largest move', counts: [...moves] }],
    first: 1,
    at: at === 0 ? null : at,
    value: value === undefined ? '' : inR(value),
    label: `Largest move in each of ${plural(moves.length, 'relaxation step')}, in radii: ${moves.map(inR).join(', ')}`,
    format: inR,
  };
}

/** @param {number} value */
const inR = (value) => `${formatFixed(value, 3)}\u00a0r`;

const NOTHING = `Not known. The positions of each step are kept for up to ${formatCount(MOST_STEPPED)} particles, once a relaxation has ended.`;

/**
 * @param {() => Chart} read
 * @param {((place: number) => void) | null} seek  null if its places are not those of the timeline
 */
function chartOf(read, seek) {
  const chart = computed(read);
  const places = () => chart.value.rows[0]?.counts.length ?? 0;
  /** @param {PointerEvent & { currentTarget: HTMLElement }} event */
  const at = ({ clientX, currentTarget }) => {
    const { left, width } = currentTarget.getBoundingClientRect();
    const place = Math.floor(((clientX - left) / Math.max(1, width)) * places());
    return chart.value.first + clamp(place, 0, places() - 1);
  };
  const plot = h(
    'div',
    {
      class: 'chart-plot',
      role: 'img',
      data: { seeks: String(seek !== null) },
      'aria-label': () => (places() > 0 ? chart.value.label : `${chart.value.title}: not known`),
      on: {
        pointerdown: (event) => {
          if (event.button !== 0 || places() === 0 || !seek) return;
          event.currentTarget.setPointerCapture(event.pointerId);
          seek(at(event));
        },
        pointermove: (event) => {
          if (seek && event.currentTarget.hasPointerCapture(event.pointerId)) seek(at(event));
        },
      },
    },
    () =>
      places() > 0
        ? [draw(chart.value), ...scaleTexts(chart.value)]
        : h('p', { class: 'quiet' }, chart.value.missing ?? NOTHING),
  );
  return h(
    'figure',
    { class: 'chart' },
    h(
      'figcaption',
      null,
      h('span', null, () => chart.value.title),
      ' ',
      h('span', { class: 'unit' }, () => chart.value.value),
    ),
    plot,
    h('div', { class: 'chart-foot', 'aria-hidden': 'true' }, () => places() > 0 && footOf(chart.value)),
  );
}

/**
 * The ends of a scale: the largest value at the right, where a falling curve leaves room, and a least value other than
 * 0 at the left.
 * @param {Chart} chart
 */
const scaleTexts = (chart) => [
  h('span', { class: 'chart-most', 'aria-hidden': 'true' }, scaleOf(chart)),
  chart.floor !== undefined && h('span', { class: 'chart-least', 'aria-hidden': 'true' }, floorOf(chart)),
];

/**
 * The charts as tables.
 * @param {LevelTable} table
 * @param {readonly number[]} energy
 * @param {readonly number[]} moves
 */
function tables(table, energy, moves) {
  const fates = fatesOf(table);
  const levels = [...table.fresh].map((fresh, k) => [
    formatCount(k),
    formatCount(fresh),
    ...fates.map(({ counts }) => formatCount(counts[k])),
  ]);
  const steps = Array.from({ length: Math.max(energy.length, moves.length > 0 ? moves.length + 1 : 0) }, (_, k) => [
    formatCount(k),
    energy[k] === undefined ? MISSING : formatSignificant(energy[k], 4),
    k === 0 || moves[k - 1] === undefined ? MISSING : inR(moves[k - 1]),
  ]);
  return [
    tableOf({ caption: 'Levels', head: ['Level', 'New', ...fates.map(({ name }) => name)], rows: levels }),
    ...(steps.length > 0
      ? [tableOf({ caption: 'Relaxation', head: ['Step', 'Energy per particle', 'Largest move'], rows: steps })]
      : []),
  ];
}
