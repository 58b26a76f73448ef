import { defineConfig } from 'vitest/config';

// Unit tests: plain modules in Node, no browser and no WebAssembly.
export default defineConfig({
  test: { include: ['tests/**/*.test.js'], environment: 'node' },
});
