/**
 * The notices shown to the user when the sampler fails.
 *
 * @module
 */

/**
 * @import { Notice } from '../types.js'
 * @import { Crash, Job } from './types.js'
 */

/**
 * Returns the notice after the worker was replaced. Its run is repeated or abandoned.
 * @param {Crash} crash @param {Job | null} lost @param {{again: boolean, version: string}} context
 * @returns {Notice}
 */
export function restartNotice(crash, lost, { again, version }) {
  const what = crash.cause === 'hang' ? 'The sampler stopped answering' : 'The sampler stopped on an error';
  const harmless = again || !lost;
  const outcome = harmless ? 'Nothing was lost.' : 'The same input stopped it twice: change the formula or a setting.';
  return {
    id: crash.cause,
    kind: harmless ? 'warn' : 'error',
    text: `${what} and was restarted. ${outcome}`,
    details: crashReport(crash, lost, version),
  };
}

/**
 * @param {Crash} crash
 * @param {Job | null} lost
 * @param {string} version
 * @param {() => void} run
 * @returns {Notice}
 */
export const safeModeNotice = (crash, lost, version, run) => ({
  id: 'safe-mode',
  kind: 'error',
  text: 'The sampler failed four times within a minute and is now off. The picture, your formula and the exports stay.',
  details: crashReport(crash, lost, version),
  action: { label: 'Start it again', run },
});

/** @param {string} text @param {() => void} run @returns {Notice} */
export const loadNotice = (text, run) => ({
  id: 'load',
  kind: 'error',
  text,
  details: text,
  action: { label: 'Try again', run },
});

/** Returns the notice after the core refused the settings. @param {string} words @returns {Notice} */
export const refusalNotice = (words) => ({
  id: 'size',
  kind: 'error',
  text: `${words.charAt(0).toUpperCase()}${words.slice(1)}.`,
});

/**
 * Returns a crash report for the user to copy.
 * @param {Crash} crash
 * @param {Job | null} lost
 * @param {string} version  of the core
 */
function crashReport(crash, lost, version) {
  return [
    `Marching Particles ${version}: the sampler ${crash.cause === 'hang' ? 'stopped answering' : 'stopped on an error'}`,
    crash.message,
    crash.stack,
    `job: ${lost ? JSON.stringify(lost) : 'none'}`,
    `restarts in the last minute: ${crash.restarts}`,
    typeof navigator === 'undefined' ? '' : navigator.userAgent,
  ]
    .filter(Boolean)
    .join('\n');
}
