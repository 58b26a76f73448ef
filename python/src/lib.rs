//! The compiled half of the Python package `marching_particles`. It takes what the Python half,
//! `package/`, has checked, and gives arrays, tuples and JSON back.

mod errors;
mod field;
mod run;

use field::{Field, Mesh};
use marching_particles::CENTRES;
use marching_particles::session::settings;
use pyo3::prelude::*;
use run::{Sample, sample};

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SETTINGS", settings_table())?;
    // The smallest and the largest number that is accepted.
    module.add("CENTRES", (*CENTRES.start(), *CENTRES.end()))?;
    module.add_class::<Field>()?;
    module.add_class::<Mesh>()?;
    module.add_class::<Sample>()?;
    module.add_function(wrap_pyfunction!(sample, module)?)
}

/// The settings as JSON: of each its argument, its name, the type of its values, their range and
/// whether it is a share of the diagonal of the box.
fn settings_table() -> String {
    let rows = settings().into_iter().map(|setting| {
        let choices: Vec<&str> = setting.choices.iter().map(|choice| choice.value).collect();
        serde_json::json!({
            "argument": setting.argument(),
            "name": setting.name,
            "kind": setting.kind,
            "least": setting.accepted().start(),
            "most": setting.accepted().end(),
            "is_share": setting.is_share(),
            "choices": choices,
        })
    });
    serde_json::Value::from_iter(rows).to_string()
}
