//! Draws particles as discs, as spheres or as the faces between them, on WebGPU, WebGL2 and Vulkan
//! through wgpu.
//!
//! The renderer takes columns of numbers and a camera matrix; it knows no field and no sampler.
//!
//! # How a disc is drawn
//!
//! * **Geometry.** Each particle is an instanced quad, a strip of four vertices. The vertex shader
//!   spans the tangent plane by two axes, one of them not foreshortened. It pads the quad by one
//!   pixel on the screen, so that the edge can be antialiased even if the disc is seen edge-on. The
//!   particles come from instance buffers, because WebGL2 has no storage buffers in the vertex
//!   stage.
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
//! Between discs one would see the far side of the surface and the background. Each particle is
//! therefore first drawn as a *bed*, a larger opaque disc in one quiet tone. A bed lies slightly
//! behind its disc, along the normal and in depth, so that it does not cut through neighbouring
//! discs, and it shrinks towards the outline, where it would stick out. Where a disc is so narrow
//! on the screen that the gaps next to it fall between pixels, its bed takes the disc's colour;
//! grey in some of these pixels would show as dots. Beds need no mesh, so the body grows with the
//! run. It ends at the faces of the box and at the cutting plane. On a closed surface, beds seen
//! from behind are not drawn. While only a part of the run is shown, later particles have faint
//! beds.
//!
//! # How a sphere is drawn
//!
//! A sphere is a disc that faces the eye and is as large as its outline. The fragment shader
//! intersects the pixel's ray with the sphere and writes the depth found, so that touching spheres
//! intersect correctly. Core, rim and points are those of discs.
//!
//! # How a mesh is drawn
//!
//! * **Geometry.** Each face is an instanced triangle whose record repeats the three corners. So a
//!   fragment knows its barycentric coordinates and all corners; with indexed triangles that would
//!   require storage buffers.
//! * **Edges** are drawn in the faces: a fragment's distance from a side, in pixels, is its
//!   barycentric coordinate divided by the slope of that coordinate. Each of two neighbours draws
//!   half of the line, whose width on the screen is constant. Where faces are so small that lines
//!   would fill them, lines fade.
//! * **Marks** are dots around corners, also drawn in the faces. They lie on the surface and end
//!   with it.
//! * **Silhouettes** are antialiased by four samples per pixel. Pipelines for these are compiled
//!   when the first faces are drawn.
//!
//! # How ambient occlusion is drawn
//!
//! The surface is darker where less of the light from all around reaches it. First the nearest
//! surface is drawn at half the resolution, as depth and normal; beds replace discs here. A second
//! pass estimates the openness of each texel from 16 points around it that rise above its tangent
//! plane. A third pass averages neighbours on the same surface, which cancels the pattern of these
//! points. When something lit is drawn, the openness dims its light. Reach and darkness depend only
//! on the picture, so that a moving frame, a still one and a larger picture look alike.
//!
//! # How a plane cuts
//!
//! A disc or sphere is hidden as a whole if its centre lies beyond the cutting plane. Faces are cut
//! along the plane: fragments beyond it are discarded, and fragments at the edge cover those
//! samples of the pixel that lie on the visible side.
//!
//! # Colour
//!
//! Colours are given in sRGB, lit and blended in linear light, and written through an sRGB view.
//!
//! # Targets
//!
//! The modules for chunks, layout, style and camera need no GPU. The renderer, behind the feature
//! `render`, needs a device and a texture to draw on. `Screen` opens a canvas of the page (features
//! `webgpu` and `webgl`), `OffScreen` a native texture (feature `vulkan`).

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
