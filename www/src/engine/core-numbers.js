// The numbers by which the page reads the columns of the core. Written from the Rust constants by a
// test: UPDATE_GOLDEN=1 cargo test --lib page_types

/** Parent index of a seed. */
export const NO_PARENT = 4294967295;
/** Component of a particle that the report leaves out. */
export const NO_COMPONENT = 4294967295;
/** Largest number of slots of a particle, and the bits of each: slot `k` has those from `SLOT_BITS * k` on. */
export const MOST_SLOTS = 10;
export const SLOT_BITS = 3;
/** Bit of `slots` that is set where a singular point of the surface lies within 2r of the particle. */
export const SINGULAR = 1073741824;
/** Fates of a slot. */
export const FATE = { open: 0, parent: 1, added: 2, matched: 3, not_converged: 4, outside: 5, undefined: 6, capped: 7 };
