/**
 * Opens a page in Firefox or WebKit as systems package them, which Playwright cannot drive.
 *
 * @module
 */
import { spawn } from 'node:child_process';
import { setTimeout as pause } from 'node:timers/promises';
import puppeteer from 'puppeteer-core';

/**
 * A page in a browser. `run` evaluates a function in the page, which sees nothing but its argument.
 * @typedef {object} Tab
 * @property {string} version
 * @property {(url: string) => Promise<void>} go
 * @property {(work: (given: any) => unknown, given?: unknown) => Promise<any>} run
 * @property {() => Promise<void>} close
 */

/** Time that a call into the page may take: software drawing on a busy machine is slow. */
const CALL_MS = 120_000;

/** Starts Firefox and connects to it by WebDriver BiDi. @param {string} executablePath @returns {Promise<Tab>} */
export async function firefox(executablePath) {
  const browser = await puppeteer.launch({
    browser: 'firefox',
    executablePath,
    headless: true,
    protocolTimeout: CALL_MS,
  });
  const page = await browser.newPage();
  return {
    version: await browser.version(),
    go: async (url) => void (await page.goto(url)),
    run: (work, given = null) => page.evaluate(work, /** @type {any} */ (given)),
    close: () => browser.close(),
  };
}

/** Port of WebKit's driver. */
const PORT = 4518;

/**
 * Starts WebKitGTK's small browser through its driver, which speaks W3C WebDriver over HTTP.
 * @param {string} driver  path of WebKitWebDriver
 * @param {string} binary  path of MiniBrowser
 * @returns {Promise<Tab>}
 */
export async function webkit(driver, binary) {
  // WebKit's sandbox cannot be set up as root, which is what containers of continuous integration run as.
  const env = { ...process.env, WEBKIT_DISABLE_SANDBOX_THIS_IS_DANGEROUS: '1' };
  const server = spawn(driver, [`--port=${PORT}`], { env, stdio: 'ignore' });
  /** @param {'POST' | 'DELETE'} method @param {string} path @param {object} [body] @returns {Promise<any>} */
  const ask = async (method, path, body) => {
    const request = { method, body: body && JSON.stringify(body), signal: AbortSignal.timeout(CALL_MS) };
    const answer = await fetch(`http://127.0.0.1:${PORT}${path}`, request);
    const { value } = await answer.json();
    if (!answer.ok) throw new Error(`${path}: ${value.error}: ${value.message}`);
    return value;
  };
  try {
    const options = { 'webkitgtk:browserOptions': { binary, args: ['--automation'] } };
    const wanted = { capabilities: { alwaysMatch: { browserName: 'MiniBrowser', ...options } } };
    const { sessionId, capabilities } = await patiently(() => ask('POST', '/session', wanted));
    const session = `/session/${sessionId}`;
    await ask('POST', `${session}/timeouts`, { script: CALL_MS });
    return {
      version: `WebKitGTK ${capabilities.browserVersion}`,
      go: (url) => ask('POST', `${session}/url`, { url }),
      async run(work, given = null) {
        const script = `const [given, end] = arguments;
          Promise.resolve(given).then(${work}).then((value) => end({ value }), (error) => end({ error: String(error) }));`;
        const { value, error } = await ask('POST', `${session}/execute/async`, { script, args: [given] });
        if (error) throw new Error(error);
        return value;
      },
      async close() {
        await ask('DELETE', session);
        server.kill();
      },
    };
  } catch (error) {
    server.kill();
    throw error;
  }
}

/** Repeats what fails while a server starts. @template T @param {() => Promise<T>} act @returns {Promise<T>} */
async function patiently(act) {
  for (let tries = 1; ; tries += 1) {
    try {
      return await act();
    } catch (error) {
      const isRefused = error instanceof TypeError;
      if (!isRefused || tries === 50) throw error;
      await pause(200);
    }
  }
}
