//! What a file was like: path, size and time of its last change.
//!
//! Enough to tell whether a file has been changed since, without reading it. A writer that keeps size and
//! time is not noticed. Tested by a file that is changed and removed.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// A file at one moment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileState {
    path: PathBuf,
    /// Size in bytes and time of the last change; `None` where there is no such file.
    found: Option<(u64, Option<SystemTime>)>,
}

impl FileState {
    /// The file as it is now.
    pub fn of(path: &Path) -> Self {
        let found = std::fs::metadata(path).ok().map(|found| (found.len(), found.modified().ok()));
        Self { path: path.to_owned(), found }
    }

    /// Whether nothing has changed since; a file that was not there is not there now.
    pub fn is_current(&self) -> bool {
        Self::of(&self.path) == *self
    }

    /// Whether the file is there and still the same.
    pub fn holds(&self) -> bool {
        self.found.is_some() && self.is_current()
    }

    /// For keys: equal only for equal states.
    pub fn to_bytes(&self) -> Vec<u8> {
        let path = self.path.as_os_str().as_encoded_bytes();
        let mut bytes = (path.len() as u64).to_le_bytes().to_vec();
        bytes.extend_from_slice(path);
        if let Some((len, modified)) = self.found {
            let since = modified.and_then(|time| time.duration_since(UNIX_EPOCH).ok());
            bytes.extend_from_slice(&len.to_le_bytes());
            bytes.extend_from_slice(&since.map_or(0, |time| time.as_nanos()).to_le_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn changes_are_seen() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let missing = FileState::of(&path);
        assert!(!missing.holds() && missing.is_current());
        std::fs::write(&path, "abc").unwrap();
        let written = FileState::of(&path);
        assert!(written.holds() && written.is_current() && !missing.is_current());
        std::fs::write(&path, "abcd").unwrap();
        let longer = FileState::of(&path);
        assert!(!written.holds() && longer.holds());
        let later = SystemTime::now() + Duration::from_secs(5);
        std::fs::File::options().write(true).open(&path).unwrap().set_modified(later).unwrap();
        let touched = FileState::of(&path);
        assert!(!longer.holds() && touched.holds());
        let states = [missing, written, longer, touched.clone()].map(|state| state.to_bytes());
        for (i, a) in states.iter().enumerate() {
            assert!(states[..i].iter().all(|b| a != b), "{i}");
        }
        std::fs::remove_file(&path).unwrap();
        assert!(!touched.holds() && !touched.is_current());
    }
}
