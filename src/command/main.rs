//! Command-line tool that samples a surface, writes particles to files and reports their quality.

mod arguments;
mod bar;
mod code;
mod failure;
mod image;
mod options;
mod outcome;
mod output;
mod points;
mod porosity;
mod reading;
mod remesh;
mod sample;
mod spacing;
mod summary;
mod surface;
mod surfaces;
mod sweep;
mod wall;

use arguments::{Arguments, Command};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{CommandFactory, Parser};
use clap_complete::Shell;
use failure::Failure;
use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    let Arguments { command, threads } = Arguments::try_parse().unwrap_or_else(|error| refused(&error));
    let result = start_threads(threads).and_then(|()| match command {
        Command::Sample(arguments) => sample::run(*arguments),
        Command::Surfaces(arguments) => surfaces::run(&arguments),
        Command::Sweep(arguments) => sweep::run(*arguments),
        Command::Completions { shell } => completions(shell),
        Command::Man { directory } => man(&directory),
    });
    match result {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("{failure}");
            failure.code()
        }
    }
}

/// Ends the program with what is wrong with its arguments.
fn refused(error: &clap::Error) -> ! {
    if error.kind() == ErrorKind::InvalidSubcommand
        && let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand)
        && error.get(ContextKind::SuggestedSubcommand).is_none()
    {
        eprintln!("error: there is no command `{word}`; a surface follows a command: sample \"{word}\"");
        std::process::exit(error.exit_code());
    }
    error.exit()
}

/// Starts the threads that share the work, including this one: one per processor by default.
fn start_threads(threads: Option<NonZeroUsize>) -> Result<(), Failure> {
    // Without this thread in the pool, it would wait and wake another one each time work is shared.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, NonZeroUsize::get));
    let started = pool.use_current_thread().build_global();
    started.map_err(|error| Failure::Usage(format!("cannot start threads: {error}")))
}

/// Prints the script with which a shell completes the arguments.
fn completions(shell: Shell) -> Result<ExitCode, Failure> {
    let mut command = Arguments::command();
    let name = command.get_name().to_owned();
    // Generated into memory, since the generator panics if the reader of its output closes.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut command, name, &mut script);
    io::Write::write_all(&mut io::stdout(), &script)?;
    Ok(ExitCode::SUCCESS)
}

/// Writes the manual pages of all commands.
fn man(directory: &Path) -> Result<ExitCode, Failure> {
    let failed = |error| Failure::File { path: PathBuf::from(directory), error };
    std::fs::create_dir_all(directory).map_err(failed)?;
    clap_mangen::generate_to(Arguments::command(), directory).map_err(failed)?;
    Ok(ExitCode::SUCCESS)
}
