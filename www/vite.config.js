import { createHash } from 'node:crypto';
import { copyFileSync, cpSync, existsSync, mkdirSync, readdirSync, readFileSync, statSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import { build, defineConfig } from 'vite';
import { buildPackage } from './package/build.js';

/** @import { Plugin } from 'vite' */

/** Folder of the examples, here and on the site. */
const EXAMPLES = 'embed';

/** What the builds of both pages share. */
const SHARED = {
  target: 'es2022',
  // Nothing is turned into a data: address: the page's content security policy allows none for
  // code.
  assetsInlineLimit: 0,
  modulePreload: { polyfill: false },
};

/**
 * Has the built page ask for the core in its head, so that it comes at the same time as the
 * scripts. The development server needs no such thing.
 * @type {Plugin}
 */
const preloadCore = {
  name: 'preload-core',
  apply: 'build',
  transformIndexHtml: {
    order: 'post',
    handler(_html, { bundle = {} }) {
      const core = Object.keys(bundle).filter((name) => /core_bg-[^/]*\.wasm$/.test(name));
      if (core.length !== 1) throw new Error(`one core expected in the site, not ${core.length}: ${core}`);
      // `fetch` takes what is preloaded only if the two agree in mode and credentials: hence
      // `crossorigin`.
      const attrs = { rel: 'preload', as: 'fetch', type: 'application/wasm', href: `./${core[0]}`, crossorigin: true };
      return [{ tag: 'link', attrs, injectTo: 'head' }];
    },
  },
};

/**
 * Builds the lesson's page by itself: if the two pages were one build, what both use would become
 * files of their own, and the first page would wait for more of them.
 * @type {Plugin & {folder?: string}}
 */
const lessonPage = {
  name: 'lesson-page',
  apply: 'build',
  configResolved({ root, build: { outDir } }) {
    lessonPage.folder = resolve(root, outDir);
  },
  closeBundle: {
    sequential: true,
    async handler() {
      await build({
        configFile: false,
        logLevel: 'warn',
        base: './',
        worker: { format: 'es' },
        build: {
          ...SHARED,
          outDir: lessonPage.folder ?? '',
          emptyOutDir: false,
          copyPublicDir: false,
          rollupOptions: { input: [join('learn', 'index.html'), join('learn', 'cards', 'index.html')] },
        },
      });
    },
  },
};

/**
 * Puts the examples of the package on the site, under `embed/`, as they are: with the package
 * beside them, as a page without a bundler has it.
 * @type {Plugin & {folder?: string}}
 */
const examplesPage = {
  name: 'examples-page',
  apply: 'build',
  configResolved({ root, build: { outDir } }) {
    examplesPage.folder = resolve(root, outDir, EXAMPLES);
  },
  closeBundle: {
    sequential: true,
    async handler() {
      const folder = examplesPage.folder ?? '';
      cpSync(EXAMPLES, folder, { recursive: true });
      await buildPackage(join(folder, 'marching-particles'));
      mkdirSync(join(folder, 'three'), { recursive: true });
      for (const name of ['three.module.js', 'three.core.js'])
        copyFileSync(join('node_modules/three/build', name), join(folder, 'three', name));
    },
  },
};

/**
 * Has the development server wait for a bundle that is not there yet: `cargo xtask serve` builds
 * only the core and a renderer before the page is served.
 * @type {Plugin}
 */
const waitForBundles = {
  name: 'wait-for-bundles',
  apply: 'serve',
  enforce: 'pre',
  resolveId(id, importer = '', options) {
    if (!id.startsWith('.') || !id.includes('/wasm/')) return null;
    // The scan for packages to bundle ends at a file that is not there. Vite's types do not have
    // the option.
    if (/** @type {{scan?: boolean}} */ (options).scan) return { id, external: true };
    return join(dirname(importer), id);
  },
  async load(id) {
    const [file] = id.split('?');
    while (file.includes('/src/wasm/') && !existsSync(file)) await setTimeout(200);
    return null;
  },
};

/**
 * Name of the service worker's file. It must not change: browsers look for a new version under the
 * old name.
 */
const SERVICE_WORKER = 'service-worker.js';
/**
 * Has the development server answer with a worker that removes itself, for browsers that have kept
 * the built site's from the same port.
 * @type {Plugin}
 */
const noServiceWorker = {
  name: 'no-service-worker',
  apply: 'serve',
  configureServer({ middlewares }) {
    middlewares.use(`/${SERVICE_WORKER}`, (_request, response) => {
      response.setHeader('content-type', 'text/javascript');
      response.end(`addEventListener('install', () => skipWaiting());
addEventListener('activate', async () => {
  await registration.unregister();
  for (const client of await clients.matchAll()) client.navigate(client.url);
});`);
    });
  },
};

/**
 * Builds the service worker, with the list of all files of the site. Workbox keeps a file until its
 * revision changes; a name that Vite has made from the contents needs none.
 * @type {Plugin & {folder?: string}}
 */
const offline = {
  name: 'offline',
  apply: 'build',
  configResolved({ root, build: { outDir } }) {
    offline.folder = resolve(root, outDir);
  },
  closeBundle: {
    sequential: true,
    async handler() {
      const folder = offline.folder ?? '';
      const files = readdirSync(folder, { recursive: true, encoding: 'utf8' })
        .map((file) => file.replaceAll('\\', '/'))
        // The examples are for other pages: who opens them has a connection.
        .filter(
          (file) =>
            file !== SERVICE_WORKER && !file.startsWith(`${EXAMPLES}/`) && statSync(join(folder, file)).isFile(),
        )
        .sort();
      const revisionOf = (/** @type {string} */ file) =>
        createHash('sha256')
          .update(readFileSync(join(folder, file)))
          .digest('hex')
          .slice(0, 16);
      const manifest = files.map((url) => ({ url, revision: url.startsWith('assets/') ? null : revisionOf(url) }));
      await build({
        configFile: false,
        logLevel: 'warn',
        define: { 'import.meta.env.SITE_FILES': JSON.stringify(manifest), 'process.env.NODE_ENV': '"production"' },
        build: {
          outDir: folder,
          emptyOutDir: false,
          copyPublicDir: false,
          target: 'es2022',
          rollupOptions: {
            input: join('src', SERVICE_WORKER),
            output: { format: 'iife', entryFileNames: SERVICE_WORKER },
          },
        },
      });
    },
  },
};

// Every address in the built page is relative, so `dist/` works at the root of a host and in any
// folder of one.
export default defineConfig({
  base: './',
  worker: { format: 'es' },
  plugins: [preloadCore, lessonPage, examplesPage, offline, waitForBundles, noServiceWorker],
  build: {
    ...SHARED,
    outDir: process.env.SITE ?? '../dist',
    emptyOutDir: true,
    // The renderer bundles are large by nature; `cargo xtask build` holds every file to its own
    // budget.
    chunkSizeWarningLimit: 4096,
  },
  server: { strictPort: false },
  optimizeDeps: {
    // The pages that are served while developing. The examples are for the built site, where the
    // package that they import stands beside them: the scan for packages would not find it.
    entries: ['index.html', 'learn/index.html', 'learn/cards/index.html'],
  },
});
