import { afterEach, beforeEach, describe, expect, test, vi } from 'vitest';
import { SamplingClient } from '../../../src/engine/sampling/client.js';

class FakeWorker {
  terminated = false;
  /** @type {any[]} */
  posted = [];
  /** @type {((event: {data: any}) => void) | null} */
  onmessage = null;
  /** @type {((event: {message?: string}) => void) | null} */
  onerror = null;
  /** @param {any} message */
  postMessage(message) {
    this.posted.push(message);
  }
  terminate() {
    this.terminated = true;
  }
  /** @param {any} data */
  say(data) {
    this.onmessage?.({ data });
  }
}

/** @type {FakeWorker[]} */
let workers = [];
/** @type {any[]} */
let events = [];
/** @type {string[]} */
let messages = [];
/** A client that has started its first worker. */
function started() {
  const client = new SamplingClient({
    spawn: () => {
      const worker = new FakeWorker();
      workers.push(worker);
      return worker;
    },
    onMessage: (message) => events.push(message.type),
    onRestart: (crash) => {
      events.push(`restart: ${crash.cause}`);
      messages.push(crash.message);
    },
    onSafeMode: (crash) => events.push(`safe after ${crash.restarts}`),
    onLoadFailed: (text) => events.push(text),
  });
  client.start();
  return client;
}

/** One whose worker is ready and has work. */
function busy() {
  const client = started();
  workers[0].say(ready);
  client.setBusy(true);
  return client;
}

const ready = { type: 'ready', description: {} };
const crash = { type: 'crashed', id: 1, message: 'unreachable', stack: '' };

beforeEach(() => {
  vi.useFakeTimers();
  workers = [];
  events = [];
  messages = [];
});
afterEach(() => vi.useRealTimers());

describe('the client of the worker', () => {
  test('lets a worker that filters an image be silent for a minute', () => {
    busy();
    workers[0].say({ type: 'opening' });
    vi.advanceTimersByTime(59_000);
    expect(workers).toHaveLength(1);
    // After the next word it is that of any other work again.
    workers[0].say({ type: 'field', id: 1, answer: { ok: true } });
    vi.advanceTimersByTime(4300);
    expect(workers).toHaveLength(2);
  });

  test('replaces a busy worker that is silent for 4 s', () => {
    busy();
    vi.advanceTimersByTime(3900);
    expect(workers).toHaveLength(1);
    vi.advanceTimersByTime(400);
    expect(events).toContain('restart: hang');
    expect(workers).toHaveLength(2);
    expect(workers[0].terminated).toBe(true);
  });

  test('gives up a worker whose script does not come within a minute, busy or not', () => {
    const client = started();
    client.setBusy(true);
    vi.advanceTimersByTime(59_000);
    expect(events).toEqual([]);
    vi.advanceTimersByTime(2000);
    expect(events).toEqual(['The sampler did not load: no word from it for 60 s.']);
    expect(client.isOff).toBe(true);
    // It may compile for long after its script has come. Once it is ready, a word is expected sooner.
    client.revive();
    client.setBusy(true);
    vi.advanceTimersByTime(50_000);
    workers[1].say({ type: 'beat' });
    vi.advanceTimersByTime(50_000);
    expect(workers).toHaveLength(2);
    workers[1].say(ready);
    vi.advanceTimersByTime(4500);
    expect(events.at(-1)).toBe('restart: hang');
  });

  test('leaves a busy worker alone that speaks', () => {
    busy();
    for (let k = 0; k < 40; k += 1) {
      vi.advanceTimersByTime(250);
      workers[0].say({ type: 'beat' });
    }
    expect(workers).toHaveLength(1);
  });

  test('says how long the silence was that it suffered', () => {
    busy();
    vi.advanceTimersByTime(4_500);
    expect(messages).toEqual(['no word from the sampler for 4 s']);
  });

  test('does not watch an idle worker', () => {
    const client = busy();
    client.setBusy(false);
    vi.advanceTimersByTime(60_000);
    expect(workers).toHaveLength(1);
  });

  test('a tab that slept finds the messages that waited before it judges', () => {
    busy();
    // The timer fires late; the message is handled right after it.
    vi.advanceTimersByTime(2001);
    workers[0].say({ type: 'beat' });
    vi.advanceTimersByTime(200);
    expect(workers).toHaveLength(1);
  });

  test('replaces a worker that says it trapped, and hears no more of the old one', () => {
    started();
    workers[0].say(ready);
    const late = workers[0].onmessage;
    workers[0].say(crash);
    expect(events.at(-1)).toBe('restart: panic');
    events = [];
    late?.({ data: { type: 'done' } });
    expect(events).toEqual([]);
  });

  test('the fourth failure within a minute is safe mode, until a person asks', () => {
    const client = started();
    for (let k = 0; k < 4; k += 1) {
      workers.at(-1)?.say(ready);
      workers.at(-1)?.say(crash);
      vi.advanceTimersByTime(5000);
    }
    expect(workers).toHaveLength(4);
    expect(events.at(-1)).toBe('safe after 4');
    expect(client.isOff).toBe(true);
    client.revive();
    expect(workers).toHaveLength(5);
    workers[4].say(crash);
    expect(events.at(-1)).toBe('restart: panic');
  });

  test('failures far apart never lead to safe mode', () => {
    started();
    for (let k = 0; k < 8; k += 1) {
      workers.at(-1)?.say(crash);
      vi.advanceTimersByTime(21_000);
    }
    expect(events.filter((e) => e === 'restart: panic')).toHaveLength(8);
  });

  test('a script that does not load is no crash', () => {
    started();
    workers[0].onerror?.({ message: 'not found' });
    expect(events).toEqual(['The sampler did not load: not found.']);
    vi.advanceTimersByTime(10_000);
    expect(workers).toHaveLength(1);
  });

  test('a load that failed is reported and not repeated by itself', () => {
    const client = started();
    workers[0].say({ type: 'failed', fault: 'missing', message: 'gone' });
    vi.advanceTimersByTime(10_000);
    expect(events).toEqual(['gone']);
    expect(workers).toHaveLength(1);
    client.revive();
    expect(workers).toHaveLength(2);
  });
});
