//! Detection of a file's format by its content.

use super::input::words;
#[cfg(feature = "images")]
use super::three_mf;
use super::{ReadError, glb, off, pcd, xyz};
use core::fmt;

/// File format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputFormat {
    /// Polygon file format, text or binary.
    Ply,
    /// Wavefront object.
    Obj,
    /// Stereolithography, as text.
    StlText,
    /// Stereolithography, binary.
    StlBinary,
    /// Object file format of Geomview, text.
    Off,
    /// Point cloud data of the Point Cloud Library, as text, binary or compressed.
    Pcd,
    /// Binary glTF.
    Glb,
    /// 3D Manufacturing Format, for which `images` has what unpacks it.
    #[cfg(feature = "images")]
    ThreeMf,
    /// Text with one point per line.
    Xyz,
}

impl fmt::Display for InputFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ply => "PLY",
            Self::Obj => "OBJ",
            Self::StlText | Self::StlBinary => "STL",
            Self::Off => "OFF",
            Self::Pcd => "PCD",
            Self::Glb => "GLB",
            #[cfg(feature = "images")]
            Self::ThreeMf => "3MF",
            Self::Xyz => "XYZ",
        })
    }
}

impl InputFormat {
    /// The formats, one of each name, in the order in which texts list them.
    pub const ALL: &[Self] = &[
        Self::Ply,
        Self::Obj,
        Self::StlText,
        Self::Off,
        Self::Glb,
        #[cfg(feature = "images")]
        Self::ThreeMf,
        Self::Pcd,
        Self::Xyz,
    ];

    /// The extension of `name`, if it belongs to another format.
    pub(super) fn contradicting_extension(self, name: &str) -> Option<String> {
        let extension = extension(name);
        let named = |format: &Self| format.to_string().eq_ignore_ascii_case(&extension);
        (Self::ALL.iter().any(named) && !named(&self)).then_some(extension)
    }
}

/// The names of the formats that are not text with one point on a line.
pub(super) fn names() -> String {
    let names = InputFormat::ALL.iter().filter(|format| **format != InputFormat::Xyz);
    names.map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Extension of a file name, in lower case.
fn extension(name: &str) -> String {
    name.rsplit_once('.').map(|(_, extension)| extension.to_ascii_lowercase()).unwrap_or_default()
}

/// Number of bytes that are checked to tell text from binary data. Binary numbers soon contain a
/// control character, so this is more than enough.
const LOOKED_AT: usize = 4096;

/// Bytes of the header of a binary STL file, including the number of triangles.
pub(super) const STL_HEADER: usize = 84;
/// Bytes of a triangle in a binary STL file.
pub(super) const STL_TRIANGLE: usize = 50;

const CONVERT: &str = "open it in a mesh program such as MeshLab or Blender and export it as PLY";
const CHOOSE: &str = "choose a file of points or of a mesh";

/// First bytes of other formats, with the format's name and advice for the user.
const KNOWN: [(&[u8], &str, &str); 16] = [
    (b"LASF", "a LAS point cloud", CONVERT),
    (b"ASTM-E57", "an E57 point cloud", CONVERT),
    (b"Kaydara FBX", "an FBX file", CONVERT),
    (
        b"\x93NUMPY",
        "a NumPy array",
        "save points as text, one on a line (XYZ); the command line reads an array of voxels (--image)",
    ),
    (b"PK\x03\x04", "a ZIP archive (3MF and USDZ are such)", "unpack it, or export it as PLY"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"BZh", "a bzip2 archive", "unpack it first"),
    (b"\xfd7zXZ", "an xz archive", "unpack it first"),
    (b"7z\xbc\xaf", "a 7z archive", "unpack it first"),
    (b"Rar!", "a RAR archive", "unpack it first"),
    (b"\x89PNG", "a PNG picture", CHOOSE),
    (b"\xff\xd8\xff", "a JPEG picture", CHOOSE),
    (b"%PDF", "a PDF document", CHOOSE),
    (b"\x7fELF", "a program", CHOOSE),
    (b"\xff\xfe", "text in UTF-16", "save it as UTF-8"),
    (b"\xfe\xff", "text in UTF-16", "save it as UTF-8"),
];

/// First words of OBJ statements.
const OBJ_WORDS: [&[u8]; 14] =
    [b"v", b"vn", b"vt", b"vp", b"f", b"o", b"g", b"s", b"l", b"p", b"mtllib", b"usemtl", b"usemap", b"mg"];

/// Format of a non-empty file. The file name counts only if the content is ambiguous.
///
/// # Errors
///
/// [`ReadError::Unknown`] with the name of the format, if it is known, and advice.
pub(super) fn sniff(name: &str, bytes: &[u8]) -> Result<InputFormat, ReadError> {
    if bytes.strip_prefix(b"ply").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace)) {
        return Ok(InputFormat::Ply);
    }
    #[cfg(feature = "images")]
    if bytes.starts_with(three_mf::MAGIC) {
        return Ok(InputFormat::ThreeMf);
    }
    if let Some(&(_, found, advice)) = KNOWN.iter().find(|(magic, ..)| bytes.starts_with(magic)) {
        return Err(ReadError::Unknown { found, advice });
    }
    if pcd::begins_with(bytes) {
        return Ok(InputFormat::Pcd);
    }
    if bytes.starts_with(glb::MAGIC) {
        return Ok(InputFormat::Glb);
    }
    let first = bytes.split(|&byte| matches!(byte, b'\n' | b'\r')).next().unwrap_or_default();
    if let [word, b"BINARY"] = words(first).take(3).collect::<Vec<_>>()[..]
        && off::prefix(word).is_some()
    {
        return Err(ReadError::Unknown { found: "a binary OFF file", advice: CONVERT });
    }
    // Many programs begin a binary STL file with `solid`, like a text one, so the size decides.
    if stl_size(bytes).is_some_and(|size| size == bytes.len() as u64) {
        return Ok(InputFormat::StlBinary);
    }
    let looked_at = &bytes[..bytes.len().min(LOOKED_AT)];
    if looked_at.iter().any(|&byte| byte < b' ' && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c)) {
        if extension(name) == "stl" || bytes.starts_with(b"solid") {
            return Ok(InputFormat::StlBinary);
        }
        return Err(ReadError::Unknown { found: "a binary file of no known kind", advice: CHOOSE });
    }
    of_text(name, bytes)
}

/// Size of the file according to the header of a binary STL file.
pub(super) fn stl_size(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(STL_HEADER - 4..STL_HEADER)?;
    let count = u32::from_le_bytes(count.try_into().ok()?);
    Some(STL_HEADER as u64 + u64::from(count) * STL_TRIANGLE as u64)
}

/// Format of a text file.
fn of_text(name: &str, bytes: &[u8]) -> Result<InputFormat, ReadError> {
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut lines = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && xyz::comment(line).is_none());
    let line = first.unwrap_or_default();
    let word = words(line).next().unwrap_or_default();
    if word.eq_ignore_ascii_case(b"solid") {
        return Ok(InputFormat::StlText);
    }
    if OBJ_WORDS.contains(&word) {
        return Ok(InputFormat::Obj);
    }
    if off::prefix(word).is_some() {
        return Ok(InputFormat::Off);
    }
    if xyz::begins_with(line) {
        return Ok(InputFormat::Xyz);
    }
    let unknown = |found, advice| Err(ReadError::Unknown { found, advice });
    if line.starts_with(b"<") {
        return unknown("an XML or HTML document", CHOOSE);
    }
    if line.starts_with(b"{") {
        return unknown("JSON (glTF is such)", "export glTF as one binary file, .glb");
    }
    // If only the first line is wrong, its reader's error helps more than "unknown format".
    match extension(name).as_str() {
        "obj" => Ok(InputFormat::Obj),
        "stl" => Ok(InputFormat::StlText),
        "off" => Ok(InputFormat::Off),
        "xyz" | "txt" | "csv" | "asc" | "pts" => Ok(InputFormat::Xyz),
        _ if line.is_empty() => unknown("a text file without content", CHOOSE),
        _ => unknown("a text file of no known kind", CHOOSE),
    }
}
