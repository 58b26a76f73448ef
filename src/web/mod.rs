//! The bindings for JavaScript: newtypes that copy, nothing else.
//!
//! One source makes five bundles, each with a feature of its own: `core`, the sampler; `points`, what makes fields from files;
//! `lesson`, the paper's algorithms event by event, each of these in a worker of its own; `webgpu` and `webgl`, the renderer,
//! which lives on the main thread.

#[cfg(feature = "core")]
mod core;
#[cfg(feature = "core")]
pub use core::Core;

#[cfg(feature = "lesson")]
mod lesson;
#[cfg(feature = "lesson")]
pub use lesson::Lesson;

#[cfg(any(feature = "core", feature = "points", feature = "lesson"))]
mod values;

#[cfg(feature = "points")]
mod points;
#[cfg(feature = "points")]
pub use points::Points;

#[cfg(feature = "render")]
mod render;
#[cfg(feature = "render")]
pub use render::Renderer;
