//! libFuzzer calls [`marching_particles_fuzz::image`].

#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| marching_particles_fuzz::image(bytes));
