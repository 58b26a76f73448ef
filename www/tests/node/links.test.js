/** Links: a state as text, and what becomes of one that cannot be had. */
import { describe, expect, test } from 'vitest';
import { begin, coarse, eventually, link, open, picture, until } from './engine.js';

/** @import { Console } from '../../src/main/types.js' */

describe('links', () => {
  test('bring back surface, settings and view', async () => {
    const wanted = {
      surface: 'torus',
      settings: { radius_share: 0.03 },
      view: { colour: /** @type {const} */ ('valence'), theme: /** @type {const} */ ('dark') },
    };
    const p = await open(link(wanted));
    expect(p.state).toMatchObject(wanted);
    expect(p.report()?.quality?.euler).toBe(0);
    const shared = await p.engine.link();
    await p.set({ surface: 'ellipsoid' });
    await p.engine.openLink(shared);
    expect(p.state).toMatchObject(wanted);
  });

  /** What is said of a link. @param {Console} p */
  const noticeOf = async (p) => (await until(p.engine.notice, (notice) => notice?.id === 'link'))?.text;

  test('with a mistake in them say what was reset, and the page works', async () => {
    const p = begin(link({ surface: 'nowhere', settings: { radius_share: 9 } }));
    const text = await noticeOf(p);
    expect(text).toContain('surface');
    expect(text).toContain('radius_share');
    expect((await p.ready)?.stop_reason).toBe('complete');
  });

  test('that are broken lead to the standard surface', async () => {
    const p = begin('#v99.j.AAAA');
    expect(await noticeOf(p)).toContain('another version');
    await p.ready;
    expect(p.state.surface).toBe('ellipsoid');
  });

  test('to what cannot be had leave the surface before, whole, with its figures and files', async () => {
    const p = await open();
    const count = p.report()?.count ?? 0;
    expect(count).toBeGreaterThan(200);
    for (const [state, sign] of /** @type {const} */ ([
      [{ ...coarse, formula: 'x^2 +' }, 'fieldError'],
      [{ settings: { radius_share: 0.0005 } }, 'notice'],
    ])) {
      void p.engine.openLink(link(state));
      await eventually(() => p.engine[sign].value).toBeTruthy();
      await until(p.engine.status, (status) => status !== 'sampling');
      expect(p.debug.counts().dimmed).toBe(true);
      expect(p.report()?.count).toBe(count);
      expect(p.particles().count).toBe(count);
      const csv = await (await p.engine.exportFile('csv')).text();
      expect(csv.trim().split('\n').length).toBeGreaterThan(count);
    }
  });

  test('to what cannot be had leave the surface before in view, also where their box is smaller', async () => {
    const p = await open();
    const before = await picture(p);
    const small = { min: [0.4, -0.1, -0.1], max: [0.6, 0.1, 0.1] };
    void p.engine.openLink(link({ ...coarse, formula: 'x^2 +', bounds: small }));
    await until(p.engine.fieldError, (error) => error);
    // Nothing of it is cut off, and the camera shows it as it did.
    await eventually(async () => (await picture(p)).drawn).toBeCloseTo(before.drawn, 2);
  });
});
