//! Small numeric building blocks that every other module may use: SIMD lanes, symmetric matrices, tangent
//! frames, boxes and the tolerances shared across the crate.

pub mod decimal;
pub mod functions;
mod lanes;

pub use lanes::{LANES, Lanes};

use glam::{DVec3, Vec3};

/// An axis-aligned box, in the field's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bounds {
    /// Smallest corner.
    pub min: [f64; 3],
    /// Largest corner.
    pub max: [f64; 3],
}

impl Bounds {
    /// The box centred on the origin with half-widths `half`.
    #[must_use]
    pub const fn symmetric(half: [f64; 3]) -> Self {
        Self { min: [-half[0], -half[1], -half[2]], max: half }
    }

    /// The box from `-half` to `half` on every axis.
    #[must_use]
    pub const fn cube(half: f64) -> Self {
        Self::symmetric([half; 3])
    }

    /// Smallest corner as a vector.
    #[must_use]
    pub fn lo(&self) -> DVec3 {
        DVec3::from_array(self.min)
    }

    /// Largest corner as a vector.
    #[must_use]
    pub fn hi(&self) -> DVec3 {
        DVec3::from_array(self.max)
    }

    /// Length of the space diagonal: the unit in which the paper gives its radii (§6).
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        (self.hi() - self.lo()).length()
    }

    /// Whether `p` lies in the closed box. Non-finite points do not.
    #[must_use]
    pub fn contains(&self, p: Vec3) -> bool {
        let p = p.as_dvec3();
        p.cmpge(self.lo()).all() && p.cmple(self.hi()).all()
    }

    /// Whether every corner is finite and every side has positive length.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        (0..3).all(|k| self.min[k].is_finite() && self.max[k].is_finite() && self.min[k] < self.max[k])
    }
}

/// A symmetric 3×3 matrix, by its upper triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sym3<T> {
    /// Entry (0, 0).
    pub xx: T,
    /// Entry (0, 1).
    pub xy: T,
    /// Entry (0, 2).
    pub xz: T,
    /// Entry (1, 1).
    pub yy: T,
    /// Entry (1, 2).
    pub yz: T,
    /// Entry (2, 2).
    pub zz: T,
}

impl Sym3<f64> {
    /// The matrix applied to `v`.
    #[must_use]
    pub fn apply(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }
}

impl Sym3<f32> {
    /// The matrix applied to `v`.
    #[must_use]
    pub fn apply(&self, v: Vec3) -> Vec3 {
        Vec3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }
}

/// Two unit vectors that span the plane perpendicular to the unit vector `n`; `(u, v, n)` is right-handed.
///
/// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017: no branch, no division by a small
/// number. A non-finite `n` gives non-finite vectors.
#[must_use]
pub fn tangent_frame(n: Vec3) -> (Vec3, Vec3) {
    let sign = 1.0_f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), Vec3::new(b, sign + n.y * n.y * a, -n.y))
}
