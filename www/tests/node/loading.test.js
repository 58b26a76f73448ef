/** A core that cannot be had: the cause is named, every promise settles, and another try helps. */
import { expect, test, vi } from 'vitest';
import { answers, begin, expectSurface, fetched, strike, until } from './engine.js';

// In one test, since a core that has loaded is kept for the engines to come.
test('without a core the cause is named, calls settle, and another try helps; a core that is there is kept', async () => {
  const simd = vi.spyOn(WebAssembly, 'validate').mockReturnValue(false);
  const p = begin();
  /** @param {RegExp} words */
  const refused = (words) => until(p.engine.notice, (notice) => notice?.id === 'load' && words.test(notice.text));
  const tryAgain = () => p.engine.notice.value?.action?.run();
  await refused(/lacks WebAssembly SIMD.*Chrome.*Firefox.*Safari/);
  expect(p.engine.notice.value?.kind).toBe('error');
  expect(fetched).toEqual([]);
  simd.mockRestore();

  for (const [answer, words] of /** @type {const} */ ([
    [{ status: 404 }, /404/],
    [{ isBlocked: true }, /could not be fetched/],
    [{ body: Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 255, 1) }, /damaged/],
    [{ type: 'text/html', body: '<!doctype html><title>Hello</title>' }, /page in its place/],
  ])) {
    answers.set('core_bg', answer);
    tryAgain();
    await refused(words);
  }

  // Also when the notice has been dismissed.
  const { action } = p.engine.notice.value ?? {};
  p.engine.dismissNotice();
  const calls = [p.ready, p.run(), p.stop(), p.open(new File(['1 2 3'], 'a.xyz')), p.debug.still()];
  expect((await Promise.allSettled(calls)).map(({ status }) => status)).toEqual(Array(5).fill('fulfilled'));

  // A wrong media type does no harm.
  fetched.length = 0;
  answers.set('core_bg', { type: 'application/octet-stream' });
  action?.run();
  await until(p.engine.report, (report) => report);
  await expectSurface(p);
  strike('panic');
  await until(p.engine.notice, (notice) => notice?.id === 'panic');
  await p.run();
  expect(fetched.filter((url) => url.includes('core_bg'))).toHaveLength(1);
});
