//! Paths: typed, or picked in a dialog; written relative to the graph's folder.

use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex};

use egui::Ui;
use egui_file_dialog::{DialogState, FileDialog};

use super::number::{entry_shown, has_room, named};
use super::slot::Slot;
use crate::editor::dialog;
use crate::graph::ParamKind;
use crate::graph::spec::Default;

/// The dialog, and whose path it picks.
struct Picker {
    dialog: FileDialog,
    wanted_by: String,
    picked: Option<PathBuf>,
}

type Shared = Arc<Mutex<Picker>>;

fn picker(ui: &Ui) -> Option<Shared> {
    ui.data(|data| data.get_temp(egui::Id::new("path picker")))
}

/// A field and a button that opens the dialog.
pub fn show(ui: &mut Ui, slot: &mut Slot, width: f32) -> Option<String> {
    let current = slot.json().as_str().unwrap_or_default().to_owned();
    let (id, name) = (slot.id().with("path"), slot.name());
    let is_nullable = slot.spec.default == Default::Null;
    let width = width - 30.0;
    let shown = end_of(&current, |text| has_room(ui, text, width));
    let typed = entry_shown(ui, id, &name, &current, Some(&shown), width, |text| {
        match text.is_empty() && is_nullable {
            true => slot.set(serde_json::Value::Null, None),
            false => slot.set(text.into(), None),
        }
    });
    let response = ui.button("…").on_hover_text("Choose a file");
    named(&response, &format!("{name} pick"));
    if response.clicked() {
        open(ui, slot, &current);
    }
    typed.or_else(|| take_picked(ui, slot))
}

/// As much of the end of a path as fits: the file's name is what one looks for.
fn end_of(path: &str, fits: impl Fn(&str) -> bool) -> String {
    if fits(path) {
        return path.to_owned();
    }
    let ends = path.char_indices().skip(1).map(|(at, _)| format!("…{}", &path[at..]));
    let mut ends = ends.skip_while(|end| !fits(end));
    ends.next().unwrap_or_else(|| path.to_owned())
}

fn open(ui: &Ui, slot: &Slot, current: &str) {
    let full = slot.document().base.join(current);
    let folder = full.parent().and_then(|folder| std::path::absolute(folder).ok());
    let (title, folder, endings) = (format!("Choose {}", slot.name()), folder.as_deref(), slot.spec.endings);
    let dialog = match slot.spec.kind {
        ParamKind::OutPath => {
            let name = full.file_name().unwrap_or_default().to_string_lossy();
            dialog::to_save(&title, folder, &name, endings)
        }
        _ => dialog::to_open(&title, folder, endings),
    };
    let picker = Picker { dialog, wanted_by: slot.name(), picked: None };
    ui.data_mut(|data| data.insert_temp(egui::Id::new("path picker"), Arc::new(Mutex::new(picker))));
}

fn take_picked(ui: &Ui, slot: &mut Slot) -> Option<String> {
    let shared = picker(ui)?;
    let mut picker = shared.lock().ok()?;
    if picker.wanted_by != slot.name() {
        return None;
    }
    let path = picker.picked.take()?;
    let text = relative(&slot.document().base, &path);
    match text.to_str() {
        Some(text) => slot.set(text.into(), None).err(),
        None => Some(format!("{} is not UTF-8; choose another path", path.display())),
    }
}

/// Draws the dialog while it is open.
pub fn dialog(ui: &mut Ui) {
    let Some(shared) = picker(ui) else { return };
    let Ok(mut picker) = shared.lock() else { return };
    if matches!(picker.dialog.state(), DialogState::Open)
        && ui.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape))
    {
        ui.data_mut(|data| data.remove::<Shared>(egui::Id::new("path picker")));
        return;
    }
    dialog::update(&mut picker.dialog, ui);
    if let Some(path) = picker.dialog.take_picked() {
        picker.picked = Some(path);
        ui.ctx().request_repaint();
    }
}

/// The way from a folder to a file, with `..` where needed; the path itself where there is none.
fn relative(base: &Path, path: &Path) -> PathBuf {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    // `absolute` leaves `..` as it is, because of links; a graph's folder is named without where it matters.
    let (base, path) =
        (absolute(if base.as_os_str().is_empty() { Path::new(".") } else { base }), absolute(path));
    let from: Vec<Component> = base.components().filter(|part| *part != Component::CurDir).collect();
    let to: Vec<Component> = path.components().filter(|part| *part != Component::CurDir).collect();
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    // Another drive, or nothing in common but the root: an absolute path says it better.
    if shared <= 1 || from[shared..].contains(&Component::ParentDir) {
        return path;
    }
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    up.chain(to[shared..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_path_is_shown() {
        let shown = |path: &str, most: usize| end_of(path, |text| text.chars().count() <= most);
        assert_eq!(shown("a/plume.vdb", 11), "a/plume.vdb");
        assert_eq!(shown("/data/plüme.vdb", 10), "…plüme.vdb");
        assert_eq!(shown("/data/plume.vdb", 0), "/data/plume.vdb");
    }

    #[test]
    fn paths_start_at_the_graph() {
        let way = |base: &str, path: &str| relative(Path::new(base), Path::new(path)).display().to_string();
        assert_eq!(way("/a/graphs", "/a/graphs/b.vdb"), "b.vdb");
        assert_eq!(way("/a/graphs", "/a/data/b.vdb"), "../data/b.vdb");
        assert_eq!(way("/a/graphs", "/other/b.vdb"), "/other/b.vdb");
        assert_eq!(way("", &std::path::absolute("c.vdb").unwrap().display().to_string()), "c.vdb");
    }
}
