//! What a graph's file held at its last saves, kept in the program's own folder.
//!
//! `versions/<hash of the file's path>/000007.json`: the text of the file, ten of them at most, the oldest
//! goes. Equal texts one after the other are one version. Their relative paths start at the graph's folder.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::image::atomic::{self, WriteError};

/// So many are kept.
pub const MOST: usize = 10;

/// One of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Version {
    /// Counts up.
    pub number: u64,
    /// When the file was written that held it.
    pub time: SystemTime,
    /// Its text.
    pub path: PathBuf,
}

/// The versions of a graph's file, newest first; none where the folder cannot be read.
pub fn list(state: &Path, file: &Path) -> Vec<Version> {
    let entries = std::fs::read_dir(folder(state, file)).into_iter().flatten().flatten();
    let version = |entry: std::fs::DirEntry| {
        let path = entry.path();
        let number = path.file_stem()?.to_str()?.parse().ok()?;
        let time = entry.metadata().ok()?.modified().ok()?;
        Some(Version { number, time, path })
    };
    let mut versions: Vec<Version> = entries.filter_map(version).collect();
    versions.sort_by_key(|version| std::cmp::Reverse(version.number));
    versions
}

/// Keeps a text of a graph's file, written then, as its newest version.
///
/// # Errors
/// Where it cannot be written; the others are then as they were.
pub(super) fn keep(state: &Path, file: &Path, text: &str, then: SystemTime) -> Result<(), WriteError> {
    let known = list(state, file);
    let newest = known.first();
    if newest.is_some_and(|newest| std::fs::read_to_string(&newest.path).is_ok_and(|kept| kept == text)) {
        return Ok(());
    }
    let number = newest.map_or(1, |newest| newest.number + 1);
    let path = folder(state, file).join(format!("{number:06}.json"));
    atomic::write(&path, text.as_bytes())?;
    // Without it the version seems newer, no more.
    let _ = std::fs::File::options().write(true).open(&path).and_then(|file| file.set_modified(then));
    for old in known.iter().skip(MOST - 1) {
        // One more than there should be does no harm.
        let _ = std::fs::remove_file(&old.path);
    }
    Ok(())
}

fn folder(state: &Path, file: &Path) -> PathBuf {
    // By one name whichever way it was opened.
    let full = std::fs::canonicalize(file).or_else(|_| std::path::absolute(file));
    let full = full.unwrap_or_else(|_| file.to_owned());
    let hash = blake3::hash(full.as_os_str().as_encoded_bytes()).to_hex();
    state.join("versions").join(&hash[..16])
}
