// Types of the panel of the surface: its editor, its gallery and its cutting plane.

import type { ReadonlySignal } from '@preact/signals-core';
import type { Description, FieldFault } from '../../engine/types.js';

/** `whole`: the text was pasted over all of the one before */
export type Change = (text: string, whole: boolean) => void;
export interface CodeEditorOptions {
  text: string;
  selection: { anchor: number; head: number };
  functions: Functions;
  /** returns the names of the formula's parameters */
  names: () => string[];
  change: Change;
  /** the text is complete */
  finish: () => void;
}
export interface FaultView {
  tone: 'hint' | 'fault';
  message: string;
  excerpt: { before: string; marked: string; after: string } | null;
  repairs: Repair[];
}
/** A surface that a text names. */
export type Meant = { id: string; name: string };
export type Repair = {
  label: string;
  declare?: string;
  /** the surface to show in the place of the formula */
  surface?: string;
  replace?: { start: number; end: number; text: string };
};
/** The interface of both editors. Offsets are UTF-16 code units. */
export interface Editor {
  element: HTMLElement;
  text: () => string;
  setText: (text: string) => void;
  replace: (start: number, end: number, text: string) => void;
  setFault: (fault: FieldFault | null, message: string) => void;
  selection: () => { anchor: number; head: number };
  focus: () => void;
  /** whether the editor itself marks the error */
  marks: boolean;
}
/** The signals on which the tiles depend. */
export interface Finding {
  /** that the search looks for */
  words: ReadonlySignal<readonly string[]>;
  /** the present surface */
  chosen: ReadonlySignal<string | null>;
  /** takes the surface of this id */
  choose: (id: string) => void;
}
export type Entry = {
  id: string;
  name: string;
  story: string;
  formula?: string;
  credit?: string;
  words?: string;
};
export type Functions = Description['functions'];
