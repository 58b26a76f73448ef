//! The solid that is made of the surface of a formula before it is sampled, and its box.

use crate::extent;
use crate::field::formula::{Formula, Thickness};
use crate::field::gallery::Surface;
use crate::math::Bounds;
use crate::sampler::SettingsError;
use core::ops::RangeInclusive;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Choice of the box in which the surface of a formula is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoxMode {
    /// A box that fits the surface, unless one is given. A surface of the gallery keeps its own.
    #[default]
    Fit,
    /// The given box, or the box of the surface that the formula began with.
    Fixed,
}

/// Treatment of the surface of a formula where the faces of the box cut it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoxFaces {
    /// The surface ends at the faces.
    #[default]
    Open,
    /// The faces close the solid f ≤ 0: see [`Formula::closed_by`].
    Closed,
}

/// Whether opposite faces of the box that closes a solid match.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoxCell {
    /// They need not: each face is sampled by itself.
    #[default]
    Lone,
    /// Opposite faces have the same particles and triangles along every axis on which the surface
    /// repeats: see [`Formula::repeated_in`].
    Periodic,
}

/// Where the surface of a model from points ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BeyondPoints {
    /// At the border of the points.
    #[default]
    Cut,
    /// Where the fitted function ends it, or the box.
    Kept,
}

/// Settings that act before a run: the box, and the solid that is made of the surface of a formula.
/// Only the last one applies to a model from points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SolidSettings {
    /// Choice of the box.
    pub box_mode: BoxMode,
    /// Treatment of the surface at the faces of the box.
    pub box_faces: BoxFaces,
    /// Whether opposite faces of the box match, if they close the solid.
    pub box_cell: BoxCell,
    /// Thickness of the shell that is sampled instead of the surface, in the units of the
    /// coordinates; 0 for the surface itself. See [`Formula::thickened_by`].
    pub thickness: Thickness,
    /// Where the surface of a model from points ends.
    pub beyond_points: BeyondPoints,
}

impl SolidSettings {
    /// Names of these settings. The page sends them together with the settings of a run.
    pub const NAMES: [&str; 5] = ["box_mode", "box_faces", "box_cell", "thickness", "beyond_points"];
    /// The values of a numeric [`SolidSettings::thickness`].
    pub const THICKNESSES: RangeInclusive<f64> = 0.0..=*Bounds::DIAGONALS.end();

    /// Checks that a numeric thickness is in its range.
    ///
    /// # Errors
    ///
    /// [`SettingsError::OutOfRange`] if it is not.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let (min, max) = Self::THICKNESSES.into_inner();
        match self.thickness {
            Thickness::Number(value) if !(min..=max).contains(&value) => {
                Err(SettingsError::OutOfRange { name: "thickness", value, min, max })
            }
            _ => Ok(()),
        }
    }

    /// The thickness of the shell, if there is one.
    #[must_use]
    pub fn thickened(&self) -> Option<&Thickness> {
        Some(&self.thickness).filter(|thickness| **thickness != Thickness::default())
    }

    /// The field of the solid that is made of the surface of `field`: the surface or the shell
    /// around it, closed by a box if one is given. A thickness that the surface cannot have is
    /// ignored.
    #[must_use]
    pub fn made_of(&self, field: Formula, closing: Option<&Bounds>) -> Formula {
        let mut solid = field.without_solid();
        if let Some(thickness) = self.thickened()
            && let Ok(shell) = solid.clone().thickened_by(thickness.clone())
        {
            solid = shell;
        }
        match closing {
            Some(bounds) if self.box_cell == BoxCell::Periodic => solid.repeated_in(bounds),
            Some(bounds) => solid.closed_by(bounds),
            None => solid,
        }
    }

    /// The box that closes the solid made of the surface of `field`: these bounds, or the unit cell
    /// in them, which may be moved if it `is_free`. None if the solid stays open.
    #[must_use]
    pub fn faces(&self, field: &Formula, bounds: Bounds, is_free: bool) -> Option<Bounds> {
        if self.box_faces == BoxFaces::Open {
            return None;
        }
        if self.box_cell == BoxCell::Lone || !is_free {
            return Some(bounds);
        }
        let solid = self.made_of(field.clone(), None);
        Some(extent::unit_cell(&solid, solid.surface_periods(), &bounds))
    }

    /// The box of a formula of the [gallery](crate::gallery), with its solid. None for another
    /// formula, and where the box is to be fitted: around a solid that a box closes, and around a
    /// shell whose thickness is a formula.
    pub(super) fn box_of(formula: &Formula) -> Option<Bounds> {
        let surface = formula.surface()?;
        let thickness = formula.thickness().cloned().unwrap_or_default();
        let is_fitted = surface.closed && matches!(thickness, Thickness::Formula(_));
        let is_own = formula.closing_box().is_none() && !is_fitted;
        is_own.then(|| Self { thickness, ..Self::default() }.box_around(&surface.bounds, surface.closed))
    }

    /// The box of a surface of the gallery. Around a surface that is closed without its box there
    /// is room for a shell of a numeric thickness.
    #[must_use]
    pub fn own_box(&self, surface: &Surface) -> Bounds {
        self.box_around(&surface.bounds, surface.closed)
    }

    /// [`SolidSettings::own_box`] of a surface with this box.
    fn box_around(&self, bounds: &Bounds, is_closed: bool) -> Bounds {
        let room = match self.thickness {
            Thickness::Number(thickness) if is_closed => DVec3::splat(0.5 * thickness),
            _ => DVec3::ZERO,
        };
        Bounds::new(bounds.lo() - room, bounds.hi() + room)
    }
}
