//! A run, and its particles.

use crate::errors;
use crate::field::Field;
use marching_particles::export::{RecordText, Vertices};
use marching_particles::quality::NamedValues;
use marching_particles::run::{Measured, Value};
use marching_particles::session::{
    Asked, Fault, FileRecord, Lengths, Session, SolidSettings, SpacingText, ValueText, without_effect,
};
use marching_particles::{Bounds, Settings, Spacing, Warning};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::sync::Arc;

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
    py.detach(|| run(field, options, spacing, bounds, &values, measured, progress.as_ref()))
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
    values: &[(String, Function)],
    measured: Measured,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Sample> {
    let raised = |error| errors::of_run(&error);
    let tell = |fraction: f64| {
        Python::attach(|py| {
            py.check_signals()?;
            progress.map_or(Ok(()), |progress| progress.call1(py, (fraction,)).map(drop))
        })
    };
    let mut session = Session::without_surface();
    field.take(&mut session, bounds)?;
    let refused = |fault: Fault| errors::of_fault(&fault, &solid);
    session.choose(solid.clone()).map_err(refused)?;
    match spacing {
        None => {}
        Some(Function::Formula(formula)) => {
            let text = SpacingText { formula: formula.clone(), ..SpacingText::default() };
            session.space(Some(text)).map_err(|fault| errors::of_spacing(&fault, &formula))?;
        }
        Some(Function::Field(function)) => session.space_by(Spacing::by(Arc::clone(&function.get().field))),
    }
    let value = |(name, function): &(String, Function)| {
        let value = match function {
            Function::Formula(text) => session.value(text).map_err(|fault| errors::of_text(&fault, text))?,
            Function::Field(function) => Value::by(Arc::clone(&function.get().field)),
        };
        Ok((name.clone(), value))
    };
    let values = values.iter().map(value).collect::<PyResult<Vec<_>>>()?;
    let asked = Asked { settings, lengths };
    let within = |bounds: &Bounds| asked.within(bounds);
    while session.fit(&within, false, SLICES).is_none() {
        session.run.check_field().map_err(raised)?;
        tell(0.0)?;
    }
    let settings = within(&session.run.bounds());
    session.start(&settings).map_err(|error| raised(error.into()))?;
    session.run.plan(measured, false);
    loop {
        let now = session.run.step(BUDGET);
        if now.stop_reason.is_some() {
            break;
        }
        tell(now.fraction)?;
    }
    session.run.check_field().map_err(raised)?;
    let record = session.record(None);
    let surface = session.run.field().clone();
    let mut sample = session.finish(measured, |fraction| Ok::<(), Ended>(tell(fraction)?))?;
    for (name, value) in values {
        sample.add_value(&*surface, &name, &value).map_err(|error| errors::of_value(&error))?;
    }
    tell(1.0)?;
    let record = record.map_or_else(RecordText::default, |made| {
        let made = FileRecord { values: ValueText::of(sample.values()), ..made };
        RecordText::new(&serde_json::to_string(&made).expect("a record is data"))
    });
    Ok(Sample(sample.recorded(record)))
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
pub(crate) struct Sample(marching_particles::Sample);

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
        let particles = self.0.particles();
        rows(py, (0..particles.len()).map(|i| particles.place(i).to_array()).collect())
    }

    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        rows(py, self.0.normals().to_vec())
    }

    fn radii<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, &self.0.particles().radius)
    }

    fn levels<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        PyArray1::from_iter(py, self.0.particles().level.iter().map(|level| level.cast_signed()))
    }

    /// The requested columns by name.
    fn values<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyArray1<f32>>)> {
        let column = |added: &NamedValues| (added.name.clone(), PyArray1::from_slice(py, &added.values));
        self.0.values().iter().map(column).collect()
    }

    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        rows(py, py.detach(|| signed(self.0.buffers(Vertices::Columns).triangles)))
    }

    /// Points, normals and faces of the mesh with one vertex per particle, and the row of each
    /// vertex.
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<Mesh<'py>> {
        let mesh = py.detach(|| self.0.buffers(Vertices::Joined));
        let points = mesh.positions.iter().map(|p| p.to_array()).collect();
        let normals = mesh.normals.iter().map(|n| n.to_array()).collect();
        let vertices = PyArray1::from_iter(py, mesh.rows.iter().map(|row| row.cast_signed()));
        Ok((rows(py, points)?, rows(py, normals)?, rows(py, signed(mesh.triangles))?, vertices))
    }

    /// The report as JSON.
    fn report(&self) -> String {
        serde_json::to_string(self.0.report()).expect("a report is data")
    }

    /// Code, severity and sentence of each warning about the particles.
    fn warnings(&self) -> Vec<(&'static str, &'static str, String)> {
        told(&self.0.report().warnings)
    }

    /// Code, severity and sentence of each warning about the mesh.
    fn mesh_warnings(&self, py: Python<'_>) -> Vec<(&'static str, &'static str, String)> {
        told(&py.detach(|| self.0.mesh_warnings()))
    }

    /// Corners of the sampled box.
    fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let bounds = self.0.bounds();
        (bounds.min, bounds.max)
    }

    fn save(&self, py: Python<'_>, path: PathBuf, is_mesh: bool) -> PyResult<()> {
        py.detach(|| if is_mesh { self.0.save_mesh(path) } else { self.0.save(path) }).map_err(|error| {
            match error.kind() {
                ErrorKind::InvalidInput => PyValueError::new_err(error.to_string()),
                _ => error.into(),
            }
        })
    }
}
