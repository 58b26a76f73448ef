//! `xtask-bindgen INPUT.wasm OUT_DIR OUT_NAME [LATER…]`: writes `OUT_NAME.js`, `OUT_NAME.d.ts` and `OUT_NAME_bg.wasm`; and
//! `OUT_NAME_rest.wasm`, with the functions whose names contain one of the words `LATER` (see [`split`]).
//!
//! This is the work of the `wasm-bindgen` command with `--target web`, called as a library so that its version is
//! pinned by the lock file and nobody has to install a tool.

mod constants;
mod split;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [input, out_dir, out_name, later @ ..] = arguments.as_slice() else {
        bail!("usage: xtask-bindgen INPUT.wasm OUT_DIR OUT_NAME [LATER…]");
    };
    let out_dir = PathBuf::from(out_dir);
    Bindgen::new()
        .input_path(input)
        .out_name(out_name)
        .typescript(true)
        // Keeps `new URL('…_bg.wasm', import.meta.url)` in the module, which is how bundlers find the wasm file.
        .omit_default_module_path(false)
        // The names as the linker knows them.
        .demangle(false)
        .remove_producers_section(true)
        .web(true)?
        .generate(&out_dir)
        .with_context(|| format!("could not bind {input}"))?;
    if !later.is_empty() {
        let read = |path: &Path| fs::read(path).with_context(|| format!("could not read {}", path.display()));
        let [bound, rest, script, types] = ["_bg.wasm", "_rest.wasm", ".js", ".d.ts"]
            .map(|ending| out_dir.join(format!("{out_name}{ending}")));
        let (first_part, rest_part) = split::split(&read(Path::new(input))?, &read(&bound)?, later)
            .with_context(|| format!("could not split {input}"))?;
        let joining = split::script(&String::from_utf8(read(&script)?)?)?;
        let typed = [read(&types)?, split::TYPES.as_bytes().to_vec()].concat();
        let files =
            [(&bound, first_part), (&rest, rest_part), (&script, joining.into_bytes()), (&types, typed)];
        for (path, content) in files {
            fs::write(path, content).with_context(|| format!("could not write {}", path.display()))?;
        }
    }
    Ok(())
}
