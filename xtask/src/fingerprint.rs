//! Content hashes that tell whether a step's inputs have changed. File times are not used: a
//! checkout or a copy changes them without changing the content.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use sha2::{Digest, Sha256};

/// A hash being built from named parts.
#[derive(Default)]
pub(crate) struct Fingerprint(Sha256);

impl Fingerprint {
    /// Adds a text under a name.
    pub(crate) fn text(mut self, name: &str, text: &str) -> Self {
        self.part(name, text.as_bytes());
        self
    }

    /// Adds a file's content; a missing file differs from an empty one.
    pub(crate) fn file(mut self, path: &Path) -> Result<Self> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_file() {
            let content = fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
            self.part(&name, &content);
        } else {
            self.part("absent", name.as_bytes());
        }
        Ok(self)
    }

    /// Adds every file under a folder, ordered by path.
    pub(crate) fn tree(mut self, folder: &Path) -> Result<Self> {
        for path in files_under(folder)? {
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            let content = fs::read(&path).with_context(|| format!("could not read {}", path.display()))?;
            self.part(&name, &content);
        }
        Ok(self)
    }

    /// The hash, as hexadecimal digits.
    pub(crate) fn finish(self) -> String {
        hex(&self.0.finalize())
    }

    fn part(&mut self, name: &str, content: &[u8]) {
        // With the lengths first, different lists of parts never give the same bytes.
        self.0.update((name.len() as u64).to_le_bytes());
        self.0.update(name.as_bytes());
        self.0.update((content.len() as u64).to_le_bytes());
        self.0.update(content);
    }
}

/// The SHA-256 of one file, as hexadecimal digits.
pub(crate) fn sha256_of(path: &Path) -> Result<String> {
    let content = fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
    Ok(hex(&Sha256::digest(content)))
}

/// Every file under `folder`, sorted; nothing if there is no such folder.
pub(crate) fn files_under(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(folder) = open.pop() {
        if !folder.is_dir() {
            continue;
        }
        for entry in fs::read_dir(&folder).with_context(|| format!("could not list {}", folder.display()))? {
            let path = entry?.path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::Fingerprint;

    #[test]
    fn parts_are_told_apart() {
        let one = Fingerprint::default().text("a", "bc").finish();
        let other = Fingerprint::default().text("ab", "c").finish();
        assert_ne!(one, other);
        assert_eq!(one, Fingerprint::default().text("a", "bc").finish());
    }
}
