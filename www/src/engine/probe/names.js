/**
 * Tells by its name whether a renderer of WebGL is a program in place of a graphics card.
 *
 * @module
 */

/**
 * Names of such programs: of Chromium, Mesa, Windows and macOS. `Software` is in those of macOS and of VMware.
 */
const PROGRAMS = /swiftshader|llvmpipe|softpipe|lavapipe|swrast|basic render|software|paravirtual/i;

/** @param {string} name */
export const isProgram = (name) => PROGRAMS.test(name);
