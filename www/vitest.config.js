import { availableParallelism } from 'node:os';
import { defineConfig } from 'vitest/config';

// Tests in Node: plain modules (`tests/unit`), and the whole engine with the core that `cargo xtask wasm` has built (`tests/node`).
export default defineConfig({
  test: {
    include: ['tests/**/*.test.js'],
    environment: 'node',
    // Much of a test of the engine is waiting, so that a processor need not be left to the one who starts them.
    maxWorkers: availableParallelism(),
    // Some hold a fast way to the plain definition over many cases: on a machine with other work that takes seconds.
    testTimeout: 60_000,
    reporters: ['default', 'json'],
    outputFile: { json: 'test-results/node.json' },
  },
});
