/**
 * The only trusted type that the page makes: addresses of its own scripts, for the workers. Markup is never made from
 * text, so nothing else may pass.
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
