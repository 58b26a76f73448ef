/**
 * Defines the page's only trusted type: URLs of its own scripts, for the workers. The page never creates markup from
 * text, so everything else is rejected.
 */

/** @typedef {{ createPolicy(name: string, rules: object): unknown }} Factory */

const factory = /** @type {Factory | undefined} */ (/** @type {any} */ (globalThis).trustedTypes);
factory?.createPolicy('default', {
  /** @param {string} address */
  createScriptURL(address) {
    const url = new URL(address, document.baseURI);
    if (url.origin !== location.origin) throw new TypeError(`a script of another origin: ${url.origin}`);
    return url.href;
  },
});
