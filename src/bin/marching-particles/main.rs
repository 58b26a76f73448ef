//! Command-line tool that samples a surface, writes particles to files and reports their quality.

mod arguments;
mod failure;
mod options;
mod outcome;
mod output;
mod points;
mod sample;
mod summary;
mod surfaces;
mod sweep;

use arguments::{Arguments, Command};
use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Sample(arguments) => sample::run(*arguments),
        Command::Surfaces(arguments) => surfaces::run(&arguments),
        Command::Sweep(arguments) => sweep::run(*arguments),
    };
    match result {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("{failure}");
            failure.code()
        }
    }
}
