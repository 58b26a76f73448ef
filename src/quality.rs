//! How good a set of particles is.
