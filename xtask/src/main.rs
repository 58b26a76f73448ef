//! Project tasks: serve, test, build, package, bench, paper.

mod bench;
mod browsers;
mod bundle;
mod check;
mod chromium;
mod debian;
mod deny;
mod fingerprint;
mod native;
mod node;
mod package;
mod paper;
mod pictures;
mod project;
mod python;
mod readers;
mod rust_source;
mod sensitivity;
mod serve;
mod site;
mod step;
mod times;
mod wasm_target;

use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

use bundle::{Bundle, Declarations, Purpose};
use project::Project;

const EXAMPLES: &str = "\
Examples:
  cargo xtask serve --open            work on the page; Rust and shaders are rebuilt when they change
  cargo xtask serve --release-site    look at the site as it will be published
  cargo xtask test                    what continuous integration runs for every change
  cargo xtask test --all              besides, everything that the published site is held to
  cargo xtask test --fast             format, lint and native tests
  cargo xtask test page browser       only these parts
  cargo xtask bench --web             the whole job in headless Chromium
  cargo xtask build                   the static site in dist/, for any static host";

/// Tasks of the Marching Particles project.
///
/// Every task sets up what it needs and is missing: the compiler's WebAssembly target, the page's
/// npm packages, a Chromium for the browser tests. What cannot be set up is named, with what to
/// install. Node.js 20.19 or newer is the one thing to have beside Rust.
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
    /// Run the checks: format, lints, native tests, WebAssembly, page, Chromium; with --all
    /// everything else, too.
    Test(check::Options),
    /// Build the static site into dist/ and hold its size to the budgets.
    Build,
    /// Build and pack the package for npm into target/package, and try it; nothing is published.
    Package,
    /// Run the benches.
    Bench(bench::Options),
    /// Halve and double constants of the sampler, and print what changes on random surfaces; a
    /// minute or two each.
    Sensitivity(sensitivity::Options),
    /// Run the paper's jobs and write its tables (docs/tables/paper.md) and figures
    /// (docs/images/paper).
    Paper(paper::Options),
    /// Build the WebAssembly bundles into www/src/wasm and rewrite their declarations (serve, test
    /// and build do the first by themselves).
    Wasm {
        /// Those of the development server, which are compiled sooner and sample up to 15 % slower.
        #[arg(long)]
        development: bool,
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
            site::build(&project, Purpose::Site)?;
            site::report_sizes(&project)
        }
        Task::Package => package::package(&project),
        Task::Bench(options) => bench::bench(&project, &options),
        Task::Sensitivity(options) => sensitivity::run(&project, &options),
        Task::Paper(options) => paper::paper(&project, &options),
        Task::Wasm { development, bundles } => {
            let bundles = if bundles.is_empty() { Bundle::ALL.to_vec() } else { bundles };
            node::prepare(&project)?;
            let purpose = if development { Purpose::Development } else { Purpose::Site };
            bundle::build(&project, &bundles, purpose, Declarations::Rewrite)
        }
    }
}
