/**
 * Puts single WebP pictures together to an animation that plays for ever. The container is RIFF, its chunks are those of
 * the WebP container specification (RFC 9649).
 */

/** Bytes of the head of a chunk: four letters and the length. */
const HEAD = 8;
/** Bytes before the first chunk of a file: the head of the file and `WEBP`. */
const FILE_HEAD = 12;
/** Flags of the extended header: the file is an animation. */
const IS_ANIMATION = 0x02;
/** Flags of a picture in an animation: it is not blended with the one before. */
const NOT_BLENDED = 0x02;

/** @param {string} name @param {Buffer[]} parts */
function chunk(name, ...parts) {
  const content = Buffer.concat(parts);
  const head = Buffer.alloc(HEAD);
  head.write(name, 'latin1');
  head.writeUInt32LE(content.length, 4);
  return Buffer.concat([head, content, Buffer.alloc(content.length % 2)]);
}

/** Numbers of three bytes each. @param {number[]} values */
function triples(...values) {
  const bytes = Buffer.alloc(3 * values.length);
  for (const [k, value] of values.entries()) bytes.writeUIntLE(value, 3 * k, 3);
  return bytes;
}

/**
 * The chunk of a picture that holds its pixels. A browser puts a profile of colours beside it, which an animation may not
 * have for each picture.
 * @param {Buffer} picture
 */
function pixelsOf(picture) {
  for (let at = FILE_HEAD; at < picture.length; ) {
    const length = picture.readUInt32LE(at + 4);
    const end = at + HEAD + length + (length % 2);
    if (picture.toString('latin1', at, at + 4) === 'VP8 ') return picture.subarray(at, end);
    at = end;
  }
  throw new Error('A picture of the animation is not a lossy WebP picture.');
}

/**
 * @param {{ pictures: {picture: Buffer, ms: number}[], width: number, height: number }} film  lossy pictures without
 *   transparency, all of that size, and the time for which each of them is shown
 */
export function animation({ pictures, width, height }) {
  const size = triples(width - 1, height - 1);
  const frames = pictures.map(({ picture, ms }) =>
    chunk('ANMF', triples(0, 0), size, triples(ms), Buffer.from([NOT_BLENDED]), pixelsOf(picture)),
  );
  return chunk(
    'RIFF',
    Buffer.from('WEBP'),
    chunk('VP8X', Buffer.from([IS_ANIMATION, 0, 0, 0]), size),
    // The background is transparent, and the number of rounds has no end.
    chunk('ANIM', Buffer.alloc(6)),
    ...frames,
  );
}
