//! The bundle for models from points: a [`Job`] behind JSON strings and copies of its results.

use crate::json;
use crate::pointcloud::job::{DEFAULT_CENTRES, Job, JobError};
use serde::Serialize;
use wasm_bindgen::prelude::wasm_bindgen;

/// From a built-in model or a file to a field. Strings are JSON.
#[wasm_bindgen]
#[derive(Default)]
pub struct Points {
    job: Option<Job>,
}

/// What is wrong, as the page shows it.
#[derive(Serialize)]
struct Refusal<'a> {
    kind: &'static str,
    message: &'a str,
    line: Option<u64>,
}

fn refused(kind: &'static str, message: &str, line: Option<u64>) -> String {
    let refusal = Refusal { kind, message, line };
    format!(r#"{{"ok":false,"error":{}}}"#, json::to_string(&refusal).unwrap_or_default())
}

fn wrong(error: &JobError) -> String {
    refused(error.kind(), &error.to_string(), error.line())
}

/// An answer, which has fields, with `ok` among them.
fn accepted(value: &impl Serialize) -> String {
    match json::to_string(value) {
        Ok(mut answer) => {
            answer.insert_str(1, r#""ok":true,"#);
            answer
        }
        Err(error) => refused("json", &error.to_string(), None),
    }
}

/// What there is to know of a field.
#[derive(Serialize)]
struct Known<'a> {
    info: &'a crate::pointcloud::ModelInfo,
    bounds: crate::math::Bounds,
}

#[wasm_bindgen]
impl Points {
    /// Nothing begun.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self::default()
    }

    /// Begins a built-in model; what was begun before is given up.
    pub fn model(&mut self, id: &str) -> String {
        self.begin(Job::model(id))
    }

    /// Begins a file; `name` is for reports. 0 centres are the default number of them.
    pub fn file(&mut self, name: &str, bytes: Vec<u8>, centres: u32) -> String {
        // Room for the old one's points goes before that for the new one's is taken.
        self.job = None;
        self.begin(Job::file(name, bytes, if centres == 0 { DEFAULT_CENTRES } else { centres }))
    }

    /// Does up to `budget` pieces of work: `Progress`.
    pub fn step(&mut self, budget: u32) -> String {
        match self.job.as_mut().map(|job| job.step(budget)) {
            Some(Ok(progress)) => accepted(&progress),
            Some(Err(error)) => wrong(&error),
            None => refused("nothing", "no model and no file was begun", None),
        }
    }

    /// The field as `Core.set_points` takes it; nothing before it is there.
    pub fn field(&self) -> Vec<u8> {
        self.job.as_ref().and_then(Job::fit).map(|fit| fit.data.to_bytes()).unwrap_or_default()
    }

    /// What there is to know of the field.
    pub fn info(&self) -> String {
        match self.job.as_ref().and_then(Job::fit) {
            Some(fit) => accepted(&Known { info: &fit.info, bounds: fit.bounds }),
            None => refused("nothing", "there is no field yet", None),
        }
    }

    /// Positions of the centres, three floats each; none before they are chosen.
    pub fn centres(&self) -> Vec<f32> {
        let centres = self.job.as_ref().map(Job::centres).unwrap_or_default();
        centres.iter().flat_map(|p| p.as_vec3().to_array()).collect()
    }

    fn begin(&mut self, job: Result<Job, JobError>) -> String {
        match job {
            Ok(job) => {
                let answer = accepted(&job.progress());
                self.job = Some(job);
                answer
            }
            Err(error) => {
                self.job = None;
                wrong(&error)
            }
        }
    }
}
