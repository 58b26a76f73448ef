//! Test that the same field, parameters and seed give the same particles on every platform. It
//! compares the native core with the digests in `tests/golden/digests.json`;
//! `tests/wasm/parity.mjs` compares the WebAssembly core, and the browser tests the page, with the
//! same file.
//!
//! A change that is meant to move particles rewrites the file:
//! `UPDATE_GOLDEN=1 cargo test --test it parity::`.

use crate::golden;
use marching_particles::field::model;
use marching_particles::field::rbf::Pull;
use marching_particles::internal::session::{FieldRequest, Session};
use marching_particles::pointcloud::fit_model;
use marching_particles::sampler::Settings;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Contents of the golden file.
#[derive(Serialize, Deserialize)]
struct Golden {
    runs: Vec<Run>,
    /// Runs on built-in models, which the page solves in another WebAssembly module.
    models: Vec<Run>,
    /// Runs whose particles have followed their surface.
    moved: Vec<Run>,
}

/// A run with its expected result.
#[derive(Serialize, Deserialize)]
struct Run {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    field: Option<serde_json::Value>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    model: Option<String>,
    /// Pulls on the surface of the model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pulls: Vec<Pull>,
    settings: serde_json::Value,
    /// Parameters of the surfaces that the particles of the run follow, one after the other.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    moves: Vec<BTreeMap<String, f64>>,
    count: usize,
    digest: String,
}

/// Units of work per step. Any other number must give the same particles, and the WebAssembly test
/// uses another one.
const BUDGET: u32 = 100_000;

fn run(case: &Run) -> (usize, String) {
    let mut session = Session::new();
    if let Some(field) = &case.field {
        let field: FieldRequest = serde_json::from_value(field.clone())
            .unwrap_or_else(|error| panic!("{}: the field request is malformed: {error}", case.name));
        session.set_field(&field).unwrap_or_else(|error| panic!("{}: {error}", case.name));
    }
    if let Some(model) = &case.model {
        let model = model::find(model).unwrap_or_else(|| panic!("{}: no such model", case.name));
        let fit = fit_model(model);
        session
            .set_points(
                fit.data,
                fit.info,
                fit.bounds,
                &FieldRequest { pulls: case.pulls.clone(), ..FieldRequest::default() },
            )
            .unwrap_or_else(|error| panic!("{}: {error}", case.name));
    }
    let settings: Settings = serde_json::from_value(case.settings.clone())
        .unwrap_or_else(|error| panic!("{}: the settings are malformed: {error}", case.name));
    session.start(&settings).unwrap_or_else(|error| panic!("{}: {error}", case.name));
    while session.run.step(BUDGET).stop_reason.is_none() {}
    for parameters in &case.moves {
        let request = FieldRequest { parameters: parameters.clone(), ..FieldRequest::default() };
        session.set_field(&request).unwrap_or_else(|error| panic!("{}: {error}", case.name));
        while session.fit(&|_| settings, true, BUDGET).is_none() {}
        assert_eq!(session.follow(&settings, false), Ok(()), "{}, to {parameters:?}", case.name);
        while session.run.step(BUDGET).stop_reason.is_none() {}
    }
    (session.run.count(), format!("{:016x}", session.run.particles().digest()))
}

#[test]
fn runs_have_the_digests_that_other_platforms_give() {
    let mut golden: Golden = golden::read("digests.json");
    assert!(golden.runs.len() >= 3, "there are {} runs", golden.runs.len());
    let mut faults = Vec::new();
    assert!(golden.moved.iter().all(|case| !case.moves.is_empty()), "a run has not moved");
    for case in golden.runs.iter_mut().chain(&mut golden.models).chain(&mut golden.moved) {
        let (count, digest) = run(case);
        assert!(count > 500, "{}: {count} particles are too few to show anything", case.name);
        golden::compare(&case.name, &mut case.count, count, &mut faults);
        golden::compare(&case.name, &mut case.digest, digest, &mut faults);
    }
    golden::finish("digests.json", &golden, &faults, "parity");
}
