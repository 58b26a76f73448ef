//! Subcommand `surfaces`: lists the gallery and the built-in models.

use crate::arguments::Surfaces;
use crate::failure::Failure;
use marching_particles::internal::session::{SurfaceEntry, describe};
use std::io::Write;
use std::process::ExitCode;

pub(crate) fn run(arguments: &Surfaces) -> Result<ExitCode, Failure> {
    let description = describe();
    let mut out = std::io::stdout().lock();
    if arguments.json {
        let surfaces = description.surfaces.iter().map(serde_json::to_value);
        let all = surfaces.chain(description.models.iter().map(serde_json::to_value));
        let all: Vec<serde_json::Value> = all.collect::<Result<_, _>>().map_err(std::io::Error::other)?;
        writeln!(out, "{}", serde_json::Value::from(all))?;
        return Ok(ExitCode::SUCCESS);
    }
    for surface in &description.surfaces {
        write_entry(&mut out, surface)?;
    }
    for model in description.models {
        let credit = if model.credit.is_empty() { "" } else { ", " };
        writeln!(out, "{}  {}{credit}{} ({} points)", model.id, model.name, model.credit, model.points)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn write_entry(
    out: &mut impl Write,
    SurfaceEntry { surface, parameters, .. }: &SurfaceEntry,
) -> std::io::Result<()> {
    let mut facts = Vec::new();
    facts.extend(surface.degree.map(|degree| format!("degree {degree}")));
    facts.extend(surface.genus.map(|genus| format!("genus {genus}")));
    let facts = if facts.is_empty() { String::new() } else { format!(" ({})", facts.join(", ")) };
    writeln!(out, "{}  {}{facts}", surface.id, surface.name)?;
    writeln!(out, "    {}", surface.formula)?;
    for p in parameters {
        writeln!(out, "    --param {}={}  {}, {} to {}", p.name, p.value, p.label, p.min, p.max)?;
    }
    let [lo, hi] = [surface.bounds.min, surface.bounds.max];
    writeln!(out, "    --box {},{},{},{},{},{}", lo[0], lo[1], lo[2], hi[0], hi[1], hi[2])
}
