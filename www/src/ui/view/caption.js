/** Returns the caption that describes the state of the run. */
import { formatCount, formatSeconds, formatShare, lastSteps, plural } from '../format.js';

/**
 * @import { Loading, Progress } from '../../engine/types.js'
 * @import { CaptionFacts } from './types.js'
 */

/** Returns the caption during a reveal. @param {{ level: number, particles: number }} reveal */
export const revealOf = ({ level, particles }) =>
  particles === 0 ? '' : `Level ${formatCount(level)} · ${plural(particles, 'particle')}`;

/** Returns the caption while a model or a file is loading. @param {Loading} loading */
export const loadingOf = ({ name, label, fraction }) => `${name} · ${label} · ${formatShare(fraction, 0)}`;

/** Where a run has stopped, after `Stopped`; empty if it placed nothing. @param {Progress} progress */
function placeOf({ level, refine_level: refined, refine_levels: most, relax_step: step, relax_steps: steps }) {
  if (step > 0) return ` after relaxation ${formatCount(step)} of ${formatCount(steps)}`;
  if (refined > 0) return ` refining, level ${formatCount(refined)} of ${formatCount(most)}`;
  return level > 0 ? ` at level ${formatCount(level)}` : '';
}

/**
 * @param {Progress} progress
 * @param {CaptionFacts} facts
 */
export function captionOf(progress, { partial, empty, busy, seconds, steps }) {
  const particles = plural(progress.particles, 'particle');
  switch (progress.phase) {
    case 'making':
      return busy ? `Making the field · ${formatShare(progress.fraction, 0)}` : resting();
    case 'seeding':
      return 'Looking for the surface';
    case 'generation':
      if (!busy) return resting();
      return progress.attempt > 1
        ? `Attempt ${formatCount(progress.attempt)}, level ${formatCount(progress.level)} · ${particles}`
        : `Level ${formatCount(progress.level)} · ${particles}`;
    case 'refinement':
      return busy
        ? `Refining, level ${formatCount(progress.refine_level)} of ${formatCount(progress.refine_levels)} · ${particles}`
        : resting();
    case 'search':
      return busy ? `Checking the components · ${particles}` : resting();
    case 'relaxation':
      return busy
        ? `Relaxation ${formatCount(progress.relax_step)} of ${formatCount(progress.relax_steps)} · ${particles}`
        : resting();
    case 'mesh':
      return `${particles} · making the mesh`;
    case 'quality':
      return `${particles} · measuring`;
    case 'done':
      return resting();
    default:
      return progress.particles > 0 ? resting() : '';
  }

  function resting() {
    if (empty) return '';
    if (progress.stop_reason === 'cap') return `Stopped at the limit · ${particles}`;
    if (partial || progress.stop_reason === 'cancelled') return `Stopped${placeOf(progress)} · ${particles}`;
    if (progress.particles === 0) return '';
    if (seconds === null) return particles;
    return `${particles} · ${formatSeconds(seconds)}${steps > 0 ? ` for ${lastSteps(steps)}` : ''}`;
  }
}
