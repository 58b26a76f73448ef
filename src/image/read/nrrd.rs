//! NRRD, "nearly raw raster data" (the format of Teem, by G. Kindlmann).

use super::header::{first_of, lines, numbers, quoted, type_of_name, wrong};
use super::{Header, ImageFormat, ImageReadError, Source};
use crate::image::AxisOrder;
use crate::image::voxels::Layout;
use glam::DVec3;

const FORMAT: ImageFormat = ImageFormat::Nrrd;

/// The entries that are used, as text.
#[derive(Default)]
struct Entries<'a> {
    type_name: Option<&'a str>,
    sizes: Option<&'a str>,
    endian: Option<&'a str>,
    encoding: Option<&'a str>,
    directions: Option<&'a str>,
    origin: Option<&'a str>,
    spacings: Option<&'a str>,
    kinds: Option<&'a str>,
    data_file: Option<&'a str>,
    byte_skip: Option<&'a str>,
    line_skip: Option<&'a str>,
}

impl<'a> Entries<'a> {
    fn slot(&mut self, name: &str) -> Option<&mut Option<&'a str>> {
        Some(match name {
            "type" => &mut self.type_name,
            "sizes" => &mut self.sizes,
            "endian" => &mut self.endian,
            "encoding" => &mut self.encoding,
            "space directions" => &mut self.directions,
            "space origin" => &mut self.origin,
            "spacings" => &mut self.spacings,
            "kinds" => &mut self.kinds,
            "data file" | "datafile" => &mut self.data_file,
            "byte skip" | "byteskip" => &mut self.byte_skip,
            "line skip" | "lineskip" => &mut self.line_skip,
            _ => return None,
        })
    }
}

pub(super) fn header(start: &[u8]) -> Result<Header, ImageReadError> {
    let mut entries = Entries::default();
    let mut end = None;
    for (_, line, behind) in lines(start) {
        if line.is_empty() {
            end = Some(behind);
            break;
        }
        // Lines with `:=` are the user's own key-value pairs.
        if let Some((name, value)) = line.split_once(": ")
            && let Some(slot) = entries.slot(&name.to_ascii_lowercase())
        {
            *slot = Some(value.trim());
        }
        end = entries.data_file.map(|_| behind);
    }
    let missing = |entry: &str| wrong(FORMAT, entry, "it is missing; export the file again");
    let end = end.ok_or_else(|| wrong(FORMAT, "end", "the header does not end; export the file again"))?;
    let name = entries.type_name.ok_or_else(|| missing("type"))?;
    let voxel_type = type_of_name(name).ok_or_else(|| {
        wrong(FORMAT, "type", format!("voxels of type {} are not read; convert them to float", quoted(name)))
    })?;
    let sizes = entries.sizes.ok_or_else(|| missing("sizes"))?;
    let sizes: Option<Vec<usize>> = sizes.split_whitespace().map(|word| word.parse().ok()).collect();
    let sizes =
        sizes.ok_or_else(|| wrong(FORMAT, "sizes", "these are no whole numbers; export the file again"))?;
    let kinds: Vec<&str> = entries.kinds.unwrap_or_default().split_whitespace().collect();
    let directions = entries.directions.map(vectors).transpose()?;
    let is_spatial = |axis: usize| match (&directions, kinds.get(axis)) {
        (Some(directions), _) => directions.get(axis).is_some_and(Option::is_some),
        (None, Some(kind)) => matches!(*kind, "domain" | "space" | "???" | "none"),
        (None, None) => axis < 3,
    };
    let axes: Vec<usize> = (0..sizes.len()).filter(|&axis| is_spatial(axis)).collect();
    let [first, second, third] = axes[..] else {
        let message = format!("it has {} axes in space, and an image has three; save one volume", axes.len());
        return Err(wrong(FORMAT, "dimension", message));
    };
    if [second, third] != [first + 1, first + 2] {
        return Err(wrong(FORMAT, "kinds", "the axes in space do not follow each other; save one volume"));
    }
    let product = |axes: core::ops::Range<usize>| {
        sizes[axes].iter().fold(1, |product: usize, &n| product.saturating_mul(n))
    };
    let (step, volumes) = (product(0..first), product(third + 1..sizes.len()));
    let mut notes = Vec::new();
    if step > 1 {
        notes.push(first_of(step, "values for each voxel"));
    }
    if volumes > 1 {
        notes.push(first_of(volumes, "volumes"));
    }
    let (matrix, origin) = placement(&entries, directions.as_deref(), &axes)?;
    let is_packed = match entries.encoding.map(str::to_ascii_lowercase).as_deref() {
        Some("raw") => false,
        Some("gzip" | "gz") => true,
        Some(other) => {
            let message = format!("data as {} is not read; save it as raw or gzip", quoted(other));
            return Err(wrong(FORMAT, "encoding", message));
        }
        None => return Err(missing("encoding")),
    };
    let is_big_endian = entries.endian.is_some_and(|endian| endian.eq_ignore_ascii_case("big"));
    let skip = entries.byte_skip.unwrap_or("0").parse::<usize>();
    let (Ok(skip), None | Some("0")) = (skip, entries.line_skip) else {
        return Err(wrong(
            FORMAT,
            "byte skip or line skip",
            "only a number of bytes is read; save the data without skips",
        ));
    };
    let source = match entries.data_file {
        None => Source::Here(end.saturating_add(skip)),
        Some(name) if name == "LIST" || name.contains('%') => {
            return Err(wrong(FORMAT, "data file", "a list of files is not read; save the data as one"));
        }
        Some(name) => Source::Beside(name.to_owned()),
    };
    Ok(Header {
        format: FORMAT,
        size: [first, second, third].map(|axis| sizes[axis]),
        order: AxisOrder::FirstFastest,
        axes: matrix,
        origin,
        layout: Layout { first: skip, step, ..Layout::plain(voxel_type, is_big_endian) },
        is_packed,
        source,
        notes,
    })
}

/// The steps from voxel to voxel and the position of the first one, in the space of the file.
fn placement(
    entries: &Entries,
    directions: Option<&[Option<DVec3>]>,
    axes: &[usize],
) -> Result<([DVec3; 3], DVec3), ImageReadError> {
    let origin = match entries.origin {
        None => DVec3::ZERO,
        Some(text) => match vectors(text)?[..] {
            [Some(origin)] => origin,
            _ => {
                return Err(wrong(
                    FORMAT,
                    "space origin",
                    "it is no vector of three numbers; export the file again",
                ));
            }
        },
    };
    if let Some(directions) = directions {
        return Ok((core::array::from_fn(|k| directions[axes[k]].unwrap_or(DVec3::AXES[k])), origin));
    }
    let Some(text) = entries.spacings else { return Ok((DVec3::AXES, origin)) };
    let spacings = numbers(text)
        .ok_or_else(|| wrong(FORMAT, "spacings", "these are no numbers; export the file again"))?;
    let spacing = |k: usize| spacings.get(axes[k]).copied().filter(|length| !length.is_nan()).unwrap_or(1.0);
    Ok((core::array::from_fn(|k| DVec3::AXES[k] * spacing(k)), origin))
}

/// Parses vectors such as `none (1,0,0) (0,1,0) (0,0,2)`.
fn vectors(text: &str) -> Result<Vec<Option<DVec3>>, ImageReadError> {
    let wrong = || {
        wrong(
            FORMAT,
            "space directions or space origin",
            format!("{} is no vector of three numbers; export the file again", quoted(text)),
        )
    };
    let mut found = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            found.push(None);
            rest = after.trim_start();
            continue;
        }
        let (inner, after) =
            rest.strip_prefix('(').and_then(|rest| rest.split_once(')')).ok_or_else(wrong)?;
        match numbers(&inner.replace(',', " ")).as_deref() {
            Some(&[x, y, z]) => found.push(Some(DVec3::new(x, y, z))),
            _ => return Err(wrong()),
        }
        rest = after.trim_start();
    }
    Ok(found)
}
