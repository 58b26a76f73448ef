/**
 * Writes the duration into a WebM film. Browsers record a film as a stream, whose head is written before its end is
 * known, and players then show no length and cannot seek. The format is EBML (RFC 8794, RFC 9559): elements of an id, a
 * size and content.
 */

const EBML = 0x1a45dfa3;
const SEGMENT = 0x18538067;
const SEEK_HEAD = 0x114d9b74;
const INFO = 0x1549a966;
const SCALE = 0x2ad7b1;
const DURATION = 0x4489;
/** Nanoseconds of a unit of time, where the film does not say. */
const USUAL_SCALE_NS = 1e6;
/** Length of the duration: id, size and a double. */
const DURATION_BYTES = 11;

/**
 * `to` is Infinity for a size that is not known.
 * @typedef {{ id: number, sizeAt: number, from: number, to: number }} Element
 */

/**
 * Reads the element at a place; null if there is none.
 * @param {DataView} view @param {number} at
 * @returns {Element | null}
 */
function elementAt(view, at) {
  const widthAt = (/** @type {number} */ place) => Math.clz32(view.getUint8(place)) - 23;
  if (at + 2 > view.byteLength) return null;
  const sizeAt = at + widthAt(at);
  if (sizeAt >= view.byteLength) return null;
  const from = sizeAt + widthAt(sizeAt);
  if (from > view.byteLength) return null;
  const id = numberIn(view, at, sizeAt);
  const width = from - sizeAt;
  const size = numberIn(view, sizeAt, from) - 2 ** (7 * width);
  const isKnown = size < 2 ** (7 * width) - 1;
  return { id, sizeAt, from, to: isKnown ? from + size : Number.POSITIVE_INFINITY };
}

/** @param {DataView} view @param {number} from @param {number} to */
function numberIn(view, from, to) {
  let value = 0;
  for (let at = from; at < to; at += 1) value = 256 * value + view.getUint8(at);
  return value;
}

/**
 * Returns the elements from a place on, as far as they can be read.
 * @param {DataView} view @param {number} from @param {number} to
 */
function* elementsIn(view, from, to) {
  for (let at = from; at < to; ) {
    const element = elementAt(view, at);
    if (!element) return;
    yield element;
    at = element.to;
  }
}

/**
 * Returns the film with its duration, or as it is if it has one or is no WebM film of the kind that browsers record.
 * @param {Uint8Array<ArrayBuffer>} film @param {number} seconds
 * @returns {Uint8Array<ArrayBuffer>}
 */
export function withDuration(film, seconds) {
  const view = new DataView(film.buffer, film.byteOffset, film.byteLength);
  const [head, segment] = elementsIn(view, 0, film.length);
  if (head?.id !== EBML || segment?.id !== SEGMENT) return film;
  let info = /** @type {Element | null} */ (null);
  for (const element of elementsIn(view, segment.from, Math.min(segment.to, film.length))) {
    // Its places would no longer be true.
    if (element.id === SEEK_HEAD) return film;
    if (element.id === INFO) info = element;
    if (info) break;
  }
  if (!info || info.to > film.length) return film;
  let scaleNs = USUAL_SCALE_NS;
  for (const { id, from, to } of elementsIn(view, info.from, info.to)) {
    if (id === DURATION) return film;
    if (id === SCALE) scaleNs = numberIn(view, from, to);
  }
  const sizes = Number.isFinite(segment.to)
    ? sizeOf(segment.to - segment.from + DURATION_BYTES + 8 - (info.from - info.sizeAt))
    : film.slice(segment.sizeAt, segment.from);
  const duration = new DataView(new ArrayBuffer(DURATION_BYTES));
  duration.setUint16(0, DURATION);
  duration.setUint8(2, 0x88);
  duration.setFloat64(3, (seconds * 1e9) / scaleNs);
  const parts = [
    film.slice(0, segment.sizeAt),
    sizes,
    film.slice(segment.from, info.sizeAt),
    sizeOf(info.to - info.from + DURATION_BYTES),
    film.slice(info.from, info.to),
    new Uint8Array(duration.buffer),
    film.slice(info.to),
  ];
  const whole = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    whole.set(part, at);
    at += part.length;
  }
  return whole;
}

/** Writes a size with eight bytes. @param {number} size */
function sizeOf(size) {
  const view = new DataView(new ArrayBuffer(8));
  view.setBigUint64(0, BigInt(size) | (1n << 56n));
  return new Uint8Array(view.buffer);
}
