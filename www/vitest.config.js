import { defineConfig } from 'vitest/config';

// Tests in Node: plain modules, and the engine by itself with the core that `cargo xtask wasm` has built (`tests/alone`).
export default defineConfig({
  test: {
    include: ['tests/**/*.test.js'],
    environment: 'node',
    // Some hold a fast way to the plain definition over many cases: on a machine with other work that takes seconds.
    testTimeout: 60_000,
  },
});
