// The parts of the engine, as its own files know them.
import type { Framing } from './framing.js';
import type { ModelLoader } from './points/loader.js';
import type { Sampler } from './sampling/sampler.js';
import type { Store } from './store.js';
import type { BackendKind, Columns, Notices, State, Take } from './types.js';
import type { Viewer } from './view/viewer.js';

/** The parts of the engine, on which its commands act. */
export interface Parts {
  store: Store;
  columns: Columns;
  picture: Picture;
  sampler: Sampler;
  loader: ModelLoader;
  framing: Framing;
  /** takes over a whole valid state and samples it */
  adopt: (state: State) => void;
}
export interface Picture {
  viewer: Viewer;
  /** reports the particle under a point of the host, or null for none */
  hover: (index: number | null, x: number, y: number, tapped?: boolean) => void;
  /** what a press takes hold of */
  hand: { take: Take; notices: Notices };
  close: () => void;
}
export interface PictureOptions {
  host: HTMLElement;
  store: Store;
  columns: Columns;
  /** the back end to try first */
  first: BackendKind | null;
}
