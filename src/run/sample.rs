//! The whole job in one call, and its result.

use super::mesh::joined;
use super::{Error, FileRecord, Measured, Report, Run, RunState, Warning};
use crate::export::{self, Format, MeshBuffers, MeshFile, MeshFormat, ParticleFile, RecordText, Vertices};
use crate::field::IntoField;
use crate::math::Bounds;
use crate::mesh::stars::Sheets;
use crate::mesh::triangulation::Triangulation;
use crate::particles::Particles;
use crate::quality;
use crate::sampler::SpacedSettings;
use crate::slices;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// Samples the surface f = 0 of a field with evenly spaced particles, and measures them. The field
/// is anything that [`IntoField`] lists: a [`Formula`](crate::Formula), a reference or an `Arc` of
/// a field, a closure.
///
/// The surface is sampled in the box of the settings, or in one that fits it: around all of a
/// bounded surface, or a part of an unbounded one. The box of a field without
/// [bounds](crate::field::Bounded) is fitted to what grids show
/// ([`FnField`](crate::field::FnField)): give the box if it is known. The settings are
/// [`Settings`](crate::Settings) or [`SpacedSettings`]. The same field, settings and seed give the
/// same particles to the last bit, on every platform. For progress, cancelling or slices of work
/// use a [`Run`].
///
/// # Errors
///
/// If a setting or the box is out of its range, there is no memory for the expected particles, no
/// particle could be placed, or a function of the program fails: the error says why. Anything else
/// that may be wrong with a field is a [`Warning`] in the report.
///
/// ```
/// use marching_particles::{Formula, Format, Settings, sample};
///
/// let surface = Formula::parse("x^4 + y^4 + z^4 = a")?.with("a", 0.5)?;
/// let sample = sample(surface, &Settings::with_count(1_000))?;
/// let mut file = Vec::new();
/// sample.write(Format::Ply, &mut file)?;
/// assert!(sample.report().measures.quality.is_some_and(|figures| figures.order.six_neighbours > 0.8));
/// assert_eq!(sample.mesh().topology.components.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sample<Kind, S>(field: impl IntoField<Kind>, settings: &S) -> Result<Sample, Error>
where
    SpacedSettings: for<'a> From<&'a S>,
{
    Run::start(field, settings)?.complete(Measured::Particles)
}

/// The particles of a finished run, with the report on them; their mesh is made when first needed.
#[derive(Clone, Debug)]
pub struct Sample {
    particles: Particles,
    report: Report,
    measured: quality::Measurements,
    bounds: Bounds,
    /// The triangles of a refined run.
    known: Vec<[u32; 3]>,
    /// The sheets of the particles, if they were measured.
    sheets: Option<Arc<Sheets>>,
    mesh: OnceLock<Triangulation>,
    /// The record, without the digest of the particles and the columns that were added.
    made: Option<FileRecord>,
}

impl Sample {
    pub(super) fn new(run: RunState<'_>, report: Report) -> Self {
        let made = run.beginning();
        Self {
            bounds: run.bounds,
            known: run.sampler.triangles().to_vec(),
            particles: run.sampler.into_particles(),
            measured: run.measuring.measured,
            sheets: run.measuring.sheets,
            report,
            made,
            mesh: run.meshing.into_joined().map_or_else(OnceLock::new, OnceLock::from),
        }
    }

    /// The sample of a run that goes on.
    pub(super) fn copied(run: &RunState<'_>, report: Report) -> Self {
        Self {
            bounds: run.bounds,
            known: run.sampler.triangles().to_vec(),
            particles: run.sampler.particles().clone(),
            measured: run.measuring.measured.clone(),
            sheets: run.measuring.sheets.clone(),
            report,
            made: run.beginning(),
            mesh: run.meshing.joined().cloned().map_or_else(OnceLock::new, OnceLock::from),
        }
    }

    /// The particles, as columns.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.particles
    }

    /// The report on the run.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// The measurements of each particle, in columns as long as the columns of
    /// [`Sample::particles`].
    #[must_use]
    pub fn measured(&self) -> &quality::Measurements {
        &self.measured
    }

    pub(super) fn measured_mut(&mut self) -> &mut quality::Measurements {
        &mut self.measured
    }

    /// The clip box, in the coordinates of the field.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The triangles over the particles: an oriented manifold, closed where the surface is. Closed
    /// parts are counter-clockwise seen from outside, even if f is larger inside. The first call
    /// joins the particles, in less than a microsecond each.
    #[must_use]
    pub fn mesh(&self) -> &Triangulation {
        if let Some(mesh) = self.mesh.get() {
            return mesh;
        }
        let bounds = self.bounds.relative_to(self.particles.origin);
        let sheets = self.sheets.as_deref();
        // A thread that waits for others may do another job of the pool, which may need the mesh:
        // nothing must be locked now.
        let mesh =
            slices::in_pool(|| slices::complete(joined(&self.particles, &self.known, &bounds, sheets)));
        self.mesh.get_or_init(|| mesh)
    }

    /// The warnings about the [mesh](Sample::mesh): a topology that differs from the measured one
    /// of the particles, holes, and particles in no triangle.
    #[must_use]
    pub fn mesh_warnings(&self) -> Vec<Warning> {
        Warning::of_mesh(&self.measured, self.mesh(), Warning::tell_of_jumps(&self.report.warnings))
    }

    /// Volume that the [mesh](Sample::mesh) encloses, see [`Triangulation::volume`];
    /// [`Report::joined_volume`] is there if the run had joined it.
    #[must_use]
    pub fn volume(&self) -> Option<f64> {
        self.mesh().volume(&self.particles)
    }

    /// Writes the particles with their measurements to `out`, which should be buffered: in a
    /// [`Format`](crate::Format), or as a [`ParticleFile`] with a record. Their normals follow the
    /// gradient: they point inward where f is larger inside.
    ///
    /// # Errors
    ///
    /// The errors of `out`.
    pub fn write(&self, file: impl Into<ParticleFile>, mut out: impl Write) -> io::Result<()> {
        export::write(&file.into(), &self.particles, &self.measured, &mut out)
    }

    /// The [mesh](Sample::mesh) as lists of vertices and triangles, as its files have it.
    ///
    /// ```
    /// use marching_particles::export::Vertices;
    /// use marching_particles::mesh::Topology;
    /// use marching_particles::{Formula, Settings, sample};
    ///
    /// let cube = Formula::parse("max(|x|, |y|, |z|) = 1")?;
    /// let sample = sample(cube, &Settings::with_count(1_000))?;
    /// let joined = sample.buffers(Vertices::Joined);
    /// assert!(Topology::new(&joined.triangles, joined.positions.len()).is_closed());
    /// // With the normals of each face the six faces are apart.
    /// let split = sample.buffers(Vertices::Split);
    /// assert_eq!(Topology::new(&split.triangles, split.positions.len()).components.len(), 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn buffers(&self, vertices: Vertices) -> MeshBuffers {
        MeshBuffers::new(self.mesh(), &self.particles, vertices)
    }

    /// Writes the [mesh](Sample::mesh) to `out`, which should be buffered: in a
    /// [`MeshFormat`](crate::MeshFormat), or as a [`MeshFile`] with a size, an upward axis and a
    /// record. A mesh that is open is written as it is: see [`Sample::mesh_warnings`].
    ///
    /// Closed parts face outward, also where f is larger inside. A particle on a crease is one
    /// vertex, unless [`Vertices`] asks for more.
    ///
    /// # Errors
    ///
    /// The errors of `out`, and an error if the 32-bit counters of the format are too small.
    pub fn write_mesh(&self, file: impl Into<MeshFile>, mut out: impl Write) -> io::Result<()> {
        export::write_mesh(&file.into(), &self.particles, &self.measured, self.mesh(), &mut out)
    }

    /// The record of how the sample was made, which [`Sample::save`] and [`Sample::save_mesh`]
    /// write: `marching-particles sample --like` repeats the run from it. It is empty unless the
    /// surface is that of a [`Formula`](crate::Formula), for the spacing by a function, and once
    /// the particles have [followed](Run::follow) their surface.
    #[must_use]
    pub fn record(&self) -> RecordText {
        self.file_record().map_or_else(RecordText::default, |record| record.text())
    }

    /// The record as a value.
    #[doc(hidden)]
    #[must_use]
    pub fn file_record(&self) -> Option<FileRecord> {
        self.made.clone().map(|made| made.of(&self.particles, self.values()))
    }

    /// Writes a file of the format that its extension names: the mesh as `glb`, `3mf`, `stl` or
    /// `obj`, the particles as `ply`, `csv`, `npy` or `xyz`. For a mesh as PLY there is
    /// [`Sample::save_mesh`]. The [record](Sample::record) is in the file if its format can hold
    /// one; for CSV it is in a file next to it, with `.json` appended to the name.
    ///
    /// # Errors
    ///
    /// If the extension is none of these, or writing fails.
    pub fn save(&self, path: impl AsRef<Path>) -> io::Result<()> {
        let path = path.as_ref();
        match (of_path(path, Format::of_extension), of_path(path, MeshFormat::of_extension)) {
            (Some(format), _) => self.save_particles(path, format),
            (None, Some(_)) => self.save_mesh(path),
            (None, None) => {
                let known = Format::ALL.iter().map(|(name, _)| *name);
                let meshes = MeshFormat::ALL.iter().map(|(name, _)| *name);
                Err(no_format(path, meshes.filter(|name| *name != "ply").chain(known).collect()))
            }
        }
    }

    fn save_particles(&self, path: &Path, format: Format) -> io::Result<()> {
        let record = self.record();
        let document = record.document();
        written(path, |out| self.write(ParticleFile { format, record }, out))?;
        match document {
            Some(document) if format == Format::Csv => {
                let mut beside = path.as_os_str().to_owned();
                beside.push(".json");
                written(beside.as_ref(), |out| out.write_all(document.as_bytes()))
            }
            _ => Ok(()),
        }
    }

    /// Writes the mesh to a file of the format that its extension names: `glb`, `3mf`, `stl`, `obj`
    /// or `ply`, with the [record](Sample::record) unless it is STL.
    ///
    /// # Errors
    ///
    /// If the extension is none of these, or writing fails.
    pub fn save_mesh(&self, path: impl AsRef<Path>) -> io::Result<()> {
        let path = path.as_ref();
        let Some(format) = of_path(path, MeshFormat::of_extension) else {
            return Err(no_format(path, MeshFormat::ALL.iter().map(|(name, _)| *name).collect()));
        };
        let file = MeshFile { record: self.record(), ..format.into() };
        written(path, |out| self.write_mesh(file, out))
    }

    /// Positions of the particles in the coordinates of the field, for a graphics buffer. A
    /// particle where patches meet occurs once for each of them, with its normal.
    #[must_use]
    pub fn positions(&self) -> Vec<[f32; 3]> {
        (0..self.particles.len()).map(|i| self.particles.place(i).as_vec3().to_array()).collect()
    }

    /// Unit normals at [`Sample::positions`].
    #[must_use]
    pub fn normals(&self) -> &[[f32; 3]] {
        bytemuck::cast_slice(&self.particles.normal)
    }

    /// The triangles of the [mesh](Sample::mesh), as indices of [`Sample::positions`].
    #[must_use]
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.mesh().triangles
    }
}

/// The format that the extension of a path names.
fn of_path<T>(path: &Path, of_extension: impl Fn(&str) -> Option<T>) -> Option<T> {
    of_extension(path.extension().and_then(OsStr::to_str).unwrap_or_default())
}

fn no_format(path: &Path, known: Vec<&str>) -> io::Error {
    let message = format!("{} has none of the extensions {}", path.display(), known.join(", "));
    io::Error::new(io::ErrorKind::InvalidInput, message)
}

/// Writes a file. The error names it, and its folder if that is missing.
fn written(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let written = || {
        let mut file = BufWriter::new(File::create(path)?);
        write(&mut file)?;
        file.flush()
    };
    written().map_err(|error| {
        let why = match path.parent() {
            Some(folder) if error.kind() == io::ErrorKind::NotFound => {
                format!("there is no folder {}", folder.display())
            }
            _ => error.to_string(),
        };
        io::Error::new(error.kind(), format!("{} could not be written: {why}", path.display()))
    })
}
