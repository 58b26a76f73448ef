//! The development server. Bundles that the page needs at once are built before it starts, the
//! others while it serves.

use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use anyhow::{Context, Result, anyhow, bail};

use crate::bundle::{self, Bundle, Declarations, Purpose};
use crate::fingerprint::files_under;
use crate::node;
use crate::project::Project;
use crate::site;
use crate::step;

/// How often the Rust sources are checked for changes.
const LOOK_EVERY: Duration = Duration::from_millis(400);

/// Loaded into the server: it ends when its input closes, which happens however this process ends.
const END_WITH_INPUT: &str = "data:text/javascript,process.stdin.on('end',()=>process.exit()).resume()";

/// Options of the development server.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Open the page in the default browser.
    #[arg(long)]
    open: bool,
    /// The port to listen on; the next free one if it is taken.
    #[arg(long, default_value_t = 5173)]
    port: u16,
    /// Draw with WebGPU where the browser has it, which compiles a second renderer; without this,
    /// with WebGL2.
    #[arg(long)]
    webgpu: bool,
    /// Serve the built static site (dist/) in place of the development server.
    #[arg(long)]
    release_site: bool,
}

/// Builds what is out of date, serves the page, and rebuilds the bundles after every change of a
/// Rust source or a shader.
pub(crate) fn serve(project: &Project, options: &Options) -> Result<()> {
    let started = Instant::now();
    // One renderer suffices, and WebGL2 runs in every browser. The last two bundles are for what a
    // visitor may request later.
    let mut bundles = vec![Bundle::Core, Bundle::Webgl];
    bundles.extend(options.webgpu.then_some(Bundle::Webgpu));
    let first = bundles.len();
    bundles.extend([Bundle::Points, Bundle::Lesson]);
    if options.release_site {
        site::build(project, Purpose::Site)?;
    } else {
        // Without Node there is nothing to wait for.
        node::node()?;
        // Fetching packages waits for the network while compiling uses the processor.
        thread::scope(|scope| {
            let packages = scope.spawn(|| node::prepare(project));
            let built =
                bundle::build(project, &bundles[..first], Purpose::Development, Declarations::Rewrite);
            packages.join().map_err(|_| anyhow!("fetching the page's packages ended with a panic"))??;
            built
        })?;
    }
    println!("  ready after {}; stop with Ctrl-C", step::seconds(started.elapsed()));
    let mut server = Server(start_vite(project, options)?);
    let mut seen = Vec::new();
    loop {
        if let Some(status) = server.0.try_wait()? {
            if status.success() {
                return Ok(());
            }
            bail!("the server ended ({status})");
        }
        thread::sleep(LOOK_EVERY);
        if options.release_site {
            continue;
        }
        let now = sources(project)?;
        if now == seen {
            continue;
        }
        if !seen.is_empty() {
            println!("\n  sources changed");
        }
        seen = now;
        // A source that does not compile is an everyday event: report it and keep serving the last
        // valid bundles.
        if let Err(error) = bundle::build(project, &bundles, Purpose::Development, Declarations::Rewrite) {
            eprintln!("\nerror: {error:#}\n");
        }
    }
}

/// The server's process, which ends with this one.
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
    } else if !options.webgpu {
        command.env("VITE_WITHOUT_WEBGPU", "1");
    }
    command.args(["--clearScreen", "false", "--port", &options.port.to_string()]);
    if options.open {
        command.arg("--open");
    }
    command.spawn().context("could not start Vite")
}

/// Every source of a bundle, with the time of its last change.
fn sources(project: &Project) -> Result<Vec<(PathBuf, Option<SystemTime>)>> {
    let mut files = files_under(&project.root.join("src"))?;
    files.extend(files_under(&project.root.join("shaders"))?);
    files.extend(["Cargo.toml", "Cargo.lock"].map(|name| project.root.join(name)));
    // A file may be deleted between being listed and being examined.
    Ok(files
        .into_iter()
        .map(|file| (file.clone(), file.metadata().and_then(|metadata| metadata.modified()).ok()))
        .collect())
}
