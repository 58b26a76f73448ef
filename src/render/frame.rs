//! The uniform block `Frame` of all shaders.
//!
//! The offsets follow the layout rules of WGSL for uniforms, which agree with std140 for these
//! types. A test compares them with the shaders.

use bytemuck::{Pod, Zeroable};

/// Uniform block that all pipelines of a picture share.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Frame {
    /// The camera.
    pub camera: Camera,
    /// Light and background.
    pub light: Light,
    /// Progress of the particles that are appearing, and the range of levels shown.
    pub appearance: Appearance,
    /// Sizes and shading of discs and faces.
    pub look: Look,
    /// The body beneath the discs.
    pub body: Body,
    /// The clip box, drawn where a picture has one.
    pub clip_box: ClipBox,
    /// Cutting plane: its normal and its offset. Points with normal · p > offset are hidden.
    /// Without a plane the normal is zero.
    pub plane: [f32; 4],
}

/// The camera, and the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Camera {
    /// Matrix from world to clip coordinates, column-major, with depth from 0 to 1.
    pub clip_from_world: [[f32; 4]; 4],
    /// Position of the eye in world coordinates, for a perspective camera.
    pub eye: [f32; 3],
    /// 1 for a perspective camera, 0 for an orthographic one.
    pub perspective: f32,
    /// Unit viewing direction in world coordinates.
    pub forward: [f32; 3],
    /// Target pixels per page pixel, the unit of line widths.
    pub pixel_ratio: f32,
    /// Width and height of the target in pixels.
    pub viewport: [f32; 2],
    /// The size of a struct in a uniform block is a multiple of 16 bytes.
    pub padding: [f32; 2],
}

/// Light and background.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Light {
    /// Unit direction to the key light, in world coordinates.
    pub key: [f32; 3],
    /// Fraction by which the whole picture fades to the background, 0 to 1.
    pub dim: f32,
    /// Unit direction to the sky of the hemispherical light, in world coordinates.
    pub sky: [f32; 3],
    /// Fraction by which back sides are drawn as an inside, 0 to 1.
    pub dim_backfaces: f32,
    /// Background colour, linear, not premultiplied by its opacity.
    pub background: [f32; 4],
    /// Fraction of the ambient occlusion that darkens the surface, 0 to 1.
    pub occlusion: f32,
    /// Difference in warmth between lit and shaded places, 0 to 1.
    pub warmth: f32,
    /// Light added along the outline.
    pub rim: f32,
    /// 1 for a light background, 0 for a dark one.
    pub light_ground: f32,
}

/// Fade-in of new particles, and the generation levels that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Appearance {
    /// Current time in seconds on the renderer's clock.
    pub time: f32,
    /// Duration in seconds of a new particle's appearance; 0 shows it at once.
    pub fade: f32,
    /// Newest generation level that is drawn; larger than every level if all are drawn.
    pub level: f32,
    /// Fraction by which levels before the newest fade to the background, 0 to 1.
    pub mute: f32,
}

/// Sizes and shading of discs and faces.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Look {
    /// Radius of a disc in repulsion radii.
    pub disc_scale: f32,
    /// 1 for flat faces, 0 for smooth ones.
    pub flat_faces: f32,
    /// Width of the edges of faces in page pixels; 0 for none.
    pub edge_px: f32,
    /// The size of a struct in a uniform block is a multiple of 16 bytes.
    pub padding: f32,
}

/// The body beneath the discs.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Body {
    /// Colour, linear.
    pub colour: [f32; 3],
    /// 1 for a surface whose inside can be seen, 0 for a closed one.
    pub is_open: f32,
    /// Smallest corner of the box where the body ends, and an unused number.
    pub lo: [f32; 4],
    /// Largest corner, and an unused number.
    pub hi: [f32; 4],
}

/// The clip box.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ClipBox {
    /// Smallest corner, and an unused number.
    pub lo: [f32; 4],
    /// Largest corner, and an unused number.
    pub hi: [f32; 4],
    /// Colour of the edges, linear, not premultiplied by its opacity.
    pub colour: [f32; 4],
}
