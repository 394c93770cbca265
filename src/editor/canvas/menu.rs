//! The menus under the right button: lines of the table of actions, and what concerns one node or wire.

use super::desk::Desk;
use super::scene::{Port, PortShape};
use super::search::Purpose;
use super::{Canvas, Chosen, Command, Request};
use crate::editor::action::{ACTIONS, Action};
use crate::graph::{Document, Side, Wire};
use crate::nodes::catalog;

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
        if !super::edge::is_link(wire) && ui.button("Insert a node…").clicked() {
            self.open_search(Purpose::Insert(wire.clone()));
            ui.close();
        }
        if ui.button("Unplug").clicked() {
            self.chosen = Some(Chosen::Wire(wire.clone()));
            self.ask(Command::Delete);
            ui.close();
        }
    }

    /// Of a port of a group, seen from either side, or of a node inside of one.
    pub(super) fn port_menu(&mut self, ui: &mut egui::Ui, shape: &PortShape, desk: &mut Desk) {
        let port = &shape.port;
        if desk.is_in_group() && port.of_opened().is_none() {
            let why_not = desk.document().can_expose(catalog(), port.side, &port.end).err();
            let button =
                ui.add_enabled(why_not.is_none(), egui::Button::new("Expose as a port of the group"));
            if button.on_disabled_hover_text(why_not.unwrap_or_default()).clicked() {
                desk.edit("Add a port", |inside| drop(inside.expose(catalog(), port.side, &port.end)));
                ui.close();
            }
        }
        let Some(own) = GroupPort::of(port, desk) else { return };
        if ui.button("Rename").clicked() {
            self.open_port_field(port, &own.name);
            ui.close();
        }
        for (text, by) in [("Move up", -1), ("Move down", 1)] {
            if ui.button(text).clicked() {
                own.change(desk, "Move a port", |inside| inside.shift_port(own.side, &own.name, by).is_ok());
                ui.close();
            }
        }
        if ui.button("Remove the port").clicked() {
            own.change(desk, "Remove a port", |inside| inside.remove_port(own.side, &own.name));
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

/// A port of a group.
struct GroupPort {
    group: String,
    side: Side,
    name: String,
}

impl GroupPort {
    /// The one that a port of the canvas is; none for that of any other node.
    fn of(port: &Port, desk: &Desk) -> Option<Self> {
        let (node, side, name) = match port.of_opened() {
            Some((side, name)) => ("", side, name),
            None => (port.end.node.as_str(), port.side, port.end.port.as_str()),
        };
        let group = desk.group_path(node);
        desk.project.document().node(&group)?.inside.as_ref()?;
        Some(Self { group, side, name: name.to_owned() })
    }

    fn change(&self, desk: &mut Desk, label: &str, change: impl FnOnce(&mut Document) -> bool) {
        desk.edit_graph(label, |graph| {
            graph.edit_inside(&self.group, change);
        });
    }
}

fn spec(command: Command) -> Option<&'static crate::editor::ActionSpec> {
    ACTIONS.iter().find(|spec| spec.action == Action::Canvas(command))
}

fn label(command: Command) -> &'static str {
    spec(command).map_or("", |spec| spec.label)
}
