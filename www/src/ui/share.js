/** Copies a link or exports a file. */

import { FILE_SURFACE } from '../engine/constants.js';
import { givenOf } from '../engine/given.js';

/**
 * @import { Engine, FileRequest, Language, MeshFormat, ParticleFormat } from '../engine/types.js'
 * @import { Toast } from './types.js'
 */

/** @param {Engine} engine @param {Toast} toast */
export async function copyLink(engine, toast) {
  try {
    const url = await linkTo(engine);
    const { surface, lines } = engine.state.peek();
    if (surface === FILE_SURFACE) {
      const { name, holds } = givenOf(engine.field.peek()) ?? { name: 'a file', holds: 'points' };
      const held = `A link cannot hold the ${holds} of ${name}${lines.length > 0 ? ' and the edges marked on it' : ''}`;
      const text = `${held}: it shows the standard surface with these settings. Send the file along.`;
      toast({ id: 'share-file', kind: 'info', text });
    }
    history.replaceState(null, '', url);
    try {
      await navigator.clipboard.writeText(url);
      toast({ id: 'share', kind: 'info', text: 'Link copied.' });
    } catch {
      toast({ id: 'share', kind: 'info', text: 'The link is in the address bar.' });
    }
  } catch {
    toast({ id: 'share', kind: 'error', text: 'The link could not be made.' });
  }
}

/**
 * Copies a program that makes the same particles.
 * @param {Engine} engine @param {Toast} toast @param {Language} language @param {string} name  of the language
 */
export async function copyCode(engine, toast, language, name) {
  try {
    await navigator.clipboard.writeText(await engine.code(language));
    toast({ id: 'code', kind: 'info', text: `${name} code copied.` });
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    toast({ id: 'code', kind: 'error', text: `No code was copied: ${why}.` });
  }
}

/** Returns the page's address, which contains the whole state. @param {Engine} engine */
const linkTo = async (engine) => location.origin + location.pathname + (await engine.link());

/** @param {Engine} engine @param {Toast} toast @param {ParticleFormat} format */
export function exportFile(engine, toast, format) {
  const make = async () => engine.exportFile(format, { link: await linkTo(engine) });
  // The record's name is the one by which the command line finds it beside the file of particles.
  const ending = format === 'json' ? 'csv.json' : format;
  return exported(engine, toast, 'particles', make, `${stem(engine)}.${ending}`);
}

/**
 * @param {Engine} engine @param {Toast} toast
 * @param {MeshFormat} format @param {Pick<FileRequest, 'placement' | 'vertices'>} how
 */
export function saveMesh(engine, toast, format, how) {
  const make = async () => engine.exportMesh(format, { ...how, link: await linkTo(engine) });
  return exported(engine, toast, 'mesh', make, `${stem(engine)}-mesh.${format}`);
}

/**
 * @param {Engine} engine @param {Toast} toast
 * @param {string} what  in words
 * @param {() => Promise<Blob>} make
 * @param {string} name  of the file
 */
async function exported(engine, toast, what, make, name) {
  if (engine.result.peek() === 'none') {
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

/** Returns the name of a file without its extension. @param {Engine} engine */
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
