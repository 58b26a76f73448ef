//! The bindings for JavaScript: newtypes that copy, nothing else.
//!
//! One source makes five bundles, each with a feature of its own: `page-core`, the sampler;
//! `page-points`, what makes fields from files; `page-lesson`, the paper's algorithms event by
//! event, each of these in a worker of its own; `webgpu` and `webgl`, the renderer, which lives on
//! the main thread.

#[cfg(feature = "page-core")]
mod core;
#[cfg(feature = "page-core")]
pub use core::Core;

#[cfg(feature = "page-lesson")]
mod lesson;
#[cfg(feature = "page-lesson")]
pub use lesson::Lesson;

#[cfg(any(feature = "page-core", feature = "page-points", feature = "page-lesson"))]
mod values;

#[cfg(feature = "page-points")]
mod points;
#[cfg(feature = "page-points")]
pub use points::Points;

#[cfg(feature = "page-render")]
mod render;
#[cfg(feature = "page-render")]
pub use render::Renderer;
