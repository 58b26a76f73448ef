//! Holds the sources to the module graph of the crate's documentation, and to files of a readable
//! length.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules that each module of a room may use. A room is a folder of modules, the crate itself
/// the outermost.
type Room = (&'static str, &'static [(&'static str, &'static [&'static str])]);

/// Who may use whom in the rooms whose order is a decision. A module of a listed room that is not
/// listed has no place in it yet; what is not listed may not be used. Parents, which declare their
/// modules, may be used by them.
const ROOMS: [Room; 6] = [
    (
        "",
        &[
            ("math", &[]),
            // Long work in slices: of any kind.
            ("slices", &[]),
            ("field", &["math", "slices"]),
            ("differential", &["math", "field"]),
            // A box is found before anything is sampled.
            ("extent", &["math", "slices", "field"]),
            // Three-dimensional images and their files: fields like any other.
            ("image", &["math", "slices", "field"]),
            // From a file to a field.
            ("pointcloud", &["math", "field", "spatial", "topology", "slices"]),
            // From a triangle mesh to a field. Its files are read as those of points are, and a
            // scan becomes an image.
            ("remesh", &["math", "slices", "field", "image", "pointcloud"]),
            // Particles, meshes of them and the search among them know no field: they hold whatever
            // made them.
            ("spatial", &["math", "slices"]),
            ("particles", &["math"]),
            ("topology", &["math", "slices"]),
            ("mesh", &["math", "slices", "spatial", "particles", "topology"]),
            ("sampler", &["math", "slices", "field", "differential", "spatial", "particles", "mesh"]),
            // Figures about a set of particles must not depend on what made them.
            (
                "quality",
                &["math", "slices", "field", "differential", "spatial", "particles", "topology", "mesh"],
            ),
            ("export", &["math", "spatial", "particles", "mesh", "quality"]),
            // The door: a field, sampled and measured.
            (
                "run",
                &[
                    "math",
                    "slices",
                    "field",
                    "differential",
                    "extent",
                    "spatial",
                    "particles",
                    "topology",
                    "mesh",
                    "sampler",
                    "quality",
                    "export",
                ],
            ),
            (
                "session",
                &[
                    "math", "slices", "field", "extent", "image", "remesh", "sampler", "quality", "run",
                    "export",
                ],
            ),
            // The paper written for reading, and the oracle of the fast fronts: it knows nothing of
            // them.
            ("paper", &["math", "field", "differential", "particles"]),
            // The lesson shares some words and numbers with the sampler, no algorithm.
            ("lesson", &["math", "field", "differential", "particles", "paper", "sampler"]),
        ],
    ),
    (
        "sampler",
        &[
            ("settings", &[]),
            ("spacing", &["settings"]),
            ("fates", &[]),
            ("phase", &[]),
            ("probe", &[]),
            ("projection", &["probe"]),
            ("neighbours", &["probe"]),
            ("sheet", &["probe", "projection", "neighbours"]),
            ("discovery", &["probe", "projection", "sheet"]),
            ("sizing", &["settings", "spacing", "probe", "discovery", "constraint"]),
            // Knows no front: it is where fronts begin.
            ("constraint", &["probe"]),
            (
                "front",
                &["settings", "fates", "probe", "projection", "neighbours", "sheet", "discovery", "sizing"],
            ),
            ("relaxation", &["probe", "projection", "neighbours", "sheet", "sizing"]),
            ("refine", &["probe", "sizing", "constraint"]),
            (
                "flow",
                &["probe", "projection", "neighbours", "sheet", "discovery", "sizing", "front", "relaxation"],
            ),
            ("message", &["settings", "discovery", "phase"]),
            ("progress", &["settings", "fates", "phase", "refine"]),
            ("count", &[]),
            ("attempt", &["settings", "projection", "discovery", "sizing", "count", "front", "refine"]),
            (
                "pattern",
                &[
                    "settings",
                    "probe",
                    "projection",
                    "neighbours",
                    "sheet",
                    "discovery",
                    "sizing",
                    "constraint",
                    "front",
                    "attempt",
                ],
            ),
            // What is known before a particle is placed, and what is made of it.
            ("surface", &["probe", "constraint", "discovery"]),
            (
                "cover",
                &[
                    "settings",
                    "phase",
                    "progress",
                    "neighbours",
                    "discovery",
                    "surface",
                    "attempt",
                    "front",
                    "relaxation",
                    "flow",
                ],
            ),
            ("pace", &["settings", "phase", "probe", "surface", "cover"]),
            // They alone know every room.
            (
                "stages",
                &[
                    "settings",
                    "phase",
                    "progress",
                    "probe",
                    "sheet",
                    "constraint",
                    "discovery",
                    "surface",
                    "count",
                    "cover",
                    "pace",
                    "attempt",
                    "front",
                    "pattern",
                    "refine",
                    "relaxation",
                    "flow",
                ],
            ),
            (
                "methods",
                &["settings", "phase", "discovery", "count", "attempt", "refine", "cover", "pace", "stages"],
            ),
        ],
    ),
    (
        "image",
        &[
            ("voxels", &[]),
            ("placement", &[]),
            ("kernel", &[]),
            ("otsu", &[]),
            ("smooth", &["voxels"]),
            ("border", &["smooth"]),
            ("filter", &["smooth"]),
            ("bricks", &["filter"]),
            ("bounds", &["bricks", "kernel"]),
            ("field", &["bricks", "kernel", "placement"]),
            ("section", &["bricks"]),
            ("coarser", &["voxels"]),
            ("labels", &["smooth", "voxels"]),
            ("read", &["placement", "voxels"]),
            ("choice", &["field", "smooth", "labels", "otsu"]),
        ],
    ),
    (
        "remesh",
        &[
            ("tree", &[]),
            ("edges", &[]),
            ("mesh", &[]),
            ("colours", &["mesh", "tree"]),
            ("prepare", &["colours", "edges", "mesh", "tree"]),
            ("cross", &[]),
            ("rule", &[]),
            ("patches", &["edges", "rule", "tree"]),
            ("patch_function", &["edges", "tree"]),
            ("rim", &["edges", "patch_function", "tree"]),
            ("parts", &["patches", "rule", "patch_function", "tree"]),
            ("scan", &["edges", "tree"]),
            ("bodies", &["edges", "mesh", "patches", "tree"]),
            ("compare", &["tree"]),
        ],
    ),
    (
        "quality",
        &[
            ("figures", &[]),
            ("options", &[]),
            ("creases", &["options"]),
            ("places", &[]),
            ("moments", &[]),
            ("border", &[]),
            ("projection", &[]),
            ("probe", &["projection"]),
            ("accuracy", &["figures", "moments"]),
            ("sheets", &["accuracy"]),
            ("triangles", &["figures", "moments"]),
            // The points, prepared; the figures below are made from them.
            ("points", &["options", "creases", "accuracy", "sheets"]),
            ("gaps", &["points", "projection"]),
            ("prepared", &["figures", "options", "points", "gaps", "triangles"]),
            ("components", &["points", "gaps", "triangles"]),
            ("order", &["figures", "moments", "points"]),
            ("spacing", &["figures", "moments", "places", "points"]),
            ("sizes", &["options", "places", "points"]),
            ("energy", &["points", "sizes"]),
            ("holes", &["border", "creases", "places", "projection", "probe", "triangles", "sizes"]),
        ],
    ),
    (
        "field",
        &[
            ("formula", &[]),
            // The one part of a formula in which another field is an operand.
            ("formula/operand", &["combined"]),
            // What its operands do not know of their pieces is found out.
            ("combined", &["edges", "given"]),
            ("edges", &[]),
            ("piecewise", &["differences"]),
            ("descent", &[]),
            ("crossing", &["descent"]),
            ("evaluator", &[]),
            ("differences", &["edges"]),
            ("function", &["differences"]),
            ("given", &["function"]),
            ("gallery", &["formula"]),
            ("model", &[]),
            // The border of points limits the function that is fitted to them.
            ("rbf", &["combined"]),
        ],
    ),
];

/// The longest file that is still read in one go.
const MAX_LINES: usize = 800;

#[test]
fn modules_use_only_what_their_room_allows() {
    let mut faults = Vec::new();
    for Use { room, user, used } in uses_between_siblings() {
        let Some((_, members)) = ROOMS.iter().find(|(name, _)| *name == room) else { continue };
        let path = user.join("/");
        let entry = members
            .iter()
            .filter(|(module, _)| path == *module || path.starts_with(&format!("{module}/")))
            .max_by_key(|(module, _)| module.len());
        match entry {
            None => faults.push(format!("{room}/{path}: has no entry in the room; say what it may use")),
            Some((_, allowed)) if !allowed.contains(&used.as_str()) => {
                faults.push(format!("{room}/{path}: uses `{used}`, which the room does not allow"));
            }
            Some(_) => {}
        }
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn rooms_name_only_modules_that_exist() {
    let modules: BTreeSet<String> = sources().into_iter().map(|(path, _)| path.join("/")).collect();
    let mut faults = Vec::new();
    for (room, members) in ROOMS {
        let names = members.iter().flat_map(|(name, allowed)| allowed.iter().chain([name]));
        for name in names.copied().collect::<BTreeSet<_>>() {
            let path = if room.is_empty() { name.to_owned() } else { format!("{room}/{name}") };
            if !modules.contains(&path) {
                faults.push(format!("{path}: no such module"));
            }
        }
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn no_room_has_a_circle_of_uses() {
    let mut rooms: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for Use { room, mut user, used } in uses_between_siblings() {
        let module = user.swap_remove(0);
        rooms.entry(room).or_default().entry(module).or_default().insert(used);
    }
    let mut faults = Vec::new();
    for (room, edges) in &rooms {
        for module in edges.keys() {
            let mut reached = BTreeSet::new();
            let mut open = vec![module];
            while let Some(next) = open.pop() {
                open.extend(edges.get(next).into_iter().flatten().filter(|&used| reached.insert(used)));
            }
            if reached.contains(module) {
                faults.push(format!("{room}/{module}: uses itself by way of {reached:?}"));
            }
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

/// The value of a line `key = "value"` of a manifest.
fn quoted<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    line.strip_prefix(key)?.trim_start().strip_prefix("= \"")?.strip_suffix('"')
}

/// The names of the packages in a folder, however deep.
fn packages_in(folder: &str) -> BTreeSet<String> {
    let manifests = files_under(&root().join(folder), &["toml"]);
    let name = |manifest: PathBuf| {
        let text = fs::read_to_string(&manifest).expect("a listed file can be read");
        text.lines().find_map(|line| quoted(line, "name").map(str::to_owned))
    };
    manifests.into_iter().filter_map(name).collect()
}

/// What is published together has one version; npm's, Python's and cargo's stand in files of their
/// own.
#[test]
fn every_published_manifest_has_one_version() {
    let read = |file: &str| fs::read_to_string(root().join(file)).expect(file);
    let version = |file: &str| {
        let text = read(file);
        let found = text.lines().find_map(|line| {
            let json = line.trim().strip_prefix("\"version\": \"").and_then(|rest| rest.split('"').next());
            quoted(line, "version").or(json).map(str::to_owned)
        });
        found.unwrap_or_else(|| panic!("{file} has no version"))
    };
    let own = version("Cargo.toml");
    for file in
        ["src/command/Cargo.toml", "python/Cargo.toml", "www/package/package.json", "www/package.json"]
    {
        assert_eq!(version(file), own, "{file}");
    }
    // Python takes the version of its crate, the command line depends on the library of its own.
    assert!(read("python/pyproject.toml").contains("dynamic = [\"version\"]"));
    let command = read("src/command/Cargo.toml");
    assert!(command.contains(&format!("marching-particles = {{ version = \"{own}\"")), "{command}");
}

/// A package that a profile does not name is compiled without optimisation, and nothing says so.
#[test]
fn every_package_of_a_bundle_is_optimised_while_developing() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("the manifest of the workspace");
    let named: BTreeSet<String> = manifest
        .lines()
        .filter_map(|line| line.strip_prefix("[profile.wasm-dev.package.")?.strip_suffix(']'))
        .map(str::to_owned)
        .collect();
    let mut wanted = packages_in("src");
    // What these do is done by others.
    for thin in ["cli", "values", "webgl", "webgpu"] {
        assert!(wanted.remove(&format!("marching-particles-{thin}")), "{thin}");
    }
    wanted.extend(["libm", "marching-particles"].map(str::to_owned));
    assert_eq!(named, wanted);
}

#[test]
fn uses_are_found_in_every_form() {
    let source = r#"
        use crate::math::Lanes;
        use crate::{field::{Field, gallery}, spatial, particles::Particles as P};
        use super::super::sampler::Front;
        use super::sibling::{self, Item};
        pub(super) use self::child::Thing;
        // use crate::commented;
        /* crate::also_commented */
        const TEXT: &str = "crate::quoted";
        const RAW: &str = r"crate::raw";
        fn quote() -> char { '"' }
        fn life<'a>(x: &'a str) -> &'a str { crate::session::f(x) }

#[cfg(test)]
mod tests { use crate::tested; }
    "#;
    let module = ["a".to_owned(), "b".to_owned()];
    let mut found: Vec<String> =
        paths_used(without_tests(&code_only(source)), &module).iter().map(|path| path.join("::")).collect();
    found.sort();
    assert_eq!(
        found,
        [
            "a::b::child::Thing",
            "a::sibling::Item",
            "a::sibling::self",
            "field::Field",
            "field::gallery",
            "math::Lanes",
            "particles::Particles",
            "sampler::Front",
            "session::f",
            "spatial",
        ]
    );
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the package is in the checkout").to_owned()
}

/// Every module of the library with its source, comments and tests taken out. What has a package of
/// its own is left to cargo, which lets it use nothing but its dependencies.
fn sources() -> Vec<(Vec<String>, String)> {
    let src = root().join("src");
    let is_of_library = |file: &PathBuf| {
        let above = file.ancestors().take_while(|folder| *folder != src);
        above.into_iter().all(|folder| !folder.join("Cargo.toml").is_file())
    };
    let files = files_under(&src, &["rs"]).into_iter().filter(is_of_library);
    let sources: Vec<(Vec<String>, String)> = files
        .map(|file| {
            let source = fs::read_to_string(&file).expect("a listed file can be read");
            (module_of(&src, &file), without_tests(&code_only(&source)).to_owned())
        })
        .filter(|(path, _)| path.last().is_some_and(|name| name != "lib" && name != "tests"))
        .collect();
    assert!(!sources.is_empty(), "no source found under {}", src.display());
    sources
}

/// A use of one module of a room by another.
struct Use {
    /// The room in which the paths of the two part.
    room: String,
    /// The module that uses, below the room.
    user: Vec<String>,
    /// The module of the room that is used, or that holds what is used.
    used: String,
}

/// Every use between modules of which none is the other's parent.
fn uses_between_siblings() -> Vec<Use> {
    let sources = sources();
    let modules: BTreeSet<&Vec<String>> = sources.iter().map(|(path, _)| path).collect();
    let mut uses = Vec::new();
    for (user, source) in &sources {
        for mut used in paths_used(source, user) {
            while !used.is_empty() && !modules.contains(&used) {
                used.pop();
            }
            let shared = user.iter().zip(&used).take_while(|(a, b)| a == b).count();
            if shared < user.len() && shared < used.len() {
                let room = user[..shared].join("/");
                uses.push(Use { room, user: user[shared..].to_vec(), used: used.swap_remove(shared) });
            }
        }
    }
    assert!(!uses.is_empty(), "no module uses another");
    uses
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
fn without_tests(code: &str) -> &str {
    code.split_once("#[cfg(test)]\nmod tests {").map_or(code, |(before, _)| before)
}

/// The paths that a file of the module `module` names from the crate's root, `super` or `self`,
/// resolved to the root.
fn paths_used(code: &str, module: &[String]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    for root in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(root) {
            let before = &code[..at];
            if before.ends_with("::") || is_word(before.chars().next_back().as_ref()) {
                continue;
            }
            for path in use_tree(&code[at..]) {
                let mut base = if path[0] == "crate" { Vec::new() } else { module.to_vec() };
                let mut rest = &path[usize::from(path[0] != "super")..];
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
                found.push([&base, rest].concat());
            }
        }
    }
    found
}

/// The paths of the use tree at the start of `code`: `a::{b, c::d}` is `a::b` and `a::c::d`.
fn use_tree(code: &str) -> Vec<Vec<String>> {
    let code = code.trim_start();
    if let Some(group) = code.strip_prefix('{') {
        return members_of_group(group).into_iter().flat_map(use_tree).collect();
    }
    let name = word(code);
    if name.is_empty() {
        return vec![Vec::new()];
    }
    match code[name.len()..].strip_prefix("::") {
        Some(rest) => use_tree(rest).into_iter().map(|path| [vec![name.to_owned()], path].concat()).collect(),
        None => vec![vec![name.to_owned()]],
    }
}

/// The members of a `{…}` group whose opening brace has been read.
fn members_of_group(group: &str) -> Vec<&str> {
    let mut members = Vec::new();
    let (mut depth, mut start) = (1, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 || depth == 1 && c == ',' {
            members.push(&group[start..at]);
            start = at + 1;
        }
        if depth == 0 {
            break;
        }
    }
    members.retain(|member| !member.trim().is_empty());
    members
}

fn word(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    &text[..end]
}
