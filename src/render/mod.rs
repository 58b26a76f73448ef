//! Drawing particles as discs with wgpu, on WebGPU and WebGL2 from one source.
//!
//! The renderer sees slices of numbers and a camera matrix; it knows no field and no sampler.
//!
//! # How a disc is drawn
//!
//! * **Geometry.** One quad (a strip of four vertices) per particle, instanced. The vertex shader spans the tangent
//!   plane with an axis that faces the camera and one that foreshortens, and pads the quad by one pixel on the
//!   screen, so that the edge can be filtered even where the disc is seen edge-on. WebGL2 has no storage buffers in
//!   the vertex stage; instance buffers work on both back ends.
//! * **Edge.** The fragment shader turns the distance to the rim, in pixels, into coverage.
//! * **Order.** Coverage needs blending, and blending needs an order that a million particles do not have. So the
//!   discs are drawn in three passes: *cores* (fully covered pixels) with the depth test and depth writes, then *rims*
//!   (partly covered pixels) blended over them, tested against the depth but not writing it, first those of discs
//!   seen from behind, then the others. Discs of one sheet do not overlap, so that the order within a pass hardly
//!   matters. No multisampling, no sorting, no written fragment depth: the same picture everywhere, 256 steps of
//!   edge instead of the five of a 4× target.
//! * **Points.** When discs shrink to a pixel or two, the gaps between them would beat against the pixels. They swell
//!   until they touch; the core pass accepts pixels that are little covered and writes them a little too deep, and the
//!   rim passes blend all points over that. A pixel then shows the average of the points that it sees of the nearest
//!   sheet, and coverage fades with the size: steady under motion.
//! * **Colour.** Colours come in as sRGB, are lit and blended in linear light, and leave through an sRGB view.
//!
//! Layout, style and camera numbers are plain code that compiles and is tested without a GPU; everything that
//! touches wgpu needs the feature `render`.

pub mod layout;
pub mod pixels;
pub mod shaders;
pub mod style;
pub mod view;

#[cfg(feature = "render")]
mod painter;
#[cfg(feature = "render")]
mod pipelines;
#[cfg(feature = "render")]
mod renderer;
#[cfg(feature = "render")]
mod store;

#[cfg(feature = "render")]
pub use renderer::{Callbacks, CreateError, OnError, OnLost, Outcome, Picture, Renderer};
