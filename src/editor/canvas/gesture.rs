//! What the pointer is about: moving nodes, drawing a box, drawing a wire, panning.
//!
//! A gesture begins where a widget is dragged (`interact`), goes on at the start of each frame, so that what
//! is drawn follows the pointer without delay, and ends with the button. Moving is one step of undo.

use std::collections::HashSet;

use egui::{Id, Key, PointerButton, Pos2, Rect, Vec2};
use indexmap::IndexSet;

use super::Canvas;
use super::desk::Desk;
use super::edge;
use super::paint::GRID;
use super::scene::Port;
use crate::graph::{Document, Side, Wire};
use crate::nodes::catalog;

/// What goes on.
#[derive(Debug, Default)]
pub enum Gesture {
    #[default]
    None,
    /// The nodes follow the pointer.
    Move {
        /// Where they stood.
        starts: Vec<(String, Vec2)>,
        /// The frame that is moved with what it holds, and where it stood.
        frame: Option<(usize, Vec2)>,
        /// Where the pointer was, on the canvas.
        from: Pos2,
    },
    /// A frame's corner follows.
    Resize { frame: usize, size: Vec2, from: Pos2 },
    /// A point of a wire follows.
    Bend { wire: Wire, idx: usize },
    /// What a box touches is selected.
    Box {
        from: Pos2,
        /// What was selected before and stays.
        kept: IndexSet<String>,
    },
    /// A wire follows the pointer.
    Connect(Drawing),
    /// The canvas follows the pointer: its pan is this and where the pointer is on the screen.
    Pan { less: Vec2 },
}

/// A wire with a loose end.
#[derive(Debug)]
pub struct Drawing {
    pub fixed: Port,
    /// The wire that it was, of the document or to a port of the opened group, if it was pulled off an input.
    pub unplugged: Option<Wire>,
    /// Whether it ends with the release of the button, or with the next click.
    pub is_held: bool,
    /// Nodes to which it would close a cycle.
    pub blocked: HashSet<String>,
}

impl Gesture {
    /// Whether what it is about is still there.
    pub fn holds(&self, document: &Document) -> bool {
        match self {
            Self::Move { starts, .. } => starts.iter().all(|(name, _)| document.nodes.contains_key(name)),
            Self::Resize { frame, .. } => *frame < document.frames.len(),
            Self::Bend { wire, idx } => document.bends.get(wire).is_some_and(|bends| *idx < bends.len()),
            Self::Connect(drawing) => {
                drawing.fixed.of_opened().is_some() || document.nodes.contains_key(&drawing.fixed.end.node)
            }
            _ => true,
        }
    }
}

impl Drawing {
    pub fn new(document: &Document, port: &Port) -> Self {
        let wires = document.wires.iter().rev();
        let unplugged = match port.side {
            Side::Input => {
                let wire = wires.into_iter().find(|wire| wire.to == port.end).cloned();
                wire.or_else(|| edge::link_to(document, &port.end))
            }
            Side::Output => None,
        };
        let fixed = match &unplugged {
            Some(wire) => Port { end: wire.from.clone(), side: Side::Output },
            None => port.clone(),
        };
        let mut rest = document.clone();
        rest.wires.retain(|wire| Some(wire) != unplugged.as_ref());
        // Through a group a wire need not pass to all of it, so there only the drop tells.
        let has_groups = document.nodes.values().any(|node| node.inside.is_some());
        let blocked = match fixed.side {
            _ if has_groups => HashSet::new(),
            Side::Output => rest.upstream(&fixed.end.node),
            Side::Input => rest.downstream(&fixed.end.node),
        };
        Self { fixed, unplugged, is_held: true, blocked }
    }
}

impl Canvas {
    /// Where the pointer is, what it scrolls and zooms, and whether it pans with the middle button.
    pub(super) fn watch(&mut self, ui: &egui::Ui, back: &egui::Response) {
        let is_over = ui.rect_contains_pointer(back.rect);
        let focused = ui.memory(|memory| memory.focused());
        let in_nodes =
            focused.is_some_and(|id| self.scene.nodes.iter().any(|node| Self::node_id(&node.name) == id));
        self.is_focused = in_nodes;
        let is_busy = self.search.is_some() || self.name_field.is_some();
        self.has_keys = (is_over || in_nodes) && !is_busy && !ui.ctx().text_edit_focused();
        if let Some(at) = ui.input(|input| input.pointer.interact_pos()) {
            self.pointer = at;
        }
        if !is_over {
            return;
        }
        let middle = ui.input(|input| input.pointer.button_pressed(PointerButton::Middle));
        if middle && matches!(self.gesture, Gesture::None) {
            self.gesture = self.pan_from(self.pointer);
        }
        let (scroll, pinch, shift) = ui.input(|input| {
            for event in &input.events {
                if let egui::Event::MouseWheel { unit, .. } = event {
                    // A wheel counts lines and zooms; a trackpad counts points and pans.
                    self.is_trackpad = *unit == egui::MouseWheelUnit::Point;
                }
            }
            (input.smooth_scroll_delta(), input.zoom_delta(), input.modifiers.shift)
        });
        if pinch != 1.0 {
            self.view.zoom_at(self.pointer, pinch);
        } else if self.is_trackpad || shift {
            self.view.pan += scroll;
        } else if scroll.y != 0.0 {
            const PER_POINT: f32 = 0.004;
            self.view.zoom_at(self.pointer, (scroll.y * PER_POINT).exp());
        }
    }

    /// A pan that began where the pointer was at `start` on the screen.
    pub(super) fn pan_from(&self, start: Pos2) -> Gesture {
        Gesture::Pan { less: self.view.pan - start.to_vec2() }
    }

    /// Whether the pointer is to pan instead of what it would do: the space bar is held, or alt.
    pub(super) fn pans(&mut self, ui: &egui::Ui) -> bool {
        let (space, alt) = ui.input(|input| (input.key_down(Key::Space), input.modifiers.alt));
        self.space_dragged |= space;
        space || alt
    }

    /// Takes the gesture further, or ends it.
    pub(super) fn go_on(&mut self, ui: &egui::Ui, desk: &mut Desk) {
        let (is_down, pressed) =
            ui.input(|input| (input.pointer.any_down(), input.pointer.primary_pressed()));
        let at = self.view.to_canvas(self.pointer);
        let is_released = !is_down;
        match std::mem::take(&mut self.gesture) {
            Gesture::None => {}
            Gesture::Pan { less } => {
                self.view.pan = less + self.pointer.to_vec2();
                if !is_released {
                    self.gesture = Gesture::Pan { less };
                }
            }
            Gesture::Box { from, kept } => {
                let area = Rect::from_two_pos(from, at);
                let touched = self.scene.nodes.iter().filter(|node| node.rect.intersects(area));
                desk.selection.nodes =
                    kept.iter().cloned().chain(touched.map(|node| node.name.clone())).collect();
                if !is_released {
                    self.gesture = Gesture::Box { from, kept };
                }
            }
            Gesture::Resize { frame, size, from } => {
                self.resize_frame(frame, size + (at - from), desk);
                if is_released {
                    desk.project.end_gesture();
                } else {
                    self.gesture = Gesture::Resize { frame, size, from };
                }
            }
            Gesture::Bend { wire, idx } => {
                self.move_bend(&wire, idx, at, desk);
                if is_released {
                    desk.project.end_gesture();
                } else {
                    self.gesture = Gesture::Bend { wire, idx };
                }
            }
            Gesture::Move { starts, frame, from } => {
                self.move_nodes(&starts, frame, at - from, desk);
                if is_released {
                    self.drop_on_wire(&starts, desk);
                    desk.project.end_gesture();
                } else {
                    self.gesture = Gesture::Move { starts, frame, from };
                }
            }
            Gesture::Connect(mut drawing) => {
                drawing.is_held |= pressed;
                if is_released && drawing.is_held {
                    self.drop_wire(ui, drawing, desk);
                } else {
                    self.gesture = Gesture::Connect(drawing);
                }
            }
        }
    }

    pub(super) fn move_id() -> Id {
        Id::new("canvas move")
    }

    fn move_nodes(&self, starts: &[(String, Vec2)], frame: Option<(usize, Vec2)>, by: Vec2, desk: &mut Desk) {
        let first = frame.map(|(_, start)| start).or_else(|| starts.first().map(|(_, start)| *start));
        let Some(first) = first else { return };
        let by = if self.snaps { ((first + by) / GRID).round() * GRID - first } else { by };
        let whole = |start: Vec2| {
            let place = (start + by).round();
            [place.x, place.y].map(f64::from)
        };
        let scene = &self.scene;
        desk.edit_during(Self::move_id(), "Move", |document| {
            Self::pin(scene, document);
            for (name, start) in starts {
                document.layout.insert(name.clone(), whole(*start));
            }
            if let Some((idx, start)) = frame
                && let Some(frame) = document.frames.get_mut(idx)
            {
                frame.at = whole(start);
            }
        });
    }

    /// The wire under a single node that has none yet.
    pub(super) fn wire_under(&self, names: &[&str]) -> Option<Wire> {
        let [name] = names else { return None };
        let node = self.scene.node(name)?;
        let is_wired = node.ports.iter().any(|port| port.is_wired);
        if is_wired {
            return None;
        }
        let reach = node.rect.height() / 2.0;
        let wire = &self.scene.wire_at(node.rect.center(), reach)?.wire;
        (!edge::is_link(wire)).then(|| wire.clone())
    }

    fn drop_on_wire(&mut self, starts: &[(String, Vec2)], desk: &mut Desk) {
        let names: Vec<&str> = starts.iter().map(|(name, _)| name.as_str()).collect();
        let Some(wire) = self.wire_under(&names) else { return };
        // Where it does not fit it was only put there.
        desk.edit_during(Self::move_id(), "Insert", |document| {
            let _ = document.insert_on(catalog(), &wire, names[0]);
        });
    }
}
