// Types of the panel that follows a particle.
import type { LessonParticles } from '../../engine/types.js';
import type { Opened as Drawn, Moment } from '../../figures/types.js';
import type { Children } from '../types.js';
import type { childrenMark } from './mark.js';

export type { Follower } from './follower.js';
/**
 * The particle that is open. `picture` is the one of the picture for which it stands, with its distance; null after a
 * step to another one.
 */
export type Opened = Drawn & { picture: { index: number; distance: number } | null };
/** Makes the content of a view of a particle. */
export type ViewContent = (opened: Opened, moment: Moment) => Children;
export type Status =
  | { kind: 'running'; particles: number }
  | { kind: 'ready' }
  | { kind: 'too_many'; text: string; radius: number }
  | { kind: 'failed'; text: string };
/** The part of the picture's pen that is used here. */
export interface Pen {
  polygon: (places: readonly ArrayLike<number>[], kind: string) => boolean;
  text: (at: { x: number; y: number }, text: string, kind: string) => void;
}
/** A run and the surface that it belongs to. */
export interface FollowedRun {
  /** see {@link surfaceKey} */
  surface: string;
  /** the surface in words */
  words: string;
  pictureRadius: number;
  /** the radius of the picture, which the run has unless that would be too many; 1 with particles of many sizes */
  own: number;
  /** the radius; with particles of many sizes the factor by which they are larger than those of the law */
  radius: number;
  /** whether the particles have different radii */
  adaptive: boolean;
  /** all its particles */
  end: LessonParticles;
  /** how many of its first particles are those of the picture */
  alike: number;
}
export interface FollowOptions {
  /** tells what a link names and is not there */
  say: (text: string) => void;
  /** puts a mark on the picture */
  mount: (mark: ReturnType<typeof childrenMark>) => void;
}
