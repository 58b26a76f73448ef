/** Every promise of the console settles, whatever its worker was doing when it died. */
import { expect, test } from 'vitest';
import { spherePly } from '../engine/sphere.js';
import { expectSurface, open, pause, until, workers } from './engine.js';

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

/** Lets a minute pass, so that some deaths in a row are no reason for safe mode. */
function passMinute() {
  const now = performance.now.bind(performance);
  performance.now = () => now() + 61_000;
}

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
  const isBusy = () => engine.busy.value || engine.progress.value.phase !== 'done';
  const settled = async () => {
    // What a file waits for ends with its worker.
    const isLoading = () => engine.loading.value && worker !== 'points';
    for (let k = 0; pending.size > 0 && k < 200; k = isBusy() || isLoading() ? 0 : k + 1) await pause(20);
  };

  passMinute();
  engine.setView({ draw: state === 'joining a mesh' ? 'mesh' : 'discs' });
  // So much work that every phase is seen, and another input in every state: one that fails twice is given up.
  const relaxSteps = state === 'relaxation' ? 100 : 30;
  const settings = { radius_share: 0.007, relax_steps: relaxSteps, seed: state.length };
  if (state === 'writing a file') call('exportMesh before', engine.exportMesh('glb'));
  else if (state === 'opening a file') call('open before', p.open(cloud(2000)));
  else if (state !== 'at rest') call('set before', p.set({ surface: 'torus', settings }));
  const rests = ['at rest', 'joining a mesh', 'writing a file'].includes(state);
  if (worker === 'points') await until(engine.loading, (loading) => loading?.stage === 'solving');
  else await until(engine.progress, ({ phase }) => phase === (rests ? 'done' : state));

  if (death === 'panic') p.debug.panic();
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
  call('set', p.set({ surface: 'ellipsoid', settings: { radius_share: 0.01 } }));
  call('stop', p.stop());
  call('run again', p.run());
  await settled();
  return [...pending];
}

for (const death of ['panic', 'silence']) {
  test(`by a worker’s ${death} in any state no promise stays open`, { timeout: 120_000 }, async () => {
    const p = await open();
    for (const [state, worker] of Object.entries(STATES)) {
      // What a panic of the solver does is the same in every stage (engine/points.test.js).
      if (worker === 'points' && death === 'panic') continue;
      expect(await attack(p, { state, worker, death }), state).toEqual([]);
    }
    await expectSurface(p);
  });
}
