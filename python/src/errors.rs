//! Converts errors of the core to exceptions of Python.

use marching_particles::Error;
use marching_particles::field::FieldError;
use marching_particles::field::formula::{FormulaError, FormulaErrorKind, Thickness};
use marching_particles::internal::session::{Condition, Fault, FaultKind, SolidSettings};
use marching_particles::pointcloud::JobError;
use marching_particles::run::ValueError;
use marching_particles::sampler::{FollowError, SettingsError};
use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;

/// The exceptions of the package, which its Python half defines.
mod python {
    use pyo3::import_exception;

    import_exception!(marching_particles._errors, CannotFollow);
    import_exception!(marching_particles._errors, EmptySurface);
    import_exception!(marching_particles._errors, FieldError);
    import_exception!(marching_particles._errors, FormulaError);
}

/// The exception of a formula. Python counts characters where Rust counts bytes.
pub(crate) fn of_formula(error: &FormulaError, text: &str) -> PyErr {
    let characters = |byte: usize| text.get(..byte).map_or(0, |before| before.chars().count());
    // A parameter has no place in the text.
    let has_place = error.kind != FormulaErrorKind::BadParameter;
    let span = has_place.then(|| (characters(error.span.start), characters(error.span.end)));
    let choices = error.choices.to_vec();
    python::FormulaError::new_err((
        error.message.clone(),
        text.to_owned(),
        span,
        error.suggestion.clone(),
        choices,
    ))
}

/// The exception for a session's refusal of a thickness formula or of a setting.
pub(crate) fn of_fault(fault: &Fault, solid: &SolidSettings) -> PyErr {
    match &solid.thickness {
        Thickness::Formula(text) => of_text(fault, text),
        Thickness::Number(_) => PyValueError::new_err(fault.message.clone()),
    }
}

/// The exception of the formula of a spacing.
pub(crate) fn of_spacing(fault: &Fault, text: &str) -> PyErr {
    match fault.kind {
        FaultKind::Settings => PyValueError::new_err(fault.message.clone()),
        _ => of_text(fault, text),
    }
}

pub(crate) fn of_text(fault: &Fault, text: &str) -> PyErr {
    // Python counts characters where the session counts UTF-16 code units.
    let characters = |unit: u32| {
        let before: Vec<u16> = text.encode_utf16().take(unit as usize).collect();
        String::from_utf16_lossy(&before).chars().count()
    };
    let span = Some((characters(fault.start), characters(fault.end)));
    let choices = fault.choices.to_vec();
    python::FormulaError::new_err((
        fault.message.clone(),
        text.to_owned(),
        span,
        fault.suggestion.clone(),
        choices,
    ))
}

/// The exception of an argument that has no effect with the others.
pub(crate) fn without_effect(argument: &str, condition: Condition) -> PyErr {
    let needed = match (condition.name, condition.value, condition.equal) {
        ("sampling", "adaptive", _) => "without adaptive=True",
        ("sampling", ..) => "with adaptive=True",
        ("size_mode", ..) => "beside count",
        ("box_faces", ..) => "without closed=True",
        (_, _, true) => "without law=\"chord_error\"",
        (_, _, false) => "without law=\"max_curvature\" or \"sum_of_curvatures\"",
    };
    PyValueError::new_err(format!("{argument} has no effect {needed}"))
}

/// The exception of a run.
pub(crate) fn of_run(error: &Error) -> PyErr {
    match error {
        Error::Field(error) => of_field(error),
        Error::NoBox { .. } => {
            let message = error.to_string();
            let message = message.trim_end_matches(" (`Settings::in_box`)");
            python::EmptySurface::new_err(format!("{message}: pass bounds=((x0, y0, z0), (x1, y1, z1))"))
        }
        Error::Nothing { message, .. } => python::EmptySurface::new_err(message.clone()),
        Error::Settings(SettingsError::SpacingFunction(error)) => of_field(error),
        Error::Settings(SettingsError::Memory { .. }) => PyMemoryError::new_err(error.to_string()),
        Error::Settings(error) => PyValueError::new_err(error.to_string()),
        _ => PyRuntimeError::new_err(error.to_string()),
    }
}

/// The exception of particles that cannot follow a surface.
pub(crate) fn of_follow(error: &FollowError) -> PyErr {
    python::CannotFollow::new_err(error.to_string())
}

/// The exception of a column of values.
pub(crate) fn of_value(error: &ValueError) -> PyErr {
    match error {
        ValueError::Function(error) => of_field(error),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// The exception that a function raised, unchanged.
fn of_field(error: &FieldError) -> PyErr {
    match error.get().downcast_ref::<PyErr>() {
        Some(raised) => Python::attach(|py| raised.clone_ref(py)),
        None => python::FieldError::new_err(error.to_string()),
    }
}

/// The exception of a fit.
pub(crate) fn of_job(error: &JobError) -> PyErr {
    PyValueError::new_err(error.to_string())
}
