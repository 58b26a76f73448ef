//! `sample --print`: prints a program that makes the particles, instead of making them.

use crate::arguments::SampleArguments;
use crate::failure::Failure;
use crate::spacing::space;
use crate::surface::{choose, fit};
use marching_particles::field::model;
use marching_particles::internal::session::{Language, Session, SpacingText};
use std::io::Write;
use std::process::ExitCode;

pub(crate) fn print(
    arguments: &SampleArguments,
    spacing: Option<SpacingText>,
    language: Language,
) -> Result<ExitCode, Failure> {
    let surface = &arguments.surface;
    let id = surface.surface.as_deref();
    if surface.points.is_some() || id.is_some_and(|id| model::find(id).is_some()) {
        return Err(Failure::Usage("--print is for formulas, not for models from points".to_owned()));
    }
    let mut session = Session::without_surface();
    choose(&mut session, surface, arguments.quiet)?;
    space(&mut session, spacing)?;
    let settings_in = |bounds: &_| arguments.sampling.settings(bounds);
    let mut settings = fit(&mut session, &settings_in, false)?;
    let found = session.run.bounds();
    settings.bounds = surface.sampled.filter(|bounds| *bounds != found);
    if settings.bounds.is_none() && arguments.sampling.depends_on_box() {
        settings.bounds = Some(found);
    }
    session.start(&settings)?;
    let code = session.code(language, &arguments.values).map_err(Failure::Usage)?;
    std::io::stdout().write_all(code.text.as_bytes())?;
    Ok(ExitCode::SUCCESS)
}
