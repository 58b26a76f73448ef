import { readdirSync, readFileSync } from 'node:fs';
import { expect, it } from 'vitest';

const sources = new URL('../../../src/', import.meta.url);

// What a script imports the development server would write into the page, whose policy forbids that.
it('every style comes through the one sheet that the page links', () => {
  const scripts = readdirSync(sources, { recursive: true, encoding: 'utf8' }).filter(
    (name) => name.endsWith('.js') && !name.startsWith('wasm/'),
  );
  expect(scripts).toContain('main/index.js');
  const importing = scripts.filter((name) =>
    /import\s*\(?\s*['"`][^'"`]*\.css/.test(readFileSync(new URL(name, sources), 'utf8')),
  );
  expect(importing).toEqual([]);

  const linked = readFileSync(new URL('styles/index.css', sources), 'utf8');
  for (const sheet of readdirSync(new URL('styles/', sources))) {
    if (sheet !== 'index.css') expect(linked).toContain(`@import './${sheet}';`);
  }
});
