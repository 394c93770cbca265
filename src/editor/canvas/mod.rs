//! The canvas: the nodes of the document, their wires, and the gestures that change them.
//!
//! Everything is drawn by the painter from the document, through a [`View`]; there is no graph beside it.
//! Each frame: what was asked for ([`Command`]) and the gesture that goes on change the document, the
//! [`Scene`] is made where it changed, then it is drawn, and what the pointer does to it begins the next
//! gesture. Nodes, ports and wires are widgets by name ("node sun", "output sun.light", "wire sun.light ->
//! split.lights"), so that the keyboard and AccessKit reach them.
//!
//! Limits: what is off the screen is no widget; arrow keys bring it there. Tested by gestures in `tests`,
//! and without a window where it is geometry or a change of a document.

mod bends;
mod command;
mod connect;
mod desk;
mod edge;
mod field;
mod frames;
mod gesture;
mod groups;
mod interact;
mod menu;
mod minimap;
mod node;
mod paint;
mod scene;
mod search;
mod theme;
mod toast;
mod told;
mod view;

use std::collections::HashMap;
use std::rc::Rc;

use egui::{Pos2, Rect, Sense, TextureHandle, Vec2};

use super::{Project, Selection, Statuses};
use crate::graph::{Document, Wire};
use crate::nodes::catalog;
use desk::Desk;
use field::NameField;
use gesture::Gesture;
use paint::Brush;
use scene::Scene;
use search::Search;
use theme::Theme;
use toast::Toast;
use view::View;

pub use command::Command;

/// What the canvas remembers between frames and the document does not hold.
#[derive(Debug, Default)]
pub struct Canvas {
    view: View,
    /// The view as everything was fitted into it, which goes on until the user changes it.
    fitted: Option<View>,
    /// Where it is on the screen; nothing before it was shown.
    screen: Option<Rect>,
    scene: Rc<Scene>,
    /// What the scene was made of.
    scene_of: Option<u64>,
    gesture: Gesture,
    /// What was clicked and is no node.
    chosen: Option<Chosen>,
    /// The group whose inside is shown, `outer/inner`; empty for the graph itself.
    group: String,
    /// The group to be shown from the next frame on.
    next_group: Option<String>,
    entered: bool,
    /// The node to be brought into view, by its name in the opened group.
    reveal_next: Option<String>,
    search: Option<Search>,
    name_field: Option<NameField>,
    toast: Option<Toast>,
    commands: Vec<Command>,
    /// Where the pointer was last, on the screen.
    pointer: Pos2,
    has_keys: bool,
    /// Something that stands over it has the keys.
    is_behind: bool,
    /// Whether a node has the keyboard.
    is_focused: bool,
    /// Gets the keyboard when it is drawn: what is no widget yet must not have it.
    focus_next: Option<String>,
    /// Whether it was last scrolled by a trackpad.
    is_trackpad: bool,
    /// Whether a gesture went on when the frame began: its end begins no other.
    was_busy: bool,
    /// Whether the pointer dragged while the space bar is held.
    space_dragged: bool,
    hides_minimap: bool,
    minimap_corner: minimap::Corner,
    snaps: bool,
}

/// What the canvas asks of the rest of the editor.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// To show this node's picture.
    Show(String),
    /// To bring this node into view, and the keyboard to its parameters.
    Inspect(String),
    /// To write this group to a file of its own, as a preset.
    SavePreset(String),
}

/// What is clicked and deleted besides nodes.
#[derive(Debug, Clone, PartialEq)]
enum Chosen {
    Wire(Wire),
    /// The point of a wire, by its place among the wire's.
    Bend(Wire, usize),
    /// By its place among the document's.
    Frame(usize),
}

impl Chosen {
    fn is_in(&self, document: &Document) -> bool {
        match self {
            Self::Wire(wire) => {
                document.wires.contains(wire) || edge::links(document).any(|link| link == *wire)
            }
            Self::Bend(wire, at) => document.bends.get(wire).is_some_and(|bends| *at < bends.len()),
            Self::Frame(at) => *at < document.frames.len(),
        }
    }
}

impl Canvas {
    /// Draws the document and applies gestures to it.
    pub fn show(
        &mut self,
        ui: &mut egui::Ui,
        project: &mut Project,
        selection: &mut Selection,
        statuses: &Statuses,
        thumbnails: &HashMap<String, TextureHandle>,
    ) -> Vec<Request> {
        self.enter(project.document());
        let mut desk = Desk::new(project, selection, statuses, thumbnails, &self.group);
        let screen = ui.available_rect_before_wrap();
        let back = ui.allocate_rect(screen, Sense::click_and_drag());
        self.place(screen, &desk);
        self.watch(ui, &back);
        self.keys(ui, &mut desk);
        for command in std::mem::take(&mut self.commands) {
            self.perform(ui, command, &mut desk);
        }
        self.was_busy = !matches!(self.gesture, Gesture::None);
        self.go_on(ui, &mut desk);
        self.update(&desk);

        let theme = Theme::of(ui);
        let painter = ui.painter_at(screen);
        let brush = Brush { painter: &painter, view: self.view, theme };
        painter.rect_filled(screen, 0.0, theme.background);
        brush.grid(screen);
        self.behind(ui, &brush, &back, &mut desk);
        self.frames(ui, &brush, &mut desk);
        self.wires(ui, &brush, &mut desk);
        self.edges(ui, &brush, &mut desk);
        self.nodes(ui, &brush, &mut desk);
        self.drawing(ui, &brush, &desk);
        if desk.document().nodes.is_empty() {
            let text = "Tab adds a node";
            brush.text(screen.center(), egui::Align2::CENTER_CENTER, text, 16.0, theme.weak, 400.0);
        }
        if !self.hides_minimap {
            self.minimap(ui, &brush, &desk.selection);
        }
        if !self.group.is_empty() {
            self.breadcrumb(ui, screen);
        }
        self.show_name_field(ui, &mut desk);
        self.show_search(ui, &mut desk);
        self.show_toast(ui);
        desk.close(&self.group)
    }

    /// The group whose inside is shown, `outer/inner`; empty for the graph itself.
    pub fn group(&self) -> &str {
        &self.group
    }

    /// Brings a node into view from the next frame on, in its group.
    pub fn reveal(&mut self, path: &str) {
        let (group, name) = path.rsplit_once('/').unwrap_or(("", path));
        self.next_group = Some(group.to_owned());
        self.reveal_next = Some(name.to_owned());
    }

    /// To be done in the next frame.
    pub fn ask(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Whether something stands over it that has the keys: a palette, a dialog.
    pub fn stay_behind(&mut self, is_behind: bool) {
        self.is_behind = is_behind;
    }

    /// Whether keys are meant for the canvas: the pointer is over it or a node has the focus.
    pub fn has_keys(&self) -> bool {
        self.has_keys
    }

    /// Takes its place on the screen, and shows there what it is to show: all of what was entered, and still all
    /// while nobody has panned or zoomed, whatever becomes of the panel.
    fn place(&mut self, screen: Rect, desk: &Desk) {
        let is_fitted = self.fitted == Some(self.view) && matches!(self.gesture, Gesture::None);
        let is_first = self.screen.is_none() || std::mem::take(&mut self.entered);
        let is_resized = self.screen != Some(screen);
        self.screen = Some(screen);
        self.view.origin = screen.min;
        self.update(desk);
        if is_first || is_fitted && is_resized {
            self.fit_all();
        }
        if let Some(node) = self.reveal_next.take().and_then(|name| self.scene.node(&name)) {
            self.view.come_near(node.rect, screen.size());
        }
    }

    fn fit_all(&mut self) {
        self.view.fit(self.scene.all_bounds(), self.screen.map_or(Vec2::ZERO, |screen| screen.size()));
        self.fitted = Some(self.view);
    }

    /// Whether a node has the keyboard.
    pub fn is_focused(&self) -> bool {
        self.is_focused
    }

    /// Whether moved nodes stand on the grid.
    pub fn snaps(&self) -> bool {
        self.snaps
    }

    /// Whether the map is shown in the corner, where there is something out of sight.
    pub fn shows_minimap(&self) -> bool {
        !self.hides_minimap
    }

    /// Brings the keyboard to the selected node, or to the first, which is then selected.
    pub fn take_keyboard(&mut self, selection: &mut Selection) {
        let inner =
            selection.active().and_then(|path| desk::inner_name(&self.group, path)).map(str::to_owned);
        let name = inner.or_else(|| {
            let first = self.scene.nodes.first()?.name.clone();
            selection.only(&desk::path(&self.group, &first));
            Some(first)
        });
        self.focus_next = name;
    }

    /// Makes the scene anew where the document is another, and forgets what is no more.
    fn update(&mut self, desk: &Desk) {
        let document = desk.document();
        let made_of = desk.project.revision();
        if self.scene_of == Some(made_of) {
            return;
        }
        let scene = Scene::new(document, catalog());
        self.scene = Rc::new(if desk.is_in_group() { scene.with_edges(document) } else { scene });
        self.scene_of = Some(made_of);
        self.chosen.take_if(|chosen| !chosen.is_in(document));
        if !self.gesture.holds(document) {
            self.gesture = Gesture::None;
        }
    }

    /// The document with a place for every node, so that moving some leaves the others where they are.
    fn pin(scene: &Scene, document: &mut Document) {
        for (name, place) in scene.places() {
            if document.nodes.contains_key(name) && !document.layout.contains_key(name) {
                document.layout.insert(name.to_owned(), place);
            }
        }
    }
}

#[cfg(test)]
mod tests;
