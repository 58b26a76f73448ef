//! Style of a picture, and the uniform block computed from style and camera.

use super::frame::{self, Appearance, Body, Camera, Frame, Light, Look};
use super::pixels::decode;
use super::view::View;

/// Style of a picture. Colours are sRGB with components from 0 to 1, opacity last.
///
/// Values out of range are clamped when the picture is drawn; NaN counts as the lower bound. The
/// ranges of lengths and times are wider than anyone needs: they only keep the shaders' results
/// finite and nonzero.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Background colour. The canvas is opaque, so the opacity has no effect there.
    pub background: [f32; 4],
    /// Shape in which particles are drawn.
    pub drawing: Drawing,
    /// Body beneath discs and spheres, which closes the gaps between them.
    pub body: Option<BodyStyle>,
    /// Whether spheres replace discs.
    pub spheres: bool,
    /// Radius of a disc or sphere in repulsion radii. At 1 the discs of a hexagonal packing touch;
    /// the default leaves gaps that make the order visible.
    pub disc_scale: f32,
    /// Direction to the key light in view coordinates: x right, y up, z towards the viewer. The
    /// default is the upper left, the convention of drawings.
    pub key_light_view: [f32; 3],
    /// Fraction by which the whole picture fades to the background, 0 to 1.
    pub dim: f32,
    /// Fraction by which discs and faces seen from behind look like an inside, darker and greyer, 0
    /// to 1.
    pub dim_backfaces: f32,
    /// Fraction of the ambient occlusion that darkens the surface, 0 to 1. With 0 it is not
    /// computed.
    pub occlusion: f32,
    /// Difference in warmth between lit and shaded places, 0 to 1. With 0 the light is white.
    pub warmth: f32,
    /// Duration in seconds of a new particle's appearance; 0 shows it at once. The default is a few
    /// frames, enough for the eye to notice.
    pub fade_s: f32,
    /// Newest generation level that is drawn. Later levels are hidden, earlier ones fade by `mute`.
    /// With `None` all levels are drawn alike.
    pub level: Option<u32>,
    /// Fraction by which earlier levels fade to the background, 0 to 1.
    pub mute: f32,
    /// Index of a particle with a ring around it.
    pub outline: Option<u32>,
    /// Clip box whose edges are drawn.
    pub clip_box: Option<ClipBoxStyle>,
    /// Plane beyond which particles and faces are hidden.
    pub plane: Option<CuttingPlane>,
    /// Canvas pixels per page pixel, the unit of line widths.
    pub pixel_ratio: f32,
}

/// Shape in which particles are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drawing {
    /// Particles are drawn as discs.
    #[default]
    Discs,
    /// Faces are drawn between the particles, and discs for newer particles that no face contains
    /// yet.
    Faces {
        /// Whether each face has one normal and one colour.
        flat: bool,
        /// Width of the edges in page pixels; 0 for none.
        edge_px: f32,
    },
}

/// The body: each particle as a larger disc slightly behind its own, faint if the particle is not
/// shown yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyStyle {
    /// Colour: sRGB, components from 0 to 1.
    pub colour: [f32; 3],
    /// Whether the inside of the surface can be seen. If not, the body's back sides are not drawn.
    pub is_open: bool,
    /// Smallest and largest corner of the surface's box, in world coordinates, where the body ends.
    pub bounds: [[f32; 3]; 2],
}

impl Default for BodyStyle {
    fn default() -> Self {
        Self { colour: [0.6; 3], is_open: true, bounds: [[f32::MIN; 3], [f32::MAX; 3]] }
    }
}

/// A box whose edges are drawn. The default is invisible.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClipBoxStyle {
    /// Smallest corner, in world coordinates.
    pub min: [f32; 3],
    /// Largest corner.
    pub max: [f32; 3],
    /// Colour of the edges: sRGB and opacity.
    pub colour: [f32; 4],
}

/// A plane that hides one side: particles by their centres, faces in part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CuttingPlane {
    /// Normal, of any length, in world coordinates. It points to the hidden side; a zero normal
    /// hides nothing.
    pub normal: [f32; 3],
    /// A point p is hidden if normal · p > offset.
    pub offset: f32,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            background: [0.98, 0.98, 0.98, 1.0],
            drawing: Drawing::Discs,
            body: None,
            spheres: false,
            disc_scale: 0.92,
            key_light_view: [-0.50, 0.72, 0.55],
            dim: 0.0,
            dim_backfaces: 1.0,
            occlusion: 0.0,
            warmth: 0.0,
            fade_s: 0.12,
            level: None,
            mute: 0.35,
            outline: None,
            clip_box: None,
            plane: None,
            pixel_ratio: 1.0,
        }
    }
}

/// Target of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureTarget {
    /// Size in pixels of the canvas for which the view was made.
    pub canvas: [u32; 2],
    /// Size of the target in pixels.
    pub size: [u32; 2],
    /// Current time in seconds on the renderer's clock.
    pub time: f32,
}

impl Style {
    /// Uniform block for a picture.
    #[must_use]
    pub fn frame(&self, view: &View, target: PictureTarget) -> Frame {
        let clamp = |v: f32, lo: f32, hi: f32| if v >= lo { v.min(hi) } else { lo };
        let share = |v: f32| clamp(v, 0.0, 1.0);
        let background = linear(self.background);
        let clip_box = self.clip_box.unwrap_or_default();
        let scale = target.size[1].max(1) as f32 / target.canvas[1].max(1) as f32;
        let (flat, edge_px) = match self.drawing {
            Drawing::Discs => (false, 0.0),
            Drawing::Faces { flat, edge_px } => (flat, edge_px),
        };
        let corner = |[x, y, z]: [f32; 3]| [x, y, z, 0.0];
        let is_light = luminance(background) > LIGHT_GROUND;
        let body = self.body.unwrap_or_default();
        let [r, g, b] = body.colour;
        let [r, g, b, _] = linear([r, g, b, 1.0]);
        let finite = |corner: [f32; 3], or: f32| corner.map(|c| if c.is_finite() { c } else { or });
        Frame {
            camera: Camera {
                clip_from_world: view.clip_from_world_for(target.canvas, target.size),
                eye: view.eye,
                perspective: if view.is_perspective() { 1.0 } else { 0.0 },
                forward: view.direction,
                pixel_ratio: clamp(self.pixel_ratio, 0.25, 8.0) * scale,
                viewport: target.size.map(|n| n.max(1) as f32),
                padding: [0.0; 2],
            },
            light: Light {
                key: view.world_from_view(self.key_light_view),
                dim: share(self.dim),
                sky: view.world_from_view([0.0, 1.0, 0.35]),
                dim_backfaces: share(self.dim_backfaces),
                background,
                occlusion: share(self.occlusion),
                warmth: share(self.warmth),
                rim: if is_light { 0.0 } else { RIM_LIGHT },
                light_ground: if is_light { 1.0 } else { 0.0 },
            },
            appearance: Appearance {
                time: target.time,
                fade: clamp(self.fade_s, 0.0, 10.0),
                level: self.level.map_or(ALL_LEVELS, |level| level as f32),
                mute: if self.level.is_some() { share(self.mute) } else { 0.0 },
            },
            look: Look {
                disc_scale: clamp(self.disc_scale, 0.01, 4.0),
                flat_faces: if flat { 1.0 } else { 0.0 },
                edge_px: clamp(edge_px, 0.0, 8.0),
                padding: 0.0,
            },
            body: Body {
                colour: [r, g, b],
                is_open: if body.is_open || self.plane.is_some() { 1.0 } else { 0.0 },
                lo: corner(finite(body.bounds[0], f32::MIN)),
                hi: corner(finite(body.bounds[1], f32::MAX)),
            },
            clip_box: frame::ClipBox {
                lo: corner(clip_box.min),
                hi: corner(clip_box.max),
                colour: linear(clip_box.colour),
            },
            plane: self.plane.map_or(NO_PLANE, CuttingPlane::uniform),
        }
    }
}

/// The uniform of a picture without a cutting plane.
const NO_PLANE: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

impl CuttingPlane {
    /// Normal and offset. A plane that is not finite hides nothing.
    fn uniform(self) -> [f32; 4] {
        let [x, y, z] = self.normal;
        let uniform = [x, y, z, self.offset];
        if uniform.iter().all(|c| c.is_finite()) && self.normal != [0.0; 3] { uniform } else { NO_PLANE }
    }
}

/// Larger than any level of 2³² particles.
const ALL_LEVELS: f32 = 1e10;

/// Luminance of a background on which black and white have equal contrast (WCAG 2: √(1.05 · 0.05) −
/// 0.05).
const LIGHT_GROUND: f32 = 0.179;

/// Light added along the outline to set it off from a dark background. On a light background its
/// shade does.
const RIM_LIGHT: f32 = 0.10;

/// Relative luminance of a linear colour.
fn luminance(linear: [f32; 4]) -> f32 {
    0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
}

/// Linear components of an sRGB colour (IEC 61966-2-1), clamped to 0 … 1; the opacity is only
/// clamped. NaN becomes 0.
#[must_use]
pub fn linear(srgb: [f32; 4]) -> [f32; 4] {
    let [r, g, b, a] = srgb.map(|c| if c >= 0.0 { c.min(1.0) } else { 0.0 });
    [decode(r), decode(g), decode(b), a]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_finite_whatever_the_style_says() {
        let nan = f32::NAN;
        let style = Style {
            background: [nan, -1.0, 2.0, nan],
            drawing: Drawing::Faces { flat: true, edge_px: nan },
            body: Some(BodyStyle {
                colour: [nan, -1.0, 2.0],
                is_open: true,
                bounds: [[nan; 3], [f32::INFINITY; 3]],
            }),
            spheres: false,
            disc_scale: nan,
            key_light_view: [nan; 3],
            dim: nan,
            dim_backfaces: -3.0,
            occlusion: nan,
            warmth: 7.0,
            fade_s: nan,
            level: Some(7),
            mute: nan,
            outline: None,
            clip_box: None,
            plane: Some(CuttingPlane { normal: [1.0, nan, 0.0], offset: 0.0 }),
            pixel_ratio: nan,
        };
        let target = PictureTarget { canvas: [0, 0], size: [0, 0], time: 0.0 };
        let frame = style.frame(&View::default(), target);
        assert!(bytemuck::cast_slice::<Frame, f32>(&[frame]).iter().all(|c| c.is_finite()), "{frame:?}");
        assert_eq!((frame.light.dim, frame.light.dim_backfaces, frame.appearance.mute), (0.0, 0.0, 0.0));
        assert!(frame.look.disc_scale > 0.0 && frame.look.edge_px == 0.0);
    }

    #[test]
    fn a_cutting_plane_hides_what_its_normal_points_to_and_none_hides_nothing() {
        let hides = |plane, p: [f32; 3]| {
            let style = Style { plane, ..Style::default() };
            let target = PictureTarget { canvas: [1, 1], size: [1, 1], time: 0.0 };
            let [x, y, z, offset] = style.frame(&View::default(), target).plane;
            x * p[0] + y * p[1] + z * p[2] > offset
        };
        let plane = |normal| Some(CuttingPlane { normal, offset: 0.5 });
        assert!(hides(plane([1.0, 0.0, 0.0]), [0.6, 9.0, 9.0]));
        assert!(!hides(plane([1.0, 0.0, 0.0]), [0.4, 9.0, 9.0]));
        for nothing in [None, plane([0.0; 3]), plane([0.0, f32::INFINITY, 0.0])] {
            assert!(!hides(nothing, [1e30, -1e30, 1e30]), "{nothing:?}");
        }
    }

    #[test]
    fn a_larger_picture_has_thicker_lines_and_the_same_camera() {
        let (style, view) = (Style::default(), View::default());
        let screen = style.frame(&view, PictureTarget { canvas: [640, 480], size: [640, 480], time: 0.0 });
        let print = style.frame(&view, PictureTarget { canvas: [640, 480], size: [1280, 960], time: 0.0 });
        assert_eq!(print.camera.pixel_ratio, 2.0 * screen.camera.pixel_ratio);
        assert_eq!(print.camera.clip_from_world, screen.camera.clip_from_world);
    }

    #[test]
    fn without_a_level_no_particle_is_hidden_or_muted() {
        let frame = |level| {
            let style = Style { level, ..Style::default() };
            style
                .frame(&View::default(), PictureTarget { canvas: [1, 1], size: [1, 1], time: 0.0 })
                .appearance
        };
        let (all, seventh) = (frame(None), frame(Some(7)));
        assert!(all.level > u32::MAX as f32 && all.mute == 0.0, "{all:?}");
        assert!(seventh.level == 7.0 && seventh.mute > 0.0, "{seventh:?}");
    }

    #[test]
    fn the_ground_is_called_light_where_black_contrasts_more() {
        let target = PictureTarget { canvas: [1, 1], size: [1, 1], time: 0.0 };
        for (grey, light) in [(0.0, 0.0), (0.3, 0.0), (0.5, 1.0), (1.0, 1.0)] {
            let style = Style { background: [grey, grey, grey, 1.0], ..Style::default() };
            assert_eq!(style.frame(&View::default(), target).light.light_ground, light, "grey {grey}");
        }
    }
}
