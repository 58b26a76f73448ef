//! The command-line tool: samples a surface to a file and says how good the result is.

mod arguments;
mod compare;
mod failure;
mod points;
mod sample;
mod summary;
mod surfaces;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Sample(arguments) => sample::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Surfaces(arguments) => surfaces::run(&arguments),
    };
    match result {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("{failure}");
            failure.code()
        }
    }
}
