import { defineConfig } from 'vite';

/**
 * Has the built page ask for the core in its head, so that it comes at the same time as the scripts. The development server
 * needs no such thing.
 * @type {import('vite').Plugin}
 */
const preloadCore = {
  name: 'preload-core',
  apply: 'build',
  transformIndexHtml: {
    order: 'post',
    handler(_html, { bundle = {} }) {
      const core = Object.keys(bundle).filter((name) => /core_bg-[^/]*\.wasm$/.test(name));
      if (core.length !== 1) throw new Error(`one core expected in the site, not ${core.length}: ${core}`);
      // `fetch` takes what is preloaded only if the two agree in mode and credentials: hence `crossorigin`.
      const attrs = { rel: 'preload', as: 'fetch', type: 'application/wasm', href: `./${core[0]}`, crossorigin: true };
      return [{ tag: 'link', attrs, injectTo: 'head' }];
    },
  },
};

// Every address in the built page is relative, so `dist/` works at the root of a host and in any folder of one.
export default defineConfig({
  base: './',
  worker: { format: 'es' },
  plugins: [preloadCore],
  build: {
    outDir: '../dist',
    emptyOutDir: true,
    target: 'es2022',
    // Nothing is turned into a data: address: the page's content security policy allows none for code.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    // The renderer bundles are large by nature; `cargo xtask build` holds every file to its own budget.
    chunkSizeWarningLimit: 4096,
  },
  server: { strictPort: false },
});
