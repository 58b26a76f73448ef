//! The records of a session's runs, and the files of particles and meshes.

use super::{BoxFaces, FileRecord, Session, Source};
use crate::export::{
    self, Bodies, Format, MeshFile, MeshFormat, ParticleFile, Placement, RecordText, Vertices,
};
use crate::run::NamedSurface;
use serde::Deserialize;

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
        self.run.record().map(|record| FileRecord { link, ..record })
    }

    /// The present surface as its record names it; none if a file or a function of the program
    /// gives it.
    pub(super) fn named_surface(&self) -> Option<NamedSurface> {
        let choice = &self.fitting.choice;
        let origin = match self.source() {
            Source::Formula(field) => NamedSurface::of(field),
            Source::Points { info, field, within } => {
                let (formula, parameters) = match within {
                    Some(formula) => (formula.text.clone(), formula.parameters.as_slice()),
                    None => (String::new(), [].as_slice()),
                };
                NamedSurface {
                    model: Some(info.name.clone()),
                    pulls: field.pulls().to_vec(),
                    ..NamedSurface::of_text(formula, parameters)
                }
            }
            #[cfg(feature = "images")]
            Source::Opened(_) => return None,
            Source::Function(_) => return None,
        };
        Some(NamedSurface {
            surface: self.surface.map(|surface| surface.id.to_owned()),
            faces: (choice.box_faces == BoxFaces::Closed).then_some(self.clip),
            solid: choice.clone(),
            ..origin
        })
    }

    /// The particles and their figures as a file of the format with this extension, or the record
    /// alone for `json`. `json` gives the text of the record. None if the extension is unknown or
    /// there is no record.
    #[expect(clippy::missing_panics_doc, reason = "memory takes all that is written")]
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
