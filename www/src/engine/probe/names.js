/**
 * Tells by a WebGL renderer's name whether it is software instead of a graphics card.
 *
 * @module
 */

/**
 * Names of software renderers in Chromium, Mesa, Windows and macOS. `Software` occurs in those of macOS and VMware.
 */
const PROGRAMS = /swiftshader|llvmpipe|softpipe|lavapipe|swrast|basic render|software|paravirtual/i;

/** @param {string} name */
export const isProgram = (name) => PROGRAMS.test(name);
