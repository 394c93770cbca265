//! The field over a node's header in which its name is written anew.

use egui::{Id, Key, TextEdit, UiBuilder, vec2};

use super::scene::HEADER;
use super::{Canvas, Desk};

/// An open field.
#[derive(Debug)]
pub struct NameField {
    name: String,
    text: String,
    is_new: bool,
}

impl Canvas {
    pub(super) fn open_name_field(&mut self, name: &str) {
        self.name_field = Some(NameField { name: name.to_owned(), text: name.to_owned(), is_new: true });
    }

    pub(super) fn show_name_field(&mut self, ui: &mut egui::Ui, desk: &mut Desk) {
        let Some(mut field) = self.name_field.take() else { return };
        let Some(node) = self.scene.node(&field.name) else { return };
        let rect = self.view.rect_to_screen(node.rect);
        let size = vec2(rect.width().max(140.0), (HEADER * self.view.zoom).max(22.0));
        let rect = egui::Rect::from_min_size(rect.min, size);
        let id = Id::new("canvas name");
        let edit = TextEdit::singleline(&mut field.text).id(id).desired_width(f32::INFINITY);
        let response = ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| ui.add_sized(size, edit)).inner;
        if field.is_new {
            field.is_new = false;
            response.request_focus();
            let all = egui::text::CCursorRange::two(
                egui::text::CCursor::new(0),
                egui::text::CCursor::new(field.text.chars().count()),
            );
            let mut state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap_or_default();
            state.cursor.set_char_range(Some(all));
            state.store(ui.ctx(), id);
        } else if response.lost_focus() {
            if !ui.input(|input| input.key_pressed(Key::Escape)) {
                self.rename(ui, &field.name, field.text.trim(), desk);
            }
            return;
        }
        self.name_field = Some(field);
    }

    fn rename(&mut self, ui: &egui::Ui, old: &str, new: &str, desk: &mut Desk) {
        let mut done = Ok(());
        desk.project.edit(&format!("Rename {old}"), |document| done = document.rename(old, new));
        match done {
            Err(reason) => self.tell(ui, reason),
            Ok(()) => {
                let nodes = std::mem::take(&mut desk.selection.nodes);
                let follow = |name: String| if name == old { new.to_owned() } else { name };
                desk.selection.nodes = nodes.into_iter().map(follow).collect();
            }
        }
    }
}
