//! Drawing a wire: where it may end, and what happens where it does.

use egui::Align2;

use super::Canvas;
use super::desk::Desk;
use super::edge;
use super::gesture::{Drawing, Gesture};
use super::node::PortLook;
use super::paint::Brush;
use super::scene::{NodeShape, Port, PortShape};
use super::search::Purpose;
use crate::graph::{Document, Side, Wire};

/// Within how many points of the screen a wire finds a port.
pub const REACH: f32 = 14.0;

impl Drawing {
    /// The wire that it would be.
    pub fn wire_to(&self, port: &Port) -> Option<Wire> {
        let (fixed, port_end) = (self.fixed.end.clone(), port.end.clone());
        match (self.fixed.side, port.side) {
            (Side::Output, Side::Input) => Some(Wire { from: fixed, to: port_end }),
            (Side::Input, Side::Output) => Some(Wire { from: port_end, to: fixed }),
            _ => None,
        }
    }

    /// Whether it may end there.
    fn fits(&self, fixed: &PortShape, port: &PortShape) -> bool {
        let is_new = fixed.port.is_new() || port.port.is_new();
        port.port.side != self.fixed.side
            && (port.kind == fixed.kind || is_new)
            && !edge::are_both(&fixed.port, &port.port)
            && !self.blocked.contains(&port.port.end.node)
    }

    /// Makes it a wire of the document.
    fn connect(&self, document: &mut Document, wire: Wire) -> Result<(), String> {
        let mut changed = document.clone();
        // A port of the group that stands for nothing would be gone before it is led elsewhere.
        let (first, last): (Vec<&Wire>, Vec<&Wire>) =
            self.unplugged.iter().partition(|unplugged| !edge::is_link(unplugged));
        first.into_iter().for_each(|unplugged| edge::disconnect(&mut changed, unplugged));
        edge::connect(&mut changed, wire)?;
        last.into_iter().for_each(|unplugged| edge::disconnect(&mut changed, unplugged));
        *document = changed;
        Ok(())
    }
}

impl Canvas {
    /// How a port is drawn while a wire is.
    pub(super) fn port_look(&self, port: &PortShape) -> PortLook {
        let Gesture::Connect(drawing) = &self.gesture else { return PortLook::Plain };
        let Some(fixed) = self.scene.port(&drawing.fixed) else { return PortLook::Plain };
        if port.port == drawing.fixed {
            return PortLook::Hot;
        }
        if !drawing.fits(fixed, port) {
            return PortLook::Dim;
        }
        let is_near = port.at.distance(self.view.to_canvas(self.pointer)) * self.view.zoom <= REACH;
        if is_near { PortLook::Hot } else { PortLook::Plain }
    }

    /// The port of a node that takes the wire when it is dropped on the node: an empty one before others.
    fn best_port<'a>(&self, drawing: &Drawing, node: &'a NodeShape) -> Option<&'a PortShape> {
        let fixed = self.scene.port(&drawing.fixed)?;
        let fitting = node.ports.iter().filter(|port| drawing.fits(fixed, port));
        fitting.min_by_key(|port| port.is_wired && !port.many)
    }

    /// Ends a wire where the pointer is.
    pub(super) fn drop_wire(&mut self, ui: &egui::Ui, drawing: Drawing, desk: &mut Desk) {
        let scene = self.scene.clone();
        let at = self.view.to_canvas(self.pointer);
        let port = scene.port_at(at, REACH / self.view.zoom).map(|port| &port.port);
        let port = match (port, scene.node_at(at).or_else(|| scene.edge_at(at))) {
            (Some(port), _) => port,
            (None, Some(node)) => match self.best_port(&drawing, node) {
                Some(port) => &port.port,
                None if node.name == drawing.fixed.end.node => return,
                None => {
                    let kind = scene.port(&drawing.fixed).and_then(|port| port.kind);
                    let kind = kind.map(|kind| kind.to_string()).unwrap_or_default();
                    let verb = if drawing.fixed.side == Side::Output { "takes" } else { "gives" };
                    return self.tell(ui, format!("nothing of {} {verb} {kind}", node.name));
                }
            },
            (None, None) => {
                match drawing.unplugged {
                    Some(wire) => super::command::unplug(desk, &wire),
                    None if drawing.fixed.is_new() => {}
                    None => self.open_search(Purpose::Connect(drawing.fixed)),
                }
                return;
            }
        };
        // Back where it was.
        if *port == drawing.fixed || drawing.unplugged.as_ref().is_some_and(|wire| wire.to == port.end) {
            return;
        }
        let Some(wire) = drawing.wire_to(port) else {
            let other = if port.side == Side::Output { "an input" } else { "an output" };
            return self.tell(ui, format!("{} goes to {other}", port.label()));
        };
        if let Some(reason) = scene.port(port).and_then(|port| self.misfit(&drawing, port)) {
            return self.tell(ui, reason);
        }
        let label = if drawing.fixed.is_new() || port.is_new() { "Add a port" } else { "Connect" };
        if let Err(reason) = desk.wire(label, |document| drawing.connect(document, wire)) {
            self.tell(ui, reason);
        }
    }

    /// The wire that is being drawn, the box, and why a wire does not fit where the pointer is.
    pub(super) fn drawing(&self, ui: &egui::Ui, brush: &Brush, desk: &Desk) {
        match &self.gesture {
            Gesture::Box { from, .. } => {
                let rect = egui::Rect::from_two_pos(brush.view.to_screen(*from), self.pointer);
                brush.painter.rect(
                    rect,
                    2.0,
                    brush.theme.accent.gamma_multiply(0.12),
                    egui::Stroke::new(1.0, brush.theme.accent),
                    egui::StrokeKind::Middle,
                );
            }
            Gesture::Connect(drawing) => {
                let Some(fixed) = self.scene.port(&drawing.fixed) else { return };
                let at = self.view.to_canvas(self.pointer);
                let target = self.scene.port_at(at, REACH / self.view.zoom);
                let target = target.filter(|port| port.port != drawing.fixed);
                let fits = target.filter(|port| drawing.fits(fixed, port));
                let start = self.view.to_screen(fixed.at);
                let end = fits.map_or(self.pointer, |port| self.view.to_screen(port.at));
                let points = if drawing.fixed.side == Side::Output { [start, end] } else { [end, start] };
                brush.curve(&points, (2.5 * self.view.zoom).max(1.5), brush.theme.port(fixed.kind));
                if let Some(reason) = target.and_then(|target| self.why_not(drawing, target, desk)) {
                    self.beside_pointer(ui, brush, &reason);
                }
                ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
            }
            _ => {}
        }
    }

    /// Why what a port carries is not what the wire carries.
    fn misfit(&self, drawing: &Drawing, target: &PortShape) -> Option<String> {
        let (fixed, kind) = self.scene.port(&drawing.fixed)?.kind.zip(target.kind)?;
        let verb = if target.port.side == Side::Input { "takes" } else { "gives" };
        (fixed != kind).then(|| format!("{} {verb} {kind}, not {fixed}", target.port.end))
    }

    /// Why the wire that is drawn may not end at a port; nothing of a port of the same side, where it cannot.
    fn why_not(&self, drawing: &Drawing, target: &PortShape, desk: &Desk) -> Option<String> {
        let wire = drawing.wire_to(&target.port)?;
        let refusal = || desk.refusal(|document| drawing.connect(document, wire));
        self.misfit(drawing, target).or_else(refusal)
    }

    fn beside_pointer(&self, ui: &egui::Ui, brush: &Brush, text: &str) {
        let at = self.pointer + egui::vec2(14.0, 18.0);
        let place = brush.painter.add(egui::Shape::Noop);
        let rect = brush.text(at, Align2::LEFT_TOP, text, 12.0, brush.theme.text, 480.0);
        let rect = rect.expand2(egui::vec2(8.0, 5.0));
        brush.painter.set(place, egui::Shape::rect_filled(rect, 5.0, ui.visuals().window_fill));
        let edge = egui::Stroke::new(1.0, brush.theme.bad);
        brush.painter.rect_stroke(rect, 5.0, edge, egui::StrokeKind::Inside);
    }
}
