//! Report of a run as text.

use crate::outcome::{MeshCounts, Outcome, Porosity};
use marching_particles::export::Unit;
use marching_particles::field::formula::Thickness;
use marching_particles::field::model::{ModelInfo, NormalSource};
use marching_particles::internal::math::{counted, grouped, significant};
use marching_particles::internal::session::{ReportRow, SpacingText, describe};
use marching_particles::mesh::Inside;
use marching_particles::run::{Cut, Severity};
use serde_json::Value;
use std::io::{self, Write};

/// Width of the labels: the longest in the table, of 31 characters, and a gap.
const LABEL: usize = 33;
/// Width of a column of figures: its longest head, `after front`, and a gap.
const COLUMN: usize = 13;

pub(crate) fn write(out: &mut impl Write, outcome: &Outcome) -> io::Result<()> {
    let report = &outcome.report;
    match (&outcome.model, &outcome.image) {
        _ if outcome.remesh.is_some() => {
            let lines = outcome.remesh.iter().flat_map(|mesh| mesh.lines());
            lines.into_iter().try_for_each(|line| writeln!(out, "{line}"))?;
        }
        (_, Some(image)) => image.lines().iter().try_for_each(|line| writeln!(out, "{line}"))?,
        (Some(model), _) => points(out, outcome.surface.as_deref().unwrap_or("points"), model)?,
        _ => writeln!(out, "{}: {}", outcome.surface.as_deref().unwrap_or("formula"), outcome.formula)?,
    }
    if !outcome.parameters.is_empty() {
        let values: Vec<String> = outcome
            .parameters
            .iter()
            .map(|(name, value)| format!("{name} = {}", significant(*value)))
            .collect();
        writeln!(out, "{}", values.join(", "))?;
    }
    if let Some(thickness) = &outcome.thickness {
        match thickness {
            Thickness::Number(number) => write!(out, "shell of thickness {}", significant(*number))?,
            Thickness::Formula(text) => write!(out, "shell of thickness {text}")?,
        }
        match outcome.porosity {
            Some(Porosity { wanted, reached: Some(reached) }) => {
                let [wanted, reached] = [wanted, reached].map(|share| significant(100.0 * share));
                writeln!(out, ", which leaves {reached} % of the box empty (wanted: {wanted} %)")?;
            }
            _ => writeln!(out)?,
        }
    }
    if let Some(SpacingText { formula, smallest, largest }) = &outcome.spacing {
        write!(out, "spacing {formula}")?;
        if let Some(smallest) = smallest {
            write!(out, ", at least {}", significant(*smallest))?;
        }
        if let Some(largest) = largest {
            write!(out, ", at most {}", significant(*largest))?;
        }
        writeln!(out)?;
    }
    writeln!(
        out,
        "{} of radius {} in {}",
        counted(report.count, "particle", "particles"),
        significant(report.sizes.radius),
        counted(report.growth.levels as usize, "level", "levels")
    )?;
    let s = &outcome.seconds;
    if outcome.model.is_some() {
        write!(out, "points {}, ", time(s.points))?;
    }
    if outcome.image.is_some() {
        write!(out, "image {}, ", time(s.points))?;
    }
    if outcome.remesh.is_some() {
        write!(out, "mesh {}, ", time(s.points))?;
    }
    write!(out, "seeding {}, generation {}", time(s.seeding), time(s.generation))?;
    if s.refinement > 0.0 {
        write!(out, ", refinement {}", time(s.refinement))?;
    }
    write!(out, ", relaxation {}", time(s.relaxation))?;
    if report.measures.quality.is_some() {
        write!(out, ", quality {}", time(s.quality))?;
    }
    if outcome.mesh.is_some() {
        write!(out, ", mesh {}", time(s.mesh))?;
    }
    let each = s.all() / report.count.max(1) as f64;
    writeln!(out, "; in all {}, {} \u{b5}s a particle", time(s.all()), significant(1e6 * each))?;
    if let Some(mesh) = &outcome.mesh {
        writeln!(out, "mesh of {}", mesh_line(mesh))?;
    }
    for line in outcome.remesh.iter().flat_map(|mesh| mesh.change_lines()) {
        writeln!(out, "{line}")?;
    }
    if let Some(peak) = outcome.peak_mb {
        writeln!(out, "peak memory {peak:.0} MB")?;
    }
    writeln!(out)?;
    table(out, outcome)?;
    if report.measures.quality.is_none() {
        writeln!(
            out,
            "\nnot measured: quality, components and Euler number of the sample, open edges; files have no columns valence, nearest \
             and residual"
        )?;
    }
    writeln!(out, "\ndigest {}", report.digest)?;
    if let Some(cut) = report.cut {
        let [min, max] =
            [outcome.bounds.min, outcome.bounds.max].map(|corner| corner.map(significant).join(","));
        let of = counted(report.border, "particle", "particles");
        match cut {
            Cut::Endless => {
                writeln!(
                    out,
                    "the surface continues outside the box from {min} to {max}; --box sets another"
                )?;
            }
            Cut::Fixed | Cut::Outgrown => writeln!(
                out,
                "the box from {min} to {max} cuts the surface, at {of}: enlarge it{}",
                if outcome.surface.is_some() { " with --box" } else { ", or fit it with --box fit" }
            )?,
        }
    }
    let of_points = outcome.model.iter().flat_map(|model| &model.warnings);
    for warning in of_points {
        writeln!(out, "warning: {warning}")?;
    }
    for warning in &report.warnings {
        let kind = if warning.severity() == Severity::Note { "note" } else { "warning" };
        writeln!(out, "{kind}: {warning}")?;
    }
    if outcome.porosity.is_some_and(|porosity| porosity.reached.is_none()) {
        writeln!(
            out,
            "warning: the mesh is open, so that its porosity is not known: a smaller --radius may close it"
        )?;
    }
    if let Some(mesh) = outcome.mesh.as_ref().filter(|mesh| outcome.is_printed && mesh.volume.is_none()) {
        let loops = mesh.borders + mesh.holes;
        let why = if loops == 0 {
            "sheets of the mesh cross or touch, so that it is no manifold".to_owned()
        } else {
            format!("the mesh is open, with {}", counted(loops, "border loop", "border loops"))
        };
        let advice = if loops == 0 { "" } else { "; --closed closes what the box cuts" };
        writeln!(out, "warning: {why}, and cannot be printed{advice}")?;
    }
    for file in &outcome.files {
        writeln!(out, "wrote {file}")?;
    }
    Ok(())
}

/// Writes the source of the points and their distances from the surface.
fn points(out: &mut impl Write, title: &str, model: &ModelInfo) -> io::Result<()> {
    let credit = if model.credit.is_empty() { "" } else { ", " };
    writeln!(out, "{title}: {}{credit}{}", model.name, model.credit)?;
    let normals = match model.normals {
        NormalSource::Given => "given",
        NormalSource::FromMesh => "from the faces",
        NormalSource::Estimated => "estimated",
    };
    let [centres, points] = [model.centres, model.points].map(|count| grouped(count as usize));
    writeln!(
        out,
        "a surface from {centres} centres near {points} points, normals {normals}, condition {:.0e}",
        model.condition
    )?;
    writeln!(
        out,
        "distance of all points from it: mean {:.3} %, 95 % below {:.3} %, largest {:.3} % of their diagonal",
        100.0 * model.residual_mean,
        100.0 * model.residual_95,
        100.0 * model.residual_max
    )
}

/// Writes the table of quality figures, before and after relaxation, without the group `Run`, which
/// the lines above already contain.
fn table(out: &mut impl Write, outcome: &Outcome) -> io::Result<()> {
    let report = serde_json::to_value(&outcome.report).map_err(io::Error::other)?;
    let compared = !report["quality_before"].is_null();
    let first = if compared { "after front" } else { "" };
    let second = if compared { "relaxed" } else { "" };
    writeln!(out, "{:LABEL$}{first:>COLUMN$}{second:>COLUMN$}{:>COLUMN$}", "", "ideal")?;
    let value = |path: &str| {
        path.split('.').try_fold(&report, |value, key| value.get(key)).filter(|value| !value.is_null())
    };
    for row in describe().report.iter().filter(|row| row.group != "Run") {
        if value(row.key).is_none() || row.unless.is_some_and(|path| value(path).is_some()) {
            continue;
        }
        let before = match row.key.strip_prefix("quality.") {
            Some(key) if compared => figure(row, value(&format!("quality_before.{key}"))),
            _ => String::new(),
        };
        let after = figure(row, value(row.key));
        let line = format!("{:LABEL$}{before:>COLUMN$}{after:>COLUMN$}{:>COLUMN$}", row.label, row.ideal);
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(())
}

/// Formats a figure with the digits and the unit of its row.
fn figure(row: &ReportRow, value: Option<&Value>) -> String {
    if let Some(word) = value.and_then(Value::as_str) {
        return word.to_owned();
    }
    let Some(value) = value.and_then(Value::as_f64) else {
        return "–".to_owned();
    };
    let (value, unit) = match row.unit {
        "%" => (value * 100.0, " %"),
        "°" => (value, "°"),
        // In the units of the formula, so of any magnitude.
        "units²" | "units³" => return significant(value),
        _ => (value, ""),
    };
    format!("{value:.*}{unit}", usize::from(row.digits))
}

/// A mesh in one line.
fn mesh_line(mesh: &MeshCounts) -> String {
    let borders = match mesh.borders + mesh.holes {
        0 if mesh.volume.is_some() => "closed".to_owned(),
        0 => "not a manifold".to_owned(),
        loops => counted(loops, "border loop", "border loops"),
    };
    let triangles = counted(mesh.triangles, "triangle", "triangles");
    let components = counted(mesh.components, "component", "components");
    let chips = match mesh.chips {
        0 => String::new(),
        chips => format!(" and {}", counted(chips, "loose chip", "loose chips")),
    };
    let left_out = match mesh.parts_left_out {
        0 => "",
        _ => ", all but the largest left out",
    };
    let unit = mesh.unit.and_then(|unit| Unit::ALL.iter().find(|(_, known)| *known == unit));
    let unit = unit.map_or(String::new(), |(symbol, _)| format!(" {symbol}"));
    let size = mesh.size.map(significant).join(" × ");
    let parts = format!("{}{chips}{left_out}, {size}{unit}", counted(mesh.parts, "part", "parts"));
    let volume = mesh.volume.map_or("–".to_owned(), significant);
    let turned = match mesh.inside {
        Some(Inside::Positive) => ", turned to face outward: f is larger inside",
        Some(Inside::Both) => ", turned in part to face outward: f is larger inside some parts",
        _ => "",
    };
    let angle = mesh.smallest_angle.map_or("–".to_owned(), |angle| format!("{angle:.1}°"));
    format!(
        "{parts}\n{triangles}, {components}, Euler number {}, {borders}, volume {volume}, smallest angle {angle}{turned}",
        mesh.euler
    )
}

/// Formats a duration in milliseconds or seconds.
fn time(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.1} ms", seconds * 1e3) } else { format!("{seconds:.2} s") }
}
