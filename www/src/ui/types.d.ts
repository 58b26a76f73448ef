// Types of the interface's parts: what elements are created from, and what panels share.

import type { ReadonlySignal, Signal } from '@preact/signals-core';
import type { Bounds, CameraState, Insets, Notice, Parameter, Shape, Vec3 } from '../engine/types.js';
import type { createDialog } from './dialog.js';
import type { createHistory } from './history.js';
import type { IconName } from './icons.js';
import type { createMotion } from './motion.js';

/** A value, or a function of signals that is read anew after every change of them. */
export type Live<T> = T | (() => T);
export type Attribute = string | number | boolean | null | undefined;
export type Child = Node | string | number | null | undefined | false;
/** The content of an element. A function is called again after every change, and its earlier result is removed. */
export type Children = Child | readonly Children[] | (() => Children);
type AttributeName =
  | `aria-${string}`
  | `data-${string}`
  | 'accept'
  | 'multiple'
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
/** Properties of every element besides its attributes. */
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

/** The longest side of a shell, and how many of its two ends no box cuts off. */
export type Span = { side: number; free: number };
/** A part to be printed; the functions read signals. */
export interface Print {
  /** its longest side in millimetres */
  sizeMm: Signal<number>;
  /** millimetres of a unit of the formula; null where there is nothing */
  scale: () => number | null;
  /** the wall in millimetres; 0 without a shell, null where its thickness is a formula */
  wall: () => number | null;
  /** the thickness that gives a wall of so many millimetres; null if none does */
  thickness: (wallMm: number) => number | null;
}
/** Does what puts another surface in the place of the present one, and names what ends with that. */
export type Replace = (act: () => void) => void;
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
export interface TableContent {
  /** an empty first word leaves the place over the names of the rows empty */
  head: readonly Child[];
  /** the first cell of a row is its name */
  rows: readonly (readonly Children[])[];
  caption?: string;
  class?: string;
}
/** The content of a chart. `first` is the number of the first place. */
export interface Drawn {
  kind: 'bars' | 'line';
  rows: { fate: string; name: string; counts: readonly number[] }[];
  first: number;
  /** the place that is shown, null for none of these */
  at: number | null;
  format: (value: number) => string;
  /** what stands below its ends, in place of the numbers of the places */
  ends?: string[];
  /** values of a dashed line, from the first place on */
  guide?: readonly number[];
  /** where the scale begins, if not at 0 */
  floor?: number;
  /** where the ideal is, as a share of the width */
  ideal?: number;
}
/** A state that can be restored: what is sampled and how, and from where it is seen. */
export type Moment = Shape & { camera: CameraState };
export type Dialog = ReturnType<typeof createDialog>;
export type Explanation = { title?: string; text: string; ideal?: string };
/** The preferred side of a popover, used if there is room. */
export type Side = 'below' | 'above' | 'left';
/** A panel with a `head` can be folded. */
/** A panel with a `head` can be folded to it; `folded`: it is on a first visit. */
export type Panel = { id: string; title: string; panel: HTMLElement; head?: HTMLElement; folded?: boolean };
export type Range = Pick<Parameter, 'name' | 'min' | 'max' | 'step'>;
/** `bounce`: to the end and back; `loop`: to the end, and again from the beginning. */
export type Course = 'bounce' | 'loop';
export type Motion = ReturnType<typeof createMotion>;
/** Places of the surface that are pulled or held; null unless the surface is to be grabbed. */
export type Pins = Signal<readonly Vec3[] | null>;
/** What the brush does to the spacing: it multiplies it by so much, or erases what is painted. */
export type BrushTimes = '0.25' | '0.5' | '2' | '4' | 'erase';
/** The brush: whether it is taken, and its radius as a share of the diagonal of the box. */
export type Brush = { on: Signal<boolean>; times: Signal<BrushTimes>; share: Signal<number> };
/** Which of them the pointer in the picture is; `marking`: whether a press marks an edge of a mesh. */
export type Hands = { pins: Pins; brush: Brush; marking: Signal<boolean> };
export interface Scale {
  min: number;
  max: number;
  /** the grid of values, 0 for none; on a logarithmic scale the factor of one key press, minus one */
  step: number;
  scale?: 'linear' | 'log';
  integer?: boolean;
}
/** `ctrl` requires Control or Command; `shift` then requires Shift or its absence. */
export type Shortcut = {
  keys: string[];
  shown: string;
  label: string;
  act: () => void;
  ctrl?: boolean;
  shift?: boolean;
};
export interface RangeOptions {
  /** the last place, from signals */
  max: () => number;
  /** the present place, from signals */
  at: () => number;
  /** the place in words, from signals */
  say: () => string;
  change: (place: number) => void;
  /** in place of the class of a slider */
  look?: string;
  id?: string;
  disabled?: () => boolean;
  'aria-label'?: string | (() => string);
}
export interface SliderOptions {
  /** accessible name */
  name: string;
  scale: Scale;
  /** or what reads it from signals, as long as the slider lasts */
  value: number | (() => number);
  /** returns the value in words, with its unit */
  describe: (value: number) => string;
  /** `live` during a drag */
  change: (value: number, live: boolean) => void;
  reset: () => void;
  /** false for a slider without a number box */
  number?: boolean;
  /** factor from the value to the number in the box, 100 for per cent */
  factor?: number;
  /** reads what is typed in the box; null for what is no number. By default it reads plain numbers */
  read?: (text: string) => Promise<number | null>;
}
export interface Slider {
  range: HTMLInputElement;
  box: HTMLInputElement | null;
  /** shows a value without calling `change` */
  set: (value: number) => void;
  setScale: (scale: Scale) => void;
}
export type FormulaSurface = { formula: string; parameters: Parameter[]; bounds: Bounds };
export type Toast = (notice: Notice) => void;
export interface ShortcutTargets {
  history: ReturnType<typeof createHistory>;
  motion: Motion;
  pins: Pins;
  brush: Brush;
  marking: Signal<boolean>;
  print: () => void;
  /** a key that is pressed before it has loaded acts as soon as it has */
  timeline: Promise<Record<'toggle' | 'back' | 'forward' | 'first' | 'all', () => void> | null>;
  /** hides or shows the panels */
  hide: () => void;
  /** opens the list of the shortcuts */
  open: () => void;
}
export interface LayoutOptions {
  shell: HTMLElement;
  view: HTMLElement;
  nav: HTMLElement;
  panels: Panel[];
  /** notices over the picture */
  notices: HTMLElement;
  /** pixels at the bottom of the view that something else than panels covers */
  covered: () => number;
  inset: (insets: Insets) => void;
}
export interface SelectOptions<T> {
  /** accessible name, where no label names it */
  name?: string;
  /** the choices, or a function of signals */
  choices: readonly Choice<T>[] | (() => readonly Choice<T>[]);
  /** the choice that is shown, from signals */
  value?: () => NoInfer<T>;
  change?: (value: T) => void;
  /** more classes */
  look?: string;
}
export type Choice<T> = { value: T; label: string };
export interface SegmentedOptions<T extends string> {
  /** accessible name */
  name: string;
  choices: readonly { value: T; label: string }[];
  /** the choice that is checked, from signals */
  value: () => NoInfer<T>;
  disabled?: () => boolean;
  /** may take its time */
  change: (value: T) => unknown;
}
