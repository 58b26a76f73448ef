/**
 * What the timeline goes along: a row of places, of which one is shown. Each of its grains is a track.
 *
 * @module
 */

/**
 * Bars above the places. With `widths` a bar stands for so many places.
 * @typedef {{ heights: ArrayLike<number>, widths?: ArrayLike<number> }} Bars
 */
/**
 * @template T
 * @typedef {import('@preact/signals-core').ReadonlySignal<T>} ReadonlySignal
 */
/**
 * @typedef {object} Track
 * @property {string} name  of a place, in the singular
 * @property {ReadonlySignal<boolean>} some  whether there are places
 * @property {ReadonlySignal<number>} at  the place that is shown
 * @property {ReadonlySignal<number>} last  the last place; the first one is 0
 * @property {ReadonlySignal<string>} text  the place in words
 * @property {ReadonlySignal<[string, string]>} short  the same for the eye: the number, and of how many
 * @property {ReadonlySignal<Bars>} bars
 * @property {ReadonlySignal<boolean>} whole  whether all is shown, no place in particular
 * @property {(at: number) => void} show
 * @property {(by: 1 | -1) => boolean} go  to the next place or the one before; false if there is none
 * @property {number} perSecond  places per second of playback, at its usual speed
 */

/**
 * The panel that follows a particle, as the timeline knows it: its two tracks, and where it stands among the levels.
 * @typedef {object} FollowPanel
 * @property {ReadonlySignal<boolean>} open
 * @property {ReadonlySignal<number | null>} level  that of the particle that is open
 * @property {ReadonlySignal<[number, number] | null>} place  the particle that is open, and its event
 * @property {Track} particles
 * @property {Track} events
 * @property {(index: number) => void} follow  follows a particle of the picture
 * @property {(place: [number, number]) => void} goTo  opens a particle of the run at an event
 * @property {(level: number) => void} goToLevel  opens the first particle of a level
 * @property {() => void} close
 * @property {(listener: (event: KeyboardEvent) => void) => void} onKey
 */

export {};
