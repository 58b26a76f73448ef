//! The WebAssembly bundles: the core, the solver for points, the lesson, and the renderer for
//! WebGPU and for WebGL2.
//!
//! A bundle is built in these steps: cargo (SIMD) → wasm-bindgen → wasm-opt →
//! `target/xtask/bundles` → `www/src/wasm`, from where the page loads it, whatever its purpose. For
//! development and for `cargo xtask test`, cargo optimises less and wasm-opt is left out. Only the
//! declarations are checked in, because the page's types come from `src/web/`. A bundle is skipped
//! if a hash over all its inputs is unchanged; if cargo produces the same module as before, binding
//! and optimising are skipped, too.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::thread;

use anyhow::{Context, Result, anyhow, bail};
use serde_json::{Value, json};

use crate::fingerprint::{Fingerprint, files_under, sha256_of};
use crate::node;
use crate::project::{Project, cargo};
use crate::step;
use crate::wasm_target::WasmTarget;

/// Purpose for which a bundle is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// The published site, and benches.
    Site,
    /// The development server and the quick tests: soon compiled, by the profile `wasm-dev`, and
    /// not optimised for size.
    Development,
}

/// What happens when the checked-in declarations of a bundle differ from what `src/web/` declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Declarations {
    /// They are rewritten.
    Rewrite,
    /// The build fails.
    Hold,
}

impl Purpose {
    /// Cargo's profile.
    fn profile(self) -> &'static str {
        match self {
            Self::Site => "release",
            Self::Development => "wasm-dev",
        }
    }
}

/// One of the bundles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Bundle {
    /// The sampler, which runs in a worker.
    Core,
    /// The solver that makes fields from files of points. It runs in a worker of its own when it is
    /// asked for.
    Points,
    /// The paper's algorithms event by event, which run in a worker of their own when the lesson is
    /// asked for.
    Lesson,
    /// The renderer on WebGPU.
    Webgpu,
    /// The renderer on WebGL2.
    Webgl,
}

impl Bundle {
    /// Every bundle, that which all others need first.
    pub(crate) const ALL: [Self; 5] = [Self::Core, Self::Points, Self::Lesson, Self::Webgl, Self::Webgpu];

    /// The folder under `www/src/wasm`.
    pub(crate) fn folder(self) -> &'static str {
        match self {
            Self::Core => "core",
            Self::Points => "points",
            Self::Lesson => "lesson",
            Self::Webgpu => "render-webgpu",
            Self::Webgl => "render-webgl",
        }
    }

    /// The name of the bundle's files, without extension.
    pub(crate) fn out_name(self) -> &'static str {
        match self {
            Self::Core => "core",
            Self::Points => "points",
            Self::Lesson => "lesson",
            Self::Webgpu | Self::Webgl => "render",
        }
    }

    /// The file of its WebAssembly module.
    pub(crate) fn module(self) -> String {
        format!("{}_bg.wasm", self.out_name())
    }

    /// The JavaScript class of the bundle.
    fn class(self) -> &'static str {
        match self {
            Self::Core => "Core",
            Self::Points => "Points",
            Self::Lesson => "Lesson",
            Self::Webgpu | Self::Webgl => "Renderer",
        }
    }

    /// The package from which it is compiled.
    pub(crate) fn package(self) -> &'static str {
        match self {
            Self::Core => "marching-particles-core",
            Self::Points => "marching-particles-points",
            Self::Lesson => "marching-particles-lesson",
            Self::Webgpu => "marching-particles-webgpu",
            Self::Webgl => "marching-particles-webgl",
        }
    }

    /// The core and the solver are built for speed. The renderers work on the GPU and the lesson's
    /// runs are slow on purpose, so the time to load them counts more.
    fn opt_level(self) -> &'static str {
        match self {
            Self::Core | Self::Points => "3",
            Self::Lesson => "z",
            Self::Webgpu | Self::Webgl => "z",
        }
    }

    /// Compiler flags of this bundle. A function with a higher inlining cost is called instead of
    /// copied into its callers (LLVM's default is 250): the core weighs 7 % less. Hot functions are
    /// marked `#[inline]`, so that sampling takes as many instructions as before; at 40 the core
    /// weighs 9 % less and takes 1 to 4 % more. In development all bundles have the same flags, so
    /// that the library is compiled once.
    fn flags(self, purpose: Purpose) -> &'static [&'static str] {
        match (self, purpose) {
            (Self::Core | Self::Points, _) | (_, Purpose::Development) => {
                &["-Cllvm-args=-inline-threshold=100"]
            }
            _ => &[],
        }
    }

    /// The folders under the root with the sources of the bundle: those of its package and of its
    /// dependencies.
    fn sources(self, project: &Project) -> Result<Vec<PathBuf>> {
        let (own, is_of_library) = match self {
            Self::Core => ("src/web/core", true),
            Self::Points => ("src/web/points", true),
            Self::Lesson => ("src/web/lesson", true),
            Self::Webgpu => ("src/web/webgpu", false),
            Self::Webgl => ("src/web/webgl", false),
        };
        if !is_of_library {
            return Ok([own, "src/render", "shaders"].map(PathBuf::from).to_vec());
        }
        let mut folders = vec![own.into(), "src/web/values".into()];
        // The folders of the library are those without a package of their own.
        for entry in fs::read_dir(project.root.join("src"))? {
            let path = entry?.path();
            if path.is_dir() && !path.join("Cargo.toml").is_file() && !path.ends_with("web") {
                folders.push(project.relative(&path).to_owned());
            }
        }
        folders.sort();
        Ok(folders)
    }

    fn wasm_opt(self) -> &'static [&'static str] {
        match self {
            Self::Core | Self::Points => &["-O3", "--strip-debug", "--strip-producers"],
            Self::Lesson | Self::Webgpu | Self::Webgl => &["-Oz", "--strip-debug", "--strip-producers"],
        }
    }
}

/// Builds the bundles that are out of date, and copies them to where the page loads them from.
pub(crate) fn build(
    project: &Project,
    bundles: &[Bundle],
    purpose: Purpose,
    declarations: Declarations,
) -> Result<()> {
    let target = WasmTarget::prepare(project)?;
    let read = |&bundle: &Bundle| Stamp::read(project, &target, bundle, purpose);
    let stamps: Vec<Stamp> = bundles.iter().map(read).collect::<Result<_>>()?;
    if !stamps.iter().all(Stamp::is_current) {
        // Cargo does both, in separate folders.
        let (modules, binder) = thread::scope(|scope| {
            let binder = scope.spawn(|| binder(project));
            (compile(project, &target, &stamps, purpose), binder.join())
        });
        let (modules, binder) =
            (modules?, binder.map_err(|_| anyhow!("compiling `bind` ended with a panic"))??);
        for stamp in stamps.iter().filter(|stamp| !stamp.is_current()) {
            let package = stamp.bundle.package();
            let module = modules.get(package);
            let module = module.with_context(|| format!("cargo named no module of {package}"))?;
            stamp.finish(project, purpose, &binder, module)?;
        }
    }
    for &bundle in bundles {
        let folder = folder(project, bundle, purpose)?;
        let page = project.www.join("src/wasm").join(bundle.folder());
        if declarations == Declarations::Hold {
            hold_declarations(project, bundle, &folder, &page)?;
        }
        publish(&folder, &page)?;
    }
    let current: Vec<&str> =
        stamps.iter().filter(|stamp| stamp.is_current()).map(|stamp| stamp.bundle.folder()).collect();
    if !current.is_empty() {
        println!("  up to date: {}", current.join(", "));
    }
    Ok(())
}

/// The folder in which a bundle is built.
fn folder(project: &Project, bundle: Bundle, purpose: Purpose) -> Result<PathBuf> {
    Ok(project.scratch("bundles")?.join(purpose.profile()).join(bundle.folder()))
}

/// The inputs of a bundle when it was last built, and its present ones.
struct Stamp {
    bundle: Bundle,
    /// The file in which they are stored.
    file: PathBuf,
    /// The folder in which the bundle is built.
    folder: PathBuf,
    /// A hash over the present inputs.
    inputs: String,
    last: Value,
    /// Whether the files of the last build are unchanged.
    is_intact: bool,
}

impl Stamp {
    fn read(project: &Project, target: &WasmTarget, bundle: Bundle, purpose: Purpose) -> Result<Self> {
        let name = bundle.folder();
        let file = project.scratch("stamps")?.join(format!("{name}-{}.json", purpose.profile()));
        let last: Value =
            fs::read(&file).ok().and_then(|text| serde_json::from_slice(&text).ok()).unwrap_or_default();
        let folder = folder(project, bundle, purpose)?;
        let is_intact = last["outputs"].as_object().is_some_and(|outputs| {
            let is_as_left = |(file, hash): (&String, &Value)| {
                sha256_of(&folder.join(file)).is_ok_and(|have| hash == have.as_str())
            };
            !outputs.is_empty() && outputs.iter().all(is_as_left)
        });
        Ok(Self { bundle, file, folder, inputs: inputs(project, target, bundle, purpose)?, last, is_intact })
    }

    fn is_current(&self) -> bool {
        self.is_intact && self.last["inputs"] == self.inputs.as_str()
    }

    /// Makes the bundle from the compiled module.
    fn finish(&self, project: &Project, purpose: Purpose, binder: &Path, module: &Path) -> Result<()> {
        let Self { bundle, ref folder, .. } = *self;
        let process =
            Fingerprint::default().file(module)?.text("process", &process_version(project, bundle)?).finish();
        if !(self.is_intact && self.last["process"] == process.as_str()) {
            if folder.exists() {
                fs::remove_dir_all(folder)?;
            }
            bind(bundle, binder, module, folder)?;
            if purpose == Purpose::Site {
                optimise(project, bundle, folder)?;
            }
        }
        let mut outputs = serde_json::Map::new();
        for file in files_under(folder)? {
            let relative = file.strip_prefix(folder)?.to_string_lossy().into_owned();
            outputs.insert(relative, Value::from(sha256_of(&file)?));
        }
        let stamp = json!({ "inputs": self.inputs, "process": process, "outputs": outputs });
        Ok(fs::write(&self.file, serde_json::to_vec_pretty(&stamp)?)?)
    }
}

/// A hash over all inputs of a bundle.
fn inputs(project: &Project, target: &WasmTarget, bundle: Bundle, purpose: Purpose) -> Result<String> {
    let root = &project.root;
    let mut fingerprint = Fingerprint::default()
        .text("compiler", &target.version)
        .text("flags", &rust_flags(project, bundle, purpose).join(" "))
        .text("profile", purpose.profile())
        .text("opt-level", bundle.opt_level())
        .text("process", &process_version(project, bundle)?)
        .file(&root.join("Cargo.toml"))?
        .file(&root.join("src/lib.rs"))?;
    for folder in bundle.sources(project)? {
        fingerprint = fingerprint.tree(&root.join(folder))?;
    }
    Ok(fingerprint.finish())
}

/// Hash of the steps after the compiler.
fn process_version(project: &Project, bundle: Bundle) -> Result<String> {
    Ok(Fingerprint::default()
        .file(&project.root.join("xtask/src/bundle.rs"))?
        .file(&project.root.join("Cargo.lock"))?
        .file(&project.www.join("node_modules/binaryen/package.json"))?
        .text("wasm-opt", &bundle.wasm_opt().join(" "))
        .finish())
}

/// The flags for the wasm target. They are complete, so that `RUSTFLAGS` in the environment cannot
/// change what is published; paths of this machine are removed from panic messages.
fn rust_flags(project: &Project, bundle: Bundle, purpose: Purpose) -> Vec<String> {
    let mut flags = vec!["-Ctarget-feature=+simd128".to_owned()];
    flags.extend(bundle.flags(purpose).iter().map(|&flag| flag.to_owned()));
    let cargo_home = std::env::var_os("CARGO_HOME")
        .map(PathBuf::from)
        .or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    if let Some(home) = cargo_home {
        flags.push(format!("--remap-path-prefix={}=cargo", home.display()));
    }
    flags.push(format!("--remap-path-prefix={}=.", project.root.display()));
    flags
}

/// Compiles the packages of out-of-date bundles, and returns the module of each.
fn compile(
    project: &Project,
    target: &WasmTarget,
    stamps: &[Stamp],
    purpose: Purpose,
) -> Result<BTreeMap<String, PathBuf>> {
    let mut modules = BTreeMap::new();
    for together in stamps.chunk_by(|a, b| are_together(a.bundle, b.bundle, purpose)) {
        if together.iter().all(Stamp::is_current) {
            continue;
        }
        // Up-to-date packages are listed, too: with fewer packages, shared dependencies may get
        // fewer features, and cargo would recompile them.
        let bundles = || together.iter().map(|stamp| stamp.bundle);
        let mut command = target.cargo(project, "build");
        command
            .args(["--locked", "--profile", purpose.profile()])
            .args(bundles().flat_map(|bundle| ["--package", bundle.package()]))
            .arg("--message-format=json-render-diagnostics")
            // Cargo allows one build at a time in a folder. A separate one lets the native checks
            // run meanwhile.
            .env("CARGO_TARGET_DIR", project.target.join("wasm"))
            .env("CARGO_PROFILE_RELEASE_OPT_LEVEL", together[0].bundle.opt_level())
            .env("CARGO_ENCODED_RUSTFLAGS", rust_flags(project, together[0].bundle, purpose).join("\u{1f}"));
        let names: Vec<&str> = bundles().map(Bundle::folder).collect();
        let messages = step::run(&format!("{}: compile", names.join(", ")), &mut command, "")?;
        for message in messages.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()) {
            let files = message["filenames"].as_array().cloned().unwrap_or_default();
            let module = files.iter().filter_map(Value::as_str).find(|name| name.ends_with(".wasm"));
            if let (Some(target), Some(module)) = (message["target"]["name"].as_str(), module) {
                modules.insert(target.replace('_', "-"), PathBuf::from(module));
            }
        }
    }
    Ok(modules)
}

/// Whether one call of cargo compiles both bundles, so that shared code is compiled once and all
/// processors are busy. WebGPU and WebGL2 are features of one library, so they exclude each other.
fn are_together(a: Bundle, b: Bundle, purpose: Purpose) -> bool {
    purpose == Purpose::Development && a != Bundle::Webgpu && b != Bundle::Webgpu
}

/// Compiles the program that writes the JavaScript of a module.
fn binder(project: &Project) -> Result<PathBuf> {
    let mut command = Command::new(cargo());
    command.current_dir(&project.root).args(["build", "--quiet", "--package", "bind", "--locked"]);
    step::capture(&mut command, "")?;
    Ok(project.target.join("debug").join(format!("bind{}", std::env::consts::EXE_SUFFIX)))
}

/// Writes the module and its JavaScript to `stage`.
fn bind(bundle: Bundle, binder: &Path, module: &Path, stage: &Path) -> Result<()> {
    let mut command = Command::new(binder);
    command.arg(module).arg(bundle.out_name()).arg(stage);
    step::run(&format!("{}: bind", bundle.folder()), &mut command, "")?;
    let script = stage.join(format!("{}.js", bundle.out_name()));
    let text = fs::read_to_string(&script).with_context(|| format!("could not read {}", script.display()))?;
    if !text.contains(&format!("export class {} ", bundle.class())) {
        bail!(
            "{} exports no class `{}`: is it still in src/web/{}?",
            script.display(),
            bundle.class(),
            bundle.folder()
        );
    }
    declare(bundle, stage)
}

/// Rewrites the declarations in `stage` for checking in. The module's own exports are left out: the
/// page only uses the class, and their names change from build to build.
fn declare(bundle: Bundle, stage: &Path) -> Result<()> {
    let file = stage.join(format!("{}.d.ts", bundle.out_name()));
    let mut text = String::new();
    let mut is_of_module = false;
    for line in fs::read_to_string(&file)?.lines() {
        is_of_module =
            if is_of_module { line != "}" } else { line.starts_with("export interface InitOutput") };
        if !is_of_module || line.ends_with('{') || line.contains("readonly memory:") {
            // A method returns a copy outside the module's memory.
            text += &line.replace("Array;", "Array<ArrayBuffer>;");
            text += "\n";
        }
    }
    fs::write(&file, in_order(&text, bundle.class()))?;
    Ok(fs::remove_file(stage.join(format!("{}_bg.wasm.d.ts", bundle.out_name())))?)
}

/// Sorts the members of the class by name, because the module's order changes from build to build.
fn in_order(text: &str, class: &str) -> String {
    let begin = format!("export class {class} {{\n");
    let Some((before, rest)) = text.split_once(&begin) else { return text.to_owned() };
    let Some((body, after)) = rest.split_once("\n}\n") else { return text.to_owned() };
    let mut members = Vec::new();
    let mut member = String::new();
    for line in body.lines() {
        member += line;
        member += "\n";
        if !line.trim_start().starts_with(['/', '*']) {
            members
                .push((line.trim_start_matches("    static").trim().to_owned(), std::mem::take(&mut member)));
        }
    }
    members.sort();
    let members: String = members.into_iter().map(|(_, member)| member).collect();
    format!("{before}{begin}{members}}}\n{after}")
}

/// Fails if the checked-in declarations of a bundle differ from those in `folder`.
fn hold_declarations(project: &Project, bundle: Bundle, folder: &Path, page: &Path) -> Result<()> {
    let file = format!("{}.d.ts", bundle.out_name());
    let known = fs::read_to_string(page.join(&file)).unwrap_or_default();
    if without_comments(&known) != without_comments(&fs::read_to_string(folder.join(&file))?) {
        bail!(
            "{} declares another class than src/web/: `cargo xtask wasm --development {}` rewrites it",
            project.relative(&page.join(&file)).display(),
            bundle.folder()
        );
    }
    Ok(())
}

/// The declarations without comments, which are not compared.
fn without_comments(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.trim_start().starts_with(['/', '*'])).collect()
}

/// Optimises the bound module in place.
fn optimise(project: &Project, bundle: Bundle, stage: &Path) -> Result<()> {
    let tool = project.www.join("node_modules/binaryen/bin/wasm-opt");
    if !tool.is_file() {
        bail!(
            "{} is missing: the package `binaryen` belongs to www/package.json",
            project.relative(&tool).display()
        );
    }
    let bound = stage.join(bundle.module());
    let optimised = stage.join("optimised.wasm");
    let mut command = Command::new(node::node()?);
    command.arg(&tool).arg(&bound).arg("-o").arg(&optimised).args(bundle.wasm_opt());
    step::run(&format!("{}: optimise (wasm-opt)", bundle.folder()), &mut command, "")?;
    fs::rename(&optimised, &bound).with_context(|| format!("could not replace {}", bound.display()))
}

/// Copies changed files to where the page loads them from. Each is replaced atomically, so that a
/// running development server never reads half a file.
fn publish(folder: &Path, page: &Path) -> Result<()> {
    fs::create_dir_all(page).with_context(|| format!("could not create {}", page.display()))?;
    for old in files_under(page)? {
        if !folder.join(old.strip_prefix(page)?).is_file() {
            fs::remove_file(&old)?;
        }
    }
    for file in files_under(folder)? {
        let to = page.join(file.strip_prefix(folder)?);
        if sha256_of(&to).is_ok_and(|have| sha256_of(&file).is_ok_and(|new| have == new)) {
            continue;
        }
        if let Some(parent) = to.parent() {
            fs::create_dir_all(parent)?;
        }
        let beside = to.with_extension("new");
        fs::copy(&file, &beside).with_context(|| format!("could not write {}", beside.display()))?;
        fs::rename(&beside, &to).with_context(|| format!("could not write {}", to.display()))?;
    }
    Ok(())
}
