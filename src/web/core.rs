//! The core bundle: a [`Session`] behind JSON strings and copies of the particle columns.

use crate::field::formula::{FormulaError, FormulaErrorKind};
use crate::field::rbf::RbfData;
use crate::json;
use crate::sampler::Settings;
use crate::session::{FieldError, FieldRequest, PointsRequest, Session, describe};
use glam::Vec3;
use serde::Serialize;
use wasm_bindgen::prelude::wasm_bindgen;

/// A sampling session. Strings are JSON; columns are copies, three floats a vector.
#[wasm_bindgen]
pub struct Core {
    session: Session,
}

fn text(value: &impl Serialize) -> String {
    json::to_string(value).unwrap_or_else(|error| refusal("json", &error.to_string()))
}

fn refusal(kind: &str, message: &str) -> String {
    refused(&Refusal { kind, message, start: 0, end: 0, suggestion: None, names: &[] })
}

/// What is wrong with a request.
#[derive(Serialize)]
struct Refusal<'a, Kind> {
    kind: Kind,
    message: &'a str,
    start: usize,
    end: usize,
    suggestion: Option<&'a str>,
    names: &'a [String],
}

fn refused<Kind: Serialize>(refusal: &Refusal<'_, Kind>) -> String {
    format!(r#"{{"ok":false,"error":{}}}"#, json::to_string(refusal).unwrap_or_default())
}

/// An answer, which has fields, with `ok` among them.
fn accepted(value: &impl Serialize) -> String {
    let mut answer = text(value);
    answer.insert_str(1, r#""ok":true,"#);
    answer
}

fn formula_error(formula: &str, error: &FormulaError) -> String {
    let span = error.utf16_span(formula);
    refused::<FormulaErrorKind>(&Refusal {
        kind: error.kind,
        message: &error.message,
        start: span.start,
        end: span.end,
        suggestion: error.suggestion.as_deref(),
        names: &error.names,
    })
}

#[wasm_bindgen]
impl Core {
    /// A session on the default surface, with nothing sampled.
    #[wasm_bindgen(constructor)]
    #[expect(clippy::new_without_default, reason = "a constructor for JavaScript")]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self { session: Session::new() }
    }

    /// Everything there is to choose and to read: `Description`.
    pub fn describe(&self) -> String {
        text(&describe())
    }

    /// Changes the field: `FieldRequest` to `FieldAnswer`. After an error the last good field stays.
    pub fn set_field(&mut self, request: &str) -> String {
        let request: FieldRequest = match json::from_str(request) {
            Ok(request) => request,
            Err(error) => return refusal("request", &error.to_string()),
        };
        match self.session.set_field(&request) {
            Ok(answer) => accepted(&answer),
            Err(FieldError::Formula(error)) => {
                formula_error(request.formula.as_deref().unwrap_or_default(), &error)
            }
            Err(error @ FieldError::UnknownSurface(_)) => refusal("unknown_surface", &error.to_string()),
            Err(error @ FieldError::Box) => refusal("box", &error.to_string()),
            Err(error @ FieldError::Points(_)) => refusal("points", &error.to_string()),
        }
    }

    /// Refuses runs that need more than about `megabytes` with their report.
    pub fn limit_memory(&mut self, megabytes: usize) {
        self.session.limit_memory(megabytes << 20);
    }

    /// Changes the field to a model from points: the solved system as `Points.field` gives it, and what `Points.info` says of
    /// it with the clip box, `{info, bounds}`; to `FieldAnswer`. After an error the last good field stays.
    pub fn set_points(&mut self, system: &[u8], about: &str) -> String {
        let about: PointsRequest = match json::from_str(about) {
            Ok(about) => about,
            Err(error) => return refusal("request", &error.to_string()),
        };
        let answer = RbfData::from_bytes(system)
            .map_err(FieldError::from)
            .and_then(|data| self.session.set_points(data, about.info, about.bounds));
        match answer {
            Ok(answer) => accepted(&answer),
            Err(error @ FieldError::Box) => refusal("box", &error.to_string()),
            Err(error) => refusal("points", &error.to_string()),
        }
    }

    /// Starts a run: `Settings`, of which what is missing has its default.
    pub fn start(&mut self, settings: &str) -> String {
        let settings: Settings = match json::from_str(settings) {
            Ok(settings) => settings,
            Err(error) => return refusal("settings", &error.to_string()),
        };
        match self.session.start(&settings) {
            Ok(start) => accepted(&start),
            Err(error) => refusal("settings", &error.to_string()),
        }
    }

    /// Does up to `budget` units of work: `Progress`.
    pub fn step(&mut self, budget: u32) -> String {
        text(&self.session.step(budget))
    }

    /// Queues relaxation steps on the present particles.
    pub fn relax(&mut self, steps: u32) -> String {
        self.session.relax(steps);
        r#"{"ok":true}"#.to_owned()
    }

    /// Ends the run and keeps the particles: `Progress`.
    pub fn cancel(&mut self) -> String {
        text(&self.session.cancel())
    }

    /// Number of particles.
    pub fn count(&self) -> usize {
        self.session.count()
    }

    /// Positions from particle `from` on.
    pub fn positions(&self, from: usize) -> Vec<f32> {
        self.vectors(&self.session.particles().position, from)
    }

    /// Unit normals from particle `from` on.
    pub fn normals(&self, from: usize) -> Vec<f32> {
        self.vectors(&self.session.particles().normal, from)
    }

    /// Repulsion radii from particle `from` on.
    pub fn radii(&self, from: usize) -> Vec<f32> {
        self.column(&self.session.particles().radius, from)
    }

    /// Generation levels from particle `from` on.
    pub fn levels(&self, from: usize) -> Vec<u32> {
        self.column(&self.session.particles().level, from)
    }

    /// Parents from particle `from` on; 0xffffffff for a seed.
    pub fn parents(&self, from: usize) -> Vec<u32> {
        self.column(&self.session.particles().parent, from)
    }

    /// Six three-bit fates per particle, from particle `from` on.
    pub fn slots(&self, from: usize) -> Vec<u32> {
        self.column(&self.session.particles().slots, from).into_iter().map(|slots| slots.0).collect()
    }

    /// Measures the particles, up to `budget` pieces of the work: `Report` once it is complete, nothing before.
    pub fn measure(&mut self, budget: u32) -> Option<String> {
        self.session.measure(budget).map(|report| text(&report))
    }

    /// Natural neighbours per particle, as of the last report.
    pub fn valence(&self) -> Vec<u8> {
        self.session.measured().valence.clone()
    }

    /// Distance to the nearest particle, as of the last report.
    pub fn nearest(&self) -> Vec<f32> {
        self.session.measured().nearest.clone()
    }

    /// |f|/|∇f| per particle, as of the last report.
    pub fn residual(&self) -> Vec<f32> {
        self.session.measured().residual.clone()
    }

    /// Connected piece per particle, 0 the largest, as of the last report; 0xffffffff for none.
    pub fn component(&self) -> Vec<u32> {
        self.session.measured().component.clone()
    }

    /// Principal curvatures of particles from `from` on, two each, worked out now.
    pub fn curvature(&mut self, from: usize) -> Vec<f32> {
        self.session.curvatures(from).into_flattened()
    }

    /// Digest of the particle columns, 16 hexadecimal digits.
    pub fn digest(&self) -> String {
        format!("{:016x}", self.session.particles().digest())
    }

    fn column<T: Copy>(&self, column: &[T], from: usize) -> Vec<T> {
        let count = self.session.count().min(column.len());
        column[from.min(count)..count].to_vec()
    }

    fn vectors(&self, column: &[Vec3], from: usize) -> Vec<f32> {
        let count = self.session.count().min(column.len());
        bytemuck::cast_slice(&column[from.min(count)..count]).to_vec()
    }
}
