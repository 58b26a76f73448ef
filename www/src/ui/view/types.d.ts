// Types of what lies over the picture.
import type { ReadonlySignal } from '@preact/signals-core';
import type { Bounds, Ray, Take } from '../../engine/types.js';
import type { Motion, Toast } from '../types.js';

export type Edges = { left: number; right: number; top: number; bottom: number };
/** in pixels of the picture */
export type Point = { x: number; y: number };
export interface Pen {
  begin: () => void;
  /** hides what was not drawn again */
  end: () => void;
  /** an outline through places; false if one of them is behind the eye */
  polygon: (places: readonly ArrayLike<number>[], kind: string) => boolean;
  line: (from: Point, to: Point, kind: string) => void;
  ring: (at: Point, radiusPx: number, kind: string) => void;
  text: (at: Point, text: string, kind: string, anchor?: 'start' | 'middle' | 'end') => void;
}
/**
 * An edge of the box in the picture, from its lower to its upper end, with those ends in space and the picture of the
 * box's centre.
 */
export type Edge = { from: Point; to: Point; ends: [number[], number[]]; centre: Point };
export interface HandleOptions {
  /** accessible name */
  name: string;
  /** class of the knob */
  kind: string;
  /** a drag begins */
  grab: (ray: Ray) => void;
  /** the pointer has moved; `fine` with Shift */
  drag: (ray: Ray, fine: boolean) => void;
  /** the drag has ended */
  drop: () => void;
  /** Escape was pressed during the drag */
  cancel: () => void;
  /**
   * arrow keys: 1 for right and up, −1 for left and down, ten times as many for page keys; null if a control elsewhere
   * does the same by keyboard
   */
  press: ((presses: number, fine: boolean) => void) | null;
}
/** A kind of mark. */
export interface Mark {
  /** whether there is something to draw; read in an effect */
  shown: () => boolean;
  /** called after every picture while it is shown */
  draw: (pen: Pen) => void;
  /** elements that the mark places itself */
  handles?: HTMLElement[];
  /** what a press on the picture takes hold of, if anything */
  take?: Take;
}
export interface OverlayParts {
  stage: HTMLElement;
  poster: HTMLElement;
  start: HTMLElement;
  /** describes the chosen generation level */
  told: ReadonlySignal<{ title: string; text: string } | null>;
}
/** The state of a run beside its progress. */
export interface CaptionFacts {
  partial: boolean;
  empty: boolean;
  busy: boolean;
  /** of the sampling or, with `steps` above 0, of so many relaxation steps after it */
  seconds: number | null;
  steps: number;
}
/** A drag of a face of the clip box. */
export interface FaceDrag {
  /** the box and the user's own box when the drag began */
  box: Bounds | null;
  own: Bounds | null;
  /** place of the pointer along the axis then */
  at: number | null;
  /** place of the face */
  value: number;
  moved: boolean;
}
export interface ToolbarOptions {
  hide: () => void;
  shortcuts: () => void;
  /** opens the dialog that takes the picture away */
  picture: () => void;
  /** makes a mesh and opens its panel */
  makeMesh: () => void;
  motion: Motion;
  toast: Toast;
}
