//! The development server.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context, Result, bail};

use crate::bundle::{self, Bundle};
use crate::fingerprint::files_under;
use crate::node;
use crate::project::Project;
use crate::site;
use crate::step;

/// How often the Rust sources are looked at.
const LOOK_EVERY: Duration = Duration::from_millis(400);

/// Loaded into the server: it ends when its input does, that is when this process is gone, however it went.
const END_WITH_INPUT: &str = "data:text/javascript,process.stdin.on('end',()=>process.exit()).resume()";

/// What to serve, and where.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Open the page in the default browser.
    #[arg(long)]
    open: bool,
    /// The port to listen on; the next free one if it is taken.
    #[arg(long, default_value_t = 5173)]
    port: u16,
    /// Serve the built static site (dist/) in place of the development server.
    #[arg(long)]
    release_site: bool,
}

/// Builds what is out of date, serves the page, and rebuilds the bundles whenever a Rust source or a shader changes.
pub(crate) fn serve(project: &Project, options: &Options) -> Result<()> {
    let started = Instant::now();
    if options.release_site {
        site::build(project)?;
    } else {
        node::prepare(project)?;
        bundle::build(project, &Bundle::ALL)?;
    }
    println!("  ready after {}; stop with Ctrl-C", step::seconds(started.elapsed()));
    let mut server = Server(start_vite(project, options)?);
    let mut seen = sources(project)?;
    loop {
        if let Some(status) = server.0.try_wait()? {
            if status.success() {
                return Ok(());
            }
            bail!("the server ended ({status})");
        }
        std::thread::sleep(LOOK_EVERY);
        if options.release_site {
            continue;
        }
        let now = sources(project)?;
        if now == seen {
            continue;
        }
        seen = now;
        println!("\n  sources changed");
        // A source that does not compile is an everyday event: say so and keep serving the last good bundles.
        if let Err(error) = bundle::build(project, &Bundle::ALL) {
            eprintln!("\nerror: {error:#}\n");
        }
    }
}

/// The server's process, ended with this one.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended already; then there is nothing to do.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start_vite(project: &Project, options: &Options) -> Result<Child> {
    let vite = project.www.join("node_modules/vite/bin/vite.js");
    if !vite.is_file() {
        bail!(
            "{} is missing: the package `vite` belongs to www/package.json",
            project.relative(&vite).display()
        );
    }
    let mut command = Command::new(node::node()?);
    command.args(["--import", END_WITH_INPUT]).arg(vite).current_dir(&project.www).stdin(Stdio::piped());
    if options.release_site {
        command.arg("preview");
    }
    command.args(["--clearScreen", "false", "--port", &options.port.to_string()]);
    if options.open {
        command.arg("--open");
    }
    command.spawn().context("could not start Vite")
}

/// Every source that goes into a bundle, with the time it was last written.
fn sources(project: &Project) -> Result<Vec<(PathBuf, Option<SystemTime>)>> {
    let mut files = files_under(&project.root.join("src"))?;
    files.extend(files_under(&project.root.join("shaders"))?);
    files.extend(["Cargo.toml", "Cargo.lock"].map(|name| project.root.join(name)));
    // A file may vanish between being listed and being looked at.
    Ok(files
        .into_iter()
        .map(|file| (file.clone(), file.metadata().and_then(|metadata| metadata.modified()).ok()))
        .collect())
}
