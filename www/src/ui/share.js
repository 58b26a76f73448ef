/** Copies a link or exports a file. */

/** @typedef {import('../engine/types.js').Engine} Engine */
/** @typedef {import('./toasts.js').Toast} Toast */

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

/** Returns the name of a file, without its extension. @param {Engine} engine */
export function stem(engine) {
  const surface = engine.field.peek()?.surface ?? 'formula';
  return `${surface}-${engine.progress.peek().particles}`;
}

/** @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const url = URL.createObjectURL(blob);
  const link = document.createElement('a');
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
