//! The option `--porosity`: finds the thickness of a shell and runs it; if the mesh leaves another
//! share of the box empty than wanted, corrects the thickness.

use crate::failure::Failure;
use crate::outcome::Porosity;
use crate::surface::{fit, refused_solid};
use marching_particles::field::formula::Thickness;
use marching_particles::internal::session::{FieldRequest, Session, SolidSettings, Source};
use marching_particles::{Bounds, Settings};

/// Largest difference from the wanted share that needs no correction.
const CLOSE: f64 = 1e-3;
/// Most corrections. The difference depends little on the thickness, so one correction is enough
/// except for coarse particles.
const CORRECTIONS: u32 = 2;

/// The search for the thickness with the wanted porosity.
pub(crate) struct Wish {
    wanted: f64,
    /// The share that the thickness is computed for: the mesh is another body than the shell.
    aim: f64,
    /// The solid. Its thickness is absent, or a formula to be scaled.
    solid: SolidSettings,
    /// The box that closes the solid.
    bounds: Bounds,
    corrections: u32,
    reached: Option<f64>,
}

impl Wish {
    /// Closes the session's surface by its box and sets the thickness for the wanted share. The box
    /// is fitted to the surface without the shell.
    pub(crate) fn begin(
        session: &mut Session,
        solid: SolidSettings,
        wanted: f64,
        settings_in: &dyn Fn(&Bounds) -> Settings,
    ) -> Result<Self, Failure> {
        if let Some(Thickness::Number(_)) = solid.thickened() {
            return Err(Failure::Usage(
                "--porosity finds the thickness: leave --thickness out, or give a formula such as \
                 \"0.1 + 0.05z\", which is scaled"
                    .into(),
            ));
        }
        let alone = SolidSettings { thickness: Thickness::default(), ..solid.clone() };
        session.choose(alone).map_err(|fault| refused_solid(&solid, fault))?;
        fit(session, settings_in, false)?;
        let bounds = session.answer().bounds;
        let request = FieldRequest { bounds: Some(bounds), ..FieldRequest::default() };
        session.set_field(&request).map_err(|fault| Failure::Usage(fault.message))?;
        let wish = Self { wanted, aim: wanted, solid, bounds, corrections: 0, reached: None };
        wish.take_thickness(session)?;
        Ok(wish)
    }

    /// Sets the session's thickness for the share `aim`.
    fn take_thickness(&self, session: &mut Session) -> Result<(), Failure> {
        let Source::Formula(surface) = session.run.field() else { return Ok(()) };
        let shape = self.solid.made_of(surface.clone(), None);
        let shell = shape.with_porosity(self.aim, &self.bounds);
        let shell = shell.map_err(|error| Failure::Usage(error.to_string()))?;
        let thickness = shell.thickness().cloned().unwrap_or_default();
        let solid = SolidSettings { thickness, ..self.solid.clone() };
        session.choose(solid).map_err(|fault| refused_solid(&self.solid, fault))
    }

    /// Takes the volume of the mesh, if it is closed. Returns whether another run is needed; then
    /// the session already has the new thickness.
    pub(crate) fn corrects(&mut self, session: &mut Session, volume: Option<f64>) -> Result<bool, Failure> {
        self.reached = volume.map(|volume| 1.0 - volume / self.bounds.size().element_product());
        let Some(reached) = self.reached else { return Ok(false) };
        let aim = self.aim + self.wanted - reached;
        let is_possible = aim > 0.0 && aim < 1.0;
        if (reached - self.wanted).abs() <= CLOSE || self.corrections == CORRECTIONS || !is_possible {
            return Ok(false);
        }
        (self.aim, self.corrections) = (aim, self.corrections + 1);
        self.take_thickness(session)?;
        Ok(true)
    }

    /// The wanted porosity, and the one of the last mesh.
    pub(crate) fn outcome(&self) -> Porosity {
        Porosity { wanted: self.wanted, reached: self.reached }
    }
}
