//! Writes a file whole or not at all.
//!
//! The bytes go to a temporary file in the target's folder, are synced to the disk, and the
//! temporary file is renamed over the target, which POSIX and Windows do in one step. So a
//! reader, a resumed render or a crash never meets half a file, and a full disk leaves what
//! was there before. The folder is created when it is missing.
//!
//! A symbolic link is followed: its target is replaced, the link stays. What is no regular
//! file (`/dev/null`, a pipe) is written through, since a rename would replace the device.
//!
//! Limits: the folder entry itself is not synced, so that a power cut may bring back the old
//! file, whole. Tested on missing folders, files in the way, full devices and left-overs.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The folder is missing and could not be made.
    #[error("cannot create folder {folder}: {source}; choose a folder that can be written")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The target is a folder.
    #[error("cannot write {path}: it is a folder; add a file name")]
    IsFolder {
        /// The target.
        path: PathBuf,
    },
    /// The file could not be made, filled, synced or renamed.
    #[error(
        "cannot write {path}: {source}; nothing was changed, free space or choose a folder that can be written"
    )]
    File {
        /// The target.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Writes `bytes` to `path`, replacing what was there; creates the folder when missing.
///
/// # Errors
/// If the folder cannot be made or written, the disk is full, or `path` is a folder. The file
/// that was there before is then unchanged, and no temporary file is left.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let failed = |source| WriteError::File { path: path.to_owned(), source };
    match fs::metadata(&target) {
        Ok(meta) if meta.is_dir() => {
            return Err(WriteError::IsFolder { path: path.to_owned() });
        }
        Ok(meta) if !meta.is_file() => {
            let device = fs::OpenOptions::new().write(true).open(&target);
            return device.and_then(|mut file| file.write_all(bytes)).map_err(failed);
        }
        _ => {}
    }
    let folder = folder_of(&target);
    fs::create_dir_all(folder).map_err(|source| WriteError::Folder { folder: folder.to_owned(), source })?;
    replace(folder, &target, bytes).map_err(failed)
}

/// Whether [`write()`] could write to `path`, as far as one can tell before: nothing is changed. To be
/// asked before an hour of work.
///
/// # Errors
/// As [`write()`], except for what only the bytes themselves show (a full disk).
pub fn check(path: &Path) -> Result<(), WriteError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match fs::metadata(&target) {
        Ok(meta) if meta.is_dir() => return Err(WriteError::IsFolder { path: path.to_owned() }),
        Ok(meta) if !meta.is_file() => return Ok(()),
        _ => {}
    }
    let folder = folder_of(&target);
    // Folders that are missing will be made in the first one that is there.
    let there = folder.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    let there = if there.as_os_str().is_empty() { Path::new(".") } else { there };
    match temporary(there) {
        Ok(_) => Ok(()),
        Err(source) if there == folder && folder.is_dir() => {
            Err(WriteError::File { path: path.to_owned(), source })
        }
        Err(source) => Err(WriteError::Folder { folder: folder.to_owned(), source }),
    }
}

fn folder_of(target: &Path) -> &Path {
    match target.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// An empty file beside the target that vanishes unless it is kept. It is as open as any other new file (the
/// umask applies), where a temporary file is private by default.
fn temporary(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let open = |path: &Path| fs::OpenOptions::new().write(true).create_new(true).open(path);
    tempfile::Builder::new().prefix(".tyndall-").suffix(".part").make_in(folder, open)
}

fn replace(folder: &Path, target: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = temporary(folder)?;
    if let Ok(meta) = fs::metadata(target) {
        file.as_file().set_permissions(meta.permissions())?;
    }
    // The inner file: errors of the outer one name the temporary path.
    file.as_file_mut().write_all(bytes)?;
    file.as_file().sync_all()?;
    file.persist(target).map_err(|e| e.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn creates_folders_and_replaces_files() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a/b/out.bin");
        write(&path, b"first, and longer").unwrap();
        write(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(path.parent().unwrap()), ["out.bin"]);
    }

    #[test]
    fn a_file_where_a_folder_should_be_is_one_clear_error() {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("file");
        fs::write(&file, b"kept").unwrap();
        let error = write(&file.join("out.bin"), b"x").unwrap_err();
        assert!(matches!(error, WriteError::Folder { .. }), "{error}");
        assert!(!error.to_string().contains('\n'));
        assert_eq!(names(dir.path()), ["file"]);
        assert_eq!(fs::read(&file).unwrap(), b"kept");
    }

    #[test]
    fn a_folder_where_the_file_should_be_is_refused() {
        let dir = tempfile::tempdir().unwrap();
        let error = write(dir.path(), b"x").unwrap_err();
        assert!(matches!(error, WriteError::IsFolder { .. }), "{error}");
        assert!(names(dir.path()).is_empty());
    }

    #[test]
    fn what_cannot_be_written_is_known_before() {
        let dir = tempfile::tempdir().unwrap();
        check(&dir.path().join("a/b/out.bin")).unwrap();
        check(Path::new("out-that-is-not-there.bin")).unwrap();
        assert!(names(dir.path()).is_empty());
        assert!(matches!(check(dir.path()), Err(WriteError::IsFolder { .. })));
        let file = dir.path().join("file");
        fs::write(&file, b"kept").unwrap();
        check(&file).unwrap();
        assert!(matches!(check(&file.join("a/out.bin")), Err(WriteError::Folder { .. })));
        assert_eq!(fs::read(&file).unwrap(), b"kept");
        assert_eq!(names(dir.path()), ["file"]);
        #[cfg(target_os = "linux")]
        {
            let error = check(Path::new("/proc/out.bin")).unwrap_err().to_string();
            assert!(error.starts_with("cannot write /proc/out.bin: "), "{error}");
            assert!(!error.contains(".tyndall-"), "{error}");
            check(Path::new("/dev/null")).unwrap();
        }
    }

    // A name that is longer than any file system allows fails after the temporary file was
    // made and filled: the rename is the step that fails, and nothing may stay.
    #[test]
    fn a_failed_rename_leaves_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let error = write(&dir.path().join("n".repeat(300)), b"x").unwrap_err();
        assert!(matches!(error, WriteError::File { .. }), "{error}");
        assert!(names(dir.path()).is_empty());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn full_and_read_only_places_are_errors() {
        // Not even root can make a file in /proc.
        let error = write(Path::new("/proc/out.bin"), b"x").unwrap_err();
        assert!(error.to_string().starts_with("cannot write /proc/out.bin"));
        let error = write(Path::new("/dev/full"), b"x").unwrap_err();
        let WriteError::File { source, .. } = error else {
            panic!("{error}");
        };
        assert_eq!(source.kind(), io::ErrorKind::StorageFull);
        write(Path::new("/dev/null"), b"x").unwrap();
        use std::os::unix::fs::FileTypeExt;
        for device in ["/dev/full", "/dev/null"] {
            assert!(fs::metadata(device).unwrap().file_type().is_char_device());
        }
    }

    #[cfg(unix)]
    #[test]
    fn permissions_and_links_are_kept() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let (file, link) = (dir.path().join("file"), dir.path().join("link"));
        write(&file, b"one").unwrap();
        // What the umask makes of a file that any program creates.
        fs::write(dir.path().join("plain"), b"").unwrap();
        let mode = |p: &Path| fs::metadata(p).unwrap().permissions().mode() & 0o777;
        assert_eq!(mode(&file), mode(&dir.path().join("plain")));
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, b"two").unwrap();
        assert_eq!(mode(&file), 0o640);
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"two");
    }
}
