//! The dialogs that files are chosen in, made in one way.
//!
//! What is offered to be opened is what can be read, by the endings of names, and all files in the second place: a name
//! may say something else than the file is. What is saved gets one of the endings that can be written. Tested here, and
//! in the tests of the window and of the inspector by what the dialogs offer.

use std::ffi::OsStr;
use std::path::Path;

use egui::Ui;
use egui_file_dialog::{FileDialog, Filter};

/// A dialog in the middle of the window that begins at this folder, if there is one.
fn dialog(title: &str, folder: Option<&Path>) -> FileDialog {
    let dialog = FileDialog::new().title(title).anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]);
    match folder.filter(|folder| folder.is_dir()) {
        Some(folder) => dialog.initial_directory(folder.to_owned()),
        None => dialog,
    }
}

/// Asks for a file that is there, whose name ends in one of these ways; all files where none is said.
pub fn to_open(title: &str, folder: Option<&Path>, endings: &'static [&'static str]) -> FileDialog {
    let mut dialog = dialog(title, folder);
    if !endings.is_empty() {
        let name = endings.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(", ");
        let filter = Filter::new(move |path: &Path| ending_of(path, endings).is_some());
        dialog = dialog.add_file_filter(&name, filter).default_file_filter(&name);
    }
    dialog.pick_file();
    dialog
}

/// Asks where to write, under this name at first, whose ending is one of these.
pub fn to_save(
    title: &str,
    folder: Option<&Path>,
    name: &str,
    endings: &'static [&'static str],
) -> FileDialog {
    let mut dialog = dialog(title, folder).default_file_name(name);
    for ending in endings {
        dialog = dialog.add_save_extension(&ending.to_uppercase(), ending);
    }
    if let Some(usual) = ending_of(Path::new(name), endings).or(endings.first().copied()) {
        dialog = dialog.default_save_extension(&usual.to_uppercase());
    }
    dialog.save_file();
    dialog
}

/// Draws it and takes what is done to it.
pub fn update(dialog: &mut FileDialog, ui: &Ui) {
    // Its field to search has a black ground under any theme, on which dark letters cannot be read.
    dialog.config_mut().show_search = ui.visuals().dark_mode;
    dialog.update(ui.ctx());
}

/// Which of these endings a name has, case ignored.
fn ending_of(path: &Path, endings: &'static [&'static str]) -> Option<&'static str> {
    let own = path.extension().and_then(OsStr::to_str)?;
    endings.iter().copied().find(|ending| own.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_told_in_any_case() {
        let ending = |name: &str| ending_of(Path::new(name), &["exr", "hdr"]);
        assert_eq!(
            ["a.exr", "b.c.HDR", "exr", "a.png", ".hdr"].map(ending),
            [Some("exr"), Some("hdr"), None, None, None]
        );
    }
}
