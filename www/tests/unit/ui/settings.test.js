import { signal } from '@preact/signals-core';
import { afterEach, describe, expect, it, vi } from 'vitest';
import { remembered } from '../../../src/ui/remembered.js';
import { arrange, countChanged, isDue, isSegmented, isShown } from '../../../src/ui/sampling/settings.js';

/** @param {object} change */
const setting = (change) =>
  /** @type {any} */ ({
    name: 'radius',
    label: 'Radius',
    group: 'Sampling',
    kind: 'number',
    default: 1,
    when: [],
    ...change,
  });
const choices = (/** @type {string[]} */ ...labels) => labels.map((label) => ({ value: label, label }));
const kind = setting({ name: 'sampling', kind: 'choice', default: 'uniform', choices: choices('uniform', 'adaptive') });
const law = setting({ name: 'law', kind: 'choice', default: 'chord', when: [{ name: 'sampling', value: 'adaptive' }] });
const scale = setting({
  name: 'scale',
  when: [
    { name: 'sampling', value: 'adaptive' },
    { name: 'law', value: 'chord', equal: false },
  ],
});
const seed = setting({ name: 'seed', group: 'Advanced', default: 0 });
const all = [kind, law, scale, seed];

describe('the settings', () => {
  it('stand at the head, in the bar or behind a button', () => {
    const { kind: head, plain, advanced } = arrange(all);
    expect(head).toBe(kind);
    expect(plain).toEqual([law, scale]);
    expect(advanced).toEqual([seed]);
    expect(arrange([seed]).kind).toBeNull();
  });

  it('are shown while all their conditions hold, defaults included', () => {
    expect(isShown(law, all, {})).toBe(false);
    expect(isShown(law, all, { sampling: 'adaptive' })).toBe(true);
    expect(isShown(scale, all, { sampling: 'adaptive' })).toBe(false);
    expect(isShown(scale, all, { sampling: 'adaptive', law: 'sum' })).toBe(true);
    expect(isShown(scale, all, { law: 'sum' })).toBe(false);
    expect(isShown(setting({ when: undefined }), all, {})).toBe(true);
  });

  it('are chosen side by side where there are two or three short values', () => {
    expect(isSegmented(kind)).toBe(true);
    expect(
      isSegmented(
        setting({ kind: 'choice', choices: choices('Chord error', 'Largest curvature', 'Sum of curvatures') }),
      ),
    ).toBe(false);
    expect(isSegmented(setting({ kind: 'choice', choices: choices('a', 'b', 'c', 'd') }))).toBe(false);
    expect(isSegmented(setting({ kind: 'choice', choices: choices('a') }))).toBe(false);
    expect(isSegmented(setting({ choices: choices('a', 'b') }))).toBe(false);
  });

  it('are counted as changed while they are shown and differ from their default', () => {
    expect(countChanged(all, all, {})).toBe(0);
    expect(countChanged([seed], all, { seed: 3 })).toBe(1);
    expect(countChanged([seed], all, { seed: 0 })).toBe(0);
    expect(countChanged([scale], all, { scale: 4 })).toBe(0);
  });
});

describe('Run', () => {
  it('is quiet while the picture is that of the present input, and during a run', () => {
    const store = {
      trial: signal('none'),
      result: signal('whole'),
      report: signal(/** @type {object | null} */ ({})),
      status: signal('rest'),
      progress: signal({ phase: 'done' }),
    };
    const due = isDue(/** @type {any} */ (store));
    expect(due.value).toBe(false);
    /** Sets a signal for as long as it is looked at. @param {'trial' | 'result' | 'status'} name @param {string} value */
    const isDueAt = (name, value) => {
      const before = store[name].value;
      store[name].value = value;
      const is = due.value;
      store[name].value = before;
      return is;
    };
    expect([isDueAt('trial', 'typing'), isDueAt('result', 'partial')]).toEqual([true, true]);
    store.report.value = null;
    expect(due.value).toBe(true);
    expect([isDueAt('status', 'sampling'), isDueAt('result', 'none')]).toEqual([false, false]);
  });
});

describe('the fold of the report', () => {
  afterEach(() => vi.unstubAllGlobals());

  it('is as it was left, also where the browser keeps nothing', () => {
    const kept = new Map();
    const storage = { getItem: kept.get.bind(kept), setItem: kept.set.bind(kept) };
    vi.stubGlobal('localStorage', storage);
    const isOpen = remembered('report', false);
    expect(isOpen.value).toBe(false);
    isOpen.value = true;
    expect(remembered('report', false).value).toBe(true);
    vi.stubGlobal('localStorage', undefined);
    expect(remembered('report', false).value).toBe(false);
  });
});
