/** Constants that the engine and the interface share. */

/** Value of `State.surface` for a surface from a file. */
export const FILE_SURFACE = 'file';
/** Disc radius as a share of the repulsion radius. */
export const DISC_SIZE = { initial: 0.92, min: 0.2, max: 1.5, step: 0.01 };
/** File extensions that `openFile` reads, for the `accept` attribute of a file chooser. */
export const FILE_TYPES = '.ply,.obj,.stl,.xyz,.txt';
