// Types of the drawings of a particle.
import type { LessonEvent, LessonIterate, Vec3 } from '../engine/types.js';

export type Of<T extends LessonEvent['type']> = Extract<LessonEvent, { type: T }>;
/** A child as far as it is known. `fate` is `open` until it is decided; `particle` is the one that it became or met. */
export interface Child {
  slot: number;
  start: Of<'slot'> | null;
  iterates: Of<'iterate'>[];
  landed: Of<'landed'> | null;
  compared: Of<'compared'> | null;
  /** the way of an adaptive child in the tangent plane */
  pushes: (Of<'start'> | Of<'push'> | Of<'push_on_circle'>)[];
  /** the angle that an adaptive child takes, and the free one */
  room: Of<'room'> | null;
  fate: Of<'fate'>['fate'];
  particle: number | null;
}
export interface Moment {
  /** the one that is shown */
  event: LessonEvent;
  frame: Of<'frame'> | null;
  gathered: Of<'gathered'> | null;
  /** the free space that an adaptive child is placed in */
  arc: Of<'arc'> | null;
  /** by slot: six, and up to ten of an adaptive particle */
  children: Child[];
  /** the slot that was spoken of last; null before the first */
  slot: number | null;
  /** whether the event itself speaks of that slot */
  isNow: boolean;
  /** of f for this particle so far */
  evaluations: number;
}
/**
 * The drawing of a slot's plane. `section` is the curve f = 0 around the particle, `newton` the way of Newton's
 * method from the place at θ₀, `newtonDistance` that of its end from the particle if it is on the surface. The lens
 * is given in radii.
 */
export interface Profile {
  normal: Vec3;
  direction: Vec3;
  /** radius of the circle on which the child is looked for */
  reach: number;
  section: Float32Array;
  newton: LessonIterate[];
  newtonDistance: number | null;
  /** how far the landing lies beside the plane that is drawn, in radii */
  newtonAside: number;
  lens: { centre: Point; half: number; section: Float32Array } | null;
}
/** A particle with its events, and what its drawings show. */
export interface Opened {
  subject: Subject;
  place: Vec3;
  normal: Vec3;
  /** of all particles of the run */
  positions: Float32Array;
  normals: Float32Array;
  radii: Float32Array;
  /** from `taken` to `done`; none if it still waited at the end of the run */
  events: LessonEvent[];
  /** by slot */
  profiles: (Profile | null)[];
}
export type Point = [number, number];
/** Two perpendicular unit vectors at a particle, and its radius. */
export type Plane = { centre: ArrayLike<number>; right: ArrayLike<number>; up: ArrayLike<number>; radius: number };

/** Whose events are told. `parent` is null for a seed; `levels` is the last level of the run. */
/** `nameOf`: what particles are called, if not by their numbers. */
export type Subject = {
  particle: number;
  level: number;
  levels?: number;
  parent: number | null;
  radius: number;
  nameOf?: (particle: number) => string;
};
