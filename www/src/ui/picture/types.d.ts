// Types of the pictures and films that are saved.
import type { Engine, Legend } from '../../engine/types.js';
import type { Course, Motion, Range, Toast } from '../types.js';

export type Context = OffscreenCanvasRenderingContext2D | CanvasRenderingContext2D;
/** The parts of a picture beside the surface. */
export interface Parts {
  legend: Legend | null;
  /** lines */
  caption: string[];
  colours: { ink: string; quiet: string };
}
/** The place of the parts and their size. */
export type Sheet = { context: Context; em: number; left: number; parts: Parts };
/** Shared by the section of pictures and that of films. */
export interface Shared {
  engine: Engine;
  page: { motion: Motion; toast: Toast };
  parts: () => Parts;
  transparent: HTMLInputElement;
  close: () => void;
}
/** A recording. */
export interface Wish {
  engine: Engine;
  size: { width: number; height: number };
  /** legend and caption of the present moment */
  parts: () => Parts;
  subject: Subject;
  /** its length, except where the user moves */
  seconds: number;
  /** ends the recording; a film keeps what it has */
  signal: AbortSignal;
  /** is told of the progress: of the whole, if that is known, and in seconds */
  tell: (share: number | null, seconds: number) => void;
}
/** The cause of the motion: the turntable, a parameter, or what the user does. */
export type Subject = { kind: 'turn' } | { kind: 'parameter'; range: Range; course: Course } | { kind: 'free' };
export type Size = { width: number; height: number };
