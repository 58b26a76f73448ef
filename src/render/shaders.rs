//! Sources of the shaders.

/// A shader: the shared text, and the text of its own file.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// File name in `shaders/`.
    pub name: &'static str,
    /// The common text and that of the file.
    pub source: &'static str,
    /// The text without comments and indentation, for the device and the bundle.
    pub lean: &'static str,
}

macro_rules! shader {
    ($name:literal) => {{
        const SOURCE: &str = concat!(
            include_str!("../../shaders/common.wgsl"),
            include_str!(concat!("../../shaders/", $name))
        );
        const LEAN: [u8; strip(SOURCE, &mut [])] = {
            let mut bytes = [0; strip(SOURCE, &mut [])];
            strip(SOURCE, &mut bytes);
            bytes
        };
        const TEXT: &str = match core::str::from_utf8(&LEAN) {
            Ok(text) => text,
            Err(_) => panic!("stripping cuts at ASCII characters only"),
        };
        Shader { name: $name, source: SOURCE, lean: TEXT }
    }};
}
/// File in `shaders/` whose text begins every shader.
pub const COMMON: &str = "common.wgsl";

/// All shaders. A test compares them with the files in `shaders/`.
pub const SHADERS: [Shader; 4] = [DISCS, FACES, LINES, OCCLUSION];

/// Draws particles as discs or as spheres, and a ring around one of them.
pub const DISCS: Shader = shader!("discs.wgsl");
/// Draws the triangles of a mesh.
pub const FACES: Shader = shader!("faces.wgsl");
/// Draws the edges of the clip box, and the creases of a surface.
pub const LINES: Shader = shader!("lines.wgsl");
/// Computes how open a surface is to light from all around.
pub const OCCLUSION: Shader = shader!("occlusion.wgsl");

/// Copies `source` to `out` without `//` comments, indentation and empty lines, as far as it fits.
/// Returns the full length.
const fn strip(source: &str, out: &mut [u8]) -> usize {
    let bytes = source.as_bytes();
    let mut length = 0;
    let mut line_is_empty = true;
    let mut i = 0;
    while i < bytes.len() {
        if bytes[i] == b'/' && i + 1 < bytes.len() && bytes[i + 1] == b'/' {
            while i < bytes.len() && bytes[i] != b'\n' {
                i += 1;
            }
            continue;
        }
        let is_space = bytes[i] == b' ' || bytes[i] == b'\n';
        if !(line_is_empty && is_space) {
            if length < out.len() {
                out[length] = bytes[i];
            }
            length += 1;
        }
        line_is_empty = bytes[i] == b'\n' || line_is_empty && is_space;
        i += 1;
    }
    length
}

#[cfg(test)]
mod tests {
    use super::strip;

    #[test]
    fn stripping_keeps_the_code() {
        let source = "// a\n\nfn f() {\n    let a = 1 / 2; // half\n    // gone\n    b\n}\n";
        let lean = "fn f() {\nlet a = 1 / 2; \nb\n}\n";
        let mut out = vec![0; strip(source, &mut [])];
        strip(source, &mut out);
        assert_eq!(String::from_utf8(out).expect("UTF-8"), lean);
    }
}
