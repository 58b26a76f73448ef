//! A run, and its particles.

use crate::errors;
use crate::field::Field;
use marching_particles::export::Vertices;
use marching_particles::internal::session::{
    Asked, FieldRequest, Lengths, Session, SolidSettings, SpacingText, without_effect,
};
use marching_particles::quality::NamedValues;
use marching_particles::run::{Measured, Value};
use marching_particles::{Bounds, Settings, Spacing, Warning};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Units of work between two checks for Ctrl-C: some milliseconds for a formula.
const BUDGET: u32 = 5_000;
/// Slices of the search for a box between two checks, 10 to 50 microseconds each.
const SLICES: u32 = 500;

/// The arguments of a run except the field, as JSON from the Python half.
#[derive(Deserialize)]
struct Options {
    settings: Settings,
    lengths: Lengths,
    solid: SolidSettings,
    /// The argument that gave each setting of the table.
    given: BTreeMap<String, String>,
}

/// Samples a field. The GIL is released except while Python functions are called.
#[pyfunction]
#[pyo3(signature = (field, options, *, spacing, bounds, values, measure, progress))]
#[expect(clippy::too_many_arguments, reason = "they are named, and Python's")]
pub(crate) fn sample(
    py: Python<'_>,
    field: &Field,
    options: &str,
    spacing: Option<Function>,
    bounds: Option<([f64; 3], [f64; 3])>,
    values: Vec<(String, Function)>,
    measure: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Sample> {
    let options: Options =
        serde_json::from_str(options).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let given: Vec<&str> = options.given.keys().map(String::as_str).collect();
    if let Some((setting, condition)) =
        without_effect(&given, &options.settings, &options.solid, spacing.is_some())
    {
        return Err(errors::without_effect(&options.given[setting.name], condition));
    }
    let bounds = bounds.map(|(min, max)| Bounds { min, max });
    let measured = if measure { Measured::Particles } else { Measured::Nothing };
    py.detach(|| run(field, options, spacing, bounds, values, measured, progress.as_ref()))
}

/// A function of place: a formula or a function of Python.
#[derive(FromPyObject)]
pub(crate) enum Function {
    Formula(String),
    Field(Py<Field>),
}

fn run(
    field: &Field,
    Options { settings, lengths, solid, .. }: Options,
    spacing: Option<Function>,
    bounds: Option<Bounds>,
    values: Vec<(String, Function)>,
    measured: Measured,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Sample> {
    let mut session = Session::without_surface();
    field.take(&mut session, bounds)?;
    session.choose(solid.clone()).map_err(|fault| errors::of_fault(&fault, &solid))?;
    match spacing {
        None => {}
        Some(Function::Formula(formula)) => {
            let text = SpacingText { formula: formula.clone(), ..SpacingText::default() };
            session.space(Some(text)).map_err(|fault| errors::of_spacing(&fault, &formula))?;
        }
        Some(Function::Field(function)) => session.space_by(Spacing::by(Arc::clone(&function.get().field))),
    }
    let asked = Asked { settings, lengths };
    let request = field.formula.clone();
    let mut motion = Motion { session, request, settings, solid, bounds, values, measured };
    let columns = motion.columns()?;
    motion.fit(&|bounds| asked.within(bounds), false, progress)?;
    motion.settings = asked.within(&motion.session.run.bounds());
    motion.session.start(&motion.settings).map_err(|error| errors::of_run(&error.into()))?;
    motion.sampled(columns, progress)
}

/// Tells the share of the work that is done, and checks for Ctrl-C.
fn tell(progress: Option<&Py<PyAny>>, fraction: f64) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        progress.map_or(Ok(()), |progress| progress.call1(py, (fraction,)).map(drop))
    })
}

/// Particles that can follow another surface, and what they were asked for with.
struct Motion {
    session: Session,
    /// The request for the formula if the field is only a formula.
    request: Option<FieldRequest>,
    /// Those of the start.
    settings: Settings,
    solid: SolidSettings,
    /// The box, if it was given.
    bounds: Option<Bounds>,
    values: Vec<(String, Function)>,
    measured: Measured,
}

impl Motion {
    /// The columns that were asked for, as functions with the present values of parameters.
    fn columns(&self) -> PyResult<Vec<(String, Value)>> {
        let column = |(name, function): &(String, Function)| {
            let value = match function {
                Function::Formula(text) => {
                    self.session.value(text).map_err(|fault| errors::of_text(&fault, text))?
                }
                Function::Field(function) => Value::by(Arc::clone(&function.get().field)),
            };
            Ok((name.clone(), value))
        };
        self.values.iter().map(column).collect()
    }

    /// Finds the box of the surface.
    fn fit(
        &mut self,
        within: &dyn Fn(&Bounds) -> Settings,
        only_grows: bool,
        progress: Option<&Py<PyAny>>,
    ) -> PyResult<()> {
        while self.session.fit(within, only_grows, SLICES).is_none() {
            self.session.run.check_field().map_err(|error| errors::of_run(&error))?;
            tell(progress, 0.0)?;
        }
        Ok(())
    }

    /// Lets the particles follow their surface to that of another field, or of the present formula
    /// with other values of these parameters.
    fn follow(
        &mut self,
        field: Option<&Field>,
        parameters: Vec<(String, f64)>,
        progress: Option<&Py<PyAny>>,
    ) -> PyResult<Vec<(String, Value)>> {
        let changed;
        let field = match field {
            Some(field) => field,
            None => {
                changed = Field::of_request(self.request.as_ref(), parameters)?;
                &changed
            }
        };
        if !field.is_formula() && self.solid != SolidSettings::default() {
            let message = "closed, periodic and thickness are for a formula by itself";
            return Err(PyValueError::new_err(message));
        }
        // The box of a function stays: its surface would have to be searched for in every frame.
        let bounds = self.bounds.or_else(|| (!field.is_formula()).then(|| self.session.run.bounds()));
        field.take(&mut self.session, bounds)?;
        let solid = self.solid.clone();
        self.session.choose(solid).map_err(|fault| errors::of_fault(&fault, &self.solid))?;
        let columns = self.columns()?;
        let settings = self.settings;
        self.fit(&|_| settings, true, progress)?;
        self.session.follow(&settings, false).map_err(|error| errors::of_follow(&error))?;
        self.request.clone_from(&field.formula);
        Ok(columns)
    }

    /// Carries out what was begun, and measures the particles.
    fn sampled(mut self, columns: Vec<(String, Value)>, progress: Option<&Py<PyAny>>) -> PyResult<Sample> {
        let made = self.carried_out(columns, progress)?;
        Ok(Sample { made, motion: Mutex::new(Some(self)) })
    }

    fn carried_out(
        &mut self,
        columns: Vec<(String, Value)>,
        progress: Option<&Py<PyAny>>,
    ) -> PyResult<marching_particles::Sample> {
        let Self { session, measured, .. } = self;
        session.run.plan(*measured, false);
        loop {
            let now = session.run.step(BUDGET);
            if now.stop_reason.is_some() {
                break;
            }
            tell(progress, now.fraction)?;
        }
        session.run.check_field().map_err(|error| errors::of_run(&error))?;
        let mut sample = session.sample(*measured, |fraction| Ok::<(), Ended>(tell(progress, fraction)?))?;
        let surface = session.run.field();
        for (name, value) in columns {
            sample.add_value(surface, &name, &value).map_err(|error| errors::of_value(&error))?;
        }
        tell(progress, 1.0)?;
        Ok(sample)
    }
}

/// The exception that ended a measurement.
struct Ended(PyErr);

impl From<marching_particles::Error> for Ended {
    fn from(error: marching_particles::Error) -> Self {
        Self(errors::of_run(&error))
    }
}

impl From<PyErr> for Ended {
    fn from(raised: PyErr) -> Self {
        Self(raised)
    }
}

impl From<Ended> for PyErr {
    fn from(Ended(raised): Ended) -> Self {
        raised
    }
}

/// The particles of a run. Every method creates new arrays, which the Python half caches.
#[pyclass(frozen, module = "marching_particles._core")]
pub(crate) struct Sample {
    made: marching_particles::Sample,
    /// None once the particles have moved to another sample.
    motion: Mutex<Option<Motion>>,
}

/// Rows of three numbers as an array, without a copy.
fn rows<T: numpy::Element + bytemuck::Pod>(
    py: Python<'_>,
    rows: Vec<[T; 3]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])
}

/// Indices as signed integers, which Python's libraries expect. There are far fewer than 2³¹ rows.
fn signed(triangles: Vec<[u32; 3]>) -> Vec<[i32; 3]> {
    triangles.into_iter().map(|triangle| triangle.map(u32::cast_signed)).collect()
}

fn told(warnings: &[Warning]) -> Vec<(&'static str, &'static str, String)> {
    let told = |warning: &Warning| (warning.code(), warning.severity().name(), warning.to_string());
    warnings.iter().map(told).collect()
}

type Mesh<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<i32>>,
    Bound<'py, PyArray1<i32>>,
);

#[pymethods]
impl Sample {
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let particles = self.made.particles();
        rows(py, (0..particles.len()).map(|i| particles.place(i).to_array()).collect())
    }

    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(py, self.made.normals().to_vec())
    }

    fn radii<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.made.particles().radius)
    }

    fn levels<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_iter(py, self.made.particles().level.iter().map(|level| level.cast_signed()))
    }

    /// The number of the particle of each row, which it keeps while it moves.
    fn identities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let numbers = self.made.particles().identities();
        PyArray1::from_iter(py, numbers.into_iter().map(u32::cast_signed))
    }

    /// The sample of the particles after they have followed their surface to that of another field,
    /// or without one to that of their formula with these values of parameters. This one keeps them
    /// if they cannot.
    fn moved(
        &self,
        py: Python<'_>,
        field: Option<&Field>,
        parameters: Vec<(String, f64)>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        py.detach(|| {
            // Nothing of Python is called while the lock is held.
            let exchange = |motion| {
                let mut kept = self.motion.lock().unwrap_or_else(PoisonError::into_inner);
                core::mem::replace(&mut *kept, motion)
            };
            let mut motion = exchange(None).ok_or_else(|| {
                let message = "the particles of this sample have moved on: move the sample that has them now";
                PyValueError::new_err(message)
            })?;
            match motion.follow(field, parameters, progress.as_ref()) {
                Ok(columns) => motion.sampled(columns, progress.as_ref()),
                Err(error) => {
                    exchange(Some(motion));
                    Err(error)
                }
            }
        })
    }

    /// The requested columns by name.
    fn values<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyArray1<f32>>)> {
        let column = |added: &NamedValues| (added.name.clone(), PyArray1::from_slice(py, &added.values));
        self.made.values().iter().map(column).collect()
    }

    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        rows(py, py.detach(|| signed(self.made.buffers(Vertices::Columns).triangles)))
    }

    /// Points, normals and faces of the mesh with one vertex per particle, and the row of each
    /// vertex.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Mesh<'py>> {
        let mesh = py.detach(|| self.made.buffers(Vertices::Joined));
        let points = mesh.positions.iter().map(|p| p.to_array()).collect();
        let normals = mesh.normals.iter().map(|n| n.to_array()).collect();
        let vertices = PyArray1::from_iter(py, mesh.rows.iter().map(|row| row.cast_signed()));
        Ok((rows(py, points)?, rows(py, normals)?, rows(py, signed(mesh.triangles))?, vertices))
    }

    /// The report as JSON.
    fn report(&self) -> String {
        serde_json::to_string(self.made.report()).expect("a report is data")
    }

    /// Code, severity and sentence of each warning about the particles.
    fn warnings(&self) -> Vec<(&'static str, &'static str, String)> {
        told(&self.made.report().warnings)
    }

    /// Code, severity and sentence of each warning about the mesh.
    fn mesh_warnings(&self, py: Python<'_>) -> Vec<(&'static str, &'static str, String)> {
        told(&py.detach(|| self.made.mesh_warnings()))
    }

    /// Corners of the sampled box.
    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let bounds = self.made.bounds();
        (bounds.min, bounds.max)
    }

    fn save(&self, py: Python<'_>, path: PathBuf, is_mesh: bool) -> PyResult<()> {
        py.detach(|| if is_mesh { self.made.save_mesh(path) } else { self.made.save(path) }).map_err(
            |error| match error.kind() {
                ErrorKind::InvalidInput => PyValueError::new_err(error.to_string()),
                _ => error.into(),
            },
        )
    }
}
