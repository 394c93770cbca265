//! What can be asked of the canvas by key, menu or palette, and the doing of it.

use egui::{Context, Event, Key, Modifiers, Pos2, Vec2, ViewportCommand};

use super::desk::Desk;
use super::gesture::Gesture;
use super::search::Purpose;
use super::{Canvas, Chosen, Request};
use crate::graph::layout::layered;
use crate::graph::{Document, Wire};
use crate::nodes::catalog;

/// What can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Command {
    /// Looks for a node to add at the pointer.
    AddNode,
    /// Puts the selected nodes on the clipboard, as the text of a graph.
    Copy,
    /// Copies and deletes.
    Cut,
    /// Adds the nodes of the clipboard at the pointer.
    Paste,
    /// Adds the selected nodes once more, beside themselves.
    Duplicate,
    /// Removes the selected nodes with their wires, or the wire that was clicked.
    Delete,
    /// Selects every node.
    SelectAll,
    /// Asks for another name of the selected node.
    Rename,
    /// Shows all nodes.
    FrameAll,
    /// Shows the selected nodes.
    FrameSelected,
    /// Puts all nodes in layers from left to right.
    Arrange,
    /// Shows or hides the map in the corner.
    ToggleMinimap,
    /// Whether moved nodes stand on the grid.
    ToggleSnap,
    /// As if the selected nodes were not there, or again as if they were.
    Mute,
    /// Lets through what the selected nodes get, or no longer.
    Bypass,
    /// Makes a node of the selected ones.
    Group,
    /// Puts what a group holds in its place.
    Ungroup,
    /// Shows the inside of the selected group.
    OpenGroup,
    /// Shows what is around this group.
    LeaveGroup,
    /// A comment around the selected nodes.
    AddFrame,
}

/// How far a copy stands beside what was duplicated.
const BESIDE: f64 = 32.0;

impl Canvas {
    /// Does what was asked for.
    pub(super) fn perform(&mut self, ui: &egui::Ui, command: Command, desk: &mut Desk) {
        let context = ui.ctx();
        let size = self.screen.map_or(Vec2::ZERO, |screen| screen.size());
        match command {
            Command::AddNode => match self.pointed_group(desk) {
                Some(name) => self.go_to(super::desk::path(&self.group, &name)),
                None => self.open_search(Purpose::Add),
            },
            Command::AddFrame => self.add_frame(desk),
            Command::Mute
            | Command::Bypass
            | Command::Group
            | Command::Ungroup
            | Command::OpenGroup
            | Command::LeaveGroup => self.perform_on_groups(ui, command, desk),
            Command::Copy => copy(context, desk),
            Command::Cut => {
                copy(context, desk);
                self.delete("Cut", desk);
            }
            Command::Paste => context.send_viewport_cmd(ViewportCommand::RequestPaste),
            Command::Duplicate => {
                let names: Vec<String> = desk.selection.nodes.iter().cloned().collect();
                let added =
                    self.insert("Duplicate", desk, |document| document.duplicate(&names, [BESIDE; 2]));
                if let Err(reason) = added {
                    self.tell(ui, reason);
                }
            }
            Command::Delete => self.delete("Delete", desk),
            Command::SelectAll => {
                desk.selection.nodes = desk.document().nodes.keys().cloned().collect();
            }
            Command::Rename => {
                if let Some(name) = desk.selection.active() {
                    self.open_name_field(name);
                }
            }
            Command::FrameAll => self.fit_all(),
            Command::FrameSelected => self.view.fit(self.scene.bounds(&desk.selection.nodes), size),
            Command::Arrange => {
                let scene = self.scene.clone();
                let size =
                    |name: &str| scene.node(name).map_or([0.0; 2], |node| super::scene::size_of(node.rect));
                desk.edit("Arrange", |document| document.layout = layered(document, size));
                self.update(desk);
                self.fit_all();
            }
            Command::ToggleMinimap => self.hides_minimap = !self.hides_minimap,
            Command::ToggleSnap => self.snaps = !self.snaps,
        }
    }

    /// Keys that no table holds: arrows, enter, escape, space, and what comes of the clipboard.
    pub(super) fn keys(&mut self, ui: &egui::Ui, desk: &mut Desk) {
        if !self.has_keys {
            self.space_dragged &= ui.input(|input| input.key_down(Key::Space));
            return;
        }
        let taken = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        taken(Key::Space);
        if ui.input(|input| input.key_released(Key::Space)) && !std::mem::take(&mut self.space_dragged) {
            self.open_search(Purpose::Add);
        }
        if taken(Key::A) {
            self.commands.push(Command::FrameAll);
        }
        if taken(Key::Backspace) {
            self.commands.push(Command::Delete);
        }
        if taken(Key::Escape) {
            self.escape(desk);
        }
        if let Some(name) = desk.selection.active().filter(|_| taken(Key::Enter)) {
            desk.requests.push(Request::Inspect(name.to_owned()));
        }
        let arrows = [
            (Key::ArrowLeft, Vec2::LEFT),
            (Key::ArrowRight, Vec2::RIGHT),
            (Key::ArrowUp, Vec2::UP),
            (Key::ArrowDown, Vec2::DOWN),
        ];
        for (_, direction) in arrows.into_iter().filter(|(key, _)| taken(*key)) {
            self.go_to_next(direction, desk);
        }
        for event in ui.input(|input| input.events.clone()) {
            match event {
                Event::Copy => self.commands.push(Command::Copy),
                Event::Cut => self.commands.push(Command::Cut),
                Event::Paste(text) => self.paste(ui, &text, desk),
                _ => {}
            }
        }
    }

    fn escape(&mut self, desk: &mut Desk) {
        match std::mem::take(&mut self.gesture) {
            Gesture::Move { starts, .. } => {
                desk.project.end_gesture();
                // Nothing moved yet where the places are those of the start.
                let moved = starts.iter().any(|(name, start)| {
                    self.scene.node(name).is_some_and(|node| node.rect.min.to_vec2() != *start)
                });
                if moved {
                    desk.project.undo();
                }
            }
            Gesture::None if self.chosen.take().is_none() => desk.selection.nodes.clear(),
            _ => {}
        }
    }

    /// To the nearest node in a direction, or to the first.
    fn go_to_next(&mut self, direction: Vec2, desk: &mut Desk) {
        let scene = self.scene.clone();
        let next = match desk.selection.active() {
            Some(name) => scene.next(name, direction),
            None => scene.nodes.first(),
        };
        let Some(next) = next else { return };
        desk.selection.only(&next.name);
        self.view.reveal(next.rect, self.screen.map_or(Vec2::ZERO, |screen| screen.size()));
        self.focus_next = Some(next.name.clone());
    }

    fn delete(&mut self, label: &str, desk: &mut Desk) {
        match self.chosen.take() {
            Some(Chosen::Wire(wire)) => {
                return unplug(desk, &wire);
            }
            Some(Chosen::Bend(wire, idx)) => return Self::remove_bend(desk, &wire, idx),
            Some(Chosen::Frame(idx)) => return Self::remove_frame(desk, idx),
            None => {}
        }
        let names: Vec<String> = desk.selection.nodes.drain(..).collect();
        let scene = self.scene.clone();
        desk.edit(label, |document| {
            Self::pin(&scene, document);
            document.remove(&names);
        });
    }

    /// Adds nodes and selects them.
    fn insert<E: std::fmt::Display>(
        &mut self,
        label: &str,
        desk: &mut Desk,
        add: impl FnOnce(&mut Document) -> Result<Vec<String>, E>,
    ) -> Result<(), E> {
        let scene = self.scene.clone();
        let mut added = Ok(Vec::new());
        desk.edit(label, |document| {
            Self::pin(&scene, document);
            added = add(document);
        });
        let names = added?;
        if !names.is_empty() {
            desk.selection.nodes = names.into_iter().collect();
        }
        Ok(())
    }

    fn paste(&mut self, ui: &egui::Ui, text: &str, desk: &mut Desk) {
        let at = self.view.to_canvas(self.pointer);
        let pasted = self.insert("Paste", desk, |document| {
            // Into nothing first, to learn where the nodes would stand.
            let mut alone = Document { base: document.base.clone(), ..Document::default() };
            alone.paste_text(catalog(), text, [0.0; 2])?;
            document.paste_text(catalog(), text, offset_to(&alone, at))
        });
        if let Err(error) = pasted {
            let first = error.to_string().lines().next().unwrap_or_default().to_owned();
            self.tell(ui, format!("the clipboard holds no nodes: {first}"));
        }
    }
}

/// Removes a wire.
pub(super) fn unplug(desk: &mut Desk, wire: &Wire) {
    desk.edit("Unplug", |document| super::edge::disconnect(document, wire));
}

fn copy(context: &Context, desk: &Desk) {
    let names: Vec<String> = desk.selection.nodes.iter().cloned().collect();
    if !names.is_empty() {
        context.copy_text(desk.document().copy(&names));
    }
}

/// What brings the upper left corner of a part to a place.
fn offset_to(part: &Document, at: Pos2) -> [f64; 2] {
    let least = |axis: usize| part.layout.values().map(|place| place[axis]).fold(f64::INFINITY, f64::min);
    let offset =
        |axis: usize, at: f32| if least(axis).is_finite() { f64::from(at) - least(axis) } else { at.into() };
    [offset(0, at.x).round(), offset(1, at.y).round()]
}
