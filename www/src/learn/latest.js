/** Work of which the last that is asked for counts, as while a number is dragged. */

/**
 * Returns what asks for a job, and is fulfilled once nothing waits. While one is under way only the newest waits.
 * @template T
 * @param {(about: T, isOld: () => boolean) => Promise<void>} job  `isOld`: whether a newer one waits
 */
export function latest(job) {
  /** @type {{ about: T } | null} */
  let wanted = null;
  /** @type {Promise<void> | null} */
  let done = null;
  async function work() {
    try {
      while (wanted) {
        const { about } = wanted;
        wanted = null;
        await job(about, () => wanted !== null);
      }
    } finally {
      done = null;
    }
  }
  return (/** @type {T} */ about) => {
    wanted = { about };
    done ??= work();
    return done;
  };
}
