//! What JavaScript sees: newtypes that copy, nothing else.
//!
//! One source makes three bundles. Without the feature `render` it is the core, which lives in a worker; with it, the
//! renderer, which lives on the main thread.

#[cfg(not(feature = "render"))]
mod core;
#[cfg(not(feature = "render"))]
pub use core::Core;

#[cfg(feature = "render")]
mod render;
#[cfg(feature = "render")]
pub use render::Renderer;
