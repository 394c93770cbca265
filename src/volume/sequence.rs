//! Numbered sequences: a pattern such as `smoke_####.vdb`, a folder, or a single file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files by frame number; a single file has none.
#[derive(Debug, Clone, PartialEq)]
pub enum Sequence {
    /// Not numbered.
    Single(PathBuf),
    /// By their numbers.
    Numbered {
        /// What names them, such as `cache/smoke_####.vdb`.
        pattern: PathBuf,
        /// Never empty.
        files: BTreeMap<i64, PathBuf>,
    },
}

/// What can be wrong with a path of frames.
#[derive(Debug, thiserror::Error)]
pub enum SequenceError {
    /// Neither file nor folder.
    #[error("{0}: no such file or folder: check the path; one in a graph starts at the graph's folder")]
    Missing(PathBuf),
    /// No file fits the pattern.
    #[error("{0}: no file fits this pattern: #### stands for the frame's digits")]
    NoFit(PathBuf),
    /// A folder without volumes.
    #[error("{0}: no numbered .vdb files in this folder: name a file, or a pattern such as smoke_####.vdb")]
    Empty(PathBuf),
    /// A folder with several sequences.
    #[error("{folder}: several sequences in this folder ({names}): name one, such as {first}")]
    Several {
        /// The folder.
        folder: PathBuf,
        /// Patterns found.
        names: String,
        /// The first of them.
        first: String,
    },
    /// A frame that is not there.
    #[error("no frame {frame} in {pattern}: there are {first} to {last}{gaps}")]
    Frame {
        /// Asked for, in the sequence's own numbers.
        frame: i64,
        /// What names the frames.
        pattern: PathBuf,
        /// First number.
        first: i64,
        /// Last number.
        last: i64,
        /// Says when numbers in between are missing.
        gaps: &'static str,
    },
}

/// Which file of a sequence a frame of the scene is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Playback {
    /// Frames count from this one; if not given, from the sequence's own first number.
    pub first_frame: Option<i64>,
    /// Added to the frame.
    pub offset: i64,
    /// After its last frame the sequence begins again.
    pub loops: bool,
    /// A frame that is not there is the one before it that is, else the first.
    pub holds: bool,
}

impl Sequence {
    /// What a path means: a pattern with `#`, a folder with one numbered sequence, or a file.
    ///
    /// # Errors
    /// [`SequenceError`] says what was found.
    pub fn find(path: &Path) -> Result<Self, SequenceError> {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() {
            return Self::in_folder(path);
        }
        if !name.contains('#') {
            return if path.exists() {
                Ok(Self::Single(path.to_owned()))
            } else {
                Err(SequenceError::Missing(path.to_owned()))
            };
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let (before, rest) = name.split_once('#').unwrap_or((&name, ""));
        let after = rest.trim_start_matches('#');
        let files: BTreeMap<i64, PathBuf> = entries(folder)
            .filter_map(|(file, path)| {
                let digits = file.strip_prefix(before)?.strip_suffix(after)?;
                Some((number(digits)?, path))
            })
            .collect();
        let pattern = path.to_owned();
        if files.is_empty() {
            Err(SequenceError::NoFit(pattern))
        } else {
            Ok(Self::Numbered { pattern, files })
        }
    }

    fn in_folder(folder: &Path) -> Result<Self, SequenceError> {
        let mut found: BTreeMap<String, BTreeMap<i64, PathBuf>> = BTreeMap::new();
        for (file, path) in entries(folder) {
            let Some(stem) = file.strip_suffix(".vdb") else { continue };
            let start = stem.trim_end_matches(|c: char| c.is_ascii_digit()).len();
            if let Some(frame) = number(&stem[start..]) {
                found.entry(format!("{}####.vdb", &stem[..start])).or_default().insert(frame, path);
            }
        }
        let names = found.keys().cloned().collect::<Vec<_>>().join(", ");
        let n_found = found.len();
        match found.into_iter().next() {
            None => Err(SequenceError::Empty(folder.to_owned())),
            Some((name, files)) if n_found == 1 => Ok(Self::Numbered { pattern: folder.join(name), files }),
            Some((first, _)) => Err(SequenceError::Several {
                folder: folder.to_owned(),
                names,
                first: folder.join(first).display().to_string(),
            }),
        }
    }

    /// The file of a frame of the scene, of the first where none is given.
    ///
    /// # Errors
    /// [`SequenceError::Frame`] names the frames that there are.
    pub fn file(&self, frame: Option<i64>, playback: Playback) -> Result<PathBuf, SequenceError> {
        let Playback { first_frame, offset, loops, holds } = playback;
        let (pattern, files) = match self {
            Self::Single(path) => return Ok(path.clone()),
            Self::Numbered { pattern, files } => (pattern, files),
        };
        let (first, last) = (*files.keys().next().unwrap_or(&0), *files.keys().next_back().unwrap_or(&0));
        let start = first_frame.unwrap_or(first);
        let mut wanted =
            frame.unwrap_or(start).saturating_sub(start).saturating_add(offset).saturating_add(first);
        if loops {
            wanted = first + wanted.saturating_sub(first).rem_euclid(last - first + 1);
        }
        let nearest = || files.range(..wanted).next_back().or(files.first_key_value()).filter(|_| holds);
        files.get(&wanted).or_else(|| Some(nearest()?.1)).cloned().ok_or_else(|| SequenceError::Frame {
            frame: wanted,
            pattern: pattern.clone(),
            first,
            last,
            gaps: if files.len() as i64 == last - first + 1 { "" } else { ", some of them missing" },
        })
    }
}

fn number(digits: &str) -> Option<i64> {
    (!digits.is_empty() && digits.bytes().all(|c| c.is_ascii_digit())).then(|| digits.parse().ok()).flatten()
}

/// Files of a folder with their names; none where it cannot be read.
fn entries(folder: &Path) -> impl Iterator<Item = (String, PathBuf)> {
    std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(Result::ok)
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(names: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for name in names {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        folder
    }

    #[test]
    fn frames_are_found_by_number() {
        let folder = folder(&["a_0003.vdb", "a_0004.vdb", "a_0006.vdb", "b.vdb", "notes.txt"]);
        for path in [folder.path().join("a_####.vdb"), folder.path().to_owned()] {
            let sequence = Sequence::find(&path).unwrap();
            let play = |frame, playback| {
                let file = sequence.file(frame, playback);
                file.map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
                    .map_err(|error| error.to_string())
            };
            let name = |frame, first_frame, offset, loops| {
                play(frame, Playback { first_frame, offset, loops, holds: false })
            };
            assert_eq!(name(None, None, 0, false).unwrap(), "a_0003.vdb");
            assert_eq!(name(Some(4), None, 0, false).unwrap(), "a_0004.vdb");
            assert_eq!(name(Some(1), Some(1), 1, false).unwrap(), "a_0004.vdb");
            assert_eq!(name(Some(7), None, 0, true).unwrap(), "a_0003.vdb");
            let held = |frame, loops| {
                play(Some(frame), Playback { loops, holds: true, ..Default::default() }).unwrap()
            };
            // Before the first, there, in a gap, after the last; 9 is 5 the second time.
            assert_eq!(
                [1, 4, 5, 7].map(|frame| held(frame, false)[2..6].to_owned()),
                ["0003", "0004", "0004", "0006"]
            );
            assert_eq!(held(9, true), "a_0004.vdb");
            let pattern = folder.path().join("a_####.vdb");
            assert_eq!(
                name(Some(5), None, 0, false).unwrap_err(),
                format!("no frame 5 in {}: there are 3 to 6, some of them missing", pattern.display())
            );
            assert!(name(Some(i64::MAX), None, i64::MAX, false).is_err());
        }
        assert!(matches!(Sequence::find(&folder.path().join("b.vdb")), Ok(Sequence::Single(_))));
    }

    #[test]
    fn what_is_no_sequence_says_why() {
        let folder = folder(&["a_1.vdb", "b_1.vdb"]);
        let message = |path: &Path| Sequence::find(path).unwrap_err().to_string();
        assert!(message(folder.path()).contains("several sequences"));
        assert!(message(&folder.path().join("c.vdb")).contains("no such file"));
        assert!(message(&folder.path().join("c_##.vdb")).contains("no file fits"));
        assert!(message(tempfile::tempdir().unwrap().path()).contains("no numbered"));
    }
}
