// The parts of the engine, as its own files know them.
import type { Framing } from './framing.js';
import type { PictureLike } from './sampling/types.js';
import type { Scheduler } from './scheduler.js';
import type { Store } from './store.js';
import type { BackendKind, Columns, FieldRequest, SampleKind, Settings, State, Take } from './types.js';
import type { Viewer } from './view/viewer.js';

/** The parts of the engine, on which its commands act. */
export interface Parts {
  store: Store;
  columns: Columns;
  picture: Picture;
  scheduler: Scheduler;
  framing: Framing;
  /** takes over a whole valid state and samples it */
  adopt: (state: State) => void;
}
export interface Picture {
  viewer: Viewer;
  /** reports the particle under a point of the host, or null for none */
  hover: (index: number | null, x: number, y: number, tapped?: boolean) => void;
  /** what a press takes hold of */
  hand: { take: Take };
  close: () => void;
}
/** `settings` in the place of the state's; `pulled` where the surface is pulled. */
export type RunOptions = { kind?: SampleKind; settings?: Settings; pulled?: Pulled };
/** Points that the surface is to pass through, and the parameters that are changed for it. */
export type Pulled = Required<Pick<FieldRequest, 'parameters' | 'pins'>>;
export interface PictureOptions {
  host: HTMLElement;
  store: Store;
  columns: Columns;
  /** the back end to try first */
  first: BackendKind | null;
}
export interface SchedulerOptions {
  store: Store;
  columns: Columns;
  picture: PictureLike;
  /** called when the core has loaded for the first time */
  onReady: () => void;
}
