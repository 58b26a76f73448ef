import { availableParallelism } from 'node:os';
import { defineConfig } from 'vitest/config';

// Tests in Node: plain modules (`tests/unit`), and the whole engine with the core that
// `cargo xtask wasm` has built (`tests/node`). What is more than the usual run: `tests/all.js`.
export default defineConfig({
  test: {
    include: ['tests/**/*.test.js'],
    environment: 'node',
    // Much of a test of the engine is waiting, so that a processor need not be left to the one who starts them.
    maxWorkers: availableParallelism(),
    // Limits are for what hangs. On a machine with much other work a test takes several times as long.
    testTimeout: 180_000,
    hookTimeout: 60_000,
    reporters: ['default', 'json'],
    outputFile: { json: 'test-results/node.json' },
  },
});
