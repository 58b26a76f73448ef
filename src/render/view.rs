//! Camera of the renderer: a matrix, an eye and a viewing direction.

use thiserror::Error;

/// A camera. In clip coordinates x points right, y points up and depth increases from 0 (near) to 1
/// (far), as in WebGPU.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Matrix from world to clip coordinates, column-major.
    pub clip_from_world: [f32; 16],
    /// Position of the eye in world coordinates, unused by an orthographic camera.
    pub eye: [f32; 3],
    /// Unit viewing direction in world coordinates, away from the eye.
    pub direction: [f32; 3],
}

/// Why numbers do not form a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// There are fewer numbers than a camera has.
    #[error("a view is 16 + 3 + 3 numbers, not {0}")]
    Length(usize),
    /// A number is NaN or infinite.
    #[error("number {0} of the view is not finite")]
    NotFinite(usize),
}

impl Default for View {
    /// Orthographic camera that looks along −z at the cube from −1 to 1.
    fn default() -> Self {
        let mut clip_from_world = [0.0; 16];
        clip_from_world[0] = 1.0;
        clip_from_world[5] = 1.0;
        clip_from_world[10] = -0.5;
        clip_from_world[14] = 0.5;
        clip_from_world[15] = 1.0;
        Self { clip_from_world, eye: [0.0, 0.0, 1.0], direction: [0.0, 0.0, -1.0] }
    }
}

impl View {
    /// Number of numbers that [`View::from_slice`] reads.
    pub const LEN: usize = 22;

    /// Camera from numbers: the matrix from world to clip coordinates (16, column-major), the eye
    /// (3) and the viewing direction (3). Further numbers are ignored.
    ///
    /// # Errors
    ///
    /// [`ViewError`] if the slice is too short or a number is not finite.
    pub fn from_slice(numbers: &[f32]) -> Result<Self, ViewError> {
        let numbers = numbers.get(..Self::LEN).ok_or(ViewError::Length(numbers.len()))?;
        if let Some(k) = numbers.iter().position(|c| !c.is_finite()) {
            return Err(ViewError::NotFinite(k));
        }
        let mut view = Self::default();
        view.clip_from_world.copy_from_slice(&numbers[..16]);
        view.eye.copy_from_slice(&numbers[16..19]);
        view.direction = unit([numbers[19], numbers[20], numbers[21]]).unwrap_or(view.direction);
        Ok(view)
    }

    /// Whether the projection is perspective: the last row of the matrix is not (0, 0, 0, w).
    #[must_use]
    pub fn is_perspective(&self) -> bool {
        [3, 7, 11].iter().any(|&k| self.clip_from_world[k] != 0.0)
    }

    /// The matrix for a target of size `to`, if the camera was made for size `from`. Everything
    /// visible at size `from` stays visible, and circles stay round.
    #[must_use]
    pub fn clip_from_world_for(&self, from: [u32; 2], to: [u32; 2]) -> [[f32; 4]; 4] {
        let aspect = |size: [u32; 2]| size[0].max(1) as f32 / size[1].max(1) as f32;
        let wider = aspect(to) / aspect(from);
        let (x, y) = if wider >= 1.0 { (1.0 / wider, 1.0) } else { (1.0, wider) };
        let mut columns = [[0.0; 4]; 4];
        for (k, column) in columns.iter_mut().enumerate() {
            let m = &self.clip_from_world[4 * k..4 * k + 4];
            *column = [x * m[0], y * m[1], m[2], m[3]];
        }
        columns
    }

    /// Converts direction `v` from view coordinates (x right, y up, z towards the viewer) to a unit
    /// vector in world coordinates. It points towards the viewer if `v` is zero or the camera is
    /// degenerate.
    #[must_use]
    pub fn world_from_view(&self, v: [f32; 3]) -> [f32; 3] {
        let m = &self.clip_from_world;
        let back = self.direction.map(|c| -c);
        let right = unit([m[0], m[4], m[8]]);
        let up = unit([m[1], m[5], m[9]]);
        let (Some(right), Some(up)) = (right, up) else { return back };
        unit(std::array::from_fn(|k| v[0] * right[k] + v[1] * up[k] + v[2] * back[k])).unwrap_or(back)
    }
}

/// `v` scaled to unit length; `None` if `v` is zero or not finite.
pub(super) fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (length > 0.0 && length.is_finite()).then(|| v.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(m: [[f32; 4]; 4], p: [f32; 3]) -> [f32; 2] {
        let row = |k: usize| m[0][k] * p[0] + m[1][k] * p[1] + m[2][k] * p[2] + m[3][k];
        [row(0) / row(3), row(1) / row(3)]
    }

    #[test]
    fn another_shape_keeps_the_picture_whole_and_round() {
        let view = View::default();
        for to in [[400, 400], [1600, 400], [300, 900]] {
            let m = view.clip_from_world_for([800, 800], to);
            let [x, y] = project(m, [1.0, 1.0, 0.0]);
            assert!(x <= 1.0 && y <= 1.0, "{to:?}: corner at {x}, {y}");
            let px = [x * to[0] as f32, y * to[1] as f32];
            assert!((px[0] - px[1]).abs() < 1e-3, "{to:?}: {px:?}");
            assert!(x.max(y) > 0.999, "{to:?}: the picture is smaller than it could be");
        }
    }

    #[test]
    fn bad_cameras_are_refused() {
        assert_eq!(View::from_slice(&[0.0; 21]), Err(ViewError::Length(21)));
        let mut numbers = [0.5; 23];
        numbers[7] = f32::NAN;
        assert_eq!(View::from_slice(&numbers), Err(ViewError::NotFinite(7)));
        numbers[7] = 0.0;
        assert!(View::from_slice(&numbers).is_ok());
    }

    #[test]
    fn view_axes_become_world_axes() {
        let view = View::default();
        assert!(!view.is_perspective());
        assert_eq!(view.world_from_view([2.0, 0.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_eq!(view.world_from_view([0.0, 3.0, 0.0]), [0.0, 1.0, 0.0]);
        assert_eq!(view.world_from_view([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
        assert_eq!(view.world_from_view([0.0; 3]), [0.0, 0.0, 1.0]);
    }
}
