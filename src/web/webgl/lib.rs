//! The bundle of the renderer on WebGL2.
#![cfg(target_arch = "wasm32")]

pub use marching_particles_render::web::Renderer;
