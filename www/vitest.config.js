import { defineConfig } from 'vitest/config';

// Unit tests: plain modules in Node, no browser and no WebAssembly.
export default defineConfig({
  // Some hold a fast way to the plain definition over many cases: on a machine with other work that takes seconds.
  test: { include: ['tests/**/*.test.js'], environment: 'node', testTimeout: 30_000 },
});
