/** What closes a dialog, and what does not. */
import { expect, test } from '@playwright/test';
import { open } from './helpers.js';

test('a press beyond a dialog closes it, and none that begins or ends in it', { tag: '@all' }, async ({ page }) => {
  const { clean } = await open(page);
  await page.keyboard.press('?');
  const help = page.getByRole('dialog', { name: 'Help' });
  const { x, y, width, height } = (await help.boundingBox()) ?? { x: 0, y: 0, width: 0, height: 0 };
  const padding = { x: x + 4, y: y + height / 2 };
  const text = { x: x + width / 2, y: y + height / 2 };
  const beyond = { x: x - 20, y: y + height / 2 };
  for (const [from, to] of [
    [padding, padding],
    [text, beyond],
    [padding, beyond],
    [beyond, padding],
  ]) {
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(to.x, to.y, { steps: 3 });
    await page.mouse.up();
    await expect(help).toBeVisible();
  }
  await page.mouse.click(beyond.x, beyond.y);
  await expect(help).toBeHidden();
  await clean();
});
