//! Project tasks: serve, test, build, bench.

mod bundle;
mod fingerprint;
mod node;
mod project;
mod rust_source;
mod step;
mod wasm_target;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

use bundle::Bundle;
use project::Project;

/// Tasks of the Marching Particles project.
#[derive(Parser)]
#[command(bin_name = "cargo xtask", max_term_width = 100, disable_help_subcommand = true)]
struct Arguments {
    /// Show the output of every command as it comes, not only of those that fail.
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Build the WebAssembly bundles into www/src/wasm (serve, test and build do this by themselves).
    Wasm {
        /// The bundles to build; all of them if none is named.
        bundles: Vec<Bundle>,
    },
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    step::set_verbose(arguments.verbose);
    match perform(arguments.task) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("\nerror: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn perform(task: Task) -> Result<()> {
    let project = Project::find()?;
    match task {
        Task::Wasm { bundles } => {
            let bundles = if bundles.is_empty() { Bundle::ALL.to_vec() } else { bundles };
            node::prepare(&project)?;
            bundle::build(&project, &bundles)
        }
    }
}
