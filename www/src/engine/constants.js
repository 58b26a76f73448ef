/** Constants that the engine and the interface share. */

/** Value of `State.surface` for a surface from a file. */
export const FILE_SURFACE = 'file';
/**
 * The name of the current model from points in a formula; alone, it is that model.
 */
export const MODEL = 'model';
/** Disc radius as a share of the repulsion radius. */
export const DISC_SIZE = { initial: 0.92, min: 0.2, max: 1.5, step: 0.01 };
/**
 * Largest number of particles for which every relaxation step is kept, animated and measured. Beyond it the positions
 * of ten steps take more than 2.4 MB, the uploads of an animation more than a frame, and measuring a step more than
 * some hundredths of a second.
 */
export const MOST_STEPPED = 20_000;
/**
 * Pause in typing after which a formula is sampled: 1.5 times the time between keys of a slow typist, 30 words a
 * minute.
 */
export const TYPING_MS = 600;
/** Largest number of parameters in a state or a link. */
export const MOST_PARAMETERS = 64;
/** Largest number of pulls on a surface. */
export const MOST_PULLS = 32;
/** Largest number of points of the lines along which edges of a mesh are marked; a link holds them. */
export const MOST_LINE_POINTS = 1000;
/** File extensions of points for `openFile`, in the form of a file chooser's `accept` attribute. */
export const FILE_TYPES = '.ply,.obj,.stl,.off,.glb,.3mf,.pcd,.xyz,.pts,.csv,.txt,.asc';
/** File extensions of triangle meshes, whose files may hold only points. */
export const MESH_TYPES = '.stl,.obj,.ply,.off,.glb,.3mf';
/** File extensions of three-dimensional images and of the data files of their headers. */
export const IMAGE_TYPES = '.nii,.nii.gz,.gz,.hdr,.img,.nrrd,.nhdr,.npy,.mha,.mhd,.raw,.zraw,.cube,.cub,.tif,.tiff';
