//! Holds the sources to the module graph of the crate's documentation, and to files of a readable length.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Who may use whom. A module is named by its path under the crate; the longest entry that fits a file counts. What is
/// not listed may not be used, and a module that is not listed has no place in the graph yet.
const MAY_USE: &[(&str, &[&str])] = &[
    ("math", &[]),
    // Long work in pieces: of any kind.
    ("pieces", &[]),
    ("json", &["math"]),
    ("field", &["math"]),
    ("differential", &["math", "field"]),
    // From a file to a field. The core that samples is built without it.
    ("pointcloud", &["math", "field", "spatial"]),
    // Particles and the search among them know no field: they hold whatever made them.
    ("spatial", &["math", "pieces"]),
    ("particles", &["math"]),
    // Triangles over particles, whoever made them.
    ("mesh", &["math", "spatial", "particles"]),
    ("trace", &["math", "particles"]),
    ("sampler", &["math", "field", "differential", "spatial", "particles", "mesh", "trace"]),
    // The methods that the paper compares its own with stand on the sampler's survey, sizes and way to the surface.
    ("baseline", &["math", "field", "sampler", "spatial", "particles"]),
    // Figures about a set of particles must not depend on what made them.
    ("quality", &["math", "pieces", "field", "differential", "spatial", "particles"]),
    ("export", &["math", "spatial", "particles", "mesh", "quality"]),
    (
        "session",
        &[
            "math",
            "pieces",
            "json",
            "field",
            "differential",
            "spatial",
            "particles",
            "trace",
            "mesh",
            "sampler",
            "quality",
            "export",
        ],
    ),
    // The renderer sees slices and camera numbers; the two sides meet in JavaScript only.
    ("render", &["math"]),
    ("web/core", &["json", "field", "sampler", "session"]),
    ("web/points", &["json", "math", "pointcloud"]),
    ("web/render", &["render"]),
];

/// Files that only declare and re-export modules.
const ROOTS: [&str; 2] = ["lib", "web"];

/// The longest file that is still read in one go.
const MAX_LINES: usize = 800;

#[test]
fn modules_use_only_what_the_graph_allows() {
    let src = root().join("src");
    let files: Vec<PathBuf> =
        files_under(&src, &["rs"]).into_iter().filter(|file| !file.starts_with(src.join("bin"))).collect();
    assert!(!files.is_empty(), "no source found under {}", src.display());
    let modules: BTreeSet<String> = files.iter().map(|file| module_of(&src, file)[0].clone()).collect();
    let mut faults = Vec::new();
    for file in &files {
        let path = module_of(&src, file);
        let name = path.join("/");
        if ROOTS.contains(&name.as_str()) {
            continue;
        }
        let entry = MAY_USE
            .iter()
            .filter(|(module, _)| name == *module || name.starts_with(&format!("{module}/")))
            .max_by_key(|(module, _)| module.len());
        let Some((_, allowed)) = entry else {
            faults.push(format!("src/{name}: this module has no entry in the graph; say what it may use"));
            continue;
        };
        let source = fs::read_to_string(file).expect("a listed file can be read");
        for used in modules_used(&without_tests(&code_only(&source)), path.len()) {
            if used == path[0] || allowed.contains(&used.as_str()) {
                continue;
            }
            let fault = if modules.contains(&used) {
                format!("src/{name}: uses `{used}`, which the graph does not allow")
            } else {
                format!("src/{name}: `crate::{used}` hides which module it comes from; name the module")
            };
            faults.push(fault);
        }
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn no_file_is_longer_than_can_be_read_in_one_go() {
    let folders = ["src", "xtask", "shaders", "tests", "benches", "www/src", "www/tests"];
    let mut seen = BTreeSet::new();
    let mut faults = Vec::new();
    for folder in folders {
        for file in files_under(&root().join(folder), &["rs", "wgsl", "js", "mjs", "css", "html"]) {
            if file.starts_with(root().join("www/src/wasm")) {
                continue;
            }
            seen.insert(folder);
            let lines = fs::read_to_string(&file).expect("a listed file can be read").lines().count();
            if lines > MAX_LINES {
                faults.push(format!("{}: {lines} lines", file.display()));
            }
        }
    }
    for folder in ["src", "xtask", "tests"] {
        assert!(seen.contains(folder), "no source found under {folder}/");
    }
    assert!(faults.is_empty(), "longer than {MAX_LINES} lines:\n{}\n", faults.join("\n"));
}

#[test]
fn uses_are_found_in_every_form() {
    let source = r#"
        use crate::math::Lanes;
        use crate::{field::{Field, gallery}, spatial, particles::Particles as P};
        use super::super::sampler::Front;
        use super::sibling;
        // use crate::commented;
        /* crate::also_commented */
        const TEXT: &str = "crate::quoted";
        const RAW: &str = r"crate::raw";
        fn quote() -> char { '"' }
        fn life<'a>(x: &'a str) -> &'a str { crate::session::f(x) }
        #[cfg(test)]
        #[allow(clippy::disallowed_methods, reason = "…")]
        mod tests { use crate::tested; }
    "#;
    let found = modules_used(&without_tests(&code_only(source)), 2);
    assert_eq!(
        found.iter().map(String::as_str).collect::<Vec<_>>(),
        ["field", "math", "particles", "sampler", "session", "spatial"]
    );
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The module path of a file: `src/a/b.rs` and `src/a/b/mod.rs` are `[a, b]`.
fn module_of(src: &Path, file: &Path) -> Vec<String> {
    let relative = file.strip_prefix(src).expect("the file lies under src").with_extension("");
    let mut path: Vec<String> = relative.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if path.len() > 1 && path.last().is_some_and(|last| last == "mod") {
        path.pop();
    }
    path
}

/// Every file under `folder` with one of the extensions, sorted.
fn files_under(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for entry in entries {
            let path = entry.expect("a listed entry can be read").path();
            if path.is_dir() {
                open.push(path);
            } else if path
                .extension()
                .is_some_and(|extension| extensions.iter().any(|wanted| extension == *wanted))
            {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The source with comments, strings and character literals blanked out.
fn code_only(source: &str) -> String {
    let text: Vec<char> = source.chars().collect();
    let mut out = String::with_capacity(source.len());
    let mut i = 0;
    while i < text.len() {
        let rest = &text[i..];
        let skipped = match rest {
            ['/', '/', ..] => rest.iter().position(|&c| c == '\n').unwrap_or(rest.len()),
            ['/', '*', ..] => block_comment(rest),
            ['r', '"' | '#', ..] if !is_word(text.get(i.wrapping_sub(1))) => raw_string(rest),
            ['"', ..] => string(rest),
            ['\'', '\\', ..] => 3 + rest[3..].iter().position(|&c| c == '\'').unwrap_or(0),
            ['\'', _, '\'', ..] => 3,
            _ => 0,
        };
        if skipped > 0 {
            out.push(' ');
            i += skipped;
        } else {
            out.push(rest[0]);
            i += 1;
        }
    }
    out
}

fn is_word(c: Option<&char>) -> bool {
    c.is_some_and(|c| c.is_alphanumeric() || *c == '_')
}

/// The length of the block comment at the start of `text`; they nest.
fn block_comment(text: &[char]) -> usize {
    let mut depth = 0;
    let mut i = 0;
    while i < text.len() {
        match &text[i..] {
            ['/', '*', ..] => {
                depth += 1;
                i += 2;
            }
            ['*', '/', ..] => {
                depth -= 1;
                i += 2;
                if depth == 0 {
                    return i;
                }
            }
            _ => i += 1,
        }
    }
    i
}

/// The length of the string at the start of `text`.
fn string(text: &[char]) -> usize {
    let mut i = 1;
    while i < text.len() {
        match text[i] {
            '\\' => i += 2,
            '"' => return i + 1,
            _ => i += 1,
        }
    }
    i
}

/// The length of the raw string at the start of `text`; 0 if it is a raw identifier.
fn raw_string(text: &[char]) -> usize {
    let hashes = text[1..].iter().take_while(|&&c| c == '#').count();
    if text.get(1 + hashes) != Some(&'"') {
        return 0;
    }
    let mut end = vec!['"'];
    end.extend(std::iter::repeat_n('#', hashes));
    let body = &text[2 + hashes..];
    2 + hashes
        + body.windows(end.len()).position(|window| window == end).map_or(body.len(), |at| at + end.len())
}

/// The source up to its test module, which stands last and may use anything.
fn without_tests(code: &str) -> String {
    let mut kept = code;
    for (at, _) in code.match_indices("#[cfg(") {
        let Some((condition, rest)) = code[at..].split_once(']') else { break };
        let mut item = rest.trim_start();
        while let Some((_, rest)) = item.strip_prefix("#[").and_then(|attribute| attribute.split_once(']')) {
            item = rest.trim_start();
        }
        // Of tests alone, or of tests and a feature.
        if condition.contains("(test") && item.starts_with("mod ") {
            kept = &code[..at];
            break;
        }
    }
    kept.to_owned()
}

/// The names that follow the crate's root in paths, in a file `depth` modules below it. Macros are not counted: they
/// live at the root.
fn modules_used(code: &str, depth: usize) -> BTreeSet<String> {
    let up = format!("{}::", vec!["super"; depth].join("::"));
    let mut found = BTreeSet::new();
    for prefix in ["crate::", up.as_str()] {
        for (at, _) in code.match_indices(prefix) {
            let before = &code[..at];
            if is_word(before.chars().next_back().as_ref()) || before.ends_with("super::") {
                continue;
            }
            let after = code[at + prefix.len()..].trim_start();
            if let Some(group) = after.strip_prefix('{') {
                found.extend(heads_of_group(group));
            } else {
                let name = word(after);
                if !after[name.len()..].starts_with('!') && name != "super" && !name.is_empty() {
                    found.insert(name.to_owned());
                }
            }
        }
    }
    found
}

/// The first names of the members of a `{…}` group whose opening brace has been read.
fn heads_of_group(group: &str) -> Vec<String> {
    let mut heads = Vec::new();
    let mut depth = 1;
    let mut at_head = true;
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => at_head = true,
            _ if at_head && depth == 1 && !c.is_whitespace() => {
                heads.push(word(&group[at..]).to_owned());
                at_head = false;
            }
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    heads.retain(|head| !head.is_empty() && head != "self");
    heads
}

fn word(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    &text[..end]
}
