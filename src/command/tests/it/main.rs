//! Tests of the command-line tool, which run the binary. They are one binary themselves:
//! `cargo test --test cli sweeps::` runs one module.

mod cli;
mod code;
#[path = "../../../../tests/it/golden.rs"]
#[expect(dead_code, reason = "no bytes are digested here")]
mod golden;
mod images;
mod meshes;
mod records;
mod spacing;
mod sweeps;
mod thickness;
mod threads;
mod values;
