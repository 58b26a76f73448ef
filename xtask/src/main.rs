//! Project tasks: serve, test, build, bench, paper.

mod bench;
mod bundle;
mod check;
mod chromium;
mod debian;
mod deny;
mod engines;
mod fingerprint;
mod node;
mod paper;
mod project;
mod rust_source;
mod serve;
mod site;
mod step;
mod wasm_target;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

use bundle::{Bundle, Purpose};
use project::Project;

const EXAMPLES: &str = "\
Examples:
  cargo xtask serve --open            work on the page; Rust and shaders are rebuilt when they change
  cargo xtask serve --release-site    look at the site as it will be published
  cargo xtask test --fast             format, lint and native tests
  cargo xtask test page browser       only these parts
  cargo xtask bench --web             the whole job in headless Chromium
  cargo xtask build                   the static site in dist/, for any static host";

/// Tasks of the Marching Particles project.
///
/// Every task sets up what it needs and is missing: the compiler's WebAssembly target, the page's npm packages, a
/// Chromium for the browser tests. What cannot be set up is named, with what to install. Node.js 20.19 or newer is the
/// one thing to have beside Rust.
#[derive(Parser)]
#[command(bin_name = "cargo xtask", max_term_width = 100, disable_help_subcommand = true, after_help = EXAMPLES)]
struct Arguments {
    /// Show the output of every command as it comes, not only of those that fail.
    #[arg(short, long, global = true)]
    verbose: bool,
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Serve the page for development and print its address.
    Serve(serve::Options),
    /// Run the checks: format, lints, documentation, native tests, WebAssembly, page, browser.
    Test(check::Options),
    /// Build the static site into dist/ and hold its size to the budgets.
    Build,
    /// Run the benches.
    Bench(bench::Options),
    /// Run the paper's jobs and write its tables (docs/tables/paper.md) and figures (docs/paper).
    Paper(paper::Options),
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
        Task::Serve(options) => serve::serve(&project, &options),
        Task::Test(options) => check::test(&project, &options),
        Task::Build => {
            site::build(&project)?;
            site::report_sizes(&project)
        }
        Task::Bench(options) => bench::bench(&project, &options),
        Task::Paper(options) => paper::paper(&project, &options),
        Task::Wasm { bundles } => {
            let bundles = if bundles.is_empty() { Bundle::ALL.to_vec() } else { bundles };
            node::prepare(&project)?;
            bundle::build(&project, &bundles, Purpose::Site)
        }
    }
}
