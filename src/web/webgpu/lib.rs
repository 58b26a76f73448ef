//! The bundle of the renderer on WebGPU.
#![cfg(target_arch = "wasm32")]

pub use marching_particles_render::web::Renderer;
