/** Work of which only the last request counts, such as while a number is dragged. */

/**
 * Returns a function that requests a job and resolves once nothing waits. During a job only the newest request waits.
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
