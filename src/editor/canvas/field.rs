//! The field in which the name of a node or of a group's port, or a frame's title, is written anew, over the old one.

use egui::{Id, Key, Rect, TextEdit, UiBuilder, vec2};

use super::Canvas;
use super::desk::Desk;
use super::scene::{HEADER, Port, ROW};
use crate::graph::{Document, Side};

/// An open field.
#[derive(Debug)]
pub struct NameField {
    of: Named,
    text: String,
    is_new: bool,
}

/// What is named.
#[derive(Debug, Clone)]
enum Named {
    Node(String),
    /// By its place among the document's.
    Frame(usize),
    /// A port of the opened group, or of a group that is seen.
    Port(Port),
}

impl Canvas {
    pub(super) fn open_name_field(&mut self, name: &str) {
        self.name_field =
            Some(NameField { of: Named::Node(name.to_owned()), text: name.to_owned(), is_new: true });
    }

    pub(super) fn open_title_field(&mut self, idx: usize, title: &str) {
        self.name_field = Some(NameField { of: Named::Frame(idx), text: title.to_owned(), is_new: true });
    }

    pub(super) fn open_port_field(&mut self, port: &Port, name: &str) {
        self.name_field =
            Some(NameField { of: Named::Port(port.clone()), text: name.to_owned(), is_new: true });
    }

    pub(super) fn show_name_field(&mut self, ui: &mut egui::Ui, desk: &mut Desk) {
        let Some(mut field) = self.name_field.take() else { return };
        let rect = match &field.of {
            Named::Node(name) => self.scene.node(name).map(|node| node.rect),
            Named::Frame(idx) => self.frame_rect(desk, *idx),
            Named::Port(port) => self.scene.port(port).map(|shape| {
                let size = vec2(super::scene::WIDTH * 0.6, ROW);
                let left = if port.side == Side::Input { 0.0 } else { size.x };
                Rect::from_min_size(shape.at - vec2(left, ROW / 2.0), size)
            }),
        };
        let Some(rect) = rect.map(|rect| self.view.rect_to_screen(rect)) else { return };
        let size = vec2(rect.width().max(140.0), (HEADER * self.view.zoom).max(22.0));
        let rect = Rect::from_min_size(rect.min, size);
        let id = Id::new("canvas name");
        let edit = TextEdit::singleline(&mut field.text).id(id).desired_width(f32::INFINITY);
        let response = ui.scope_builder(UiBuilder::new().max_rect(rect), |ui| ui.add_sized(size, edit)).inner;
        if field.is_new {
            field.is_new = false;
            response.request_focus();
            let cursor = egui::text::CCursor::new;
            let all = egui::text::CCursorRange::two(cursor(0), cursor(field.text.chars().count()));
            let mut state = egui::text_edit::TextEditState::load(ui.ctx(), id).unwrap_or_default();
            state.cursor.set_char_range(Some(all));
            state.store(ui.ctx(), id);
        } else if response.lost_focus() {
            if !ui.input(|input| input.key_pressed(Key::Escape)) {
                self.take_name(ui, &field.of, field.text.trim(), desk);
            }
            return;
        }
        self.name_field = Some(field);
    }

    fn take_name(&mut self, ui: &egui::Ui, of: &Named, new: &str, desk: &mut Desk) {
        let old = match of {
            Named::Node(name) => name,
            Named::Port(port) => {
                let (node, side, old) = match port.of_opened() {
                    Some((side, name)) => ("", side, name),
                    None => (port.end.node.as_str(), port.side, port.end.port.as_str()),
                };
                let group = desk.group_path(node);
                let mut done = Ok(());
                let change = |graph: &mut Document| done = graph.rename_port(&group, side, old, new);
                desk.edit_graph(&format!("Rename {old}"), change);
                return done.unwrap_or_else(|reason| self.tell(ui, reason));
            }
            Named::Frame(idx) => {
                return desk.edit("Name a frame", |document| {
                    if let Some(frame) = document.frames.get_mut(*idx) {
                        new.clone_into(&mut frame.title);
                    }
                });
            }
        };
        let mut done = Ok(());
        desk.edit(&format!("Rename {old}"), |document| done = document.rename(old, new));
        match done {
            Err(reason) => self.tell(ui, reason),
            Ok(()) => {
                let nodes = std::mem::take(&mut desk.selection.nodes);
                let follow = |name: String| if name == *old { new.to_owned() } else { name };
                desk.selection.nodes = nodes.into_iter().map(follow).collect();
            }
        }
    }
}
