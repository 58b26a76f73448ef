//! The compiled half of the Python package `marching_particles`. It takes arguments that the Python
//! half, `package/`, has checked, and returns arrays, tuples and JSON.

mod errors;
mod field;
mod run;

use field::{Field, Mesh};
use marching_particles::internal::session::settings;
use marching_particles::pointcloud::CENTRES;
use pyo3::prelude::*;
use run::{Sample, sample};

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SETTINGS", settings_table())?;
    // The smallest and the largest accepted number.
    module.add("CENTRES", (*CENTRES.start(), *CENTRES.end()))?;
    module.add_class::<Field>()?;
    module.add_class::<Mesh>()?;
    module.add_class::<Sample>()?;
    module.add_function(wrap_pyfunction!(sample, module)?)
}

/// The settings as JSON: for each its argument, its name, the type and range of its values, and
/// whether it is a share of the box's diagonal.
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
