//! Reader of OFF files (Geomview, "OFF Files"): text with one point or one face per line.

use super::ReadError;
use super::input::{COMPONENTS, Input, number, quoted, words};
use super::mesh::FileMesh;
use glam::DVec3;

/// The letters before `OFF` in the first word of such a file. `ST`, `C` and `N` mean that points
/// have texture coordinates, colours and normals; `4` and `n` that points are not
/// three-dimensional. The first number may follow without a space.
pub(super) fn prefix(word: &[u8]) -> Option<&[u8]> {
    let at = word.windows(3).position(|letters| letters == b"OFF")?;
    let (prefix, rest) = word.split_at(at);
    let is_known = prefix.iter().all(|letter| b"STCN4n".contains(letter));
    (is_known && rest[3..].iter().all(u8::is_ascii_digit)).then_some(prefix)
}

/// The next line with more than a comment, without the comment.
fn line<'a>(input: &mut Input<'a>) -> Option<&'a [u8]> {
    core::iter::from_fn(|| input.line())
        .map(|line| line.split(|&byte| byte == b'#').next().unwrap_or_default().trim_ascii())
        .find(|line| !line.is_empty())
}

fn count(word: Option<&[u8]>, what: &str, input: &Input) -> Result<u64, ReadError> {
    let missing =
        || input.error(format!("the numbers of points and faces are needed, that of {what} is missing"));
    let word = word.ok_or_else(missing)?;
    let number = core::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
    number.ok_or_else(|| input.error(format!("`{}` is no number of {what}", quoted(word))))
}

/// Reads the header, the points and the faces.
pub(super) async fn read(input: &mut Input<'_>, mesh: &mut FileMesh) -> Result<(), ReadError> {
    let head = line(input).unwrap_or_default();
    let mut sizes = words(head);
    let word = sizes.next().unwrap_or_default();
    let prefix = prefix(word).unwrap_or_default();
    if prefix.contains(&b'4') || prefix.contains(&b'n') {
        return Err(
            input.error("the points of this OFF file are not points in space; export it with x, y and z")
        );
    }
    let (has_normals, has_colours) = (prefix.contains(&b'N'), prefix.contains(&b'C'));
    // The letter nearest to `OFF` is first in a line: normals in CNOFF, colours of three or four
    // numbers in NCOFF.
    let colours_first =
        prefix.iter().rposition(|&letter| letter == b'C') > prefix.iter().rposition(|&letter| letter == b'N');
    let after = if prefix.starts_with(b"ST") { 2 } else { 0 };
    let mut words_of_line: Vec<&[u8]> = Vec::new();
    let glued = &word[(prefix.len() + 3).min(word.len())..];
    let mut sizes: Vec<&[u8]> =
        Some(glued).filter(|word| !word.is_empty()).into_iter().chain(sizes).collect();
    if sizes.is_empty() {
        sizes = words(line(input).unwrap_or_default()).collect();
    }
    let points = count(sizes.first().copied(), "points", input)?;
    let faces = count(sizes.get(1).copied(), "faces", input)?;
    check_claim(input, [points, faces])?;
    let cut_off = |input: &Input, what: &str, count: u64| {
        input.error(format!("the file ends before all {count} {what}; it is cut off: export it again"))
    };
    for _ in 0..points {
        let line = line(input).ok_or_else(|| cut_off(input, "points", points))?;
        words_of_line.clear();
        words_of_line.extend(words(line));
        let p = input.vector(&mut words_of_line.iter().copied(), &COMPONENTS[..3])?;
        let mut n = DVec3::ZERO;
        if has_normals {
            let before = if colours_first { words_of_line.len().saturating_sub(3 + after).max(3) } else { 3 };
            n = input.vector(&mut words_of_line.iter().copied().skip(before), &COMPONENTS[3..])?;
        }
        mesh.add_point([p.x, p.y, p.z, n.x, n.y, n.z], has_normals)?;
        if has_colours {
            let before = if has_normals && !colours_first { 6 } else { 3 };
            let mut parts = words_of_line.iter().skip(before).map(|word| number(word));
            if let [Some(Some(red)), Some(Some(green)), Some(Some(blue))] = [(); 3].map(|()| parts.next()) {
                mesh.add_colour([red, green, blue])?;
            }
        }
        input.end_row().await;
    }
    let mut corners = Vec::new();
    for _ in 0..faces {
        let line = line(input).ok_or_else(|| cut_off(input, "faces", faces))?;
        let mut words = words(line);
        let count = count(words.next(), "corners", input)?;
        corners.clear();
        // After the corners comes the colour of the face.
        for _ in 0..count {
            let Some(word) = words.next() else {
                return Err(input.error(format!("this face has fewer corners than the {count} that it says")));
            };
            let corner = core::str::from_utf8(word).ok().and_then(|word| word.parse::<u32>().ok());
            let corner = corner.filter(|&corner| u64::from(corner) < points).ok_or_else(|| {
                input.error(format!(
                    "the face has vertex {}, and the {points} vertices are counted from 0",
                    quoted(word)
                ))
            })?;
            corners.push(corner);
        }
        mesh.add_polygon(&corners)?;
        input.end_row().await;
    }
    Ok(())
}

/// Compares the counts in the header with the bytes that follow.
fn check_claim(input: &Input, counts: [u64; 2]) -> Result<(), ReadError> {
    // Three digits, or one, each with a character after it; the last line needs no line end.
    let (left, mut needed) = (input.remaining() as u64, 0_u64);
    for (element, count, size) in [("point", counts[0], 6), ("face", counts[1], 2)] {
        needed = needed.saturating_add(count.saturating_mul(size));
        if needed > left + 1 {
            return Err(ReadError::Claim { element: element.to_owned(), count, needed, left });
        }
    }
    Ok(())
}
