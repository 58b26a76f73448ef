//! Writes a module and its JavaScript to a folder: `bind MODULE NAME FOLDER`.
//!
//! It does the work of the command `wasm-bindgen --target web`, as a library: the lock file pins
//! its version, and no tool has to be installed. It is a separate program, compiled at the same
//! time as the modules, because it takes longer to compile than all other tasks together.

use anyhow::{Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [module, name, folder] = &arguments[..] else { bail!("usage: bind MODULE NAME FOLDER") };
    Bindgen::new()
        .input_path(module)
        .out_name(name)
        .typescript(true)
        // Keeps `new URL('…_bg.wasm', import.meta.url)` in the module, by which bundlers find the
        // wasm file.
        .omit_default_module_path(false)
        .remove_producers_section(true)
        .web(true)?
        .generate(folder)
}
