import { describe, expect, test } from 'vitest';
import { LOADING_MS } from '../../../src/engine/bundle/load.js';
import { DeviceLost } from '../../../src/engine/view/backends.js';
import { DeviceKeeper } from '../../../src/engine/view/device.js';

/** @import { BackendKind } from '../../../src/engine/types.js' */

/**
 * A keeper over scripted devices. `broken` kinds cannot be opened; `lost` ones never answer.
 * @param {string[]} [broken] @param {string[]} [lost] @param {Promise<unknown>} [after]  that of which devices of a
 *   graphics card come
 * @param {{isSeen?: boolean, best?: BackendKind, first?: BackendKind}} [how]  `isSeen`: whether the picture is known to
 *   be in sight; `best`: what the probe finds; `first`: what is asked for
 */
function kept(broken = [], lost = [], after, { isSeen = true, best = 'webgpu', first } = {}) {
  /** @type {string[]} */
  const log = [];
  /** Why the next devices are lost while they open. @type {string[]} */
  const taken = [];
  /** @type {any[]} */
  const events = [];
  /** `late` ends the wait for a device. */
  const clock = { ms: 0, late: () => {} };
  const keeper = new DeviceKeeper({
    host: /** @type {any} */ (null),
    onOpen: (device, isStandIn) => log.push(`${isStandIn ? 'stand-in' : 'open'} ${device.kind}`),
    onLost: (kind) => log.push(`lost ${kind}`),
    onFallback: (kind, _message, isLate) => log.push(`gave up ${kind}${isLate ? ', late' : ''}`),
    first,
    probe: async () => best,
    open: async (kind, _host, on) => {
      if (kind !== 'canvas2d') await after;
      if (lost.includes(kind)) await new Promise(() => {});
      if (taken.length > 0) throw new DeviceLost(taken.pop());
      if (broken.includes(kind)) throw new Error(`${kind} is not available`);
      events.push(on);
      return /** @type {any} */ ({ kind, renderer: {}, dispose: () => log.push(`close ${kind}`) });
    },
    clock: {
      now: () => clock.ms,
      wait: (ms) =>
        new Promise((resolve) => {
          if (ms < LOADING_MS) resolve();
          else clock.late = resolve;
        }),
    },
  });
  if (isSeen) keeper.seen(true);
  const settle = async () => {
    for (let k = 0; k < 10; k += 1) await Promise.resolve();
  };
  return { keeper, log, taken, events, clock, settle };
}

describe('the keeper of devices', () => {
  test('takes the first kind that works', async () => {
    const { keeper, log } = kept(['webgpu']);
    await keeper.start();
    expect(log).toEqual(['gave up webgpu', 'open webgl2']);
  });

  test('goes down to the painter', async () => {
    const { keeper, log } = kept(['webgpu', 'webgl2']);
    await keeper.start();
    expect(log.at(-1)).toBe('open canvas2d');
  });

  test('without a graphics card stays with the painter that stood in, and opens nothing else', async () => {
    const { keeper, log } = kept([], [], undefined, { best: 'canvas2d' });
    await Promise.all([keeper.start(), keeper.standIn()]);
    expect(log).toEqual(['stand-in canvas2d', 'open canvas2d']);
    keeper.drew();
    expect(log).toHaveLength(2);
    expect(keeper.opened).toBe(1);
    await keeper.retry();
    expect(log.slice(2)).toEqual(['close canvas2d', 'open canvas2d']);
  });

  test('opens what is asked for, whatever the probe finds', async () => {
    for (const first of /** @type {const} */ (['webgpu', 'webgl2', 'canvas2d'])) {
      for (const best of /** @type {const} */ (['webgpu', 'webgl2', 'canvas2d'])) {
        const { keeper, log } = kept([], [], undefined, { best, first });
        await keeper.start();
        expect(log).toEqual([`open ${first}`]);
      }
    }
  });

  test('begins with the kind that the probe finds', async () => {
    const { keeper, log } = kept([], [], undefined, { best: 'webgl2' });
    await keeper.start();
    expect(log).toEqual(['open webgl2']);
  });

  test('is stood in for until it has drawn', async () => {
    let fetched = () => {};
    const after = new Promise((resolve) => (fetched = () => resolve(null)));
    const { keeper, log } = kept([], [], after);
    const started = keeper.start();
    await keeper.standIn();
    fetched();
    await started;
    expect(log).toEqual(['stand-in canvas2d', 'open webgpu']);
    keeper.drew();
    expect(log.at(-1)).toBe('close canvas2d');
    // A second time nothing is closed.
    keeper.drew();
    expect(log).toHaveLength(3);
  });

  test('is not stood in for once it is there, nor by itself', async () => {
    const { keeper, log } = kept();
    await keeper.start();
    await keeper.standIn();
    expect(log).toEqual(['open webgpu', 'close canvas2d']);
    const painter = kept(['webgpu', 'webgl2']);
    await painter.keeper.start();
    await painter.keeper.standIn();
    expect(painter.log.filter((line) => line.startsWith('stand-in'))).toEqual([]);
  });

  test('that is closed takes what stands in for it along', async () => {
    let fetched = () => {};
    const after = new Promise((resolve) => (fetched = () => resolve(null)));
    const { keeper, log } = kept([], [], after);
    const started = keeper.start();
    await keeper.standIn();
    fetched();
    await started;
    keeper.close();
    expect(log.filter((line) => line.startsWith('close'))).toEqual(['close webgpu', 'close canvas2d']);
  });

  test('gives up a kind whose request is lost, says so, and tries it again when it is asked to', async () => {
    const lost = ['webgpu'];
    const { keeper, log, clock, settle } = kept([], lost);
    const started = keeper.start();
    await settle();
    clock.late();
    await started;
    expect(log).toEqual(['gave up webgpu, late', 'open webgl2']);
    lost.pop();
    await keeper.retry();
    expect(log.slice(2)).toEqual(['close webgl2', 'open webgpu']);
  });

  test('says that there is no picture at all', async () => {
    const { keeper, log } = kept(['webgpu', 'webgl2', 'canvas2d']);
    await keeper.start();
    expect(log.at(-1)).toBe('gave up canvas2d');
  });

  test('leaves nobody waiting for the answer of a device that is gone', async () => {
    const { keeper } = kept();
    await keeper.start();
    expect(await keeper.answered(Promise.resolve(7))).toBe(7);
    await expect(keeper.answered(Promise.reject(new Error('no')))).rejects.toThrow('no');
    expect(keeper.waiting.size).toBe(0);
    const never = keeper.answered(new Promise(() => {}));
    keeper.giveUp('unreachable');
    await expect(never).rejects.toThrow('lost');
  });

  test('mends a loss with the same kind three times in a minute, then takes the next', async () => {
    const { keeper, log, events, clock, settle } = kept();
    await keeper.start();
    for (let k = 0; k < 4; k += 1) {
      clock.ms += 1000;
      events.at(-1).onLost('unknown', 'gone');
      await settle();
    }
    expect(log.filter((l) => l === 'open webgpu')).toHaveLength(4);
    expect(log.slice(-2)).toEqual(['gave up webgpu', 'open webgl2']);
    expect(keeper.opened).toBe(5);
  });

  test('mends losses far apart without end', async () => {
    const { keeper, log, events, clock, settle } = kept();
    await keeper.start();
    for (let k = 0; k < 9; k += 1) {
      clock.ms += 30_000;
      events.at(-1).onLost('unknown', 'gone');
      await settle();
    }
    expect(log).not.toContain('gave up webgpu');
    expect(keeper.device?.kind).toBe('webgpu');
  });

  test('hears nothing of a device that it has closed', async () => {
    const { keeper, log, events, settle } = kept();
    await keeper.start();
    const old = events[0];
    old.onLost('unknown', 'gone');
    await settle();
    const length = log.length;
    old.onLost('unknown', 'gone again');
    old.onError('late');
    await settle();
    expect(log).toHaveLength(length);
  });

  test('leaves a kind at once that refuses what it is told', async () => {
    const { keeper, log, events, settle } = kept();
    await keeper.start();
    events[0].onError('validation');
    await settle();
    expect(log).toEqual(['open webgpu', 'close webgpu', 'gave up webgpu', 'open webgl2']);
  });

  test('throws away a device that arrives after the page is gone', async () => {
    const { keeper, log, settle } = kept([], [], undefined, { first: 'webgpu' });
    const opening = keeper.start();
    keeper.close();
    await opening;
    await settle();
    expect(log).toEqual(['close webgpu']);
    expect(keeper.device).toBe(null);
  });

  test('that loses its device while it opens tries again, and does not go down to the painter', async () => {
    const { keeper, log, taken, settle } = kept();
    taken.push('another picture needs it', 'another picture needs it');
    await keeper.start();
    await settle();
    expect(log).toEqual(['lost webgpu', 'lost webgpu', 'open webgpu']);
  });

  test('whose place is not known yet takes no other picture’s context, and opens again once it is in sight', async () => {
    const { keeper, log, events, settle } = kept(['webgpu'], [], undefined, { isSeen: false });
    await keeper.start();
    events.at(-1).onLost('unknown', 'another picture needs it');
    await settle();
    expect(log.slice(-2)).toEqual(['close webgl2', 'open canvas2d']);
    keeper.seen(true);
    await settle();
    expect(log.at(-1)).toBe('open webgl2');
  });

  test('out of sight draws dots in place of a device that it lost, and opens that again in sight', async () => {
    const { keeper, log, events, settle } = kept(['webgpu']);
    await keeper.start();
    keeper.seen(false);
    events.at(-1).onLost('unknown', 'another frame needs it');
    await settle();
    expect(log.slice(-2)).toEqual(['close webgl2', 'open canvas2d']);
    keeper.seen(false);
    await settle();
    expect(keeper.device?.kind).toBe('canvas2d');
    keeper.seen(true);
    await settle();
    expect(log.slice(-2)).toEqual(['close canvas2d', 'open webgl2']);
    // It was no fault of the device's.
    expect(keeper.losses).toEqual([]);
    expect(log.filter((line) => line.startsWith('lost'))).toEqual([]);
    keeper.seen(true);
    await settle();
    expect(keeper.opened).toBe(3);
  });
});
