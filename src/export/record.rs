//! The record of a file, from which it can be made again: one line of JSON, in each format at a place of its own.
//!
//! PLY, OBJ and CSV carry it in a comment, 3MF in its description, GLB in the extras of its asset. What it says is the caller's
//! affair; here it is text.

/// The word before a record.
const MARK: &str = "marching_particles";

/// A record as the formats carry it: its mark and the JSON, without the characters that end a comment or begin a tag.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordText(Option<String>);

impl RecordText {
    /// The record that is an object of JSON.
    #[must_use]
    pub fn new(json: &str) -> Self {
        let mut text = String::with_capacity(json.len());
        for unit in json.encode_utf16() {
            match u8::try_from(unit) {
                // Outside of strings these stand nowhere but between values.
                Ok(b'\n' | b'\r' | b'\t') => {}
                Ok(byte @ (b' '..=b'~')) if !matches!(byte, b'<' | b'>' | b'&') => text.push(byte.into()),
                _ => text += &format!("\\u{unit:04x}"),
            }
        }
        Self(Some(text))
    }

    /// The record as a comment, after the words that begin one; nothing without a record.
    pub(super) fn comment(&self, begin: &str) -> String {
        self.0.as_ref().map_or(String::new(), |json| format!("{begin} {MARK} {json}\n"))
    }

    /// The record as text between tags.
    pub(super) fn words(&self) -> Option<String> {
        self.0.as_ref().map(|json| format!("{MARK} {json}"))
    }

    /// The record as a member of an object of JSON, with a comma before it; nothing without a record.
    pub(super) fn member(&self) -> String {
        self.0.as_ref().map_or(String::new(), |json| format!(r#","extras":{{"{MARK}":{json}}}"#))
    }

    /// The JSON of the record in a file; none if there is no record in it.
    #[must_use]
    pub fn find(file: &[u8]) -> Option<&str> {
        let at = file.windows(MARK.len()).position(|window| window == MARK.as_bytes())?;
        let rest = &file[at + MARK.len()..];
        let begin = rest.iter().position(|&byte| byte == b'{')?;
        // Between the mark and the object there are a quote, a colon and a space at most.
        let object = &rest[begin..];
        (begin <= 3).then(|| core::str::from_utf8(&object[..length(object)?]).ok()).flatten()
    }
}

/// Number of bytes of the object of JSON with which a text begins.
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
        for file in
            [record.comment("#"), format!("<m>{}</m>", record.words().expect("a record")), record.member()]
        {
            assert!(file.trim_end().bytes().all(|byte| (b' '..=b'~').contains(&byte)), "{file}");
            let file = format!("first\n{file} and }} more");
            let found: serde_json::Value =
                serde_json::from_str(RecordText::find(file.as_bytes()).expect("a record")).expect("JSON");
            assert_eq!(found, serde_json::from_str::<serde_json::Value>(json).expect("JSON"));
        }
        assert_eq!(RecordText::find(b"ply\ncomment marching_particles"), None);
        assert_eq!(RecordText::find(b"marching_particles {\"open\": 1"), None);
        assert_eq!(RecordText::default().comment("#") + &RecordText::default().member(), "");
    }
}
