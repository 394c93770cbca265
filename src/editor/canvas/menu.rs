//! The menus under the right button: lines of the table of actions, and what concerns one node or wire.

use super::desk::Desk;
use super::search::Purpose;
use super::{Canvas, Chosen, Command, Request};
use crate::editor::action::{ACTIONS, Action};
use crate::graph::Wire;

impl Canvas {
    pub(super) fn back_menu(&mut self, ui: &mut egui::Ui) {
        self.lines(ui, &[Command::AddNode, Command::Paste, Command::SelectAll]);
        ui.separator();
        self.lines(ui, &[Command::AddFrame, Command::Arrange, Command::FrameAll]);
        ui.separator();
        for (command, is_on) in
            [(Command::ToggleSnap, self.snaps), (Command::ToggleMinimap, !self.hides_minimap)]
        {
            let mut ticked = is_on;
            if ui.checkbox(&mut ticked, label(command)).clicked() {
                self.ask(command);
                ui.close();
            }
        }
    }

    pub(super) fn node_menu(&mut self, ui: &mut egui::Ui, name: &str, desk: &mut Desk) {
        if ui.button("Show in the viewport").clicked() {
            desk.requests.push(Request::Show(name.to_owned()));
            ui.close();
        }
        self.lines(ui, &[Command::Rename, Command::FrameSelected]);
        ui.separator();
        self.lines(ui, &[Command::Mute, Command::Bypass]);
        ui.separator();
        self.lines(ui, &[Command::Group, Command::AddFrame]);
        if desk.document().nodes.get(name).is_some_and(|node| node.inside.is_some()) {
            self.lines(ui, &[Command::OpenGroup, Command::Ungroup]);
            if ui.button("Save as a preset…").clicked() {
                desk.requests.push(Request::SavePreset(name.to_owned()));
                ui.close();
            }
        }
        ui.separator();
        self.lines(ui, &[Command::Cut, Command::Copy, Command::Duplicate, Command::Delete]);
    }

    pub(super) fn wire_menu(&mut self, ui: &mut egui::Ui, wire: &Wire) {
        if ui.button("Insert a node…").clicked() {
            self.open_search(Purpose::Insert(wire.clone()));
            ui.close();
        }
        if ui.button("Unplug").clicked() {
            self.chosen = Some(Chosen::Wire(wire.clone()));
            self.ask(Command::Delete);
            ui.close();
        }
    }

    pub(super) fn frame_menu(&mut self, ui: &mut egui::Ui, idx: usize, title: &str, desk: &mut Desk) {
        if ui.button("Rename").clicked() {
            self.open_title_field(idx, title);
            ui.close();
        }
        if ui.button("Remove the frame").clicked() {
            Self::remove_frame(desk, idx);
            ui.close();
        }
    }

    fn lines(&mut self, ui: &mut egui::Ui, commands: &[Command]) {
        for command in commands {
            let shortcut = spec(*command).and_then(|spec| spec.shortcut);
            let shortcut = shortcut.map_or(String::new(), |shortcut| ui.ctx().format_shortcut(&shortcut));
            if ui.add(egui::Button::new(label(*command)).shortcut_text(shortcut)).clicked() {
                self.ask(*command);
                ui.close();
            }
        }
    }
}

fn spec(command: Command) -> Option<&'static crate::editor::ActionSpec> {
    ACTIONS.iter().find(|spec| spec.action == Action::Canvas(command))
}

fn label(command: Command) -> &'static str {
    spec(command).map_or("", |spec| spec.label)
}
