import { defineConfig } from 'vite';

// Every address in the built page is relative, so `dist/` works at the root of a host and in any folder of one.
export default defineConfig({
  base: './',
  worker: { format: 'es' },
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
