import { expect, test, vi } from 'vitest';
import { opponentOf, Race } from '../../../src/engine/lesson/race.js';

const bounds = {
  min: /** @type {[number, number, number]} */ ([-1, -1, -1]),
  max: /** @type {[number, number, number]} */ ([1, 1, 1]),
};
const surface = { formula: 'x^2 + y^2 + z^2 = 1', parameters: [], bounds };
const ours = { radius: 0.1 };

/**
 * Workers whose turns take `workMs`, and which are done after `turns` of them.
 * @param {{workMs: number, turns: number}[]} lanes
 */
function fakeWorkers(lanes) {
  let spawned = 0;
  return () => {
    const { workMs, turns } = lanes[spawned % lanes.length];
    spawned += 1;
    let taken = 0;
    /** @type {any} */
    const worker = { onmessage: null, onerror: null, terminate: vi.fn(), settings: null };
    const tell = (/** @type {any} */ data) => setTimeout(() => worker.onmessage?.({ data }));
    worker.postMessage = (/** @type {any} */ message) => {
      const progress = () => ({ particles: taken, is_done: taken >= turns });
      if (message.type === 'start') {
        worker.settings = message.settings;
        if (message.settings.radius < 0) tell({ type: 'refused', id: message.id, error: { message: 'radius' } });
        else tell({ type: 'ended', id: message.id, progress: progress() });
      } else if (message.about === 'advance') {
        taken += 1;
        tell({ type: 'answer', id: message.id, answer: { progress: progress(), workMs } });
      } else {
        tell({ type: 'answer', id: message.id, answer: { at: taken } });
      }
    };
    return worker;
  };
}

test('both have worked equally long at every moment, until one is done', async () => {
  /** @type {[number, number][]} */
  const clocks = [];
  const race = new Race({
    spawn: fakeWorkers([
      { workMs: 1, turns: 30 },
      { workMs: 5, turns: 20 },
    ]),
    onLane: () => clocks.push([race.lanes[0].workMs, race.lanes[1].workMs]),
  });
  await race.start(surface, [ours, opponentOf(ours)]);
  expect(clocks).toHaveLength(50);
  for (const [a, b] of clocks) expect(a >= 30 || Math.abs(a - b) <= 5, `${a} and ${b}`).toBe(true);
  expect(race.lanes.map((lane) => lane.progress?.is_done)).toEqual([true, true]);
  expect(race.lanes.map((lane) => lane.workMs)).toEqual([30, 100]);
  expect(await race.particles(1)).toEqual({ at: 20 });
});

test('a race that is paused takes no turn until it goes on', async () => {
  let turns = 0;
  const race = new Race({
    spawn: fakeWorkers([{ workMs: 1, turns: 20 }]),
    onLane: () => {
      turns += 1;
      if (turns === 10) race.pause();
    },
  });
  const over = race.start(surface, [ours, ours]);
  await vi.waitFor(() => expect(turns).toBe(10));
  await new Promise((resolve) => setTimeout(resolve, 30));
  expect(turns).toBe(10);
  race.resume();
  await over;
  expect(turns).toBe(40);
});

test('a race is given up for the next one, and refused in the core’s words', async () => {
  const race = new Race({ spawn: fakeWorkers([{ workMs: 1, turns: 5 }]) });
  const first = race.start(surface, [ours, ours]).catch((error) => error);
  const second = race.start(surface, [ours, ours]);
  expect(await first).toMatchObject({ kind: 'given_up' });
  await second;
  const refused = race.start(surface, [{ radius: -1 }, ours]).catch((error) => error);
  expect(await refused).toMatchObject({ kind: 'refused', message: 'radius' });
  race.close();
});

test('the opponent is the one of the paper’s Table 1, with the same sizes', () => {
  expect(opponentOf(ours)).toMatchObject({ radius: 0.1, method: 'witkin_heckbert' });
  const adaptive = { sampling: /** @type {const} */ ('adaptive'), law_scale: 0.1, radius_min: 0.01, radius_max: 0.1 };
  expect(opponentOf(adaptive)).toEqual({ ...adaptive, method: 'forces' });
});
