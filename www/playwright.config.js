import { existsSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { defineConfig } from '@playwright/test';
import { ALL } from './tests/all.js';

// The browser tests run against the built site (the folder SITE, else `dist/`), once at the root of a host and once in a
// folder of one. The Chromium is CHROMIUM_PATH, else the system's, the one without windows first, else Playwright's own.
const system = [process.env.CHROMIUM_PATH, '/usr/bin/chromium-headless-shell', '/usr/bin/chromium'];
const executablePath = system.find((path) => path && existsSync(path));

const quiet = [
  '--no-sandbox',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  // Without a crash reporter the browser without windows does not handle an access outside of wasm memory, and the page
  // crashes.
  '--enable-crash-reporter',
  // Every page compiles the modules anew, and few tests run long enough to win back the time of the optimising
  // compiler: a third of what a page takes until it is ready. Optimised code runs in the parity tests (Node), in
  // Firefox and in WebKit.
  '--js-flags=--liftoff-only',
];
// Software WebGPU and WebGL2; with fewer flags the graphics process fails on presenting while the API reports success.
const webgpu = [
  '--enable-unsafe-webgpu',
  '--use-webgpu-adapter=swiftshader',
  '--use-vulkan=swiftshader',
  '--enable-features=Vulkan',
  '--use-angle=swiftshader',
  '--ignore-gpu-blocklist',
];
/** Whether the one test that takes minutes runs, and no other. */
const SOAK = !!process.env.SOAK;
const port = Number(process.env.MARCHING_PARTICLES_TEST_PORT ?? 4517);

/** @param {string[]} args */
const chromium = (args) => ({
  browserName: /** @type {const} */ ('chromium'),
  launchOptions: { executablePath, args: [...quiet, ...args] },
});

export default defineConfig({
  testDir: 'tests/chromium',
  // The usual run is a visit to every part of the page; what is marked `@all` surveys them.
  grepInvert: ALL ? undefined : /@all/,
  testMatch: SOAK ? '**/soak.spec.js' : '**/*.spec.js',
  outputDir: 'test-results/chromium',
  forbidOnly: !!process.env.CI,
  // Limits are for what hangs. On a machine with much other work a test takes several times as long.
  timeout: 180_000,
  expect: { timeout: 60_000 },
  // A page for each processor. Much of a test is waiting for timers and frames, so two pages share a single one well.
  workers: Math.max(2, availableParallelism()),
  fullyParallel: true,
  // A test that passes only when it is repeated has a cause, which is to be found.
  retries: 0,
  reporter: [['list'], ['json', { outputFile: 'test-results/chromium.json' }]],
  use: {
    viewport: { width: 480, height: 360 },
    baseURL: `http://localhost:${port}/`,
    serviceWorkers: 'block',
    // A picture that grows level by level takes seconds. A test of motion asks for it by `emulateMedia`.
    contextOptions: { reducedMotion: 'reduce' },
  },
  webServer: {
    command: `node tests/server.js ${port}`,
    url: `http://localhost:${port}/`,
    // Another checkout's server would show another checkout's page.
    reuseExistingServer: false,
  },
  projects: [
    {
      name: 'webgl2',
      use: chromium([]),
      testIgnore: SOAK ? [] : '**/{*.{webgpu,canvas2d,contexts,large-type},soak}.spec.js',
    },
    { name: 'webgpu', use: chromium(webgpu), testMatch: '**/*.webgpu.spec.js' },
    {
      name: 'large-type',
      use: chromium(['--blink-settings=defaultFontSize=32']),
      testMatch: '**/*.large-type.spec.js',
    },
    { name: 'contexts', use: chromium(['--max-active-webgl-contexts=4']), testMatch: '**/*.contexts.spec.js' },
    { name: 'canvas2d', use: chromium(['--disable-3d-apis']), testMatch: '**/*.canvas2d.spec.js' },
  ].filter(({ name }) => !SOAK || name === 'webgl2'),
});
