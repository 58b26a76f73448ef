//! What JavaScript sees: newtypes that copy, nothing else.
//!
//! One source makes four bundles. With the feature `render` it is the renderer (for WebGPU or for WebGL2), which lives on the
//! main thread; with `points`, what makes fields from files, in a worker of its own; with neither the core, in another worker.

#[cfg(not(any(feature = "render", feature = "points")))]
mod core;
#[cfg(not(any(feature = "render", feature = "points")))]
pub use core::Core;

#[cfg(not(feature = "render"))]
mod values;

#[cfg(feature = "points")]
mod points;
#[cfg(feature = "points")]
pub use points::Points;

#[cfg(feature = "render")]
mod render;
#[cfg(feature = "render")]
pub use render::Renderer;
