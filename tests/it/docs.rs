//! Holds the documents to the program: the table of settings to the settings, the summaries in
//! `docs` to the tables that the benches have written, the promised compiler to the one in use, and
//! every link to a file.
//!
//! `UPDATE_GOLDEN=1 cargo test --test it docs::` writes what differs.

use crate::golden::checkout;
use marching_particles::internal::math::shortest_text;
use marching_particles::internal::session::{Condition, Setting, SettingKind, SettingValue, settings};
use marching_particles::pointcloud::InputFormat;
use std::path::{Path, PathBuf};
use std::{env, fs};

const END: &str = "<!-- End of the table. -->\n";

fn read(name: &str) -> String {
    fs::read_to_string(checkout().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Holds the table of a page, between its marks, to `wanted`, or writes it there.
fn check_table(page: &str, name: &str, wanted: &str) {
    let begin =
        format!("<!-- Table of {name}, written by a test: UPDATE_GOLDEN=1 cargo test --test it docs:: -->\n");
    let text = read(page);
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("{page} has no mark: {begin}"));
    let (written, after) = rest.split_once(END).unwrap_or_else(|| panic!("{page} has no end of {name}"));
    if env::var_os("UPDATE_GOLDEN").is_some_and(|value| value == "1") {
        fs::write(checkout().join(page), [before, &begin, wanted, END, after].concat()).expect("a page");
        return;
    }
    assert_eq!(written, wanted, "{page}: UPDATE_GOLDEN=1 cargo test --test it docs:: puts it right");
}

fn percent(share: f64) -> String {
    let percent: f64 = format!("{:.3e}", 100.0 * share).parse().expect("a number");
    format!("{} %", shortest_text(percent))
}

fn values(setting: &Setting) -> String {
    if !setting.choices.is_empty() {
        let values: Vec<String> =
            setting.choices.iter().map(|choice| format!("`{}`", choice.value)).collect();
        return values.join(", ");
    }
    let (min, max) = setting.accepted().into_inner();
    match setting.default {
        _ if setting.is_share() => format!("{} to {} of the box diagonal", percent(min), percent(max)),
        _ if setting.kind == SettingKind::Formula => {
            format!("{} to {}, or a formula", shortest_text(min), shortest_text(max))
        }
        SettingValue::Integer(_) if max >= u64::MAX as f64 => "any whole number".to_owned(),
        _ => {
            format!("{} to {} {}", shortest_text(min), shortest_text(max), setting.unit).trim_end().to_owned()
        }
    }
}

fn default(setting: &Setting) -> String {
    match setting.default {
        SettingValue::Choice(value) => format!("`{value}`"),
        SettingValue::Integer(whole) => whole.to_string(),
        SettingValue::Number(share) if setting.is_share() => percent(share),
        SettingValue::Number(number) => shortest_text(number),
    }
}

fn condition(Condition { name, value, equal }: &Condition) -> String {
    format!("`{name}` {} `{value}`", if *equal { "=" } else { "≠" })
}

/// A name in the camel case of JavaScript.
fn camel(name: &str) -> String {
    let mut words = name.split('_');
    let first = words.next().unwrap_or_default().to_owned();
    words.fold(first, |text, word| text + &word[..1].to_uppercase() + &word[1..])
}

/// The names of settings in Python and for npm that are not those of their arguments, since the
/// doors give them in another form: the box by its corners, the border of points where these are
/// fitted.
const ELSEWHERE: [(&str, &str, &str); 2] = [
    ("box_mode", "`bounds`", "bounds"),
    ("beyond_points", "`beyond_points` of `fit_points`", "beyondPoints"),
];

/// The names of a setting in Python and for npm.
fn names(setting: &Setting) -> (String, String) {
    match ELSEWHERE.iter().find(|(name, ..)| *name == setting.name) {
        Some((_, python, npm)) => ((*python).to_owned(), (*npm).to_owned()),
        None => (format!("`{}`", setting.argument()), camel(setting.argument())),
    }
}

fn settings_table() -> String {
    let mut rows = String::from(
        "| Setting | Command line | Python | npm | Values | Default | Used if | Meaning |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for setting in &settings() {
        let conditions: Vec<String> = setting.when.iter().map(condition).collect();
        let (python, npm) = names(setting);
        rows += &format!(
            "| `{}` | `--{}` | {python} | `{npm}` | {} | {} | {} | {} |\n",
            setting.name,
            setting.option(),
            values(setting),
            default(setting),
            conditions.join(", "),
            setting.help
        );
    }
    rows
}

/// A part of a table file: its heading, its text, and the rows of its table without the head.
struct Section<'a> {
    title: &'a str,
    text: &'a str,
    rows: Vec<Vec<&'a str>>,
}

/// The sections of a table file that hold a table.
fn sections(text: &str) -> Vec<Section<'_>> {
    let mut sections = Vec::new();
    for (title, text) in text.split("\n##").filter_map(|part| part.split_once('\n')) {
        let rows = text.lines().filter(|line| line.starts_with('|')).skip(2);
        let rows: Vec<Vec<&str>> =
            rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect()).collect();
        if !rows.is_empty() {
            sections.push(Section { title: title.trim_start_matches('#').trim(), text, rows });
        }
    }
    sections
}

/// The number at the head of a cell.
fn number(cell: &str) -> f64 {
    let end = cell.find(|c: char| !"-.0123456789e".contains(c)).unwrap_or(cell.len());
    cell[..end].parse().unwrap_or_else(|_| panic!("`{cell}` begins with a number"))
}

/// The number in the brackets of a cell.
fn bracketed(cell: &str) -> f64 {
    number(cell.split_once('(').unwrap_or_else(|| panic!("`{cell}` has brackets")).1)
}

fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    let (low, high) = ((numbers.len() - 1) / 2, numbers.len() / 2);
    0.5 * (numbers[low] + numbers[high])
}

/// Median and worst of a column, the lowest or the highest, with so many digits.
fn median_and_worst(rows: &[&Vec<&str>], column: usize, worst: fn(f64, f64) -> f64, digits: usize) -> String {
    let all = || rows.iter().map(|row| number(row[column]));
    let extreme = all().reduce(worst).expect("a row");
    format!("{:.digits$} / {extreme:.digits$}", median(all()))
}

fn flow_summary() -> String {
    let mut table = String::from(
        "| Particles | Six neighbours | Largest hole | Closest pair | Still there | Speed-up |\n\
         | --- | --: | --: | --: | --: | --: |\n",
    );
    for Section { title, rows, .. } in sections(&read("docs/tables/flow.md")) {
        let last: Vec<&Vec<&str>> = rows.iter().filter(|row| row[1] == "100").collect();
        let beside = |column: usize| {
            let ours = median(last.iter().map(|row| number(row[column])));
            let fresh = median(last.iter().map(|row| bracketed(row[column])));
            format!("{ours:.2} ({fresh:.2})")
        };
        table += &format!(
            "| {} | {} | {} | {} | {:.0} % | {:.1} |\n",
            title.trim_start_matches("About "),
            beside(3),
            beside(4),
            beside(5),
            100.0 * median(last.iter().map(|row| number(row[6]).min(1.0))),
            median(rows.iter().map(|row| number(row[10])))
        );
    }
    table
}

fn methods_summary() -> String {
    let mut table = String::from(
        "| Particles | Method | Six neighbours, % | Mean smallest angle | Smallest angle | Triangles > 90°, % \
         | Largest hole | Closest pair |\n| --- | --- | --: | --: | --: | --: | --: | --: |\n",
    );
    for Section { title, rows, .. } in sections(&read("docs/tables/methods.md")) {
        // A surface has a row for the front, and one without a name after it if it could be
        // refined.
        let pairs = rows.windows(2).filter(|pair| pair[1][0].is_empty());
        let (fronts, refined): (Vec<_>, Vec<_>) = pairs.map(|pair| (&pair[0], &pair[1])).unzip();
        for (method, rows) in [("front", fronts), ("refined", refined)] {
            let column = |column, worst, digits| median_and_worst(&rows, column, worst, digits);
            table += &format!(
                "| {} | {method}, {} surfaces | {} | {} | {} | {} | {} | {} |\n",
                title.trim_end_matches(" particles"),
                rows.len(),
                column(3, f64::min, 1),
                column(4, f64::min, 1),
                column(5, f64::min, 1),
                column(6, f64::max, 2),
                column(7, f64::max, 2),
                column(8, f64::min, 2)
            );
        }
    }
    table
}

fn solids_summary() -> String {
    let mut table = String::from(
        "| Particles | Method | Closed meshes | Volume off by | Off the edge | Six neighbours, % | Smallest angle \
         | Largest hole | Closest pair |\n| --- | --- | --: | --: | --: | --: | --: | --: | --: |\n",
    );
    for Section { title, rows, .. } in sections(&read("docs/tables/solids.md")) {
        for method in ["front", "refined"] {
            // A run that could not be refined has the front's particles.
            let is_front = method == "front";
            let rows: Vec<&Vec<&str>> = rows.iter().filter(|row| (row[1] == "front") == is_front).collect();
            let closed = rows.iter().filter(|row| !row[4].contains("open")).count();
            let known = rows.iter().filter(|row| row[4].parse::<f64>().is_ok());
            let volume = known.map(|row| (number(row[4]) - 1.0).abs()).fold(0.0, f64::max);
            let off = rows.iter().map(|row| number(row[5])).fold(0.0, f64::max);
            let column = |column, worst, digits| median_and_worst(&rows, column, worst, digits);
            table += &format!(
                "| {} | {method} | {closed} of {} | {:.2} % | {off:.0e} | {} | {} | {} | {} |\n",
                title.trim_end_matches(" particles"),
                rows.len(),
                100.0 * volume,
                column(6, f64::min, 1),
                column(7, f64::min, 1),
                column(8, f64::max, 2),
                column(9, f64::min, 2)
            );
        }
    }
    table
}

fn paper_summary() -> String {
    let mut table = String::from(
        "| Job | Marching, printed | faithful | fast | Other method, printed | faithful | Ratio, printed | here |\n\
         | --- | --: | --: | --: | --: | --: | --: | --: |\n",
    );
    for Section { title, text, rows } in sections(&read("docs/tables/paper.md")) {
        let Some(total) = rows.iter().find(|row| row[0] == "Total time") else { continue };
        let ratios = text.split_once("over that of the front: ").expect("a line with the ratios").1;
        let (printed, here) = ratios.split_once(" in the paper, ").expect("both ratios");
        let here = here.split_once(" here.").expect("our ratio").0.replace("more than ", "> ");
        table += &format!("| {title} | {} | {printed} | {here} |\n", total[1..].join(" | "));
    }
    table
}

#[test]
fn the_compiler_that_is_promised_is_the_one_that_every_check_runs_with() {
    let promised = env!("CARGO_PKG_RUST_VERSION");
    assert!(read("rust-toolchain.toml").contains(&format!("channel = \"{promised}.0\"")), "{promised}");
    assert!(read("README.md").contains(&format!("Rust {promised}")), "{promised}");
}

#[test]
fn everything_that_is_published_has_one_version() {
    let version = env!("CARGO_PKG_VERSION");
    for manifest in ["Cargo.toml", "python/Cargo.toml", "src/command/Cargo.toml"] {
        assert!(read(manifest).contains(&format!("\nversion = \"{version}\"\n")), "{manifest}");
    }
    for manifest in ["www/package/package.json", "www/package.json"] {
        assert!(read(manifest).contains(&format!("\"version\": \"{version}\"")), "{manifest}");
    }
    assert!(read("CHANGELOG.md").contains(&format!("## [{version}]")), "CHANGELOG.md");
}

#[test]
fn the_root_of_the_library_is_small_and_the_front_page_names_all_of_it() {
    let root = read("src/lib.rs");
    let names: Vec<&str> = root
        .split("\npub use ")
        .skip(1)
        .flat_map(|item| {
            let (path, _) = item.split_once(';').expect("the end of a `use`");
            let names = path.rsplit("::").next().expect("a name");
            names.split(['{', '}', ',', '\n']).map(str::trim).filter(|name| !name.is_empty())
        })
        .collect();
    let missing: Vec<_> =
        names.iter().filter(|name| **name != "glam" && !root.contains(&format!("[`{name}`]"))).collect();
    assert!(missing.is_empty(), "not in the table of src/lib.rs: {missing:?}");
    assert!((30..=40).contains(&names.len()), "{} names at the root: {names:?}", names.len());
}

#[test]
fn the_table_of_settings_is_that_of_the_settings() {
    check_table("docs/settings.md", "settings", &settings_table());
}

/// The type of an argument in the text that declares a function or an interface.
fn declared<'a>(text: &'a str, within: (&str, &str), name: &str, end: &str) -> &'a str {
    let (_, text) = text.split_once(within.0).expect(within.0);
    let (text, _) = text.split_once(within.1).expect(within.1);
    let begin = format!("\n{name}: ");
    let (_, text) = text.split_once(&begin).unwrap_or_else(|| panic!("{} has no {name}", within.0));
    text.split_once(end).map_or(text, |(kind, _)| kind)
}

#[test]
fn every_setting_is_declared_with_its_kind_in_python_and_for_npm() {
    let typescript = read("www/package/index.d.ts");
    let python = read("python/package/marching_particles/__init__.pyi");
    for setting in &settings() {
        let argument = setting.argument();
        let is_flag = ["adaptive", "exactly", "closed", "periodic"].contains(&argument);
        let choices = || setting.choices.iter().map(|choice| choice.value);
        let kinds = |flag: &str, whole: &str, number: &str, size: &str, formula: &str, quote: char| {
            match setting.kind {
                _ if is_flag => vec![flag.to_owned()],
                _ if argument == "count" => vec![whole.to_owned()],
                SettingKind::Choice => choices().map(|value| format!("{quote}{value}{quote}")).collect(),
                SettingKind::Integer => vec![whole.to_owned()],
                SettingKind::Formula => vec![formula.to_owned()],
                _ if setting.is_share() => vec![size.to_owned()],
                _ => vec![number.to_owned()],
            }
        };
        let hold = |door: &str, found: &str, kinds: Vec<String>| {
            for kind in kinds {
                assert!(found.contains(&kind), "{argument} is {found} {door}, without {kind}");
            }
        };
        if setting.name == "box_mode" {
            continue;
        }
        let name = format!("  {}?", names(setting).1);
        let found = declared(&typescript, ("export interface Options {", "\n}"), &name, ";\n");
        hold("for npm", found, kinds("boolean", "number", "number", "Size", "number | string", '\''));
        let function = if setting.name == "beyond_points" { "def fit_points(" } else { "def sample(" };
        let found = declared(&python, (function, "\n) -> "), &format!("    {argument}"), ",\n");
        hold(
            "in Python",
            found,
            kinds("bool", "SupportsIndex", "SupportsFloat", "_Size", "SupportsFloat, str", '"'),
        );
    }
}

#[test]
fn every_list_of_the_formats_of_points_is_complete() {
    let names: Vec<String> = InputFormat::ALL.iter().map(ToString::to_string).collect();
    let list = names.join(", ");
    let listed = list.strip_suffix(", XYZ").expect("text comes last");
    for page in [
        "CHANGELOG.md",
        "python/package/marching_particles/_fields.py",
        "src/command/arguments.rs",
        "src/pointcloud/mod.rs",
        "www/package/README.md",
        "www/package/index.d.ts",
    ] {
        let text = read(page).replace("///", "");
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(words.contains(listed), "{page} does not name {listed}");
    }
    let rows = names.iter().map(|name| ("docs/files.md", format!("\n| {name}")));
    let types =
        names.iter().map(|name| ("www/src/engine/constants.js", format!(".{},", name.to_lowercase())));
    for (page, wanted) in rows.chain(types) {
        assert!(read(page).contains(&wanted), "{page} does not name {wanted:?}");
    }
}

#[test]
fn the_summaries_are_those_of_the_tables() {
    check_table("docs/results.md", "moving surfaces", &flow_summary());
    check_table("docs/results.md", "methods", &methods_summary());
    check_table("docs/results.md", "solids", &solids_summary());
    check_table("docs/results.md", "the paper", &paper_summary());
}

/// The documents that people write: all but the tables of the benches.
fn documents() -> Vec<PathBuf> {
    let mut documents = Vec::new();
    for folder in ["", "docs"] {
        let entries = fs::read_dir(checkout().join(folder)).expect("a folder of documents");
        let paths = entries.map(|entry| entry.expect("an entry of the folder").path());
        documents.extend(paths.filter(|path| path.extension().is_some_and(|extension| extension == "md")));
    }
    documents.sort();
    documents
}

#[test]
fn every_link_of_a_document_leads_to_a_file_and_a_heading() {
    let anchor = |heading: &str| {
        let kept = heading.trim_start_matches('#').trim().to_lowercase();
        kept.chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
            .collect::<String>()
            .replace(' ', "-")
    };
    let mut links = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).expect("a document");
        let targets = text
            .split("](")
            .skip(1)
            .chain(text.split("src=\"").skip(1))
            .chain(text.split("srcset=\"").skip(1));
        for target in targets.filter_map(|rest| rest.split([')', '"']).next()) {
            if target.contains("://") {
                continue;
            }
            let (path, heading) = target.split_once('#').unwrap_or((target, ""));
            let file =
                if path.is_empty() { document.clone() } else { document.with_file_name("").join(path) };
            assert!(file.exists(), "{}: there is no {target}", document.display());
            let has_heading = || {
                let text = fs::read_to_string(&file).expect("a document");
                text.lines().any(|line| line.starts_with('#') && anchor(line) == heading)
            };
            assert!(heading.is_empty() || has_heading(), "{}: no heading for {target}", document.display());
            links += 1;
        }
    }
    assert!(links > 30, "{links} links were found");
}

#[test]
fn prose_wraps_at_100_columns_and_the_readme_is_short() {
    for document in documents() {
        let text = fs::read_to_string(&document).expect("a document");
        let is_prose =
            |line: &&str| !["|", "<", "!["].iter().any(|begin| line.trim_start().starts_with(begin));
        for line in text.lines().filter(is_prose) {
            let columns = line.chars().count();
            assert!(columns <= 100, "{}: {columns} columns: {line}", document.display());
        }
    }
    assert!(read("README.md").len() <= 10_000, "the README has at most 10 kB");
}

/// The Rust files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = entries.partition(|path| path.is_dir());
    let inner = folders.iter().flat_map(|folder| sources(folder));
    files.into_iter().filter(|path| path.extension().is_some_and(|kind| kind == "rs")).chain(inner).collect()
}

#[test]
fn comments_wrap_at_100_columns() {
    let folders = ["src", "tests", "benches", "examples", "xtask/src", "fuzz/targets"];
    let files: Vec<PathBuf> = folders.iter().flat_map(|folder| sources(&checkout().join(folder))).collect();
    assert!(files.len() > 300, "{} files were found", files.len());
    for file in files {
        let mut is_code = false;
        for line in fs::read_to_string(&file).expect("a source").lines() {
            let Some(comment) = line.trim_start().strip_prefix("//") else { continue };
            let text = comment.trim_start_matches(['/', '!']).trim_start();
            is_code ^= text.starts_with("```");
            // Tables and examples stay as they are.
            let columns = line.chars().count();
            let is_prose = !is_code && !text.starts_with('|');
            assert!(columns <= 100 || !is_prose, "{}: {columns} columns: {line}", file.display());
        }
    }
}
