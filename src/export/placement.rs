//! The placement of a mesh in a file: its scale, its unit of length and the axis that points up.

use super::MeshFormat;
use crate::particles::Particles;
use crate::quality::Measurements;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// Unit of length of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[non_exhaustive]
pub enum Unit {
    /// Millimetre.
    #[serde(rename = "mm")]
    Millimetre,
    /// Centimetre.
    #[serde(rename = "cm")]
    Centimetre,
    /// Metre.
    #[serde(rename = "m")]
    Metre,
    /// Inch.
    #[serde(rename = "in")]
    Inch,
}

impl Unit {
    /// Every unit with its symbol.
    pub const ALL: [(&str, Self); 4] =
        [("mm", Self::Millimetre), ("cm", Self::Centimetre), ("m", Self::Metre), ("in", Self::Inch)];

    /// Length of the unit in metres.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Centimetre => 1e-2,
            Self::Metre => 1.0,
            Self::Inch => 0.0254,
        }
    }

    /// Name of the unit in 3MF.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "millimeter",
            Self::Centimetre => "centimeter",
            Self::Metre => "meter",
            Self::Inch => "inch",
        }
    }
}

/// Axis of the formula's coordinates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum UpAxis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    #[default]
    Z,
}

impl UpAxis {
    /// Every axis with its name.
    pub const ALL: [(&str, Self); 3] = [("x", Self::X), ("y", Self::Y), ("z", Self::Z)];

    /// Permutes the coordinates of the formula so that this axis becomes z; this is exact.
    fn turned<T: Copy>(self, [x, y, z]: [T; 3]) -> [T; 3] {
        match self {
            Self::X => [y, z, x],
            Self::Y => [z, x, y],
            Self::Z => [x, y, z],
        }
    }
}

/// Size and orientation of a mesh in a file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(default)]
pub struct Placement {
    /// Length of a unit of the formula, in the unit of the file; positive.
    pub scale: f64,
    /// Unit of the file. 3MF names it, and for GLB lengths are converted to metres; other formats
    /// cannot express it. Without a unit, numbers are not converted: they mean metres in GLB,
    /// millimetres in 3MF.
    pub unit: Option<Unit>,
    /// Axis of the formula that points up in the file: along z, in GLB along y, as its
    /// specification requires.
    pub up: UpAxis,
}

impl Default for Placement {
    fn default() -> Self {
        Self { scale: 1.0, unit: None, up: UpAxis::Z }
    }
}

impl Placement {
    /// The particles and their measurements as placed in a file; none if they are unchanged.
    pub(crate) fn placed(
        &self,
        format: MeshFormat,
        particles: &Particles,
        measured: &Measurements,
    ) -> Option<(Particles, Measurements)> {
        let in_metres = self.unit.filter(|_| format == MeshFormat::Glb).map_or(1.0, Unit::metres);
        let scale = self.scale * in_metres;
        if scale == 1.0 && self.up == UpAxis::Z {
            return None;
        }
        let (mut particles, mut measured) = (particles.clone(), measured.clone());
        let length = |length: &mut f32| *length = (f64::from(*length) * scale) as f32;
        for p in &mut particles.local {
            *p = (DVec3::from_array(self.up.turned(p.as_dvec3().to_array())) * scale).as_vec3();
        }
        for n in &mut particles.normal {
            *n = Vec3::from_array(self.up.turned(n.to_array()));
        }
        particles.origin = DVec3::from_array(self.up.turned(particles.origin.to_array())) * scale;
        particles.radius.iter_mut().for_each(length);
        measured.nearest.iter_mut().for_each(length);
        measured.residual.iter_mut().for_each(length);
        Some((particles, measured))
    }
}
