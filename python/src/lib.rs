//! The compiled half of the Python package `marching_particles`. It takes what the Python half,
//! `package/`, has checked, and gives arrays, tuples and JSON back.

mod errors;
mod field;
mod run;

use field::Field;
use marching_particles::{CENTRES, Settings};
use pyo3::prelude::*;
use run::{Sample, sample};

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // The smallest and the largest number that is accepted.
    let counts = Settings::range("count").expect("a setting that is a number");
    module.add("COUNTS", (*counts.start() as u32, *counts.end() as u32))?;
    module.add("CENTRES", (*CENTRES.start(), *CENTRES.end()))?;
    module.add_class::<Field>()?;
    module.add_class::<Sample>()?;
    module.add_function(wrap_pyfunction!(sample, module)?)
}
