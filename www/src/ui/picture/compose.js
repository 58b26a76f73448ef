/** Draws the legend and a caption on a picture of the surface. */
import { givenOf } from '../../engine/given.js';
import { formatCount, formatSignificant, plural } from '../format.js';

/**
 * @import { Engine, Legend } from '../../engine/types.js'
 * @import { Context, Parts, Sheet } from './types.js'
 */

/** Height of the letters as a share of the picture's shorter side, and its minimum in pixels. */
const LETTER_SHARE = 0.022;
const LEAST_LETTER_PX = 11;
/** Margin of the drawing, and width of a scale, in heights of a letter. */
const MARGIN_EM = 1.4;
const SCALE_EM = 13;
/** Distance between lines. */
const LINE_EM = 1.45;

/**
 * Draws the parts over the picture that the context holds.
 * @param {Context} context
 * @param {Parts} parts
 */
export function compose(context, parts) {
  const { width, height } = context.canvas;
  const em = Math.max(LEAST_LETTER_PX, LETTER_SHARE * Math.min(width, height));
  const sheet = { context, em, left: MARGIN_EM * em, parts };
  context.textBaseline = 'alphabetic';
  if (parts.legend && parts.legend.kind !== 'plain') drawLegend(sheet, parts.legend);
  const lines = parts.caption.flatMap((line) => wrapped(sheet, line, width - 2 * sheet.left));
  lines.forEach((line, i) => {
    const y = height - sheet.left - (lines.length - 1 - i) * LINE_EM * em;
    write(sheet, line, sheet.left, y, i === 0 ? 'bold' : 'quiet');
  });
}

/**
 * @param {Sheet} sheet @param {string} text @param {number} x @param {number} y
 * @param {'bold' | 'plain' | 'quiet'} style @param {CanvasTextAlign} [align]
 */
function write({ context, em, parts }, text, x, y, style, align = 'left') {
  context.font = `${style === 'bold' ? '600 ' : ''}${em}px system-ui, sans-serif`;
  context.fillStyle = style === 'quiet' ? parts.colours.quiet : parts.colours.ink;
  context.textAlign = align;
  context.fillText(text, x, y);
}

/** Breaks a line between words if it is too long. @param {Sheet} sheet @param {string} text @param {number} width */
function wrapped({ context, em }, text, width) {
  context.font = `${em}px system-ui, sans-serif`;
  /** @type {string[]} */
  const lines = [];
  for (const word of text.split(' ')) {
    const longer = lines.length > 0 ? `${lines[lines.length - 1]} ${word}` : word;
    if (lines.length > 0 && context.measureText(longer).width <= width) lines[lines.length - 1] = longer;
    else lines.push(word);
  }
  return lines;
}

/** @param {Sheet} sheet @param {Legend} legend */
function drawLegend(sheet, legend) {
  const { em, left } = sheet;
  let y = left + em * 0.8;
  write(sheet, legend.unit && legend.range ? `${legend.title}, ${legend.unit}` : legend.title, left, y, 'bold');
  y += 0.6 * em;
  if (legend.entries?.length) {
    for (const { label, colour, count } of legend.entries) {
      y += LINE_EM * em;
      dot(sheet, colour, left + 0.4 * em, y - 0.35 * em);
      write(sheet, count === undefined ? label : `${label}  ${formatCount(count)}`, left + 1.3 * em, y, 'quiet');
    }
    return;
  }
  const width = SCALE_EM * em;
  strip(sheet, legend, y, width);
  const [low, high] = endsOf(legend);
  write(sheet, low, left, y + 2.1 * em, 'quiet');
  write(sheet, high, left + width, y + 2.1 * em, 'quiet', 'right');
}

/**
 * Draws the colours of a scale as a gradient.
 * @param {Sheet} sheet
 * @param {Legend} legend
 * @param {number} y
 * @param {number} width
 */
function strip({ context, em, left }, { colours, range, mark }, y, width) {
  const ramp = context.createLinearGradient(left, 0, left + width, 0);
  colours.forEach((colour, i) => void ramp.addColorStop(i / Math.max(1, colours.length - 1), colour));
  context.fillStyle = ramp;
  context.fillRect(left, y, width, 0.8 * em);
  if (!range || mark === undefined || !(range[1] > range[0])) return;
  const place = (mark - range[0]) / (range[1] - range[0]);
  if (place < 0 || place > 1) return;
  context.fillStyle = '#000';
  context.fillRect(left + place * width - 1, y - 0.15 * em, 2, 1.1 * em);
}

/** @param {Sheet} sheet @param {string} colour @param {number} x @param {number} y */
function dot({ context, em }, colour, x, y) {
  context.fillStyle = colour;
  context.beginPath();
  context.arc(x, y, 0.4 * em, 0, 2 * Math.PI);
  context.fill();
}

/** Returns the texts at the ends of a scale. @param {Legend} legend @returns {[string, string]} */
export function endsOf({ kind, range }) {
  if (!range) return ['', ''];
  if (range[0] === range[1]) return [`${formatSignificant(range[0])} everywhere`, ''];
  return kind === 'diverging'
    ? [`≤\u2009${formatSignificant(range[0], 2)}`, `≥\u2009${formatSignificant(range[1], 2)}`]
    : [formatSignificant(range[0]), formatSignificant(range[1])];
}

/** Longest formula in a caption. */
const LONGEST_FORMULA = 120;

/** Returns the lines of the caption: the surface, its formula, and the credit for data. @param {Engine} engine */
export function captionOf(engine) {
  const field = engine.field.peek();
  const about = engine.description.peek();
  const entry = about?.surfaces.find(({ id }) => id === field?.surface);
  const name = givenOf(field)?.name ?? entry?.name ?? 'f(x, y, z) = 0';
  const { particles } = engine.progress.peek();
  const formula = field?.formula.replace(/\s+/g, ' ') ?? '';
  const values = (field?.parameters ?? []).map(({ name, value }) => `${name} = ${formatSignificant(value)}`);
  return [
    `${name} · ${plural(particles, 'particle')}`,
    formula.length > 0 && formula.length <= LONGEST_FORMULA
      ? [formula, ...values].join(', ')
      : field?.image || field?.mesh
        ? values.join(', ')
        : '',
    field?.model?.credit ?? '',
  ].filter(Boolean);
}
