/** Every promise of the console settles, whatever its worker was doing when it died. */
import { describe, expect, test } from 'vitest';
import { GRACE_MS, SILENCE_MS } from '../../src/engine/bundle/load.js';
import { expectSurface, open, pause, strike, turn, until, workers } from './engine.js';
import { spherePly } from './sphere.js';

/** @import { Console } from '../../src/main/types.js' */

/** What the engine is doing when a worker dies, and whose work it is. */
const STATES = {
  'at rest': 'sampler',
  seeding: 'sampler',
  generation: 'sampler',
  relaxation: 'sampler',
  quality: 'sampler',
  'joining a mesh': 'sampler',
  'writing a file': 'sampler',
  'opening a file': 'points',
};

/** Longer than a silent worker is waited for. */
const LONG_MS = 2 * SILENCE_MS;

/**
 * Brings the engine into a state, lets a worker die there and makes more calls.
 * @param {Console} p
 * @param {{state: string, worker: string, death: string}} row
 * @returns {Promise<string[]>} the calls that are open although nothing has been under way for long
 */
async function attack(p, { state, worker, death }) {
  const { engine } = p;
  const cloud = (/** @type {number} */ count) => new File([spherePly(count)], 'ball.ply');
  const pending = new Set();
  const call = (/** @type {string} */ name, /** @type {Promise<unknown>} */ promise) => {
    pending.add(name);
    promise.catch(() => {}).then(() => pending.delete(name));
  };
  const isBusy = () => engine.status.value === 'sampling' || engine.progress.value.phase !== 'done';
  const settled = async () => {
    // What a file waits for ends with its worker.
    const isLoading = () => engine.loading.value && worker !== 'points';
    for (let ms = 0; pending.size > 0 && ms < LONG_MS; ms = isBusy() || isLoading() ? 0 : ms + 20) {
      // The engine cannot know yet that its worker is gone, and waits for a word of it. The sampler
      // is let work meanwhile, which would be silent for as long by the same clock. A worker that
      // fits points ends with each file, so its end says nothing once the file before is settled.
      const isWaiting = worker === 'sampler' || (pending.has('open before') && engine.status.value !== 'sampling');
      const isSilent = workers[worker].at(-1)?.isEnded && isWaiting;
      await (isSilent ? turn(SILENCE_MS + GRACE_MS) : pause(20));
    }
  };

  engine.setView({ draw: state === 'joining a mesh' ? 'mesh' : 'discs' });
  // The worker tells of the relaxation only if it takes longer than a picture.
  const relaxSteps = state === 'relaxation' ? 1000 : 30;
  const settings = { radius_share: 0.007, relax_steps: relaxSteps };
  if (state === 'writing a file') call('exportMesh before', engine.exportMesh('glb'));
  else if (state === 'opening a file') call('open before', p.open(cloud(2000)));
  else if (state !== 'at rest') call('set before', p.set({ surface: 'torus', settings }));
  const rests = ['at rest', 'joining a mesh', 'writing a file'].includes(state);
  if (worker === 'points') await until(engine.loading, (loading) => loading?.label === 'Solving for the surface');
  else await until(engine.progress, ({ phase }) => phase === (rests ? 'done' : state));

  if (death === 'panic') strike('panic');
  else workers[worker].at(-1)?.terminate();
  // First what nothing else helps to settle.
  call('exportMesh', engine.exportMesh('ply'));
  await settled();
  call('pixels', p.pixels(40, 30));
  call('still', p.debug.still());
  call('relax', p.relax(1));
  call('open', p.open(cloud(30)));
  await settled();
  call('run', p.run());
  call('set', p.set({ surface: 'ellipsoid', settings: { radius_share: 0.02 } }));
  call('stop', p.stop());
  call('run again', p.run());
  await settled();
  return [...pending];
}

for (const death of ['panic', 'silence']) {
  describe(`by a worker’s ${death} no promise stays open`, () => {
    // What a panic of the solver does is the same in every stage (engine/points.test.js).
    const states = Object.entries(STATES).filter(([, worker]) => worker === 'sampler' || death === 'silence');
    test.each(states)('%s', async (state, worker) => {
      const p = await open();
      expect(await attack(p, { state, worker, death })).toEqual([]);
      await expectSurface(p);
    });
  });
}
