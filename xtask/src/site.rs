//! The static site, and the report on its size.

use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::bundle::{self, Bundle, Declarations, Purpose};
use crate::fingerprint::{files_under, sha256_of};
use crate::node;
use crate::project::Project;

/// The largest gzip size, in kB, of what the page loads before any WebAssembly: HTML, style sheets
/// and scripts.
///
/// A budget is an alarm against accidents, not a goal. A change that needs more raises it in a
/// commit of its own, which says why; no code is contorted to stay under one.
const FIRST_PAINT_BUDGET_KB: f64 = 104.0;

/// The largest gzip size, in kB, of what the lesson's page loads before any WebAssembly; its
/// figures start after that.
const LESSON_PAGE_BUDGET_KB: f64 = 51.0;

/// The largest gzip size of a bundle, in kB: its module and its JavaScript. The note on
/// [`FIRST_PAINT_BUDGET_KB`] applies here, too.
fn budget_kb(bundle: Bundle) -> f64 {
    match bundle {
        // A tenth is for images: their readers, the spline and gzip decompression. The core samples
        // them, and another module would need a second copy of the voxels. A twelfth is for
        // triangle meshes, for the same reason.
        Bundle::Core => 1460.0,
        // A sixth is for edges of fields and solids of two fields, which every field can have. A
        // tenth is for reading binary glTF files, with a JSON parser.
        Bundle::Points => 327.0,
        Bundle::Lesson => 313.0,
        Bundle::Webgpu => 90.0,
        Bundle::Webgl => 850.0,
    }
}

/// The folder of the built site: `dist/` for the published site, a folder under the target folder
/// for the quick tests.
pub(crate) fn folder(project: &Project, purpose: Purpose) -> PathBuf {
    match purpose {
        Purpose::Site => project.dist.clone(),
        Purpose::Development => project.target.join("xtask/site"),
    }
}

/// Builds the site.
pub(crate) fn build(project: &Project, purpose: Purpose) -> Result<()> {
    node::prepare(project)?;
    bundle::build(project, &Bundle::ALL, purpose, Declarations::Hold)?;
    let folder = folder(project, purpose);
    node::script(project, "page: build (Vite)", "build", &[("SITE", &folder.to_string_lossy())])?;
    Ok(())
}

/// One line of the size report.
struct Line {
    name: String,
    raw: usize,
    gzip: usize,
    budget_kb: Option<f64>,
}

/// Prints the sizes of what a visitor loads; an error if a part exceeds its budget.
pub(crate) fn report_sizes(project: &Project) -> Result<()> {
    let mut shipped = BTreeMap::new();
    for file in files_under(&project.dist)? {
        shipped.insert(sha256_of(&file)?, file);
    }
    let mut lines = Vec::new();
    for bundle in Bundle::ALL {
        let folder = project.www.join("src/wasm").join(bundle.folder());
        let module = folder.join(bundle.module());
        if !shipped.contains_key(&sha256_of(&module)?) {
            bail!(
                "{} is not in {}: the page does not load it",
                project.relative(&module).display(),
                project.dist.display()
            );
        }
        let script = folder.join(format!("{}.js", bundle.out_name()));
        lines.push(line(bundle.folder(), &[module, script], Some(budget_kb(bundle)))?);
    }
    for (name, page, budget) in [
        ("first paint", "index.html", FIRST_PAINT_BUDGET_KB),
        ("lesson page", "learn/index.html", LESSON_PAGE_BUDGET_KB),
    ] {
        let page = project.dist.join(page);
        let html = fs::read_to_string(&page).with_context(|| format!("could not read {}", page.display()))?;
        let mut files = vec![page];
        files.extend(first_paint(&html).into_iter().map(|address| project.dist.join(address)));
        lines.push(line(name, &files, Some(budget))?);
    }
    let everything: Vec<PathBuf> = shipped.into_values().collect();
    lines.push(line("whole site", &everything, None)?);

    println!("\n  {:<16}{:>12}{:>12}{:>12}", "", "raw kB", "gzip kB", "budget kB");
    let mut over = Vec::new();
    for line in &lines {
        let gzip_kb = kilobytes(line.gzip);
        let budget = line.budget_kb.map_or_else(|| "–".to_owned(), |budget| format!("{budget:.0}"));
        let is_over = line.budget_kb.is_some_and(|budget| gzip_kb > budget);
        let mark = if is_over { "  over budget" } else { "" };
        println!("  {:<16}{:>12.1}{:>12.1}{:>12}{mark}", line.name, kilobytes(line.raw), gzip_kb, budget);
        if is_over {
            over.push(line.name.as_str());
        }
    }
    if !over.is_empty() {
        bail!("over budget: {}", over.join(", "));
    }
    Ok(())
}

/// A thousand bytes, as browsers count them.
fn kilobytes(bytes: usize) -> f64 {
    bytes as f64 / 1000.0
}

fn line(name: &str, files: &[PathBuf], budget_kb: Option<f64>) -> Result<Line> {
    let mut raw = 0;
    let mut gzip = 0;
    for file in files {
        let content = fs::read(file).with_context(|| format!("could not read {}", file.display()))?;
        raw += content.len();
        gzip += gzip_size(file, &content)?;
    }
    Ok(Line { name: name.to_owned(), raw, gzip, budget_kb })
}

fn gzip_size(file: &Path, content: &[u8]) -> Result<usize> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(content).with_context(|| format!("could not compress {}", file.display()))?;
    Ok(encoder.finish()?.len())
}

/// The addresses, in the site, of the scripts and style sheets that a page loads before it first
/// paints: scripts, module preloads (Vite lists the static imports of the entry there) and style
/// sheets.
fn first_paint(html: &str) -> Vec<String> {
    let mut found = Vec::new();
    for tag in html.split('<').filter_map(|part| part.split_once('>')).map(|(tag, _)| tag) {
        let address = if tag.starts_with("script") {
            attribute(tag, "src")
        } else if tag.starts_with("link")
            && matches!(attribute(tag, "rel"), Some("stylesheet" | "modulepreload"))
        {
            attribute(tag, "href")
        } else {
            None
        };
        if let Some(address) = address {
            found.push(address.trim_start_matches("../").trim_start_matches("./").to_owned());
        }
    }
    found
}

/// The value of a quoted attribute of a tag.
fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = tag.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

#[cfg(test)]
mod tests {
    use super::first_paint;

    #[test]
    fn first_paint_is_scripts_preloads_and_style_sheets() {
        let html = r#"<head><link rel="icon" href="./icon.svg"><link rel="stylesheet" crossorigin href="./assets/a.css">
            <link rel="modulepreload" crossorigin href="../assets/b.js"><script type="module" src="./assets/c.js"></script>"#;
        assert_eq!(first_paint(html), ["assets/a.css", "assets/b.js", "assets/c.js"]);
    }
}
