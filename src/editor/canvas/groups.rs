//! Groups: entering and leaving them, the way back on the screen, and muting and bypassing.

use egui::{Area, Frame, Id, Order, Pos2, Rect, vec2};

use super::desk::Desk;
use super::{Canvas, Command};
use crate::editor::{Project, Selection};
use crate::graph::Document;
use crate::nodes::catalog;

impl Canvas {
    /// Shows the inside of a group from the next frame on; of the empty path the graph itself.
    pub(super) fn go_to(&mut self, group: String) {
        self.next_group = Some(group);
    }

    /// The selected group, where the pointer is on it: there, the key that adds a node enters it.
    pub(super) fn pointed_group(&self, desk: &Desk) -> Option<String> {
        let node = self.scene.node_at(self.view.to_canvas(self.pointer))?;
        (node.is_group && desk.selection.active() == Some(&node.name)).then(|| node.name.clone())
    }

    /// Goes where it was told to; out of a group that is no more.
    pub(super) fn enter(&mut self, document: &Document) {
        let mut group = self.next_group.take().unwrap_or_else(|| self.group.clone());
        while document.inside(&group).is_none() {
            group = group.rsplit_once('/').map_or(String::new(), |(outer, _)| outer.to_owned());
        }
        if group != self.group {
            // What was chosen, drawn or searched belonged to the other level.
            (self.gesture, self.chosen, self.search, self.name_field) = Default::default();
            (self.group, self.entered, self.scene_of) = (group, true, None);
        }
    }

    /// The way back, a button for each level.
    pub(super) fn breadcrumb(&mut self, ui: &egui::Ui, screen: Rect) {
        let mut chosen = None;
        let area = Area::new(Id::new("canvas breadcrumb"))
            .order(Order::Middle)
            .fixed_pos(screen.min + vec2(10.0, 10.0));
        area.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.horizontal(|ui| {
                    if ui.button("Graph").clicked() {
                        chosen = Some(String::new());
                    }
                    let ends = self.group.match_indices('/').map(|(at, _)| at).chain([self.group.len()]);
                    for end in ends {
                        let path = &self.group[..end];
                        let name = path.rsplit('/').next().unwrap_or(path);
                        ui.add(egui::Label::new("›").selectable(false));
                        if ui.selectable_label(end == self.group.len(), name).clicked() {
                            chosen = Some(path.to_owned());
                        }
                    }
                });
            });
        });
        if let Some(group) = chosen {
            self.go_to(group);
        }
    }

    /// Adds a graph as a group in the middle of what is seen, under a free name like `like`, and selects it.
    pub fn insert_graph(
        &mut self,
        project: &mut Project,
        selection: &mut Selection,
        preset: &Document,
        like: &str,
    ) {
        let middle = self.screen.map_or(Pos2::ZERO, |screen| self.view.to_canvas(screen.center()));
        let place = [middle.x - 0.5 * super::scene::WIDTH, middle.y - super::scene::HEADER];
        let (scene, group) = (self.scene.clone(), self.group.clone());
        let mut name = None;
        project.edit("Insert a graph", |document| {
            if let Some(inside) = document.inside_mut(&group) {
                Self::pin(&scene, inside);
                let place = place.map(|x| f64::from(x.round()));
                name = Some(inside.insert_preset(catalog(), preset, like, place));
            }
        });
        if let Some(name) = name {
            selection.only(&super::desk::path(&group, &name));
        }
    }

    pub(super) fn perform_on_groups(&mut self, ui: &egui::Ui, command: Command, desk: &mut Desk) {
        let names: Vec<String> = desk.selection.nodes.iter().cloned().collect();
        let scene = self.scene.clone();
        match command {
            Command::Group if !names.is_empty() => {
                let mut made = Ok(String::new());
                desk.edit("Group", |document| {
                    Self::pin(&scene, document);
                    made = document.make_group(&names, "group");
                });
                match made {
                    Ok(name) => desk.selection.only(&name),
                    Err(reason) => self.tell(ui, reason),
                }
            }
            Command::Ungroup => {
                let Some(name) = names.last() else { return };
                let mut made = Ok(Vec::new());
                desk.edit("Ungroup", |document| {
                    Self::pin(&scene, document);
                    made = document.ungroup(name);
                });
                match made {
                    Ok(names) => desk.selection.nodes = names.into_iter().collect(),
                    Err(reason) => self.tell(ui, reason),
                }
            }
            Command::OpenGroup => {
                let active =
                    desk.selection.active().and_then(|name| desk.document().nodes.get_key_value(name));
                if let Some((name, _)) = active.filter(|(_, node)| node.inside.is_some()) {
                    self.go_to(super::desk::path(&self.group, name));
                }
            }
            Command::LeaveGroup => {
                let outer = self.group.rsplit_once('/').map_or("", |(outer, _)| outer);
                self.go_to(outer.to_owned());
            }
            // All on where one is off, so that the key gives the same for all.
            Command::Mute | Command::Bypass => {
                let is_mute = command == Command::Mute;
                let label = if is_mute { "Mute" } else { "Bypass" };
                desk.edit(label, |document| {
                    let nodes = || names.iter();
                    let is_on = |name: &String| {
                        document
                            .nodes
                            .get(name)
                            .is_some_and(|node| if is_mute { node.mute } else { node.bypass })
                    };
                    let on = !nodes().all(is_on);
                    for name in nodes() {
                        if let Some(node) = document.nodes.get_mut(name) {
                            *(if is_mute { &mut node.mute } else { &mut node.bypass }) = on;
                        }
                    }
                });
            }
            _ => {}
        }
    }
}
