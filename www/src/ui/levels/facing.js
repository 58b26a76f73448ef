/** From where a place of the surface is seen. Pure. */
import { clamp } from '../scale.js';

/** A place seen at less than this cosine counts as hidden. */
const FACING = 0.3;
/** From straight above or below the surface would lose its upright. */
const STEEPEST_RAD = 0.9;

/**
 * The angles of the camera that faces a normal, or null where it already does.
 * @param {{ yaw: number, pitch: number }} camera
 * @param {Iterable<number>} normal  of length 1
 */
export function facing({ yaw, pitch }, [x, y, z]) {
  const seen = x * Math.cos(yaw) * Math.cos(pitch) + y * Math.sin(yaw) * Math.cos(pitch) + z * Math.sin(pitch);
  if (!(seen < FACING)) return null;
  // The short way round.
  const way = Math.hypot(x, y) > 1e-3 ? Math.atan2(y, x) - yaw : 0;
  return {
    yaw: yaw + Math.atan2(Math.sin(way), Math.cos(way)),
    pitch: clamp(Math.asin(clamp(z, -1, 1)), -STEEPEST_RAD, STEEPEST_RAD),
  };
}
