//! What JavaScript sees: newtypes that copy, nothing else.
//!
//! One source makes five bundles. With the feature `render` it is the renderer (for WebGPU or for WebGL2), which lives on the
//! main thread; with `points`, what makes fields from files, and with `lesson`, the paper's algorithms event by event, each in a
//! worker of its own; with none of them the core, in another worker.

#[cfg(not(any(feature = "render", feature = "points", feature = "lesson")))]
mod core;
#[cfg(not(any(feature = "render", feature = "points", feature = "lesson")))]
pub use core::Core;

#[cfg(feature = "lesson")]
mod lesson;
#[cfg(feature = "lesson")]
pub use lesson::Lesson;

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
