import { expect, test } from '@playwright/test';
import { afresh, atRest, COARSE, expectDrawn, open, scan, settled, state, typeFormula } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/**
 * Windows in which a page is opened, and those to which it is resized; a desk's and a phone's in every run.
 * @type {{ tag: string[], sizes: [number, number][] }[]}
 */
const WINDOWS = [
  { tag: [], sizes: [[1440, 900]] },
  {
    tag: [],
    sizes: [
      [390, 844],
      [320, 640],
      [844, 390],
      [600, 340],
    ],
  },
  {
    tag: ['@all'],
    sizes: [
      [1280, 720],
      [3840, 2160],
      [2560, 1440],
    ],
  },
  { tag: ['@all'], sizes: [[820, 1180]] },
];

for (const { tag, sizes } of WINDOWS) {
  const [[width, height], ...others] = sizes;
  test(`from ${width} by ${height} on nothing overflows; the page settles without a jump and asks nobody else for anything`, {
    tag,
  }, async ({ page, baseURL }) => {
    /** @type {string[]} */
    const foreign = [];
    page.on('request', (request) => {
      if (!request.url().startsWith(new URL(baseURL ?? '').origin) && !/^(blob|data):/.test(request.url()))
        foreign.push(request.url());
    });
    await page.addInitScript(() => {
      /** @type {any} */ (window).shift = 0;
      new PerformanceObserver((list) => {
        for (const entry of list.getEntries()) /** @type {any} */ (window).shift += /** @type {any} */ (entry).value;
      }).observe({ type: 'layout-shift', buffered: true });
    });
    const { clean } = await open(page, { width, height, folded: true });
    expect(await page.evaluate(() => /** @type {any} */ (window).shift)).toBeLessThan(0.05);
    expect(foreign).toEqual([]);
    await expectNoOverflow(page, width, height);
    for (const [otherWidth, otherHeight] of others) {
      await page.setViewportSize({ width: otherWidth, height: otherHeight });
      await atRest(page);
      await expectNoOverflow(page, otherWidth, otherHeight);
    }
    await clean();
  });
}

/** @param {Page} page @param {number} width @param {number} height */
async function expectNoOverflow(page, width, height) {
  const compact = width < 720 || height < 480;
  for (const tab of compact ? ['Sampling', 'Report', 'Surface'] : ['']) {
    const button = page.getByRole('navigation', { name: 'Panels' }).getByRole('button', { name: tab });
    // A press on the tab of an open panel closes it.
    if (tab && !(await page.locator(`#panel-${tab.toLowerCase()}`).isVisible())) await button.click();
    const { scroll, outside, rows } = await page.evaluate(() => {
      const visible = (/** @type {Element} */ element) => element.checkVisibility();
      const outside = [...document.querySelectorAll('.panel, .toolbar, .legend, .tabs')]
        .filter(visible)
        .filter((element) => {
          const { left, right, top, bottom } = element.getBoundingClientRect();
          return left < -0.5 || right > innerWidth + 0.5 || top < -2.5 || bottom > innerHeight + 0.5;
        })
        .map((element) => element.className);
      for (const body of document.querySelectorAll('.panel-body')) {
        if (visible(body) && body.scrollWidth > body.clientWidth + 1)
          outside.push(`${body.id} ${body.scrollWidth} > ${body.clientWidth}`);
      }
      const middle = (/** @type {Element} */ element) =>
        Math.round(element.getBoundingClientRect().top + element.clientHeight / 2);
      const rows = new Set([...document.querySelectorAll('.tabs > *')].filter(visible).map(middle)).size;
      return { scroll: document.documentElement.scrollWidth, outside, rows };
    });
    const where = `${width} by ${height} ${tab}`;
    expect(rows, where).toBe(Number(compact));
    expect(scroll, where).toBeLessThanOrEqual(width);
    expect(outside, where).toEqual([]);
  }
  // The surface stays visible: a good part of the window belongs to the picture.
  const view = await page.locator('#view').boundingBox();
  expect((view?.width ?? 0) * (view?.height ?? 0)).toBeGreaterThan(0.2 * width * height);
}

/** Expects that axe finds nothing, in the light and in the dark. @param {Page} page */
async function expectAccessible(page) {
  for (const colorScheme of /** @type {const} */ (['light', 'dark'])) {
    await page.emulateMedia({ colorScheme });
    expect((await scan(page)).violations, colorScheme).toEqual([]);
  }
}

test('axe finds nothing at 390 by 844', async ({ page }) => {
  await open(page, { width: 390, height: 844, hash: COARSE });
  for (const tab of ['Sampling', 'Report', 'Surface']) {
    await page.getByRole('navigation', { name: 'Panels' }).getByRole('button', { name: tab }).click();
    await expectAccessible(page);
  }
});

test('axe finds nothing at 1440 by 900', async ({ page }) => {
  await open(page, { width: 1440, height: 900, hash: COARSE });
  await expectAccessible(page);
  await page.getByRole('radio', { name: 'Adaptive' }).check();
  await page.getByRole('button', { name: 'Advanced' }).click();
  // Off the settings, whose explanation would come up in a layer outside of every landmark.
  await page.mouse.move(720, 400);
  await settled(page);
  await expectAccessible(page);
  await page.getByRole('button', { name: 'View options' }).click();
  await expectAccessible(page);
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Help' }).click();
  await expectAccessible(page);
});

test('on a phone the surface stands clear of tools, legend and caption', { tag: '@all' }, async ({ page }) => {
  await open(page, { width: 390, height: 844 });
  await page.locator('.tile[data-surface="sphere"]').click();
  await page.getByRole('combobox', { name: 'Colour by' }).selectOption('curvature');
  await settled(page);
  await expect(page.locator('.scale .unit')).toBeVisible();
  for (const [width, height] of /** @type {const} */ ([
    [390, 844],
    [320, 640],
    [320, 568],
  ])) {
    await page.setViewportSize({ width, height });
    await atRest(page);
    const { under, between } = await page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const box = (/** @type {string} */ part) =>
        /** @type {Element} */ (document.querySelector(part)).getBoundingClientRect();
      // Small discs are picked from up to six pixels beside them.
      const hit = (/** @type {DOMRect} */ { left, right, top, bottom }) => {
        for (let x = left + 6; x <= right - 6; x += 4)
          for (let y = top + 6; y <= bottom - 6; y += 4) if (engine.pick(x, y) !== null) return true;
        return false;
      };
      const [tools, legend, caption] = ['.toolbar', '.legend', '.caption'].map(box);
      return {
        under: [tools, legend, caption].map(hit),
        between: engine.pick(tools.left / 2, (legend.bottom + caption.top) / 2) !== null,
      };
    });
    expect(under).toEqual([false, false, false]);
    expect(between).toBe(true);
  }
});

test('on a larger window a fit leaves the legend free, and a page that is opened again shows the same', {
  tag: '@all',
}, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  const isUnderLegend = () =>
    page.evaluate(() => {
      const { engine } = /** @type {any} */ (window).marchingParticles;
      const box = /** @type {Element} */ (document.querySelector('.legend')).getBoundingClientRect();
      for (let x = box.left; x <= box.right - 6; x += 4)
        for (let y = box.top; y <= box.bottom - 6; y += 4) if (engine.pick(x, y) !== null) return true;
      return false;
    });
  // A heart reaches into the corners of its picture.
  await typeFormula(page, '(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3 = 0');
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.lookFrom('front'));
  await settled(page);
  await page.keyboard.press('Escape');
  for (const [width, height] of /** @type {const} */ ([
    [1440, 900],
    [1024, 768],
  ])) {
    await page.setViewportSize({ width, height });
    await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.fit());
    await atRest(page);
    expect(await isUnderLegend(), `${width} by ${height}`).toBe(false);
  }
  // Turned by hand it is as small as it was.
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.orbit(1.2, 0.3));
  await atRest(page);
  const before = (await state(page)).view.camera;
  await expect
    .poll(() =>
      page.evaluate(
        async () =>
          (await /** @type {any} */ (window).marchingParticles.link()) === location.href.replace(location.search, ''),
      ),
    )
    .toBe(true);
  await page.reload();
  await settled(page);
  await atRest(page);
  const after = (await state(page)).view.camera;
  expect(after.distance / before.distance).toBeCloseTo(1, 4);
  expect(after.yaw).toBeCloseTo(before.yaw, 4);
  await clean();
});

test('targets are large, the theme can be switched, and the page says what it is', { tag: '@all' }, async ({
  page,
}) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await test.step('targets are at least 24 pixels', async () => {
    const small = await page.evaluate(() =>
      [...document.querySelectorAll('button, select, input:not(.visually-hidden), summary')]
        .filter((element) => element.checkVisibility({ visibilityProperty: true }) && !element.closest('label.check'))
        .map((element) => ({
          name: element.textContent || element.getAttribute('aria-label'),
          box: element.getBoundingClientRect(),
        }))
        .filter(({ box }) => box.width < 23.5 || box.height < 23.5)
        .map(({ name, box }) => `${name} ${box.width} by ${box.height}`),
    );
    expect(small).toEqual([]);
  });

  await test.step('the theme follows the system and can be switched', async () => {
    await page.emulateMedia({ colorScheme: 'dark' });
    await afresh(page);
    const ground = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
    const dark = await ground();
    await page.getByRole('button', { name: 'View options' }).click();
    await page.getByRole('button', { name: 'Light', exact: true }).click();
    expect(await ground()).not.toBe(dark);
    await page.emulateMedia({ colorScheme: 'light' });
    await page.getByRole('button', { name: 'System' }).click();
    expect(await ground()).not.toBe(dark);
  });

  await test.step('on a phone formula and sliders come before the story, and the list of keys is in reach', async () => {
    await afresh(page, { width: 390, height: 844 });
    const top = async (/** @type {string} */ part) => (await page.locator(part).first().boundingBox())?.y ?? NaN;
    expect(await top('.formula')).toBeLessThan(await top('.story'));
    expect(await top('.parameters')).toBeLessThan(await top('.story'));
    expect(await top('.story')).toBeLessThan(await top('.clip'));
    await page.getByRole('button', { name: 'Help' }).click();
    await expect(page.getByRole('dialog', { name: 'Help' })).toBeVisible();
  });

  await test.step('in a large window everything grows with it, in a usual one it has the size that the user has set', async () => {
    await afresh(page, { width: 1600, height: 900 });
    const sizes = () =>
      page.evaluate(() => {
        const [field, levels, bar] = ['#panel-field', '#panel-levels', '#panel-sampling'].map((part) =>
          /** @type {Element} */ (document.querySelector(part)).getBoundingClientRect(),
        );
        return {
          type: parseFloat(getComputedStyle(document.documentElement).fontSize),
          field: field.width,
          levels: levels.height,
          bar: bar.width,
        };
      });
    const usual = await sizes();
    expect(usual.type).toBe(16);
    for (const [width, height] of /** @type {const} */ ([
      [1920, 1080],
      [3440, 1080],
    ])) {
      await page.setViewportSize({ width, height });
      expect((await sizes()).type).toBe(16);
    }
    await page.setViewportSize({ width: 3840, height: 2160 });
    const large = await sizes();
    for (const part of /** @type {const} */ (['type', 'field', 'levels', 'bar']))
      expect(large[part], part).toBeGreaterThan(1.7 * usual[part]);
  });
  await clean();
});

test('without its style sheet the page still has all its controls', { tag: '@all' }, async ({ page }) => {
  await page.route('**/*.css', (route) => route.abort());
  await page.goto('/?backend=canvas2d');
  await settled(page);
  await expect(page.locator('#formula')).toBeAttached();
  await expect(page.getByRole('button', { name: 'Without relaxing' })).toBeAttached();
});

test('a style sheet that comes after the script finds everything in its place', { tag: '@all' }, async ({ page }) => {
  await page.setViewportSize({ width: 1440, height: 900 });
  /** @type {(nothing: void) => void} */
  let send = () => {};
  const sent = new Promise((/** @type {(nothing: void) => void} */ resolve) => {
    send = resolve;
  });
  await page.route('**/*.css', async (route) => {
    await sent;
    await route.continue();
  });
  // Chromium holds module scripts back until the style sheet is there, unless they are asynchronous; WebKit does not.
  await page.route(/\/\?backend/, async (route) => {
    const response = await route.fetch();
    await route.fulfill({
      response,
      body: (await response.text()).replace('<script type="module"', '<script async type="module"'),
    });
  });
  await page.goto('/?backend=canvas2d', { waitUntil: 'commit' });
  // No frame is drawn before the style sheet is there.
  await page.waitForFunction(() => /** @type {any} */ (window).marchingParticles?.engine.description.value, undefined, {
    polling: 100,
  });
  expect(await page.locator('#field-body').textContent()).toBe('');
  send();
  await expect
    .poll(() => page.evaluate(() => /** @type {any} */ (window).marchingParticles.debug.counts().frames))
    .toBeGreaterThan(0);
  await settled(page);
  // While a slow computer draws what moves, the canvas has fewer pixels.
  const size = () =>
    page.evaluate(() => {
      const { width, height } = /** @type {HTMLCanvasElement} */ (document.querySelector('#canvas-host canvas'));
      return [width, height];
    });
  await expect.poll(size).toEqual([1440, 900]);
  const ground = await page.locator('meta[name="theme-color"]').first().getAttribute('content');
  expect(ground).toBe(await page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor));
});

test('keys alone reach the formula, a slider, the run and the panels', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page, { width: 1440, height: 900 });
  await page.keyboard.press('Tab');
  await page.keyboard.press('Enter');
  await expect(page.getByRole('textbox', { name: 'Formula' })).toBeFocused();
  await expect(page.locator('.code-host')).toBeVisible();
  await page.keyboard.press('Escape');
  // Out of the editor by Tab, on to the first slider.
  for (let i = 0; i < 4 && !(await page.evaluate(() => document.activeElement?.matches('.row .slider'))); i += 1)
    await page.keyboard.press('Tab');
  const name = await page.evaluate(() => document.activeElement?.closest('.row')?.getAttribute('data-parameter'));
  expect(name).toBeTruthy();
  await page.keyboard.press('ArrowRight');
  await expect.poll(async () => Object.keys((await state(page)).parameters)).toContain(name);
  await page.locator('#canvas-host').focus();
  const yaw = (await state(page)).view.camera.yaw;
  await page.keyboard.press('ArrowLeft');
  await expect.poll(async () => (await state(page)).view.camera.yaw).not.toBe(yaw);
  await page.keyboard.press('h');
  await expect(page.locator('#panel-field')).toBeHidden();
  await page.keyboard.press('h');
  await page.keyboard.press('h');
  await expect(page.locator('#panel-field')).toBeVisible();
  await page.keyboard.press('?');
  const help = page.getByRole('dialog', { name: 'Help' });
  await expect(help.locator('p').first()).toContainText('covers a surface, given by a formula, with particles');
  await page.keyboard.press('Escape');
  await expect(page.getByRole('dialog')).toHaveCount(0);
  await page.keyboard.press('?');
  await help.getByRole('link', { name: 'lesson' }).click();
  await expect(page).toHaveURL(/\/learn\/#surface=/);
  await clean();
});

test('the picture of a dark page is dark from the first frame, also where the sampler does not come', {
  tag: '@all',
}, async ({ page }) => {
  await page.emulateMedia({ colorScheme: 'dark' });
  await page.setViewportSize({ width: 390, height: 844 });
  /** @type {() => Promise<void>} */
  let refuse = async () => {};
  await page.route('**/core_bg*.wasm', (route) => {
    refuse = () => route.abort();
  });
  await page.goto('./?backend=canvas2d');
  await page.waitForFunction(() => 'marchingParticles' in window);
  // The picture starts after the core, also when that does not come.
  await refuse();
  await page.waitForFunction(() => /** @type {any} */ (window).marchingParticles?.debug.counts().frames > 0);
  const brightest = await page.evaluate(async () =>
    Math.max(
      ...(await /** @type {any} */ (window).marchingParticles.pixels(4, 4)).pixels.filter(
        (/** @type {number} */ _, /** @type {number} */ i) => i % 4 < 3,
      ),
    ),
  );
  expect(brightest).toBeLessThan(64);
  await expectDrawn(page, 'canvas2d');
});

test('the page says in one line what it is', { tag: '@all' }, async ({ page }) => {
  for (const [width, height] of /** @type {const} */ ([
    [1440, 900],
    [320, 568],
  ])) {
    const { clean } = await open(page, { width, height });
    const line = page.getByText('Even particles on any surface f(x, y, z) = 0');
    await expect(line).toBeVisible();
    expect((await line.boundingBox())?.height).toBeLessThan(24);
    await clean();
  }
});

test('a theme that was chosen is that of the lesson and of the next visit, and no link changes it', {
  tag: '@all',
}, async ({ page }) => {
  await page.emulateMedia({ colorScheme: 'light' });
  const { clean } = await open(page);
  const theme = () => page.evaluate(() => getComputedStyle(document.documentElement).colorScheme);
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.setView({ theme: 'dark' }));
  expect(await theme()).toBe('dark');
  await page.goto('./learn/');
  expect(await theme()).toBe('dark');
  await page.goto('./?backend=canvas2d');
  await settled(page);
  expect(await theme()).toBe('dark');
  expect((await state(page)).view.theme).toBe('dark');
  const light = await page.evaluate(async () => {
    const { engine, link } = /** @type {any} */ (window).marchingParticles;
    engine.setView({ theme: 'light' });
    const address = await link();
    engine.setView({ theme: 'dark' });
    return new URL(address).hash;
  });
  await page.goto('./learn/');
  await page.goto(`./?backend=canvas2d${light}`);
  await settled(page);
  expect(await theme()).toBe('light');
  await page.goto('./learn/');
  expect(await theme()).toBe('dark');
  await clean();
});
