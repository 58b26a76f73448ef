//! Which constants matter: the bench `sensitivity` with each constant halved and doubled.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::project::{Project, cargo};
use crate::step;

/// The constants of the sampler that matter most, each as its file in `src` and its name.
const CONSTANTS: [&str; 13] = [
    "sampler/front/mod.rs:MAX_DIP",
    "sampler/projection.rs:MAX_TURN",
    "sampler/sheet.rs:UNCOVERED",
    "sampler/neighbours/constants.rs:GAUSSIAN_SKIN",
    "sampler/relaxation/repulsion.rs:MAX_MOVE",
    "sampler/relaxation/stepper.rs:GROWTH",
    "sampler/refine/mod.rs:LEAST_PARTICLES",
    "sampler/refine/coarse.rs:MAX_BEND",
    "sampler/refine/recipe.rs:rounds",
    "sampler/refine/recipe.rs:loss",
    "sampler/refine/recipe.rs:omega",
    "sampler/refine/net.rs:MAX_MOVE",
    "sampler/constraint/mod.rs:LONGEST",
];
/// Folders that the bench does not need.
const LEFT_OUT: [&str; 4] = ["target", "www", ".git", "corpus"];
/// Number of the bench's figures, each a column.
const FIGURES: usize = 6;

/// Which constants to vary.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Constants, as FILE:NAME with the file's path in `src`: a `const`, or a field of one, whose
    /// value is written as a number. By default those that matter most.
    #[arg(value_name = "FILE:NAME")]
    constants: Vec<String>,
}

/// The lines of a bench run by name, and the titles of its columns.
struct Outcome {
    titles: Vec<String>,
    runs: BTreeMap<String, Vec<String>>,
}

/// Runs the bench with the present sources, and with each constant halved and doubled; prints how
/// much the figures change.
pub(crate) fn run(project: &Project, options: &Options) -> Result<()> {
    let tree = project.scratch("sensitivity")?;
    copy(&project.root, &tree)?;
    let default = || CONSTANTS.map(str::to_owned).to_vec();
    let constants = if options.constants.is_empty() { default() } else { options.constants.clone() };
    // A wrong name is reported before anything is built.
    for constant in &constants {
        varied(&tree, constant, 1.0)?;
    }
    let base = bench(&tree)?;
    print_row(&base.titles, "constant", "value", "runs with other particles");
    for constant in &constants {
        for factor in [0.5, 2.0] {
            let (path, before, text, value) = varied(&tree, constant, factor)?;
            fs::write(&path, text)?;
            let outcome = bench(&tree);
            fs::write(&path, before)?;
            print_changes(constant, &value, &base, &outcome?);
        }
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    if from.is_dir() {
        fs::create_dir_all(to)?;
        for entry in fs::read_dir(from)? {
            let entry = entry?;
            if !LEFT_OUT.iter().any(|name| entry.file_name() == *name) {
                copy(&entry.path(), &to.join(entry.file_name()))?;
            }
        }
    } else if fs::read(from)? != fs::read(to).unwrap_or_default() {
        // Unchanged files keep their dates, so that cargo does not recompile them.
        fs::copy(from, to).with_context(|| format!("could not copy {}", from.display()))?;
    }
    Ok(())
}

/// The file of a constant, its text before and after, and the new value.
fn varied(tree: &Path, constant: &str, factor: f64) -> Result<(PathBuf, String, String, String)> {
    let (file, name) = constant.split_once(':').with_context(|| format!("{constant} is not FILE:NAME"))?;
    let path = tree.join("src").join(file);
    let before = fs::read_to_string(&path).with_context(|| format!("there is no src/{file}"))?;
    let mut found = None;
    for (at, _) in before.match_indices(&format!("{name}: ")) {
        let is_word = before[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let line = before[at..].lines().next().unwrap_or_default();
        let value = line.split_once("= ").map_or(&line[name.len() + 2..], |(_, value)| value);
        let value = value.trim_end_matches([';', ',']);
        let Ok(number) = value.replace('_', "").parse::<f64>() else { continue };
        if is_word {
            continue;
        }
        if found.is_some() {
            bail!("src/{file} has {name} several times");
        }
        let start = at + line.find(value).context("a part of the line")?;
        let changed = factor * number;
        let text = if value.contains('.') {
            format!("{changed:?}")
        } else {
            format!("{}", changed.round().max(1.0))
        };
        found = Some((start..start + value.len(), text));
    }
    let (range, value) = found.with_context(|| format!("src/{file} has no {name} that is a number"))?;
    let mut after = before.clone();
    after.replace_range(range, &value);
    Ok((path, before, after, value))
}

fn bench(tree: &Path) -> Result<Outcome> {
    let mut command = Command::new(cargo());
    command.current_dir(tree).args([
        "bench",
        "--package",
        "benches",
        "--locked",
        "--quiet",
        "--profile",
        "test",
    ]);
    command.args(["--bench", "sensitivity"]).env("CARGO_TARGET_DIR", tree.join("target"));
    let line = step::command_line(&command);
    let output = command.output().with_context(|| format!("could not start `{line}`"))?;
    if !output.status.success() {
        bail!("`{line}` failed ({}):\n{}", output.status, String::from_utf8_lossy(&output.stderr));
    }
    let text = String::from_utf8(output.stdout)?;
    let mut lines = text.lines().map(|line| line.split('\t').map(str::to_owned).collect::<Vec<_>>());
    let titles = lines.next().context("the bench prints nothing")?;
    let runs = lines.map(|mut line| (line.remove(0), line)).collect();
    Ok(Outcome { titles: titles[2..].to_vec(), runs })
}

fn print_row(figures: &[String], constant: &str, value: &str, others: &str) {
    println!("{constant:<48} {value:>8}  {others}  {}", figures.join("  "));
}

/// Prints the change of the mean figures over the runs that finish in both cases.
fn print_changes(constant: &str, value: &str, base: &Outcome, varied: &Outcome) {
    let mut sums = [[0.0; 2]; FIGURES];
    let (mut others, mut ended) = (0, 0);
    for (name, before) in &base.runs {
        let Some(after) = varied.runs.get(name) else { continue };
        others += usize::from(before.first() != after.first());
        if before.len() != FIGURES + 1 || after.len() != FIGURES + 1 {
            ended += usize::from(before.len() != after.len());
            continue;
        }
        for (k, sum) in sums.iter_mut().enumerate() {
            for (sum, line) in sum.iter_mut().zip([before, after]) {
                *sum += line[k + 1].parse::<f64>().unwrap_or(f64::NAN);
            }
        }
    }
    let change = |(title, [before, after]): (&String, &[f64; 2])| {
        let width = title.len();
        format!("{:>+width$.2}%", 100.0 * (after / before - 1.0), width = width - 1)
    };
    let mut figures: Vec<String> = base.titles.iter().zip(&sums).map(change).collect();
    if ended > 0 {
        figures.push(format!("{ended} that end in one only"));
    }
    let others = format!("{:>25}", format!("{others} of {}", base.runs.len()));
    print_row(&figures, constant, value, &others);
}
