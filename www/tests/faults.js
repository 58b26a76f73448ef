/**
 * Faults of the sampler for tests: a script that a worker runs before its own. `strike` has the next call into the core
 * trap, overflow the stack or never return, and sees to it that there is one. A core that is still loading is spared
 * until it has loaded.
 */
(() => {
  /** @type {any} */
  const scope = globalThis;
  /** What is called while the core loads. */
  const Loading = /^(?!core_)|^core_(?:new|limit_memory|describe)$/;
  /** @typedef {'panic' | 'overflow' | 'hang'} Fault @type {Fault | null} */
  let pending = null;

  /** @param {any} core  the exports of its instance */
  function befall(core) {
    const fault = pending;
    pending = null;
    if (fault === 'hang') for (;;);
    // An object address far outside the memory traps on its first use and leaves the instance in the same state as a
    // panic.
    if (fault === 'panic') core.core_count(0x7ffffff0);
    if (fault === 'overflow') {
      /** @returns {number} */
      const deeper = () => 1 + deeper();
      deeper();
    }
  }

  const { instantiate } = scope.WebAssembly;
  scope.WebAssembly.instantiate = async (/** @type {unknown[]} */ ...given) => {
    const made = await instantiate(...given);
    const core = (made.instance ?? made).exports;
    if (!core.core_count) return made;
    const exports = Object.fromEntries(
      Object.entries(core).map(([name, value]) => [
        name,
        typeof value !== 'function' || Loading.test(name)
          ? value
          : (/** @type {unknown[]} */ ...parts) => {
              befall(core);
              return value(...parts);
            },
      ]),
    );
    const instance = Object.create(scope.WebAssembly.Instance.prototype, { exports: { value: exports } });
    return made.instance ? { ...made, instance } : instance;
  };

  scope.strike = (/** @type {Fault} */ fault) => {
    pending = fault;
    // A worker without a job calls the core for this.
    const placed = { positions: new Float32Array(0), normals: new Float32Array(0), radii: new Float32Array(0) };
    scope.onmessage?.({ data: { type: 'measure', request: 0, field: {}, placed, isAdaptive: false } });
  };
})();

export {};
