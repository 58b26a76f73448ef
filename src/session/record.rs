//! The record in a file, from which the particles can be made again, and the files of particles and
//! meshes.

use super::{BoxFaces, Session, SolidSettings, Source, SpacingText};
use crate::export::{
    self, Bodies, Format, MeshFile, MeshFormat, ParticleFile, Placement, RecordText, Vertices,
};
use crate::field::rbf::Pull;
use crate::math::Bounds;
use crate::quality::NamedValues;
use crate::sampler::{Method, Settings};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The record in a file, from which the same particles can be made again. Files store it as JSON
/// ([`export::RecordText`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct FileRecord {
    /// Version of the program.
    pub version: String,
    /// Digest of the particles, 16 hexadecimal digits.
    pub digest: String,
    /// Link to the page in this state, if the page made the file.
    #[serde(default)]
    pub link: Option<String>,
    /// Gallery surface whose formula it is.
    #[serde(default)]
    pub surface: Option<String>,
    /// Model from points, instead of a formula.
    #[serde(default)]
    pub model: Option<String>,
    /// Pulls on the surface of the model.
    #[serde(default)]
    pub pulls: Vec<Pull>,
    /// Text of the formula; empty for a model alone.
    pub formula: String,
    /// Values of its parameters.
    #[serde(default)]
    pub parameters: BTreeMap<String, f64>,
    /// Box of the run.
    pub bounds: Bounds,
    /// Box whose faces close the solid, if they do.
    #[serde(default)]
    pub faces: Option<Bounds>,
    /// Settings of the solid that is made of the surface before it is sampled.
    #[serde(default)]
    #[cfg_attr(test, ts(type = "Record<string, number | string>"))]
    pub solid: SolidSettings,
    /// Spacing of the run, if it is by a formula.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, ts(optional))]
    pub spacing: Option<SpacingText>,
    /// Columns that formulas added.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(test, ts(as = "Option<Vec<ValueText>>", optional))]
    pub values: Vec<ValueText>,
    /// Settings of the run.
    #[cfg_attr(test, ts(type = "Record<string, number | string>"))]
    pub settings: Settings,
}

/// A column of numbers at the particles, by a formula that may use the parameters of the surface.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct ValueText {
    /// Name of the column.
    pub name: String,
    /// Text of the formula.
    pub formula: String,
}

impl ValueText {
    /// The columns that formulas gave; a record cannot hold functions.
    pub fn of(added: &[NamedValues]) -> Vec<Self> {
        let text =
            |own: &NamedValues| own.formula.clone().map(|formula| Self { name: own.name.clone(), formula });
        added.iter().filter_map(text).collect()
    }
}

/// Request for a mesh file.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(default)]
pub struct FileRequest {
    /// Extension of the format.
    pub format: String,
    /// Size and orientation of the mesh.
    pub placement: Placement,
    /// The vertices of the particles on sharp edges, in GLB, OBJ and PLY, and the columns of PLY.
    pub vertices: Vertices,
    /// The bodies that the file holds.
    pub bodies: Bodies,
    /// Link for the record.
    pub link: Option<String>,
    /// Whether the file is written without a record.
    pub plain: bool,
}

impl Session {
    /// The record of the present particles, which begins with their run; none before the first run.
    pub fn record(&self, link: Option<String>) -> Option<FileRecord> {
        let mut record = self.made.clone()?;
        record.digest = format!("{:016x}", self.run.particles().digest());
        record.link = link;
        record.values = ValueText::of(&self.run.measured().values);
        // Steps made after the run count as its own: ten and one are eleven.
        if let (Method::Front, Some(progress)) = (record.settings.method, self.run.progress()) {
            record.settings.relax_steps = progress.relax_step;
        }
        Some(record)
    }

    /// The record of a run that starts now; none if a file or a function of the program gives the
    /// surface, or a function the spacing: a record cannot hold these.
    pub(super) fn beginning(&self, settings: &Settings) -> Option<FileRecord> {
        if self.spacing_function.is_some() {
            return None;
        }
        let (formula, parameters, model, pulls) = match self.source() {
            Source::Formula(field) => (field.text().to_owned(), field.parameters(), None, Vec::new()),
            Source::Points { info, field, within } => {
                let (text, parameters) = match within {
                    Some(formula) => (formula.text.clone(), formula.parameters.as_slice()),
                    None => (String::new(), [].as_slice()),
                };
                (text, parameters, Some(info.name.clone()), field.pulls().to_vec())
            }
            #[cfg(feature = "images")]
            Source::Opened(_) => return None,
            Source::Function(_) => return None,
        };
        // Collecting a map at once sorts it, by a stable sort that takes 3 kB.
        let mut values = BTreeMap::new();
        values.extend(parameters.iter().map(|p| (p.name.to_string(), p.value)));
        Some(FileRecord {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            digest: String::new(),
            link: None,
            surface: self.surface.map(|surface| surface.id.to_owned()),
            model,
            pulls,
            formula,
            parameters: values,
            bounds: self.run.bounds(),
            faces: (self.fitting.choice.box_faces == BoxFaces::Closed).then_some(self.clip),
            solid: self.fitting.choice.clone(),
            spacing: self.spacing.clone().filter(|_| self.next_spacing().is_some()),
            values: Vec::new(),
            settings: Settings { bounds: None, ..*settings },
        })
    }

    /// The particles and their figures as a file of the format with this extension, or the record
    /// alone for `json`. `json` gives the text of the record. None if the extension is unknown or
    /// there is no record.
    pub fn particle_file(
        &self,
        extension: &str,
        json: impl FnOnce(&FileRecord) -> String,
    ) -> Option<Vec<u8>> {
        let record = self.record_text(None, json);
        if extension == "json" {
            return record.document().map(String::into_bytes);
        }
        let file = ParticleFile { format: Format::of_extension(extension)?, record };
        let mut bytes = Vec::new();
        export::write(&file, self.run.particles(), self.run.measured(), &mut bytes)
            .expect("memory takes all that is written");
        Some(bytes)
    }

    fn record_text(&self, link: Option<String>, json: impl FnOnce(&FileRecord) -> String) -> RecordText {
        self.record(link).map_or_else(RecordText::default, |made| RecordText::new(&json(&made)))
    }

    /// The mesh as a file, with up to `budget` slices of the work: its bytes once it is complete,
    /// none before. `json` gives the JSON of the record. The answer is empty for an unknown
    /// extension, or if the file would be too large.
    pub fn mesh_file(
        &mut self,
        request: &FileRequest,
        json: impl FnOnce(&FileRecord) -> String,
        budget: u32,
    ) -> Option<Option<Vec<u8>>> {
        let Some(format) = MeshFormat::of_extension(&request.format) else { return Some(None) };
        let record =
            if request.plain { RecordText::default() } else { self.record_text(request.link.clone(), json) };
        let FileRequest { placement, vertices, bodies, .. } = *request;
        let wish = MeshFile { format, placement, vertices, bodies, record };
        self.run.mesh_file(&wish, budget).map_or(Some(None), |bytes| bytes.map(Some))
    }
}
