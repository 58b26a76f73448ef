//! The fields that can be sampled: a formula, functions of Python, or a surface through points.

use crate::errors;
use marching_particles::field::{BatchField, BatchPiecewise, Combined};
use marching_particles::glam::DVec3;
use marching_particles::image::{AxisOrder, ImageChoice, ImageError, VoxelType};
use marching_particles::internal::extent;
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::pointcloud::job::Job;
use marching_particles::remesh::{MeshEdges, MeshError, MeshField, MeshKind, MeshOptions};
use marching_particles::{Bounds, Formula, Image, TriangleMesh, gallery};
use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// Slices of a fit between two checks for Ctrl-C, about a millisecond each.
const FIT_SLICES: u32 = 50;

/// A shared field.
type Shared = Arc<dyn marching_particles::Field>;

/// A field.
#[pyclass(frozen, module = "marching_particles._core")]
pub(crate) struct Field {
    pub(crate) field: Shared,
    /// The default box for sampling; without it a box is fitted.
    bounds: Option<Bounds>,
    /// The request for the formula if the field is only a formula; none for other fields.
    pub(crate) formula: Option<FieldRequest>,
}

#[pymethods]
impl Field {
    /// The field of a formula, or of the gallery surface with this identifier, with these parameter
    /// values.
    #[staticmethod]
    fn formula(text: &str, parameters: Vec<(String, f64)>) -> PyResult<Self> {
        let surface = gallery::find(text);
        let mut formula = match surface {
            Some(surface) => surface.field(),
            None => Formula::parse(text).map_err(|error| errors::of_formula(&error, text))?,
        };
        for (name, value) in &parameters {
            formula = formula.with(name, *value).map_err(|error| errors::of_formula(&error, text))?;
        }
        let (given, parameters) = (Some(text.to_owned()), parameters.into_iter().collect());
        let request = match surface {
            Some(_) => FieldRequest { surface: given, parameters, ..FieldRequest::default() },
            None => FieldRequest { formula: given, parameters, ..FieldRequest::default() },
        };
        let bounds = surface.map(|surface| surface.bounds);
        Ok(Self { formula: Some(request), ..Self::new(Arc::new(formula), bounds) })
    }

    /// The field of a function from an array of points (n, 3) to a float64 array of n values, and
    /// of an optional one to gradients (n, 3). Both arrays are C-contiguous.
    #[staticmethod]
    #[pyo3(signature = (values, gradients=None))]
    fn function(values: Py<PyAny>, gradients: Option<Py<PyAny>>) -> Self {
        let field = BatchField::new(move |points: &[DVec3], f: &mut [f64]| call(&values, points, f));
        let field: Shared = match gradients {
            None => Arc::new(field),
            Some(gradients) => Arc::new(field.with_gradients(move |points: &[DVec3], out: &mut [DVec3]| {
                call(&gradients, points, bytemuck::cast_slice_mut(out))
            })),
        };
        Self::new(field, None)
    }

    /// The field put together of pieces, which are functions as in [`Self::function`]. `labels`
    /// returns an int64 array with the index of the piece at each point.
    #[staticmethod]
    fn piecewise(labels: Py<PyAny>, pieces: Vec<Py<PyAny>>) -> Self {
        let labels = move |points: &[DVec3], out: &mut [u32]| -> PyResult<()> {
            Python::attach(|py| {
                let found: PyReadonlyArray1<'_, i64> = on_points(py, &labels, points)?.extract()?;
                let found = found.as_slice()?.iter();
                out.iter_mut().zip(found).for_each(|(out, &label)| *out = u32::try_from(label).unwrap_or(0));
                Ok(())
            })
        };
        let piece =
            move |label: u32, points: &[DVec3], f: &mut [f64]| call(&pieces[label as usize], points, f);
        Self::new(Arc::new(BatchPiecewise::new(labels, piece)), None)
    }

    /// The field of a surface through points, with the report on it as JSON.
    #[staticmethod]
    #[pyo3(signature = (points, normals, centres, is_cut))]
    fn points(
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        normals: Option<PyReadonlyArray2<'_, f64>>,
        centres: u32,
        is_cut: bool,
    ) -> PyResult<(Self, String)> {
        let file = ply(points.as_slice()?, normals.as_ref().map(|normals| normals.as_slice()).transpose()?);
        Self::fitted(py, "points.ply", file, centres, is_cut)
    }

    /// [`Self::points`] for the content of a file of this name.
    #[staticmethod]
    fn file(
        py: Python<'_>,
        name: &str,
        content: Vec<u8>,
        centres: u32,
        is_cut: bool,
    ) -> PyResult<(Self, String)> {
        Self::fitted(py, name, content, centres, is_cut)
    }

    /// The field of a surface in an image, with its facts as JSON. The bytes are voxels of this
    /// type, the index along the last axis changing fastest in C order, else along the first;
    /// `rows` is the affine map from indices to points.
    #[staticmethod]
    #[pyo3(signature = (voxels, voxel_type, size, is_c_order, rows, iso, label, smooth, is_dark_inside, is_closed))]
    #[allow(clippy::too_many_arguments, reason = "they are the keywords of the package's function")]
    fn image(
        py: Python<'_>,
        voxels: PyReadonlyArray1<'_, u8>,
        voxel_type: &str,
        size: [usize; 3],
        is_c_order: bool,
        rows: [[f64; 4]; 3],
        iso: Option<f64>,
        label: Option<f64>,
        smooth: Option<f64>,
        is_dark_inside: bool,
        is_closed: bool,
    ) -> PyResult<(Self, String)> {
        let voxel_type = VoxelType::named(voxel_type);
        let voxel_type = voxel_type.expect("the package converts what has no type here");
        let order = if is_c_order { AxisOrder::LastFastest } else { AxisOrder::FirstFastest };
        let voxels = voxels.as_slice()?.to_vec();
        py.detach(|| {
            let image = Image::from_bytes(size, order, voxel_type, voxels)
                .and_then(|image| image.with_affine(rows))
                .map_err(|error| PyValueError::new_err(error.to_string()))?;
            Self::imaged(&image, &ImageChoice { iso, label, smooth, is_dark_inside, is_closed })
        })
    }

    /// [`Self::image`] of a file, which may name others beside it.
    #[staticmethod]
    #[pyo3(signature = (path, iso, label, smooth, is_dark_inside, is_closed))]
    fn image_file(
        py: Python<'_>,
        path: PathBuf,
        iso: Option<f64>,
        label: Option<f64>,
        smooth: Option<f64>,
        is_dark_inside: bool,
        is_closed: bool,
    ) -> PyResult<(Self, String)> {
        py.detach(|| {
            // A file that is missing is a FileNotFoundError.
            std::fs::File::open(&path)?;
            let image = Image::open(&path).map_err(|error| PyValueError::new_err(error.to_string()))?;
            Self::imaged(&image, &ImageChoice { iso, label, smooth, is_dark_inside, is_closed })
        })
    }

    /// The field of a triangle mesh, with a colour for each vertex or none. `edges` tells which
    /// edges stay sharp, "auto", "none" or an angle in degrees, and so do the segments, of six
    /// numbers each.
    #[staticmethod]
    #[pyo3(signature = (vertices, faces, colours, segments, edges, borders, smooth))]
    #[allow(clippy::too_many_arguments, reason = "they are the keywords of the package's function")]
    fn mesh(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, u32>,
        colours: Option<PyReadonlyArray2<'_, f32>>,
        segments: PyReadonlyArray2<'_, f64>,
        edges: &str,
        borders: Option<bool>,
        smooth: Option<f64>,
    ) -> PyResult<(Self, Mesh, String)> {
        let vertices: Vec<DVec3> =
            vertices.as_slice()?.as_chunks::<3>().0.iter().map(|&p| DVec3::from_array(p)).collect();
        let faces = faces.as_slice()?.as_chunks::<3>().0.to_vec();
        let colours = colours.map(|colours| Ok::<_, PyErr>(colours.as_slice()?.as_chunks::<3>().0.to_vec()));
        let (colours, segments) = (colours.transpose()?, segments_of(&segments)?);
        py.detach(|| {
            let mesh = TriangleMesh::new(vertices, faces).and_then(|mesh| match colours {
                Some(colours) => mesh.with_colours(colours),
                None => Ok(mesh),
            });
            Self::meshed(mesh, &segments, edges, borders, smooth)
        })
    }

    /// [`Self::mesh`] for the content of a file of this name.
    #[staticmethod]
    fn mesh_file(
        py: Python<'_>,
        name: &str,
        content: Vec<u8>,
        segments: PyReadonlyArray2<'_, f64>,
        edges: &str,
        borders: Option<bool>,
        smooth: Option<f64>,
    ) -> PyResult<(Self, Mesh, String)> {
        let segments = segments_of(&segments)?;
        py.detach(|| Self::meshed(TriangleMesh::read(name, content), &segments, edges, borders, smooth))
    }

    /// The union, in a box around the boxes of both fields if they are known.
    fn union(&self, other: &Self) -> Self {
        self.with(other, |a, b| marching_particles::union([a, b]), self.joined(other))
    }

    /// The intersection; the box of either field contains it.
    fn intersection(&self, other: &Self) -> Self {
        let bounds = self.known().or_else(|| other.known());
        self.with(other, |a, b| marching_particles::intersection([a, b]), bounds)
    }

    /// The difference; the box of this field contains it.
    fn difference(&self, other: &Self) -> Self {
        self.with(other, marching_particles::difference, self.known())
    }

    /// The smooth union. A smooth minimum is at most a sixth of the width below the smaller value,
    /// so the box is enlarged by that.
    fn smooth_union(&self, other: &Self, width: f64) -> Self {
        let bounds = self.joined(other).map(|bounds| bounds.enlarged(width / 6.0));
        self.with(other, |a, b| marching_particles::smooth_union(a, b, width), bounds)
    }

    /// The field minus the distance.
    fn offset(&self, distance: f64) -> Self {
        let bounds = self.known().map(|bounds| bounds.enlarged(distance.max(0.0)));
        Self::combined(marching_particles::offset(Arc::clone(&self.field), distance), bounds)
    }

    /// Whether the field is only a formula.
    #[getter]
    pub(crate) fn is_formula(&self) -> bool {
        self.formula.is_some()
    }

    /// Corners of the box of the surface, if it is known.
    #[getter]
    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        self.known().map(|bounds| (bounds.min, bounds.max))
    }
}

/// A triangle mesh, with which a new mesh of it can be compared.
#[pyclass(frozen, module = "marching_particles._core")]
pub(crate) struct Mesh(MeshField);

#[pymethods]
impl Mesh {
    /// The distance of a mesh from this one, as JSON.
    fn compare(
        &self,
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, i32>,
    ) -> PyResult<String> {
        let points: Vec<DVec3> =
            points.as_slice()?.as_chunks::<3>().0.iter().map(|&p| DVec3::from_array(p)).collect();
        let faces = faces.as_slice()?.as_chunks::<3>().0;
        let faces: Vec<[u32; 3]> = faces.iter().map(|face| face.map(|corner| corner as u32)).collect();
        let change = py.detach(|| self.0.compare(&points, &faces));
        Ok(serde_json::to_string(&change).expect("numbers are data"))
    }
}

impl Field {
    fn imaged(image: &Image, choice: &ImageChoice) -> PyResult<(Self, String)> {
        let raised = |error: ImageError| PyValueError::new_err(error.to_string());
        let surface = image.surface(choice, None).map_err(raised)?;
        let known = serde_json::json!({
            "iso": surface.field().iso(),
            "smooth": surface.smooth(),
            "noise": image.noise(),
            "range": image.range(),
            "notes": surface.notes(),
        });
        Ok((Self::new(Arc::new(surface.field().clone()), None), known.to_string()))
    }

    fn meshed(
        mesh: Result<TriangleMesh, MeshError>,
        segments: &[[DVec3; 2]],
        edges: &str,
        borders: Option<bool>,
        smooth: Option<f64>,
    ) -> PyResult<(Self, Mesh, String)> {
        let raised = |error: MeshError| PyValueError::new_err(error.to_string());
        let mesh = mesh.map_err(raised)?;
        let edges = match edges {
            "auto" => MeshEdges::Auto,
            "none" => MeshEdges::Rounded,
            angle => MeshEdges::Angle(angle.parse().unwrap_or(f64::NAN)),
        };
        let solid = mesh.solid().map_err(raised)?.with_edges_along(segments);
        let mut options = MeshOptions::with_edges(edges);
        (options.borders, options.smooth) = (borders, smooth);
        let field = solid.field(&options).map_err(raised)?;
        let known = serde_json::json!({
            "kind": match field.kind() {
                MeshKind::Parts { .. } => "part",
                MeshKind::Union { .. } => "union",
                _ => "scan",
            },
            "repairs": solid.repairs().words(),
            "border_edges": solid.border_edges(),
            "border_loops": solid.border_loops(),
            "notes": mesh.notes(),
        });
        Ok((Self::new(Arc::new(field.clone()), None), Mesh(field), known.to_string()))
    }

    /// The field of the formula of a request, with other values of these parameters.
    pub(crate) fn of_request(
        request: Option<&FieldRequest>,
        parameters: Vec<(String, f64)>,
    ) -> PyResult<Self> {
        let Some(FieldRequest { formula, surface, parameters: known, .. }) = request else {
            let message = "params belongs to a formula: give the field to which the particles move";
            return Err(PyTypeError::new_err(message));
        };
        let mut values = known.clone();
        values.extend(parameters);
        let text = formula.as_ref().or(surface.as_ref()).expect("a request has one of them");
        Self::formula(text, values.into_iter().collect())
    }

    /// The box of the surface, if it is known.
    fn known(&self) -> Option<Bounds> {
        let found =
            || self.field.facts().within.map(|_| extent::find(self.field.as_ref()).with_room(|_| 0.0));
        self.bounds.or_else(found)
    }

    fn new(field: Shared, bounds: Option<Bounds>) -> Self {
        Self { field, bounds, formula: None }
    }

    fn fitted(
        py: Python<'_>,
        name: &str,
        file: Vec<u8>,
        centres: u32,
        is_cut: bool,
    ) -> PyResult<(Self, String)> {
        py.detach(|| {
            let raised = |error| errors::of_job(&error);
            let mut job = Job::file(name, file, centres).map_err(raised)?;
            while !job.step(FIT_SLICES).map_err(raised)?.done {
                Python::attach(|py| py.check_signals())?;
            }
            let fit = job.complete().map_err(raised)?;
            let report = serde_json::to_string(&fit.info).expect("a report is data");
            let field = if is_cut { fit.field() } else { fit.field().untrimmed() };
            Ok((Self::new(Arc::new(field), Some(fit.bounds)), report))
        })
    }

    /// Gives the field to a session, in this box, else the field's default box, else a fitted one.
    pub(crate) fn take(&self, session: &mut Session, bounds: Option<Bounds>) -> PyResult<()> {
        let taken = match &self.formula {
            // The session knows the box of a surface of the gallery.
            Some(request) => session.set_field(&FieldRequest { bounds, ..request.clone() }),
            None => session.set_function(Arc::clone(&self.field), bounds.or(self.bounds)),
        };
        taken.map(drop).map_err(|fault| PyValueError::new_err(fault.to_string()))
    }

    fn combined(field: Combined, bounds: Option<Bounds>) -> Self {
        Self::new(Arc::new(field), bounds)
    }

    fn with(
        &self,
        other: &Self,
        rule: impl FnOnce(Shared, Shared) -> Combined,
        bounds: Option<Bounds>,
    ) -> Self {
        Self::combined(rule(Arc::clone(&self.field), Arc::clone(&other.field)), bounds)
    }

    /// The box around the boxes of both fields.
    fn joined(&self, other: &Self) -> Option<Bounds> {
        self.known().zip(other.known()).map(|(own, other)| own.joined(&other))
    }
}

/// Segments from rows of six numbers.
fn segments_of(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<[DVec3; 2]>> {
    let ends = rows.as_slice()?.as_chunks::<6>().0.iter();
    Ok(ends.map(|&[a, b, c, d, e, f]| [DVec3::new(a, b, c), DVec3::new(d, e, f)]).collect())
}

/// Calls a Python function with points. It may keep their array, which is a copy.
fn on_points<'py>(py: Python<'py>, function: &Py<PyAny>, points: &[DVec3]) -> PyResult<Bound<'py, PyAny>> {
    let flat: &[f64] = bytemuck::cast_slice(points);
    let array = PyArray1::from_slice(py, flat).reshape([points.len(), 3])?;
    function.bind(py).call1((array,))
}

/// Calls a function of Python that returns a float64 array.
fn call(function: &Py<PyAny>, points: &[DVec3], out: &mut [f64]) -> PyResult<()> {
    Python::attach(|py| {
        let result: PyReadonlyArrayDyn<'_, f64> = on_points(py, function, points)?.extract()?;
        out.copy_from_slice(result.as_slice()?);
        Ok(())
    })
}

/// Points as a PLY file, since the core fits surfaces to files.
fn ply(points: &[f64], normals: Option<&[f64]>) -> Vec<u8> {
    let names = if normals.is_some() { &["x", "y", "z", "nx", "ny", "nz"][..] } else { &["x", "y", "z"] };
    let mut file = format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", points.len() / 3);
    names.iter().for_each(|name| file.push_str(&format!("property double {name}\n")));
    file.push_str("end_header\n");
    let mut bytes = file.into_bytes();
    for (i, point) in points.chunks_exact(3).enumerate() {
        let normal = normals.map_or(&[][..], |normals| &normals[3 * i..3 * i + 3]);
        bytes.extend(point.iter().chain(normal).flat_map(|number| number.to_le_bytes()));
    }
    bytes
}
