//! The ports of the opened group, beside what it holds: its inputs at the left, its outputs at the right.
//!
//! Seen from inside, an input of the group gives and an output takes, so both are drawn as panels with ports of
//! the other side. A wire at them is no wire of the document but what a port stands for ([`Document::lead`]);
//! the last port of a panel is not there yet, and a wire to it makes it ([`Document::expose`]). Tested by
//! gestures in `tests::ports`.

use egui::{Align2, CornerRadius, Pos2, Rect, Stroke, StrokeKind, vec2};

use super::Canvas;
use super::desk::Desk;
use super::paint::Brush;
use super::scene::{HEADER, NodeShape, PAD, Port, PortShape, ROW};
use crate::graph::{Document, End, PortSpec, PortType, Side, Wire};
use crate::nodes::catalog;

/// In place of a node's name, which cannot have spaces.
const INPUTS: &str = "inputs of the group";
const OUTPUTS: &str = "outputs of the group";
/// In place of a port's name, for the one that is not there yet.
const NEW: &str = "+";

const WIDTH: f32 = 128.0;
/// Between a panel and the nodes.
const GAP: f32 = 64.0;

impl Port {
    /// The port of the opened group that it is from inside; an empty name for the one that is not there yet.
    pub fn of_opened(&self) -> Option<(Side, &str)> {
        let side = match self.end.node.as_str() {
            INPUTS => Side::Input,
            OUTPUTS => Side::Output,
            _ => return None,
        };
        Some((side, if self.end.port == NEW { "" } else { &self.end.port }))
    }

    /// Whether a wire there makes a port.
    pub fn is_new(&self) -> bool {
        self.of_opened().is_some_and(|(_, port)| port.is_empty())
    }
}

/// Which side of the group a wire's end is: none for a wire of the document.
fn side_of(wire: &Wire) -> Option<Side> {
    match (wire.from.node.as_str(), wire.to.node.as_str()) {
        (INPUTS, _) => Some(Side::Input),
        (_, OUTPUTS) => Some(Side::Output),
        _ => None,
    }
}

/// Whether it is what a port of the group stands for.
pub fn is_link(wire: &Wire) -> bool {
    side_of(wire).is_some()
}

/// What the ports of a group stand for, as wires.
pub fn links(document: &Document) -> impl Iterator<Item = Wire> {
    let inputs = document.inputs.iter().flat_map(|(port, ends)| {
        ends.iter().map(|end| Wire { from: End::new(INPUTS, port), to: end.clone() })
    });
    let outputs = document.outputs.iter();
    inputs.chain(outputs.map(|(port, end)| Wire { from: end.clone(), to: End::new(OUTPUTS, port) }))
}

/// The last link to an input of a node, as a wire.
pub fn link_to(document: &Document, end: &End) -> Option<Wire> {
    links(document).filter(|wire| wire.to == *end).last()
}

/// Whether two ports of the panels are meant, which no wire joins.
pub fn are_both(a: &Port, b: &Port) -> bool {
    a.of_opened().is_some() && b.of_opened().is_some()
}

/// What a port of a node or of the opened group carries.
pub fn kind_of(document: &Document, port: &Port) -> Option<PortType> {
    spec_of(document, port).map(|spec| spec.kind)
}

fn spec_of(document: &Document, port: &Port) -> Option<PortSpec> {
    match (port.of_opened(), port.side) {
        (Some((Side::Input, name)), _) => document.input(catalog(), document.inputs.get(name)?.first()?),
        (Some((Side::Output, name)), _) => document.output(catalog(), document.outputs.get(name)?),
        (None, Side::Input) => document.input(catalog(), &port.end),
        (None, Side::Output) => document.output(catalog(), &port.end),
    }
}

/// Wires two ports, of which one may be the group's.
///
/// # Errors
/// Those of [`Document::connect`], [`Document::expose`] and [`Document::lead`].
pub fn connect(document: &mut Document, wire: Wire) -> Result<(), String> {
    let Some(side) = side_of(&wire) else { return document.connect(catalog(), wire) };
    let (port, end) = match side {
        Side::Input => (wire.from, wire.to),
        Side::Output => (wire.to, wire.from),
    };
    if [INPUTS, OUTPUTS].contains(&end.node.as_str()) {
        return Err("an input of the group leads to a node of it; put one between".to_owned());
    }
    match port.port.as_str() {
        NEW => document.expose(catalog(), side, &end).map(drop),
        name => document.lead(catalog(), side, name, &end),
    }
}

/// Takes back what [`connect`] did.
pub fn disconnect(document: &mut Document, wire: &Wire) {
    match side_of(wire) {
        None => document.disconnect(wire),
        Some(Side::Input) => document.unlead(Side::Input, &wire.from.port, &wire.to),
        Some(Side::Output) => document.unlead(Side::Output, &wire.to.port, &wire.from),
    };
}

/// The panels beside what covers `bounds`.
pub fn panels(document: &Document, bounds: Rect) -> Vec<NodeShape> {
    let center = if bounds.is_positive() { bounds.center() } else { Pos2::ZERO };
    let half = if bounds.is_positive() { bounds.width() / 2.0 } else { 0.0 };
    [Side::Input, Side::Output].map(|side| panel(document, side, center, half + GAP)).into()
}

/// The panel of a side, its inner edge `away` from the middle.
fn panel(document: &Document, side: Side, center: Pos2, away: f32) -> NodeShape {
    let (name, own_side, names): (_, _, Vec<&String>) = match side {
        Side::Input => (INPUTS, Side::Output, document.inputs.keys().collect()),
        Side::Output => (OUTPUTS, Side::Input, document.outputs.keys().collect()),
    };
    let size = vec2(WIDTH, HEADER + (names.len() + 1) as f32 * ROW + 2.0 * PAD);
    let left = if side == Side::Input { center.x - away - WIDTH } else { center.x + away };
    let rect = Rect::from_min_size(Pos2::new(left, center.y - size.y / 2.0), size);
    let x = if side == Side::Input { rect.right() } else { rect.left() };
    let names = names.into_iter().map(String::as_str).chain([NEW]).enumerate();
    let ports = names.map(|(row, port)| {
        let port = Port { end: End::new(name, port), side: own_side };
        let spec = spec_of(document, &port);
        let doc = match (&spec, port.is_new()) {
            (_, true) => "a wire to here makes it a port of the group".to_owned(),
            (Some(spec), _) => spec.doc.to_owned(),
            (None, _) => "what it stands for is not there; remove it".to_owned(),
        };
        PortShape {
            beside: None,
            kind: spec.map(|spec| spec.kind),
            many: false,
            doc,
            at: Pos2::new(x, rect.top() + HEADER + PAD + (row as f32 + 0.5) * ROW),
            is_wired: !port.is_new(),
            is_required: false,
            port,
        }
    });
    let ports = ports.collect();
    NodeShape { name: name.to_owned(), rect, ports, ..NodeShape::default() }
}

impl Canvas {
    /// Draws the panels.
    pub(super) fn edges(&mut self, ui: &egui::Ui, brush: &Brush, desk: &mut Desk) {
        let scene = self.scene.clone();
        let zoom = brush.view.zoom;
        for panel in &scene.edges {
            let rect = brush.view.rect_to_screen(panel.rect);
            if !rect.expand(16.0).intersects(brush.painter.clip_rect()) {
                continue;
            }
            let corners = CornerRadius::same((7.0 * zoom).round().clamp(1.0, 16.0) as u8);
            let stroke = Stroke::new(1.0, brush.theme.weak.gamma_multiply(0.5));
            let fill = brush.theme.node.gamma_multiply(0.5);
            brush.painter.rect(rect, corners, fill, stroke, StrokeKind::Inside);
            let title = if panel.name == INPUTS { "inputs" } else { "outputs" };
            let at = Pos2::new(rect.center().x, rect.top() + HEADER / 2.0 * zoom);
            let size = (12.0 * zoom).max(9.0);
            brush.text(at, Align2::CENTER_CENTER, title, size, brush.theme.weak, rect.width());
            for port in &panel.ports {
                let look = self.port_look(port);
                brush.port(port, look);
                self.port(ui, brush, port, desk);
            }
        }
    }
}
