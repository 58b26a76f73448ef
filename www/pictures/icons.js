/**
 * Draws the icons of the installed page from the shape of public/favicon.svg: `npm run icons`.
 *
 * Writes public/icons/*.png. Systems that cut icons to a shape of their own (Android, iOS) get one on a ground.
 */
import { mkdir, readFile } from 'node:fs/promises';
import { fileURLToPath } from 'node:url';
import { launch } from './browser.js';

const folder = fileURLToPath(new URL('../public/', import.meta.url));
const svg = await readFile(`${folder}favicon.svg`, 'utf8');
await mkdir(`${folder}icons`, { recursive: true });
const browser = await launch();
// Name, size, and the share of it that the shape takes: 80 % of a maskable icon are sure to be seen.
for (const [name, px, share] of /** @type {[string, number, number][]} */ ([
  ['192', 192, 1],
  ['512', 512, 1],
  ['maskable', 512, 0.62],
  ['180', 180, 0.78],
])) {
  const page = await browser.newPage({ viewport: { width: px, height: px }, colorScheme: 'light' });
  const ground = share < 1 ? '#f2f4f6' : 'transparent';
  await page.setContent(
    `<style>body{margin:0;height:100vh;display:grid;place-items:center;background:${ground}}svg{width:${100 * share}vw}</style>${svg}`,
  );
  await page.screenshot({ path: `${folder}icons/${name}.png`, omitBackground: true });
  await page.close();
}
await browser.close();
