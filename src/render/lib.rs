//! Renderer of particles, as discs, as spheres or as the faces between them, on WebGPU, WebGL2 and
//! Vulkan through wgpu.
//!
//! The renderer takes columns of numbers and a camera matrix; it knows no field and no sampler.
//!
//! # How a disc is drawn
//!
//! * **Geometry.** Each particle is an instanced quad, a strip of four vertices. The vertex shader
//!   spans the tangent plane by an axis that is not foreshortened and one that is. It pads the quad
//!   by one pixel on the screen, so that the edge can be antialiased even if the disc is seen
//!   edge-on. The particles come from instance buffers, because WebGL2 has no storage buffers in
//!   the vertex stage.
//! * **Antialiasing.** The fragment shader computes the coverage of a pixel from its distance to
//!   the rim.
//! * **Order.** Coverage requires blending, and blending depends on the order of drawing, but
//!   sorting a million particles is too slow. The discs are therefore drawn in three passes. The
//!   first draws *cores*, fully covered pixels, with depth test and depth writes. Two more blend
//!   *rims*, partly covered pixels, over them with depth test but without depth writes: those of
//!   discs seen from behind, then the others. Discs of one sheet do not overlap, so the order
//!   within a pass hardly matters. There is no multisampling, no sorting and no fragment depth. The
//!   picture is the same on all devices, and an edge has 256 levels of coverage instead of the five
//!   of a 4× multisampled target.
//! * **Points.** When discs shrink to a pixel or two, the gaps between them would cause moiré. The
//!   discs are therefore enlarged until they touch. The core pass accepts pixels with little
//!   coverage and writes a slightly larger depth; the rim passes then blend all points of the
//!   nearest sheet. A pixel shows the average of the points in it, and coverage decreases with the
//!   size of a point, so that the picture is steady under motion.
//!
//! # How the body beneath the discs is drawn
//!
//! Between discs the far side of the surface and the background would show. Each particle is
//! therefore drawn a second time, before the discs: as a *bed*, a larger opaque disc in one quiet
//! tone. A bed lies a little behind its disc, along the normal and in depth, so that it does not
//! cut through the discs beside it, and it gets smaller towards the outline, where it would stick
//! out. Where a disc is so narrow on the screen that the gaps beside it fall between pixels, its
//! bed takes on its colour: grey in some of these pixels would show as dots. Beds need no mesh; the
//! body grows with the run. The body ends at the faces of the box and
//! at the cutting plane. Of a closed surface, beds seen from behind are left out. Particles that
//! are not shown yet, because only a part of the run is, have faint beds: the surface to come.
//!
//! # How a sphere is drawn
//!
//! A sphere is a disc that faces the eye, as large as its outline. The fragment shader finds where
//! the ray of the pixel meets the sphere, and writes that depth: spheres that touch cut each other
//! where they should. Core, rim and points are those of discs.
//!
//! # How a mesh is drawn
//!
//! * **Geometry.** Each face is an instanced triangle whose record repeats the three corners. A
//!   fragment then knows its barycentric coordinates and all corners, which indexed triangles could
//!   not tell it without storage buffers.
//! * **Edges** lie in the faces: a fragment's distance from a side in pixels is its barycentric
//!   coordinate over the slope of that. Each of two neighbours draws half of the line, which is as
//!   wide on the screen everywhere. Where faces are so small that lines would fill them, lines
//!   fade.
//! * **Marks** are dots around corners, in the faces as well. They lie on the surface and are cut
//!   off by it.
//! * **Silhouettes** are antialiased by four samples per pixel, for which the pipelines are
//!   compiled when the first faces are drawn.
//!
//! # How a surface takes light from itself
//!
//! The surface is darker where less of the light from all around reaches it. What is nearest to the
//! eye is drawn first, at every other pixel each way: its depth and its normal; discs are stood for
//! by their beds, in their places. A second pass finds the openness of each texel from 16 places
//! around it that rise above its tangent plane; a third one takes the mean of neighbours on the
//! same surface, in which the pattern of these places cancels out. Everything that is lit
//! multiplies its light by a share of it when it is drawn. Reach and darkness follow from the
//! picture alone, so that a frame in motion, one at rest and a larger picture are alike.
//!
//! # How a plane cuts
//!
//! A disc or sphere whose centre is beyond the cutting plane is not drawn, so that discs stay
//! whole. Faces are cut along the plane: their fragments beyond it are discarded, and those at the
//! edge cover as many of the pixel's samples as lie on the side that is shown.
//!
//! # Colour
//!
//! Colours are given in sRGB, lit and blended in linear light, and written through an sRGB view.
//!
//! # What it draws on
//!
//! The modules for chunks, layout, style and camera need no GPU. The renderer, behind the feature
//! `render`, needs a device and a texture to draw on. `Screen` opens a canvas of the page (features
//! `webgpu` and `webgl`), `OffScreen` a texture, natively (feature `vulkan`).

pub mod chunks;
pub mod frame;
pub mod layout;
pub mod pixels;
pub mod shaders;
pub mod style;
pub mod view;

#[cfg(feature = "render")]
mod gpu;
#[cfg(feature = "vulkan")]
mod off_screen;
#[cfg(feature = "render")]
mod painter;
#[cfg(feature = "render")]
mod pipelines;
#[cfg(feature = "render")]
mod renderer;
#[cfg(all(feature = "page", target_arch = "wasm32"))]
mod screen;
#[cfg(feature = "render")]
mod store;
#[cfg(all(feature = "page", target_arch = "wasm32"))]
pub mod web;

#[cfg(feature = "render")]
pub use gpu::{Callbacks, CreateError, OnError, OnLost};
#[cfg(feature = "vulkan")]
pub use off_screen::OffScreen;
#[cfg(feature = "render")]
pub use renderer::{Columns, Picture, Renderer};
#[cfg(all(feature = "page", target_arch = "wasm32"))]
pub use screen::{DrawOutcome, Screen};
