//! Golden files: results that the same code gives on every platform, kept as JSON in
//! `tests/golden`.
//!
//! `UPDATE_GOLDEN=1` writes them anew, after a change that is meant to alter them.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::path::{Path, PathBuf};

/// The folder of the checkout.
pub(crate) fn checkout() -> &'static Path {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package
        .ancestors()
        .find(|folder| folder.join("Cargo.lock").is_file())
        .expect("a workspace has a lock file")
}

fn path(name: &str) -> PathBuf {
    checkout().join("tests/golden").join(name)
}

/// The content of the golden file `name`.
pub(crate) fn read<T: DeserializeOwned>(name: &str) -> T {
    let text = std::fs::read_to_string(path(name)).expect("the golden file can be read");
    serde_json::from_str(&text).expect("the golden file is well formed")
}

/// Replaces `expected` by `found`, and notes a fault where the two differ.
pub(crate) fn compare<V: PartialEq + Debug>(
    case: &str,
    expected: &mut V,
    found: V,
    faults: &mut Vec<String>,
) {
    if *expected != found {
        faults.push(format!("{case}: {found:?}, not {expected:?}"));
    }
    *expected = found;
}

/// Writes `content`, which holds what was found, where `UPDATE_GOLDEN=1` asks for it.
///
/// # Panics
///
/// Where it does not, if there are faults. The message names `module`, whose tests write the file.
pub(crate) fn finish<T: Serialize>(name: &str, content: &T, faults: &[String], module: &str) {
    if std::env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        let text =
            serde_json::to_string_pretty(content).expect("the golden file can be written as JSON") + "\n";
        std::fs::write(path(name), text).expect("the golden file can be written");
        return;
    }
    assert!(
        faults.is_empty(),
        "\n{}\nIf this was meant to change: UPDATE_GOLDEN=1 cargo test {module}::\n",
        faults.join("\n")
    );
}

/// FNV-1a hash of bytes, in 16 hexadecimal digits.
pub(crate) fn digest(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}
