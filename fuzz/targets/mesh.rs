//! libFuzzer calls [`marching_particles_fuzz::mesh`].

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| marching_particles_fuzz::mesh(bytes));
