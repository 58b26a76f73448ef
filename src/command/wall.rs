//! The option `--wall` with `--size`: the thickness of a shell as a share of the mesh's longest
//! side. The side is known only after a run, so the thickness may need a correction.

use crate::arguments::{Length, SampleArguments};
use crate::failure::Failure;
use crate::surface::{fit, refused_solid};
use marching_particles::export::{Bodies, Unit};
use marching_particles::field::formula::Thickness;
use marching_particles::internal::session::{Session, SolidSettings, Source};
use marching_particles::{Bounds, Run, Settings};

/// Largest relative difference from the wanted wall that needs no correction: printers do not
/// resolve it.
const CLOSE: f64 = 5e-3;
/// Number of times the thickness is corrected for the size of the shell. A shell grows by at most
/// its thickness, so each correction reduces the difference to the wall's share of the longest
/// side.
const CORRECTIONS: u32 = 2;

impl SampleArguments {
    /// The wanted wall, as a length of the formula or as a share of the longest side.
    pub(crate) fn wall_share(&self) -> Option<WallShare> {
        let wall = self.wall?;
        Some(match self.size {
            Some(size) => WallShare::OfSide(wall.metres() / size.metres()),
            None => {
                let unit = self.unit.map_or(Unit::Millimetre, |(_, unit)| unit);
                WallShare::Length(wall.metres() / Length { value: self.scale, unit }.metres())
            }
        })
    }
}

/// How a wall is specified.
#[derive(Clone, Copy)]
pub(crate) enum WallShare {
    Length(f64),
    OfSide(f64),
}

/// The search for the thickness that gives the wanted wall.
pub(crate) struct Wall {
    share: WallShare,
    solid: SolidSettings,
    thickness: f64,
    corrections: u32,
}

impl Wall {
    /// Sets the session's thickness, assuming that the mesh is as long as the box.
    pub(crate) fn begin(
        session: &mut Session,
        solid: SolidSettings,
        share: WallShare,
        settings_in: &dyn Fn(&Bounds) -> Settings,
    ) -> Result<Self, Failure> {
        fit(session, settings_in, false)?;
        let side = session.answer().bounds.size().max_element();
        let mut wall = Self { share, solid, thickness: 0.0, corrections: 0 };
        wall.take(session, side)?;
        Ok(wall)
    }

    /// Sets the session's thickness for a mesh with this longest side.
    fn take(&mut self, session: &mut Session, side: f64) -> Result<(), Failure> {
        self.thickness = self.wanted(side);
        let solid = SolidSettings { thickness: Thickness::Number(self.thickness), ..self.solid.clone() };
        session.choose(solid.clone()).map_err(|fault| refused_solid(&solid, fault))
    }

    fn wanted(&self, side: f64) -> f64 {
        match self.share {
            WallShare::Length(length) => length,
            WallShare::OfSide(share) => share * side,
        }
    }

    /// Checks the mesh of the run. Returns whether another run is needed; then the session already
    /// has the new thickness.
    pub(crate) fn corrects(&mut self, session: &mut Session, kept: Bodies) -> Result<bool, Failure> {
        let Some(side) = longest_side(&session.run, kept).filter(|&side| side > 0.0) else {
            return Ok(false);
        };
        let is_close = (self.wanted(side) / self.thickness - 1.0).abs() <= CLOSE;
        if is_close || self.corrections == CORRECTIONS {
            return Ok(false);
        }
        self.corrections += 1;
        self.take(session, side)?;
        Ok(true)
    }
}

/// The longest side of the box around the chosen bodies of a run's mesh, once it is triangulated.
fn longest_side(run: &Run<'_, Source>, kept: Bodies) -> Option<f64> {
    let bodies = run.mesh()?.bodies(run.particles());
    Some(kept.size(&bodies).max_element())
}
