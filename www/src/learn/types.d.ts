// Types of the learn page: its runs, its pictures, its questions and its choices.
import type { LessonChapter, LessonProgress, LessonSettings } from '../engine/lesson/types.js';
import type { LessonClient, LessonEvent, LessonParticles } from '../engine/types.js';
import type { Palette } from '../engine/view/types.js';
import type { Point, Subject } from '../figures/types.js';
import type { ALGORITHM } from '../figures/words.js';
import type { FormulaSurface, Scale } from '../ui/types.js';
import type { Stops } from './answers.js';
import type { Lab } from './lab.js';

export type { Lab, Stops };

/** The controls of the bench that an assignment may lock: the surface, and the choices on the right. */
export type Control = 'on' | 'right';
/**
 * The comparison on the bench: values of the choices. `on`: the name of a surface of the gallery; that of the lesson if
 * it is empty.
 */
export type Setup = { on: string; left: string; right: string };
/** One of several choices that are made at once. Its values, or the range of its numbers. */
export interface Knob {
  name: string;
  values: readonly { value: string; label: string }[];
  scale?: Scale;
  set: (value: string) => Partial<LessonSettings>;
  /** what a value that is not that of the lesson does to the sampling */
  why: (value: string) => string;
}
/** What a value of the choices gives. */
export type Try = { value: string; run: LabRun; score: Score };
/** Two samplings that a card compares. */
export interface WhatIf {
  /** what to look for */
  look: string;
  colouring: Colouring;
  /** a figure that decides where the samplings cannot be told apart */
  decides?: keyof ScoreFigures;
  sides: readonly Side[];
}
export type Choices = readonly { value: string; label: string }[];
/**
 * What a question asks for. `choice`: one of several; `number`: a count. `F`: what is measured for the
 * answer.
 */
export interface Part<F> {
  /** empty where a question has one part */
  name: string;
  kind: 'choice' | 'number';
  /** above the part, where there are several */
  legend?: string;
  choices?: Choices;
  /** of the number */
  label?: string;
  /** largest number */
  most?: number;
  right: (facts: F) => string | number;
}
export interface Question<F> {
  question: string;
  /** the parts that are asked together; figures show more once the first round is over */
  rounds: readonly (readonly Part<F>[])[];
  /** measures what the answer needs */
  ask: (lab: Lab) => Promise<F>;
  /** what the answer says */
  words: (facts: F) => string[];
}
/** A sampling of a pair that is judged, with the name that it has once it was. */
export type JudgedSide = { name: string; settings: Partial<LessonSettings>; isAdaptive?: boolean };
/** `name`: of the surface; `isAlike`: whether the radii are chosen so that both have as many particles. */
export type Judged = {
  surface: FormulaSurface;
  name: string;
  sides: readonly [JudgedSide, JudgedSide];
  particles: number;
  isAlike?: boolean;
};
/**
 * What is said of a slot. `particle`: the one that holds it; of a new one, its number in the run.
 */
export type Verdict = { fate: 'matched' | 'added'; particle: number | null };
/**
 * A surface on which the learner is the algorithm. `isAtSeam`: where the front first meets itself;
 * `ends`: what is said at the end; `asks`: the question that is asked before the turn of the second particle, and
 * `waits`: what is said until then.
 */
export interface Patch {
  id: string;
  name: string;
  surface: FormulaSurface;
  radius: number;
  seed: [number, number, number];
  isAtSeam?: boolean;
  asks?: string;
  waits?: string;
  ends: string;
}
/**
 * What the run decides at a slot: after event `at`, told by event `end`. `met`: the front meets
 * itself there.
 */
export interface Decision {
  slot: number;
  at: number;
  end: number;
  compared: Extract<LessonEvent, { type: 'compared' }> | null;
  met: LessonEvent | null;
  verdict: Verdict;
}
/** A learner's guess and the answer of the run. */
export type Guessed = {
  stop: string;
  question: string;
  guess: string | number | null;
  right?: string | number;
  answer: string;
};
/** A place that is marked, if its side is in view. */
export interface Mark {
  place: ArrayLike<number>;
  /** where an arrow ends */
  to?: ArrayLike<number>;
  normal: ArrayLike<number>;
  radius: number;
  /** the ring is the empty circle of a hole itself */
  isHole?: boolean;
  kind: 'ring' | 'cross' | 'arrow';
}
/** What a run costs: for each particle, and in rounds. `others`: particles of the other method. */
export interface Cost {
  particles: number;
  others: number;
  rows: { name: string; evaluations: number; pushes: number; rounds: number }[];
}
/**
 * The content of a picture. `count`: the first so many particles; `colours`: one for each, of this
 * theme's palette.
 */
export interface Scene {
  particles: LessonParticles;
  /** those that the surface to come is made of; else the particles that are not drawn */
  body?: LessonParticles;
  count?: number;
  /** nothing of its inside can be seen: see {@link isClosed} */
  isClosed?: boolean;
  colours: (palette: Palette) => Uint32Array;
  marks?: readonly Mark[];
}
/**
 * A run that has come to its end. `placed` are the particles before the first relaxation step,
 * `end` those after the last; `placing` counts the evaluations of f until then.
 */
export interface LabRun {
  /** that of its surface */
  lab: Lab;
  /** closed if the run was not to be kept */
  client: LessonClient;
  settings: Partial<LessonSettings>;
  radius: number;
  chapters: LessonChapter[];
  progress: LessonProgress;
  placed: LessonParticles;
  end: LessonParticles;
  placing: number;
}
/** A hole or a pair: its middle or its two particles. `radius`: of the hole, or of a particle. */
export type ScorePlace = { places: readonly (readonly number[])[]; radius: number; normal: readonly number[] };
/** The figures that are compared; null where one is undefined. */
export type ScoreFigures = Record<
  'six' | 'hole' | 'uncovered' | 'pair' | 'count' | 'evaluations' | 'gap',
  number | null
>;
export type Score = ScoreFigures & {
  places: { hole: ScorePlace | null; pair: ScorePlace | null };
  /** number of neighbours of each particle */
  valence: Uint8Array;
};
/** One of them. */
export interface ScoreRow {
  key: keyof ScoreFigures;
  name: string;
  /** whether only files of a work have it, and tables where it is asked for */
  isRare?: boolean;
  /** null where there is none */
  ideal: number | null;
  /** the side of the ideal on which a value is worse; null if it is told, and not judged */
  worse: 'above' | 'below' | null;
  /** by how much it differs from seed to seed; none for what is not judged */
  chance?: (score: Score) => number;
  /** decimals that are written and compared */
  digits: number;
  write: (value: number) => string;
  /** a difference, if it is not written as a value */
  writeChance?: (value: number) => string;
}
/**
 * What a table of two scores says. `names`: of the two, if not those below the pictures; `keys`: the figures that
 * decide, in their order; `also`: rows that tables do not have else; `isMarked`: whether it says which is better.
 */
export interface ScoreWords {
  names?: readonly string[];
  keys?: readonly (keyof ScoreFigures)[];
  also?: readonly (keyof ScoreFigures)[];
  isMarked?: boolean;
}
/** The colouring of the two pictures. */
export type Colouring = 'level' | 'parent' | 'nearest' | 'radius' | 'none';
/** Discs that a picture is fitted to. */
export type Discs = Pick<LessonParticles, 'positions' | 'radii'>;
export type Side = { label: string; make: (lab: Lab) => Promise<LabRun> };
export type Task = { title: string; setup: Setup; locks: Control[]; questions: string[] };
/** The work that a learner hands in. */
export type Work = {
  assignment: string;
  surface: string;
  name: string;
  /** the class */
  group: string;
  answers: { question: string; answer: string }[];
  predictions: Guessed[];
  runs: object[];
};
export type Law = LessonSettings['law'];
/** The surface of the lesson. */
export type OwnSurface = { surface: FormulaSurface; isOwn: boolean; from: string; notice: string };
/** The input of a figure: the runs, the learner's answers, and the text from which pairs are drawn. */
export type Context = { lab: Promise<Lab>; stops: Stops; series: string };
/**
 * A slot in its plane, from p: places are (along V, along N). `bend` is that of the surface towards
 * the child, which landed on the circle at `child`, `section` the curve f = 0; `newton` are the
 * places of Newton's method, `landing` its distance from p, and `aside` how far beside the plane it
 * lies.
 */
export interface SlotCase {
  bend: number;
  radius: number;
  child: Point;
  newton: Point[];
  landing: number | null;
  aside: number;
  section: Float32Array;
}
/** A number in a sentence. */
export interface NumberOptions {
  name: string;
  scale: Scale;
  /** read anew whenever its signals change */
  value: () => number;
  say: (value: number) => string;
  change: (value: number) => void;
  /** the figure that follows the number, if it is not the one around it */
  stage?: () => HTMLElement | null;
}
export interface RangeRowOptions {
  name: string;
  max: number | (() => number);
  value?: number;
  /** returns a value in words */
  say: (value: number) => string;
  change: (value: number) => void;
}
export interface SelectRowOptions<T extends string> {
  name: string;
  choices: () => readonly { value: T; label: string }[];
  value: () => NoInfer<T>;
  change: (value: T) => void;
  isLocked?: boolean;
}
export interface StepsOptions {
  name: string;
  events: () => LessonEvent[];
  /** number of the event that is shown first */
  first: number;
  subject: () => Subject;
  lines?: typeof ALGORITHM;
  /** steps over either end */
  beyond?: (by: 1 | -1) => void;
}
export interface StopsOptions {
  /** ids of elements */
  stops: readonly string[];
  /** shows a comparison; without values, that of the best and the worst so far */
  onBench: (given: Partial<Setup>) => Promise<void>;
  /** loads what a class needs */
  teach: () => Promise<typeof import('./teach.js')>;
  /** says something at a stop, or at the top of the page */
  say: (words: string, place?: Element | null) => void;
}
