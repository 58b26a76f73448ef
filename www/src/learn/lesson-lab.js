/** The surface of a lesson page: the learner's own, or the ellipsoid instead. */
import { kindOf, LessonClient } from '../engine/lesson/client.js';
import { Meter } from '../engine/sampling/meter.js';
import { byId } from '../ui/dom.js';
import { surfaceWords } from '../ui/surface-link.js';
import '../ui/theme.js';
import { readAddress, writeAddress } from './address.js';
import { Lab, NoSurface, PARTICLES } from './lab.js';
import { subjectOf } from './surface.js';

const open = async () => new LessonClient();

/** Reads the surface from the address, names it in the page, and opens its lab. */
export function openSubject() {
  const { parts } = readAddress(location.hash);
  const subject = subjectOf(parts.surface);
  const notice = byId('notice');
  notice.textContent = subject.notice;
  const name = (/** @type {string} */ words) => {
    const host = document.getElementById('surface-name');
    if (host) host.textContent = words;
  };
  if (subject.isOwn) name(`your surface, ${surfaceWords(subject.surface)}`);
  for (const link of document.querySelectorAll('#back, #back-end'))
    if (link instanceof HTMLAnchorElement) link.href += subject.from;
  // Links to the lesson's other page keep the surface.
  for (const link of document.querySelectorAll('.to-cards, .to-lesson'))
    if (link instanceof HTMLAnchorElement && parts.surface)
      link.hash = writeAddress({ stop: link.hash.slice(1), parts: { surface: parts.surface } });

  const meter = new Meter();
  /** Tries the learner's surface; if it has no particles, the ellipsoid is used. */
  async function openLab() {
    const own = new Lab(subject.surface, open, meter);
    if (!subject.isOwn) return own;
    try {
      await own.radiusFor(PARTICLES);
      return own;
    } catch (error) {
      const isRefused = error instanceof NoSurface || kindOf(error) === 'refused';
      if (!isRefused) return own;
      notice.textContent = `${error instanceof Error ? error.message : error} The figures show an ellipsoid.`;
      name('an ellipsoid');
      return new Lab(subjectOf(undefined).surface, open, meter);
    }
  }
  return { subject, notice, parts, lab: openLab() };
}
