//! The bundle for models from points: a [`Job`] behind plain objects and copies of its results.
#![cfg(target_arch = "wasm32")]

use marching_particles::field::model::SolvedModel;
use marching_particles::pointcloud::job::{DEFAULT_CENTRES, Job, JobError};
use marching_particles_values::answer;
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// Where the declarations of the bundle find the types of the values.
#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r"import type {
  Answer,
  PointsProgress,
  SolvedModel,
} from '../../engine/core-types.js';";

/// Solver that makes a field from a built-in model or a file of points. Answers are plain objects.
#[wasm_bindgen]
#[derive(Default)]
pub struct Points {
    job: Option<Job>,
}

#[wasm_bindgen]
impl Points {
    /// A solver without a job.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        console_error_panic_hook::set_once();
        Self::default()
    }

    /// Begins a built-in model, and drops the previous job: an `Answer` with `PointsProgress`. 0
    /// centres mean their default number.
    #[wasm_bindgen(unchecked_return_type = "Answer<PointsProgress, string>")]
    pub fn model(&mut self, id: &str, centres: u32) -> JsValue {
        self.begin(|| Job::model(id, wanted(centres)))
    }

    /// Begins a file, and drops the previous job: an `Answer` with `PointsProgress`. `name` is for
    /// reports. 0 centres mean their default number.
    #[wasm_bindgen(unchecked_return_type = "Answer<PointsProgress, string>")]
    pub fn file(&mut self, name: &str, bytes: Vec<u8>, centres: u32) -> JsValue {
        self.begin(|| Job::file(name, bytes, wanted(centres)))
    }

    /// Does up to `budget` slices of work: an `Answer` with `PointsProgress`.
    #[wasm_bindgen(unchecked_return_type = "Answer<PointsProgress, string>")]
    pub fn step(&mut self, budget: u32) -> JsValue {
        let job = self.job.as_mut().ok_or_else(|| "no model and no file was begun".to_owned());
        answer(job.and_then(|job| job.step(budget).map_err(|error| error.to_string())))
    }

    /// The field for `Core.set_points`; empty until it is solved.
    pub fn field(&self) -> Vec<u8> {
        self.job.as_ref().and_then(Job::fit).map(|fit| fit.data.to_bytes()).unwrap_or_default()
    }

    /// The report on the model: an `Answer` with `SolvedModel`.
    #[wasm_bindgen(unchecked_return_type = "Answer<SolvedModel, string>")]
    pub fn info(&self) -> JsValue {
        let fit = self.job.as_ref().and_then(Job::fit).ok_or("there is no field yet");
        answer(fit.map(|fit| SolvedModel { info: fit.info.clone(), bounds: fit.bounds }))
    }

    /// Positions of the centres, three floats each; none before they are chosen.
    pub fn centres(&self) -> Vec<f32> {
        let centres = self.job.as_ref().map(Job::centres).unwrap_or_default();
        centres.iter().flat_map(|p| p.as_vec3().to_array()).collect()
    }

    fn begin(&mut self, job: impl FnOnce() -> Result<Job, JobError>) -> JsValue {
        // The old job's memory is freed before the new one's is allocated.
        self.job = None;
        let begun = job().map(|job| self.job.insert(job).progress());
        answer(begun.map_err(|error| error.to_string()))
    }
}

/// The wanted number of centres: 0 means the default number.
fn wanted(centres: u32) -> u32 {
    if centres == 0 { DEFAULT_CENTRES } else { centres }
}
