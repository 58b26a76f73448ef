import { expect, it } from 'vitest';
import { withDuration } from '../../../src/ui/picture/webm.js';

const bytes = (/** @type {(number | number[])[]} */ ...parts) => Uint8Array.from(parts.flat());
const head = [0x1a, 0x45, 0xdf, 0xa3, 0x83, 0x42, 0x86, 0x80];
const scale = [0x2a, 0xd7, 0xb1, 0x83, 0x0f, 0x42, 0x40];
const unknown = [0x01, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff];
const cluster = [0x1f, 0x43, 0xb6, 0x75, 0xff, 1, 2, 3];
const lengthOf = (/** @type {number[]} */ content) => 0x80 | content.length;
const info = (/** @type {number[]} */ content) => [0x15, 0x49, 0xa9, 0x66, lengthOf(content), ...content];
const duration = [0x44, 0x89, 0x88, 0x40, 0xa3, 0x88, 0, 0, 0, 0, 0];

it('a film that was recorded as a stream gets its duration, in its own unit of time', () => {
  const film = bytes(head, [0x18, 0x53, 0x80, 0x67], unknown, info(scale), cluster);
  const long = [0x15, 0x49, 0xa9, 0x66, 0x01, 0, 0, 0, 0, 0, 0, 18, ...scale, ...duration];
  const whole = bytes(head, [0x18, 0x53, 0x80, 0x67], unknown, long, cluster);
  // 2.5 s in milliseconds.
  expect(withDuration(film, 2.5)).toEqual(whole);
  expect(withDuration(whole, 9)).toBe(whole);
});

it('a segment of known size grows with it', () => {
  const content = [...info(scale), 0xec, 0x81, 0];
  const film = bytes(head, [0x18, 0x53, 0x80, 0x67, lengthOf(content)], content);
  const grown = withDuration(film, 1);
  const at = head.length + 4;
  const size = Number(new DataView(grown.buffer).getBigUint64(at) & 0xff_ffff_ffff_ffffn);
  expect(size).toBe(grown.length - at - 8);
});

it('what is no such film stays as it is', () => {
  const mp4 = bytes([0, 0, 0, 24, 0x66, 0x74, 0x79, 0x70, 1, 2, 3]);
  const sought = bytes(head, [0x18, 0x53, 0x80, 0x67], unknown, [0x11, 0x4d, 0x9b, 0x74, 0x80], info(scale));
  for (const film of [bytes([]), mp4, sought, bytes(head)]) expect(withDuration(film, 1)).toBe(film);
});
