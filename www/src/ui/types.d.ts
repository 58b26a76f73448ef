// Types of the interface's parts: what elements are created from, and what panels share.

import type { ReadonlySignal } from '@preact/signals-core';
import type { IconName } from './icons.js';

/** A value, or a function of signals that is read anew after every change of them. */
export type Live<T> = T | (() => T);
export type Attribute = string | number | boolean | null | undefined;
export type Child = Node | string | number | null | undefined | false;
/** What an element holds; a function is read anew, and what it returned before is taken away. */
export type Children = Child | readonly Children[] | (() => Children);
type AttributeName =
  | `aria-${string}`
  | `data-${string}`
  | 'accept'
  | 'alt'
  | 'autocapitalize'
  | 'autocomplete'
  | 'autocorrect'
  | 'checked'
  | 'class'
  | 'cols'
  | 'colspan'
  | 'decoding'
  | 'disabled'
  | 'for'
  | 'height'
  | 'hidden'
  | 'href'
  | 'id'
  | 'inputmode'
  | 'lang'
  | 'loading'
  | 'max'
  | 'maxlength'
  | 'min'
  | 'name'
  | 'placeholder'
  | 'popover'
  | 'popovertarget'
  | 'readonly'
  | 'rel'
  | 'role'
  | 'rows'
  | 'scope'
  | 'selected'
  | 'spellcheck'
  | 'src'
  | 'start'
  | 'step'
  | 'tabindex'
  | 'title'
  | 'type'
  | 'value'
  | 'width';
type Listeners<E> = {
  [K in keyof HTMLElementEventMap]?: (event: HTMLElementEventMap[K] & { currentTarget: E }) => void;
};
/** What every element may be given besides attributes. */
export interface Given<E> {
  /** listeners of events */
  on?: Listeners<E>;
  /** properties of the object, set once its children are there */
  prop?: { [K in keyof E]?: Live<E[K]> };
  data?: Record<string, Live<Attribute>>;
  /** properties of CSS by their own names */
  style?: Record<string, Live<string | number>>;
}
export type Props<E> = Given<E> & { [K in AttributeName]?: Live<Attribute> };
export type SvgProps<E> = Given<E> & Record<string, unknown>;

export interface ButtonProps extends Props<HTMLButtonElement> {
  press?: () => void;
  /** in place of a text, which `aria-label` then gives */
  icon?: Live<IconName>;
  /** whether a press does nothing; the button can still be reached by the keyboard */
  off?: () => boolean;
}

/** Bars above the places. With `widths` a bar stands for so many places. */
export type Bars = { heights: ArrayLike<number>; widths?: ArrayLike<number> };
export interface Track {
  /** of a place, in the singular */
  name: string;
  /** whether there are places */
  some: ReadonlySignal<boolean>;
  /** the place that is shown */
  at: ReadonlySignal<number>;
  /** the last place; the first one is 0 */
  last: ReadonlySignal<number>;
  /** the place in words */
  text: ReadonlySignal<string>;
  /** the same for the eye: the number, and of how many */
  short: ReadonlySignal<[string, string]>;
  bars: ReadonlySignal<Bars>;
  /** whether all is shown, no place in particular */
  whole: ReadonlySignal<boolean>;
  show: (at: number) => void;
  /** to the next place or the one before; false if there is none */
  go: (by: 1 | -1) => boolean;
  /** places per second of playback, at its usual speed */
  perSecond: number;
}
/**
 * The panel that follows a particle, as the timeline knows it: its two tracks, and where it stands among the
 * levels.
 */
export interface FollowPanel {
  open: ReadonlySignal<boolean>;
  /** that of the particle that is open */
  level: ReadonlySignal<number | null>;
  /** the particle that is open, and its event */
  place: ReadonlySignal<[number, number] | null>;
  particles: Track;
  events: Track;
  /** follows a particle of the picture */
  follow: (index: number) => void;
  /** opens a particle of the run at an event */
  goTo: (place: [number, number]) => void;
  /** opens the first particle of a level */
  goToLevel: (level: number) => void;
  close: () => void;
  onKey: (listener: (event: KeyboardEvent) => void) => void;
}
