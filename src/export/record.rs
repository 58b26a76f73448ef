//! The record of a file, from which the file can be made again: JSON, embedded differently in each
//! format.
//!
//! PLY and OBJ carry it in comments, 3MF in its description, GLB in the extras of its asset; for
//! other formats it is a separate JSON file. Its contents are up to the caller; here it is text.

/// The word that precedes a record.
const MARK: &str = "marching_particles";

/// The longest comment line, in characters. MeshLab reads no PLY header line of more than 512.
const LONGEST_LINE: usize = 200;

/// A record as the formats carry it: a JSON object without the characters that end a comment or
/// begin a tag.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordText(Option<String>);

impl RecordText {
    /// The record that is an object of JSON.
    #[must_use]
    pub fn new(json: &str) -> Self {
        let mut text = String::with_capacity(json.len());
        for unit in json.encode_utf16() {
            match u8::try_from(unit) {
                // Outside strings these occur only between values.
                Ok(b'\n' | b'\r' | b'\t') => {}
                Ok(byte @ (b' '..=b'~')) if !matches!(byte, b'<' | b'>' | b'&') => text.push(byte.into()),
                _ => text += &format!("\\u{unit:04x}"),
            }
        }
        Self(Some(text))
    }

    /// The record as comments, each begun by `begin`; empty without a record. A text longer than
    /// [`LONGEST_LINE`] continues after the mark of the next line.
    pub(super) fn comment(&self, begin: &str) -> String {
        let mut rest = self.0.as_deref().unwrap_or_default();
        let mut lines = String::new();
        while !rest.is_empty() {
            let most = (LONGEST_LINE - begin.len() - MARK.len() - 2).min(rest.len());
            // Programs that rewrite comments may drop spaces at the ends of lines.
            let is_safe = |&at: &usize| {
                let ends = [rest.as_bytes()[at - 1], rest.as_bytes().get(at).copied().unwrap_or(b'}')];
                !ends.contains(&b' ')
            };
            let at = (1..=most).rev().find(is_safe).unwrap_or(most);
            let (line, after) = rest.split_at(at);
            lines += &format!("{begin} {MARK} {line}\n");
            rest = after;
        }
        lines
    }

    /// The record as the content of a separate JSON file; none without a record.
    #[must_use]
    pub fn document(&self) -> Option<String> {
        self.0.as_ref().map(|json| format!("{{\"{MARK}\":{json}}}\n"))
    }

    /// The record as text between tags.
    pub(super) fn words(&self) -> Option<String> {
        self.0.as_ref().map(|json| format!("{MARK} {json}"))
    }

    /// The record as a member of a JSON object, after a comma; empty without a record.
    pub(super) fn member(&self) -> String {
        self.0.as_ref().map_or(String::new(), |json| format!(r#","extras":{{"{MARK}":{json}}}"#))
    }

    /// The JSON of the record in a file, if it has one.
    #[must_use]
    pub fn find(file: &[u8]) -> Option<String> {
        let at = file.windows(MARK.len()).position(|window| window == MARK.as_bytes())?;
        let from = file[..at].iter().rposition(|&byte| is_line_end(byte)).map_or(0, |end| end + 1);
        let prefix = [&file[from..at], MARK.as_bytes(), b" "].concat();
        let rest = &file[at + MARK.len()..];
        // Between the mark and the object there are at most a quote, a colon and a space.
        let begin = rest.iter().position(|&byte| byte == b'{').filter(|&begin| begin <= 3)?;
        let (mut text, mut rest) = line(&rest[begin..]);
        let mut whole = text.to_vec();
        while let Some(more) = rest.strip_prefix(&prefix[..]) {
            (text, rest) = line(more);
            whole.extend_from_slice(text);
        }
        whole.truncate(length(&whole)?);
        String::from_utf8(whole).ok()
    }
}

fn is_line_end(byte: u8) -> bool {
    matches!(byte, b'\n' | b'\r')
}

/// A line without its end, and what follows it.
fn line(text: &[u8]) -> (&[u8], &[u8]) {
    let end = text.iter().position(|&byte| is_line_end(byte)).unwrap_or(text.len());
    let (line, rest) = text.split_at(end);
    let rest = rest.strip_prefix(b"\r\n").or_else(|| rest.get(1..)).unwrap_or_default();
    (line, rest)
}

/// Length in bytes of the JSON object at the start of a text.
fn length(text: &[u8]) -> Option<usize> {
    let (mut depth, mut is_string, mut is_escaped) = (0_u32, false, false);
    for (k, &byte) in text.iter().enumerate() {
        match byte {
            _ if is_escaped => is_escaped = false,
            b'\\' => is_escaped = is_string,
            b'"' => is_string = !is_string,
            b'{' if !is_string => depth += 1,
            b'}' if !is_string => {
                depth -= 1;
                if depth == 0 {
                    return Some(k + 1);
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_is_found_in_what_carries_it() {
        let json = r#"{"formula":"|x| < π \" } &","settings":{"seed":1}}"#;
        let record = RecordText::new(json);
        let document = record.document().expect("a record");
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&document).expect("JSON")[MARK]["settings"]["seed"],
            1
        );
        for file in [
            record.comment("#"),
            format!("<m>{}</m>", record.words().expect("a record")),
            record.member(),
            document,
        ] {
            assert!(file.trim_end().bytes().all(|byte| (b' '..=b'~').contains(&byte)), "{file}");
            assert_found(&format!("first\n{file} and }} more"), json);
        }
        assert_eq!(RecordText::find(b"ply\ncomment marching_particles"), None);
        assert_eq!(RecordText::find(b"marching_particles {\"open\": 1"), None);
        let none = RecordText::default();
        assert_eq!(none.comment("#") + &none.member(), "");
        assert_eq!(none.document(), None);
    }

    #[track_caller]
    fn assert_found(file: &str, json: &str) {
        let found = RecordText::find(file.as_bytes()).unwrap_or_else(|| panic!("no record in {file}"));
        let [found, json] =
            [&found, json].map(|text| serde_json::from_str::<serde_json::Value>(text).expect("JSON"));
        assert_eq!(found, json);
    }

    #[test]
    fn a_long_record_is_many_short_lines_and_one_text_again() {
        // A line of spaces alone has no better place to be cut.
        for filling in ["ab c", " ", "x", "π", "\\\\", "} {"] {
            for length in [0, 1, 170, 171, 172, 173, 174, 175, 600, 5000] {
                let json = format!(r#"{{"formula":"{}","seed":1}}"#, filling.repeat(length));
                let text = RecordText::new(&json).comment("comment");
                assert!(text.lines().all(|line| line.len() <= LONGEST_LINE), "{text}");
                assert!(text.lines().all(|line| line.starts_with("comment marching_particles ")), "{text}");
                for end in ["\n", "\r\n"] {
                    let file = format!("ply\nformat ascii 1.0\n{text}element vertex 0\nend_header\n");
                    assert_found(&file.replace('\n', end), &json);
                }
                // The comments of another file, and an old record of one line.
                assert_found(&format!("{text}# marching_particles 2\n"), &json);
                assert_found(&format!("# marching_particles {json}\nx,y,z\n"), &json);
            }
        }
        let words =
            RecordText::new(&format!(r#"{{"formula":"{}"}}"#, "ab cde ".repeat(200))).comment("comment");
        assert!(words.lines().all(|line| line.trim_end() == line), "{words}");
    }
}
