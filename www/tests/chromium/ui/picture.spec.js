/** The picture taken away: as a file, on paper, as a film, as a sequence of pictures. And what moves by itself. */
import { readFile } from 'node:fs/promises';
import { expect, test } from '@playwright/test';
import { unzipSync } from 'fflate';
import { BufferSource, EncodedPacketSink, Input, MP4, WEBM } from 'mediabunny';
import { afresh, atRest, open, report, scan, settled, state } from './helpers.js';

/** @import { Page } from '@playwright/test' */

/** @param {Page} page */
async function openDialog(page) {
  await page.getByRole('button', { name: 'Save picture' }).click();
  const dialog = page.getByRole('dialog', { name: 'Save the picture' });
  await expect(dialog).toBeVisible();
  return dialog;
}

/**
 * What is in a PNG file: its size, whether its corner is ground, and its dark and its opaque share.
 * @param {Page} page
 * @param {Buffer} png
 */
const look = (page, png) =>
  page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const { width, height } = bitmap;
    const context = /** @type {OffscreenCanvasRenderingContext2D} */ (
      new OffscreenCanvas(width, height).getContext('2d')
    );
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const drawn = (/** @type {number} */ i) =>
      Math.abs(data[i] - data[0]) + Math.abs(data[i + 1] - data[1]) + Math.abs(data[i + 2] - data[2]) > 24;
    let [top, left, bottom, right, count] = [height, width, 0, 0, 0];
    for (let y = 0; y < height; y += 1) {
      for (let x = 0; x < width; x += 1) {
        if (!drawn(4 * (y * width + x))) continue;
        count += 1;
        [top, bottom, left, right] = [Math.min(top, y), Math.max(bottom, y), Math.min(left, x), Math.max(right, x)];
      }
    }
    return { width, height, alpha: data[3], count, box: { top, left, bottom, right } };
  }, png.toString('base64'));

/** @param {Page} page @param {() => Promise<void>} press */
async function fileOf(page, press) {
  const [download] = await Promise.all([page.waitForEvent('download'), press()]);
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

/** What is in a film: its kind, its length, and the times and the data of its pictures. @param {Buffer} bytes */
async function filmIn(bytes) {
  const input = new Input({ source: new BufferSource(bytes), formats: [MP4, WEBM] });
  const track = await input.getPrimaryVideoTrack();
  const config = await track?.getDecoderConfig();
  if (!track || !config) throw new Error('There is no film in the file.');
  const packets = [];
  for await (const packet of new EncodedPacketSink(track).packets()) packets.push(packet);
  return {
    kind: (await input.getFormat()).name,
    seconds: await input.computeDuration(),
    size: [await track.getDisplayWidth(), await track.getDisplayHeight()],
    times: packets.map(({ timestamp }) => timestamp),
    config,
    packets,
  };
}

/**
 * The picture of a film at a place, as a PNG.
 * @param {Page} page @param {Awaited<ReturnType<typeof filmIn>>} film @param {number} place
 */
async function pictureAt(page, { config, packets }, place) {
  const chunks = packets.slice(0, place + 1).map(({ data, type }) => ({
    type,
    base64: Buffer.from(data).toString('base64'),
  }));
  const description = config.description && Buffer.from(/** @type {any} */ (config.description)).toString('base64');
  const base64 = await page.evaluate(
    async ({ codec, description, chunks }) => {
      const bytesOf = (/** @type {string} */ base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
      let last = /** @type {VideoFrame | null} */ (null);
      const decoder = new VideoDecoder({
        output: (frame) => {
          last?.close();
          last = frame;
        },
        error: (error) => console.error(error),
      });
      decoder.configure({ codec, ...(description && { description: bytesOf(description) }) });
      for (const [k, { type, base64 }] of chunks.entries()) {
        decoder.decode(new EncodedVideoChunk({ type, data: bytesOf(base64), timestamp: k }));
      }
      await decoder.flush();
      if (!last) throw new Error('no picture');
      const canvas = new OffscreenCanvas(last.displayWidth, last.displayHeight);
      canvas.getContext('2d')?.drawImage(last, 0, 0);
      last.close();
      decoder.close();
      const png = new Uint8Array(await (await canvas.convertToBlob({ type: 'image/png' })).arrayBuffer());
      return btoa(Array.from(png, (byte) => String.fromCharCode(byte)).join(''));
    },
    { codec: config.codec, description, chunks },
  );
  return Buffer.from(base64, 'base64');
}

/** Records a film of what the user does, whose last picture shows the surface. @param {Page} page */
async function recorded(page) {
  const dialog = await openDialog(page);
  await dialog.getByRole('combobox', { name: 'Motion' }).selectOption('My own moves');
  await dialog.getByRole('button', { name: 'Make film' }).click();
  const bar = page.getByRole('group', { name: 'Recording' });
  await expect(bar.getByText(/^[1-9]/)).toBeVisible();
  await page.evaluate(() => /** @type {any} */ (window).marchingParticles.engine.orbit(1, 0));
  const { name, bytes } = await fileOf(page, () => bar.getByRole('button', { name: 'Stop recording' }).click());
  await expect(bar).toHaveCount(0);
  const film = await filmIn(bytes);
  expect(film.times.length).toBeGreaterThan(1);
  expect(film.seconds).toBeGreaterThan(0.9);
  const last = await look(page, await pictureAt(page, film, film.times.length - 1));
  expect([last.width, last.height]).toEqual(film.size);
  expect(last.count).toBeGreaterThan(0.05 * last.width * last.height);
  return { ...film, ending: name.split('.').pop() };
}

test('a browser that does not encode the codec of an MP4 film makes a WebM film', { tag: '@all' }, async ({ page }) => {
  await page.addInitScript(() => {
    const ask = VideoEncoder.isConfigSupported.bind(VideoEncoder);
    VideoEncoder.isConfigSupported = (config) =>
      config.codec.startsWith('avc') ? Promise.resolve({ supported: false, config }) : ask(config);
  });
  const { clean } = await open(page, { width: 900, height: 700 });
  const film = await recorded(page);
  expect([film.kind, film.ending]).toEqual(['WebM', 'webm']);
  await clean();
});

test('the picture and what moves in it', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await test.step('a picture is saved in a chosen size, without ground, and with legend and caption', async () => {
    const save = async (/** @type {string} */ size, /** @type {string[]} */ checks) => {
      const dialog = await openDialog(page);
      await dialog.getByRole('combobox', { name: 'Size' }).first().selectOption({ label: size });
      for (const name of ['Transparent background', 'Legend', 'Caption'])
        await dialog.getByRole('checkbox', { name }).setChecked(checks.includes(name));
      const { name, bytes } = await fileOf(page, () => dialog.getByRole('button', { name: 'Save PNG' }).click());
      expect(name).toMatch(/^ellipsoid-\d+\.png$/);
      await expect(dialog).toBeHidden();
      return look(page, bytes);
    };
    const plain = await save('Square, 2048\u202f×\u202f2048', []);
    expect([plain.width, plain.height, plain.alpha]).toEqual([2048, 2048, 255]);
    // The surface fills a square as it fills the height of the window.
    const fills = Math.max(plain.box.right - plain.box.left, plain.box.bottom - plain.box.top) / 2048;
    expect(fills).toBeGreaterThan(0.6);
    const told = await save('Square, 2048\u202f×\u202f2048', ['Legend', 'Caption']);
    // The legend is at the top, the caption at the bottom.
    expect(told.box.top).toBeLessThan(plain.box.top);
    expect(told.box.bottom).toBeGreaterThan(plain.box.bottom);
    expect(told.count).toBeGreaterThan(plain.count);
    const bare = await save('Screen, 1280\u202f×\u202f800', ['Transparent background']);
    expect([bare.width, bare.height, bare.alpha]).toEqual([1280, 800, 0]);
  });

  await test.step('a film of what the user does is recorded until it is stopped', async () => {
    await afresh(page, { width: 900, height: 700 });
    const film = await recorded(page);
    expect([film.kind, film.ending]).toEqual(['MP4', 'mp4']);
    // In the time in which it was recorded, one picture after the other.
    expect(film.times).toEqual([...new Set(film.times)].sort((a, b) => a - b));
  });

  await test.step('a printed page has the picture, the formula and the figures, and nothing else', async () => {
    await afresh(page, { width: 1440, height: 900 });
    await page.evaluate(() => {
      const store = /** @type {any} */ (window);
      store.printed = new Promise((resolve) => {
        window.print = () => resolve(undefined);
      });
    });
    await page.keyboard.press('ControlOrMeta+p');
    await page.evaluate(() => /** @type {any} */ (window).printed);
    await page.emulateMedia({ media: 'print' });
    const sheet = page.locator('.sheet');
    await expect(sheet.getByRole('heading', { level: 1 })).toContainText('Ellipsoid');
    await expect(sheet.locator('math')).toBeVisible();
    await expect(sheet.locator('img')).toBeVisible();
    expect(
      await sheet.locator('img').evaluate((img) => /** @type {HTMLImageElement} */ (img).naturalWidth),
    ).toBeGreaterThan(1000);
    await expect(sheet.locator('.figures tr:visible').nth(5)).toBeVisible();
    await expect(page.locator('.panel:visible, .toolbar:visible, .canvas-host:visible')).toHaveCount(0);
    await page.evaluate(() => dispatchEvent(new Event('afterprint')));
    await expect(sheet).toHaveCount(0);
    await page.emulateMedia({ media: 'screen' });
    await expect(page.locator('.toolbar')).toBeVisible();
  });

  await test.step('a parameter is played, in one step of the history, and stops where it is', async () => {
    await afresh(page);
    const value = async () => (await state(page)).parameters.a;
    await page.getByRole('button', { name: 'Play a' }).click();
    const course = page.getByRole('radiogroup', { name: 'Course' });
    await course.getByRole('radio', { name: 'Loop' }).check();
    await page.getByRole('combobox', { name: 'Speed', exact: true }).selectOption('4\u202f×');
    await expect.poll(value).not.toBe(undefined);
    const first = await value();
    await expect.poll(value).not.toBe(first);
    await page.getByRole('button', { name: 'Pause a' }).click();
    await settled(page);
    const last = await value();
    expect((await report(page)).stop_reason).toBe('complete');
    await expect(course).toBeHidden();
    expect(await value()).toBe(last);
    await page.getByRole('button', { name: 'Undo' }).click();
    await settled(page);
    expect((await state(page)).parameters).toEqual({});
  });

  await test.step('the turntable turns until it is pressed again, or Escape', async () => {
    await afresh(page);
    const yaw = async () => (await state(page)).view.camera.yaw;
    const before = await yaw();
    await page.getByRole('button', { name: 'View options' }).click();
    const button = page.locator('[aria-label="Turntable"]');
    await button.click();
    await expect(button).toHaveAttribute('aria-pressed', 'true');
    await expect.poll(yaw).not.toBe(before);
    // Before the motion, Escape ends what lies over the page: the menu, and the explanation of its button.
    await expect(async () => {
      await page.keyboard.press('Escape');
      await expect(button).toHaveAttribute('aria-pressed', 'false', { timeout: 200 });
    }).toPass();
    await atRest(page);
    const rest = await yaw();
    await page.waitForTimeout(300);
    expect(await yaw()).toBe(rest);
    await page.keyboard.press('o');
    await expect.poll(yaw).not.toBe(rest);
    await page.keyboard.press('o');
  });

  await test.step('the dialog is operated by keys, and is accessible', async () => {
    await afresh(page, { width: 390, height: 844 });
    await page.getByRole('button', { name: 'Save picture' }).focus();
    await page.keyboard.press('Enter');
    const dialog = page.getByRole('dialog', { name: 'Save the picture' });
    await expect(dialog).toBeVisible();
    expect((await scan(page)).violations).toEqual([]);
    await page.keyboard.press('Escape');
    await expect(dialog).toBeHidden();
    await expect(page.getByRole('button', { name: 'Save picture' })).toBeFocused();
  });
  await clean();
});

test('a sequence of pictures, and a film', { tag: '@all' }, async ({ page }) => {
  // Each of its 120 pictures is painted in four samples.
  const { clean } = await open(page, { width: 480, height: 360 });
  await test.step('a sequence can be given up', async () => {
    const dialog = await openDialog(page);
    await dialog.getByRole('combobox', { name: 'Motion' }).selectOption('Turntable');
    await dialog.getByRole('button', { name: 'Picture sequence' }).click();
    await page.getByRole('button', { name: 'Stop recording' }).click();
    await expect(page.getByRole('group', { name: 'Recording' })).toHaveCount(0);
    const { yaw } = (await state(page)).view.camera;
    await atRest(page);
    expect((await state(page)).view.camera.yaw).toBeCloseTo(yaw, 4);
  });

  await test.step('a sequence has a picture of full quality for every place of a parameter, which is put back', async () => {
    await afresh(page, { width: 480, height: 360 });
    const before = await report(page);
    const dialog = await openDialog(page);
    await dialog.getByRole('combobox', { name: 'Motion' }).selectOption('Parameter a');
    await dialog.getByRole('combobox', { name: 'Size' }).nth(1).selectOption({ label: 'HD, 1280\u202f×\u202f720' });
    await dialog.getByRole('combobox', { name: 'Length' }).selectOption('2\u202fs');
    const { name, bytes } = await fileOf(page, () => dialog.getByRole('button', { name: 'Picture sequence' }).click());
    expect(name).toMatch(/\.zip$/);
    const files = unzipSync(bytes);
    const names = Object.keys(files);
    expect(names).toHaveLength(60);
    expect([names[0], names[59]]).toEqual(['frame-0001.png', 'frame-0060.png']);
    // From the narrowest ellipsoid to the widest and back.
    const [first, middle] = await Promise.all([0, 30].map((i) => look(page, Buffer.from(files[names[i]]))));
    expect([first.width, first.height]).toEqual([1280, 720]);
    expect(middle.count).toBeGreaterThan(1.5 * first.count);
    await settled(page);
    expect((await state(page)).parameters).toEqual({});
    expect((await report(page)).digest).toBe(before.digest);
    // What moved by itself is no step of the history.
    await expect(page.getByRole('button', { name: 'Undo' })).toBeHidden();
  });

  await test.step('a film has the same pictures, each for a thirtieth of a second, however long it takes', async () => {
    await afresh(page, { width: 480, height: 360 });
    const before = await report(page);
    const dialog = await openDialog(page);
    await dialog.getByRole('combobox', { name: 'Motion' }).selectOption('Parameter a');
    await dialog.getByRole('combobox', { name: 'Length' }).selectOption('2\u202fs');
    const { bytes } = await fileOf(page, () => dialog.getByRole('button', { name: 'Make film' }).click());
    const film = await filmIn(bytes);
    expect(film.size).toEqual([1280, 720]);
    expect(film.times).toHaveLength(60);
    for (const [k, time] of film.times.entries()) expect(time).toBeCloseTo(k / 30, 2);
    expect(film.seconds).toBeCloseTo(2, 1);
    const [first, middle] = [
      await look(page, await pictureAt(page, film, 0)),
      await look(page, await pictureAt(page, film, 30)),
    ];
    expect([first.width, first.height]).toEqual([1280, 720]);
    expect(middle.count).toBeGreaterThan(1.5 * first.count);
    await settled(page);
    expect((await state(page)).parameters).toEqual({});
    expect((await report(page)).digest).toBe(before.digest);
  });
  await clean();
});
