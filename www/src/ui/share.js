/** Copies a link, saves a picture or exports a file. */

/** @typedef {import('../engine/types.js').Engine} Engine */
/** @typedef {import('./toasts.js').Toast} Toast */

/** Width of a saved picture in pixels. Its height has the proportion of the window. */
const PICTURE_WIDTH_PX = 2400;

/** @param {Engine} engine @param {Toast} toast */
export async function copyLink(engine, toast) {
  try {
    const url = await engine.shareUrl();
    history.replaceState(null, '', url);
    try {
      await navigator.clipboard.writeText(url);
      toast({ id: 'share', kind: 'info', text: 'The link is on the clipboard.' });
    } catch {
      toast({ id: 'share', kind: 'info', text: 'The link is in the address bar.' });
    }
  } catch {
    toast({ id: 'share', kind: 'error', text: 'The link could not be made.' });
  }
}

/** @param {Engine} engine @param {Toast} toast */
export async function savePicture(engine, toast) {
  try {
    const height = Math.round((PICTURE_WIDTH_PX * innerHeight) / innerWidth);
    download(await engine.savePng({ width: PICTURE_WIDTH_PX, height }), `${stem(engine)}.png`);
  } catch {
    toast({ id: 'save', kind: 'error', text: 'The picture could not be drawn.' });
  }
}

/** @param {Engine} engine @param {Toast} toast @param {'ply' | 'csv'} format */
export const exportFile = (engine, toast, format) =>
  exported(engine, toast, 'particles', () => engine.exportFile(format), `${stem(engine)}.${format}`);

/** @param {Engine} engine @param {Toast} toast @param {import('../engine/types.js').MeshFormat} format */
export const exportMesh = (engine, toast, format) =>
  exported(engine, toast, 'mesh', () => engine.exportMesh(format), `${stem(engine)}-mesh.${format}`);

/**
 * @param {Engine} engine @param {Toast} toast
 * @param {string} what  in words
 * @param {() => Promise<Blob>} make
 * @param {string} name  of the file
 */
async function exported(engine, toast, what, make, name) {
  if (engine.empty.peek()) {
    toast({
      id: 'save',
      kind: 'info',
      text: 'There are no particles to export: the formula has no surface in the box.',
    });
    return;
  }
  try {
    download(await make(), name);
  } catch {
    toast({
      id: 'save',
      kind: 'error',
      text: `The ${what} could not be exported. Run the sampler again, then export.`,
    });
  }
}

/** @param {Engine} engine */
function stem(engine) {
  const surface = engine.field.peek()?.surface ?? 'formula';
  return `${surface}-${engine.progress.peek().particles}`;
}

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const url = URL.createObjectURL(blob);
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
