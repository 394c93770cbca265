//! The widgets of the canvas: background, wires, nodes and ports, and the gestures that begin on them.

use egui::{EventFilter, Id, PointerButton, Pos2, Rect, Response, Sense, Vec2, WidgetInfo, WidgetType};

use super::desk::{self, Desk};
use super::gesture::{Drawing, Gesture};
use super::node::{self, NEAR_PORTS, NodeLook};
use super::paint::{Brush, WireLook};
use super::scene::{HEADER, NodeShape, PortShape};
use super::told::{reasons, state_text};
use super::{Canvas, Chosen, Request};
use crate::graph::Wire;

/// Within how many points of the screen a wire is found.
const REACH: f32 = 7.0;

impl Canvas {
    pub(super) fn node_id(name: &str) -> Id {
        Id::new(("canvas node", name))
    }

    /// The wire under the pointer, where no node is over it.
    pub(super) fn hovered_wire(&self) -> Option<Wire> {
        let at = self.view.to_canvas(self.pointer);
        if self.scene.node_at(at).is_some() {
            return None;
        }
        Some(self.scene.wire_at(at, REACH / self.view.zoom)?.wire.clone())
    }

    /// What is done to the empty, and to wires away from their middle.
    pub(super) fn behind(&mut self, ui: &egui::Ui, brush: &Brush, back: &Response, desk: &mut Desk) {
        back.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "canvas"));
        if !self.was_busy && back.drag_started_by(PointerButton::Primary) {
            let start = ui.input(|input| input.pointer.press_origin()).unwrap_or(self.pointer);
            self.gesture = if self.pans(ui) {
                self.pan_from(start)
            } else {
                let adds = ui.input(|input| input.modifiers.shift || input.modifiers.command);
                let kept = if adds { desk.selection.nodes.clone() } else { Default::default() };
                Gesture::Box { from: brush.view.to_canvas(start), kept }
            };
        }
        if back.clicked() || back.secondary_clicked() {
            self.chosen = self.hovered_wire().map(Chosen::Wire);
        }
        if back.clicked() && !self.was_busy {
            back.request_focus();
            ui.memory_mut(|memory| memory.surrender_focus(back.id));
            if self.chosen.is_none() && !ui.input(|input| input.modifiers.shift || input.modifiers.command) {
                desk.selection.nodes.clear();
            }
        }
        if back.double_clicked() {
            match self.hovered_wire() {
                Some(wire) => self.add_bend(&wire, desk),
                None => self.open_search(super::search::Purpose::Add),
            }
        }
        back.context_menu(|ui| match self.chosen.clone() {
            Some(Chosen::Wire(wire)) => self.wire_menu(ui, &wire),
            _ => self.back_menu(ui),
        });
        if matches!(self.gesture, Gesture::Pan { .. }) {
            ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
        }
    }

    /// Draws the wires; a handle in the middle of each bears its name.
    pub(super) fn wires(&mut self, ui: &egui::Ui, brush: &Brush, desk: &mut Desk) {
        let scene = self.scene.clone();
        let screen = brush.painter.clip_rect();
        let is_drawing = matches!(self.gesture, Gesture::Connect(_));
        let hovered = match &self.gesture {
            Gesture::None if ui.rect_contains_pointer(screen) => self.hovered_wire(),
            Gesture::Move { starts, .. } => {
                let names: Vec<&str> = starts.iter().map(|(name, _)| name.as_str()).collect();
                self.wire_under(&names)
            }
            _ => None,
        };
        let unplugged = match &self.gesture {
            Gesture::Connect(drawing) => drawing.unplugged.clone(),
            _ => None,
        };
        for shape in &scene.wires {
            if unplugged.as_ref() == Some(&shape.wire) {
                continue;
            }
            let is_chosen = self.chosen == Some(Chosen::Wire(shape.wire.clone()))
                || hovered.as_ref() == Some(&shape.wire);
            let at_chosen = |name: &String| desk.selection.nodes.contains(name);
            let look = match () {
                () if is_drawing => WireLook::Dim,
                () if is_chosen || at_chosen(&shape.wire.from.node) || at_chosen(&shape.wire.to.node) => {
                    WireLook::Hot
                }
                () => WireLook::Plain,
            };
            brush.wire(shape, screen, look);
            if !is_drawing {
                self.bends(ui, brush, shape, desk);
            }
            let middle = brush.view.to_screen(shape.middle());
            if is_drawing || !screen.contains(middle) {
                continue;
            }
            let rect = Rect::from_center_size(middle, Vec2::splat(12.0));
            let response = ui.interact(rect, Id::new(("canvas wire", &shape.wire)), Sense::CLICK);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, shape.label()));
            if response.clicked() || response.secondary_clicked() {
                self.chosen = Some(Chosen::Wire(shape.wire.clone()));
                desk.selection.nodes.clear();
            }
            if response.double_clicked() {
                self.add_bend(&shape.wire, desk);
            }
            response.context_menu(|ui| self.wire_menu(ui, &shape.wire));
        }
    }

    /// Draws the nodes that are on the screen.
    pub(super) fn nodes(&mut self, ui: &egui::Ui, brush: &Brush, desk: &mut Desk) {
        let scene = self.scene.clone();
        let seen = brush.view.rect_to_canvas(brush.painter.clip_rect()).expand(16.0);
        let focused = ui.memory(|memory| memory.focused());
        // What has the keyboard stays a widget wherever it is.
        let is_shown =
            |name: &String| focused == Some(Self::node_id(name)) || self.focus_next.as_ref() == Some(name);
        let shown: Vec<&NodeShape> =
            scene.nodes.iter().filter(|node| node.rect.intersects(seen) || is_shown(&node.name)).collect();
        for shape in shown {
            self.node(ui, brush, shape, desk);
        }
    }

    fn node(&mut self, ui: &egui::Ui, brush: &Brush, shape: &NodeShape, desk: &mut Desk) {
        let rect = brush.view.rect_to_screen(shape.rect);
        let response = ui.interact(rect, Self::node_id(&shape.name), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("node {}", shape.name)));
        if self.focus_next.take_if(|name| *name == shape.name).is_some() {
            response.request_focus();
        }
        self.touch_node(ui, &response, shape, desk);
        let status = &desk.status(&shape.name);
        let looks: Vec<_> = shape.ports.iter().map(|port| self.port_look(port)).collect();
        let is_drawing = matches!(self.gesture, Gesture::Connect(_));
        let look = NodeLook {
            is_selected: desk.selection.nodes.contains(&shape.name),
            is_hovered: response.hovered(),
            is_focused: response.has_focus(),
            is_dim: is_drawing && looks.iter().all(|look| *look == node::PortLook::Dim),
            time: ui.input(|input| input.time),
        };
        let picture = desk.thumbnail(&shape.name).map(egui::TextureHandle::id);
        brush.node(shape, status, look, picture);
        if matches!(status.state, super::super::NodeState::Running) {
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(500));
        }
        for (port, look) in shape.ports.iter().zip(looks) {
            let is_faint = shape.mute && look == node::PortLook::Plain;
            brush.port(port, if is_faint { node::PortLook::Dim } else { look });
            if brush.view.zoom >= NEAR_PORTS {
                self.port(ui, brush, port, desk);
            }
        }
        let tips =
            [(brush.state_rect(shape), state_text(status)), (brush.badge_rect(shape), reasons(status))];
        for ((rect, text), what) in tips.into_iter().zip(["state", "left out"]) {
            let is_badge = what == "left out";
            if brush.view.zoom < NEAR_PORTS || (is_badge && text.is_empty()) {
                continue;
            }
            let response = ui.interact(rect, Self::node_id(&shape.name).with(what), Sense::hover());
            let label = || format!("{what} of {}: {text}", shape.name);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, label()));
            response.on_hover_text(text.as_str());
        }
    }

    fn touch_node(&mut self, ui: &egui::Ui, response: &Response, shape: &NodeShape, desk: &mut Desk) {
        let adds = ui.input(|input| input.modifiers.shift || input.modifiers.command);
        let nodes = &mut desk.selection.nodes;
        if response.has_focus() {
            // Arrows and tab are the canvas' own here; escape leaves it.
            let filter =
                EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: false };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        }
        if response.clicked() {
            self.chosen = None;
            response.request_focus();
            if !adds {
                desk.selection.only(&shape.name);
            } else if !nodes.shift_remove(&shape.name) {
                nodes.insert(shape.name.clone());
            }
        } else if response.secondary_clicked() && !nodes.contains(&shape.name) {
            desk.selection.only(&shape.name);
        }
        if response.double_clicked() {
            let at = self.view.to_canvas(self.pointer);
            if at.y < shape.rect.top() + HEADER {
                self.open_name_field(&shape.name);
            } else if shape.is_group {
                self.go_to(desk::path(&self.group, &shape.name));
            } else {
                desk.requests.push(Request::Show(shape.name.clone()));
            }
        }
        if !self.was_busy && response.drag_started_by(PointerButton::Primary) {
            self.begin_move(ui, shape, adds, desk);
        }
        response.context_menu(|ui| self.node_menu(ui, &shape.name, desk));
    }

    fn begin_move(&mut self, ui: &egui::Ui, shape: &NodeShape, adds: bool, desk: &mut Desk) {
        if self.pans(ui) {
            let start = ui.input(|input| input.pointer.press_origin()).unwrap_or(self.pointer);
            self.gesture = self.pan_from(start);
            return;
        }
        if adds {
            desk.selection.nodes.insert(shape.name.clone());
        } else if !desk.selection.nodes.contains(&shape.name) {
            desk.selection.only(&shape.name);
        }
        // The dragged one first: it is what snaps.
        let others = desk.selection.nodes.iter().filter(|name| **name != shape.name);
        let names = std::iter::once(&shape.name).chain(others);
        let start = |name: &String| Some((name.clone(), self.scene.node(name)?.rect.min.to_vec2()));
        let starts = names.filter_map(start).collect();
        let press: Pos2 = ui.input(|input| input.pointer.press_origin()).unwrap_or(self.pointer);
        self.gesture = Gesture::Move { starts, frame: None, from: self.view.to_canvas(press) };
    }

    pub(super) fn port(&mut self, ui: &egui::Ui, brush: &Brush, shape: &PortShape, desk: &mut Desk) {
        let at = brush.view.to_screen(shape.at);
        let rect = Rect::from_center_size(at, Vec2::splat((16.0 * brush.view.zoom).max(8.0)));
        let id = Id::new(("canvas port", &shape.port));
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, shape.port.label()));
        let is_idle = !self.was_busy && matches!(self.gesture, Gesture::None);
        if is_idle && response.drag_started_by(PointerButton::Primary) {
            self.gesture = Gesture::Connect(Drawing::new(desk.document(), &shape.port));
        } else if is_idle && response.clicked() {
            // Of a click the wire stays at the pointer until the next.
            let mut drawing = Drawing::new(desk.document(), &shape.port);
            drawing.is_held = false;
            self.gesture = Gesture::Connect(drawing);
        }
        // What is no group's and in none has nothing to be asked.
        let is_plain =
            !desk.is_in_group() && !self.scene.node(&shape.port.end.node).is_some_and(|node| node.is_group);
        if !is_plain && !shape.port.is_new() {
            response.context_menu(|ui| self.port_menu(ui, shape, desk));
        }
        if matches!(self.gesture, Gesture::None) {
            response.on_hover_ui(|ui| {
                if shape.port.is_new() {
                    return drop(ui.label(&shape.doc));
                }
                let kind = shape.kind.map_or("unknown".to_owned(), |kind| kind.to_string());
                let many = if shape.many { ", many wires" } else { "" };
                ui.strong(format!("{}: {kind}{many}", shape.port.end.port));
                ui.label(&shape.doc);
            });
        }
    }
}
