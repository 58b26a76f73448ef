//! `xtask-bindgen INPUT.wasm OUT_DIR OUT_NAME`: writes `OUT_NAME.js`, `OUT_NAME.d.ts` and `OUT_NAME_bg.wasm`.
//!
//! This is the work of the `wasm-bindgen` command with `--target web`, called as a library so that its version is
//! pinned by the lock file and nobody has to install a tool.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, out_dir, out_name] = arguments.as_slice() else {
        bail!("usage: xtask-bindgen INPUT.wasm OUT_DIR OUT_NAME");
    };
    let out_dir = PathBuf::from(out_dir);
    Bindgen::new()
        .input_path(input)
        .out_name(out_name)
        .typescript(true)
        // Keeps `new URL('…_bg.wasm', import.meta.url)` in the module, which is how bundlers find the wasm file.
        .omit_default_module_path(false)
        .remove_producers_section(true)
        .web(true)?
        .generate(&out_dir)
        .with_context(|| format!("could not bind {input}"))
}
