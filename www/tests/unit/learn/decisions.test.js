/** What the algorithm decides at the slots of a particle, and what is said against another decision. */
import { expect, test } from 'vitest';
import { LessonClient } from '../../../src/engine/lesson/client.js';
import { triple } from '../../../src/engine/vector.js';
import { inPlane } from '../../../src/figures/geometry.js';
import { momentAt } from '../../../src/figures/moment.js';
import { openParticle } from '../../../src/figures/particle.js';
import { tell } from '../../../src/figures/words.js';
import { decisionsOf, letterOf, objection, PATCHES, runOn, treatedOf } from '../../../src/learn/decisions.js';
import { Lab } from '../../../src/learn/lab.js';
import { loadWasm, spawn } from './workers.js';

const R = 0.5;
/** @param {number} slot @param {number | null} against @param {number | null} distance */
const compared = (slot, against, distance) => ({
  type: 'compared',
  parent: 1,
  slot,
  position: [2 * R, 0, 0],
  against,
  distance,
  limit: 1.4 * R,
  corresponds: distance !== null && distance < 1.4 * R,
});
/** @param {number} slot @param {string} fate @param {number | null} particle */
const fate = (slot, fate, particle) => ({ type: 'fate', parent: 1, slot, fate, particle });

/** @type {any[]} */
const EVENTS = [
  { type: 'gathered', particle: 1, reach: 2, neighbours: [] },
  fate(0, 'parent', 0),
  compared(1, 2, 0.1 * R),
  fate(1, 'matched', 2),
  compared(2, 3, 1.5 * R),
  { type: 'fronts_meet', parent: 1, slot: 2, particle: 3, is_other: false },
  { type: 'added', particle: 4, data: {} },
  fate(2, 'added', 4),
  fate(3, 'outside', null),
];
/** @type {any} */
const OPENED = {
  subject: { particle: 1, level: 1, parent: 0, radius: R },
  // Of 0, 1, 2 and 3: from the child 4 r, 2 r, 0.1 r and 1.5 r away.
  positions: Float32Array.from([3, 0, 0, 0, 0, 0, 1.05, 0, 0, 1.75, 0, 0]),
};

test('the learner decides matched and new ones, each asked before it is told; the parent is given', () => {
  const decisions = decisionsOf(EVENTS);
  expect(decisions.map(({ slot, at, end, verdict, met }) => [slot, at, end, verdict.fate, met !== null])).toEqual([
    [1, 2, 3, 'matched', false],
    [2, 4, 7, 'added', true],
  ]);
});

test('particles have letters, so that none is named as a slot', () => {
  expect([0, 25, 26, 51, 52].map(letterOf)).toEqual(['A', 'Z', 'AA', 'AZ', 'BA']);
  const subject = { particle: 1, level: 1, parent: 0, radius: R, nameOf: letterOf };
  const told = EVENTS.map((_, at) => tell(momentAt(EVENTS, at), subject));
  expect(told).toContain('The child of slot 1 matched particle C, so nothing is added.');
  for (const words of told) expect(words).not.toMatch(/article \d/);
});

test('what the run decided meets no objection, and all else does, with its reason', () => {
  const decisions = decisionsOf(EVENTS);
  const [matched, added] = decisions;
  for (const decision of decisions) expect(objection(OPENED, decision, decision.verdict)).toBe('');
  expect(objection(OPENED, matched, { fate: 'added', particle: null })).toMatch(
    /Particle C lies 0\.10\sr .*within the tolerance of 1\.40\sr/,
  );
  expect(objection(OPENED, matched, { fate: 'matched', particle: 3 })).toMatch(
    /0\.10\sr .*1\.50\sr .*The nearest one counts/,
  );
  expect(objection(OPENED, added, { fate: 'matched', particle: 3 })).toMatch(
    /Particle D lies 1\.50\sr .*beyond the tolerance of 1\.40\sr/,
  );
});

test.each(PATCHES)('on $name the nearest particle is nearest in the drawing, too', async (patch) => {
  loadWasm();
  const lab = new Lab(patch.surface, async () => new LessonClient({ spawn }), /** @type {any} */ (null));
  const run = await runOn(lab, patch);
  for (const particle of await treatedOf(run, patch)) {
    const opened = await openParticle(run.client, run, particle);
    for (const { at, compared: asked, verdict } of decisionsOf(opened.events)) {
      const { frame, gathered } = momentAt(opened.events, at);
      if (verdict.fate !== 'matched' || !frame || !asked) continue;
      const plane = { centre: opened.place, right: frame.u, up: frame.w, radius: patch.radius };
      const [x, y] = inPlane(plane, asked.position);
      const seen = (gathered?.neighbours ?? []).map((near) => {
        const [u, v] = inPlane(plane, triple(opened.positions, near.particle));
        return { particle: near.particle, far: Math.hypot(u - x, v - y) };
      });
      seen.sort((one, other) => one.far - other.far);
      expect(seen[0].particle).toBe(verdict.particle);
      if (seen[1]) expect(seen[1].far - seen[0].far).toBeGreaterThan(0.3);
    }
  }
  run.client.close();
});
