//! Values at the particles, by formulas and functions: more columns for files and programs.

use super::{Run, RunState, Sample};
use crate::differential::{Curvature, curvatures};
use crate::export::COLUMNS;
use crate::field::formula::{QUANTITIES, Source};
use crate::field::{BATCH, Field, FieldError, Frame, IntoField, Value};
use crate::math::unkey;
use crate::mesh::triangulation::Triangulation;
use crate::particles::Particles;
use crate::quality::NamedValues;
use crate::spatial::tree::Tree;

use glam::{DVec3, Vec3};
use std::sync::Arc;

/// Why values cannot be added to a sample.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ValueError {
    /// Not every file can have this name.
    #[error(
        "`{name}` cannot be the name of values: take a letter, then letters, digits and _, and no name of another column"
    )]
    Name {
        /// The name.
        name: String,
    },
    /// The function has failed with this error.
    #[error("the function of the values has failed: {0}")]
    Function(FieldError),
}

/// How each of the [quantities](QUANTITIES) is read.
const READ: [fn(&At) -> f32; QUANTITIES.len()] = [
    |at| at.particles.normal[at.row].x,
    |at| at.particles.normal[at.row].y,
    |at| at.particles.normal[at.row].z,
    |at| at.curvature.k1,
    |at| at.curvature.k2,
    |at| at.curvature.direction.x,
    |at| at.curvature.direction.y,
    |at| at.curvature.direction.z,
    |at| at.particles.radius[at.row],
    |at| at.particles.level[at.row] as f32,
    |at| at.area,
    |at| at.edge,
];

/// Quantities that need the second derivatives, or the sharp edges.
const CURVED: [&str; 5] = ["k_1", "k_2", "d_x", "d_y", "d_z"];
const EDGE: &str = "edge";

/// Properties of a row of the particles.
struct At<'a> {
    particles: &'a Particles,
    row: usize,
    curvature: Curvature,
    area: f32,
    edge: f32,
}

impl Value {
    /// The value of a function of position: anything that can be [sampled](IntoField), such as a
    /// function of a point or one of a batch of points that may fail. It is evaluated once for each
    /// row of the particles.
    pub fn by<Kind>(function: impl IntoField<Kind, Field: 'static>) -> Self {
        Self::of_field(Arc::new(function.into_field()))
    }
}

/// The column of a value.
fn named(value: &Value, name: &str, values: Vec<f32>) -> NamedValues {
    let formula = match &value.0 {
        Source::Formula(formula) => Some(formula.text().to_owned()),
        Source::Function(_) => None,
    };
    NamedValues { name: name.to_owned(), formula, values }
}

impl Sample {
    /// Adds a column of numbers at the rows of the particles, which files get as well: PLY and CSV
    /// under its name, NPY after the other columns, and GLB as the attribute `_NAME` in capitals.
    /// `field` is the sampled one, or a reference to it: it gives the curvatures.
    ///
    /// # Errors
    ///
    /// If another column has the name, or some file cannot have it; or if a function of the program
    /// fails.
    pub fn add_value<Kind>(
        &mut self,
        field: impl IntoField<Kind>,
        name: &str,
        value: &Value,
    ) -> Result<(), ValueError> {
        let field = field.into_field();
        // A colour that the field gives yields to that of the program.
        if field.columns().iter().any(|(own, _)| *own == name) {
            self.measured_mut().values.retain(|column| column.name != name || column.formula.is_some());
        }
        check_name(name, self.values().iter())?;
        let mesh = value.needs_mesh().then(|| self.mesh());
        let values = column(value, self.particles(), &field, self.bounds().diagonal(), mesh)?;
        self.measured_mut().values.push(named(value, name, values));
        Ok(())
    }

    /// The columns that were [added](Sample::add_value).
    #[must_use]
    pub fn values(&self) -> &[NamedValues] {
        &self.measured().values
    }
}

impl<'f, F: Field + 'f> Run<'f, F> {
    /// [`Sample::add_value`] at the particles of a complete run, with the mesh joined if the value
    /// [needs](Value::needs_mesh) it. It replaces a column of the same name. A later report drops
    /// the columns.
    #[doc(hidden)]
    pub fn add_value(&mut self, name: &str, value: &Value) -> Result<(), ValueError> {
        let is_other = |own: &NamedValues| own.name != name;
        check_name(name, self.measured().values.iter().filter(|own| is_other(own)))?;
        let values = column(value, self.particles(), self.field(), self.bounds().diagonal(), self.mesh())?;
        let all = &mut self.measured_mut().values;
        all.retain(is_other);
        all.push(named(value, name, values));
        Ok(())
    }
}

impl RunState<'_> {
    /// Adds the [columns](Field::columns) of the field itself, unless they are there.
    pub(super) fn add_own_values(&mut self, field: &dyn Field) {
        for (name, value) in field.columns() {
            if self.measuring.measured.values.iter().all(|column| column.name != name)
                && let Ok(values) = column(&value, self.particles(), field, self.bounds.diagonal(), None)
            {
                let column = NamedValues { name: name.to_owned(), formula: None, values };
                self.measuring.measured.values.push(column);
            }
        }
    }
}

/// Checks that no other column has the name, and that every file can have it.
fn check_name<'a>(name: &str, others: impl Iterator<Item = &'a NamedValues>) -> Result<(), ValueError> {
    let mut taken = COLUMNS.iter().map(|column| column.name).chain(others.map(|v| &*v.name));
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    // GLB writes the names in capitals.
    if !is_word || taken.any(|known| known.eq_ignore_ascii_case(name)) {
        return Err(ValueError::Name { name: name.to_owned() });
    }
    Ok(())
}

/// The value at each row of particles on the surface of a field, in a box of this diagonal. The
/// area is 0 without a mesh.
fn column(
    value: &Value,
    particles: &Particles,
    field: &dyn Field,
    diagonal: f64,
    mesh: Option<&Triangulation>,
) -> Result<Vec<f32>, ValueError> {
    let count = particles.len();
    let places: Vec<DVec3> = (0..count).map(|row| particles.place(row)).collect();
    let formula = match &value.0 {
        Source::Formula(formula) => formula,
        Source::Function(function) => {
            let mut values = vec![0.0; count];
            for (places, values) in places.chunks(BATCH).zip(values.chunks_mut(BATCH)) {
                function.values(places, values);
            }
            let failure = function.failure().map(ValueError::Function);
            return failure.map_or_else(|| Ok(values.into_iter().map(|v| v as f32).collect()), Err);
        }
    };
    let mut curvature = vec![Curvature::default(); if value.takes(&CURVED) { count } else { 0 }];
    if !curvature.is_empty() {
        let frame = Frame { length: diagonal, ..Frame::around(particles.origin) };
        curvatures(&mut *field.evaluator(frame), &particles.local, &mut curvature);
    }
    if let Some(error) = field.failure() {
        return Err(ValueError::Function(error));
    }
    let area = mesh.filter(|_| value.needs_mesh()).map_or_else(Vec::new, |mesh| areas(mesh, particles));
    let edge = if value.takes(&[EDGE]) { distances_to_edges(particles) } else { Vec::new() };
    let taken: Vec<_> = QUANTITIES.iter().zip(READ).filter(|(name, _)| value.takes(&[name])).collect();
    let mut formula = formula.clone();
    let value_at = |(row, place): (usize, DVec3)| {
        let curvature = curvature.get(row).copied().unwrap_or_default();
        let [area, edge] = [&area, &edge].map(|column| column.get(row).copied().unwrap_or(0.0));
        let at = At { particles, row, curvature, area, edge };
        let is_set = taken.iter().all(|(name, read)| formula.set_parameter(name, read(&at).into()).is_ok());
        if is_set { formula.value(place) as f32 } else { f32::NAN }
    };
    Ok(places.into_iter().enumerate().map(value_at).collect())
}

/// The share of each row in the area of the mesh.
fn areas(mesh: &Triangulation, particles: &Particles) -> Vec<f32> {
    let mut areas = vec![0.0_f64; particles.len()];
    for k in 0..mesh.triangles.len() {
        let corners = mesh.outward_corners(k);
        let [a, b, c] = corners.map(|row| particles.local[row as usize].as_dvec3());
        let third = (b - a).cross(c - a).length() / 6.0;
        corners.iter().for_each(|&row| areas[row as usize] += third);
    }
    areas.into_iter().map(|area| area as f32).collect()
}

/// The distance of each row from the nearest sharp edge or rim, along the segments between the
/// particles there.
fn distances_to_edges(particles: &Particles) -> Vec<f32> {
    /// Number of nearest ends whose segments are examined: a longer segment that passes nearer has
    /// an end among them.
    const ENDS: usize = 8;
    let edges = particles.segments.iter().zip(particles.edges()).filter(|(_, is_edge)| *is_edge);
    let segments: Vec<[Vec3; 2]> =
        edges.map(|(rows, _)| rows.map(|row| particles.local[row as usize])).collect();
    let ends = segments.as_flattened().iter().zip(0..).map(|(&end, k)| (end, k)).collect();
    let tree = Tree::of(ends);
    let mut nearest = Vec::new();
    let distance = |&p: &Vec3| {
        tree.nearest_many(p, ENDS, |_| true, &mut nearest);
        let to = nearest.iter().map(|&key| {
            let [a, b] = segments[tree.origin[unkey(key).1 as usize] as usize / 2];
            let along = b - a;
            let share = (p - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
            p.distance(a + along * share.clamp(0.0, 1.0))
        });
        to.fold(f32::NAN, f32::min)
    };
    particles.local.iter().map(distance).collect()
}
