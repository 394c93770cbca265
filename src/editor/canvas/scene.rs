//! Where everything stands: nodes, ports and wires in points of the canvas, made from the document.
//!
//! Derived anew whenever the document changes, and never changed itself. A node without a place in the
//! document gets one from [`layered`]: all of them in a document without layout, else below what has one.
//! Wires are cubics that leave an output and reach an input level. Tested by ports inside of their nodes,
//! by what is found at a point, and by wires that pass through their ends.

use std::collections::HashMap;

use egui::{Pos2, Rect, Vec2, pos2, vec2};

use super::edge;
use crate::graph::layout::layered;
use crate::graph::{
    Catalog, Category, Document, End, Node, NodeSpec, ParamKind, PortSpec, PortType, Side, Wire,
};

pub const WIDTH: f32 = 184.0;
/// Of a header; of the second line in it that tells the type of a node that has another name.
pub const HEADER: f32 = 27.0;
pub const SUBTITLE: f32 = 15.0;
pub const ROW: f32 = 20.0;
pub const FOOTER: f32 = 20.0;
pub const THUMBNAIL: f32 = 92.0;
pub const PAD: f32 = 5.0;

/// The canvas' points of everything.
#[derive(Debug, Default)]
pub struct Scene {
    pub nodes: Vec<NodeShape>,
    /// Inside of a group, the panels of its ports.
    pub edges: Vec<NodeShape>,
    pub wires: Vec<WireShape>,
    by_name: HashMap<String, usize>,
}

/// A node.
#[derive(Debug)]
pub struct NodeShape {
    pub name: String,
    pub type_id: String,
    pub category: Option<Category>,
    pub is_group: bool,
    /// There is room for its picture.
    pub has_picture: bool,
    pub mute: bool,
    pub bypass: bool,
    pub rect: Rect,
    pub header: f32,
    pub ports: Vec<PortShape>,
}

/// A port.
#[derive(Debug, Clone)]
pub struct PortShape {
    pub port: Port,
    /// None for one that only a wire names.
    pub kind: Option<PortType>,
    pub many: bool,
    pub doc: String,
    pub at: Pos2,
    /// Name of the port of the other side in the same row, which shares the row's width.
    pub beside: Option<String>,
    pub is_wired: bool,
    /// An input that must not stay empty.
    pub is_required: bool,
}

/// Which port.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Port {
    pub end: End,
    pub side: Side,
}

/// A wire.
#[derive(Debug)]
pub struct WireShape {
    pub wire: Wire,
    pub kind: Option<PortType>,
    /// From the output through its bends to the input.
    pub points: Vec<Pos2>,
}

impl Port {
    /// "input march.medium", "group input lights" or "new group input", for AccessKit.
    pub fn label(&self) -> String {
        match self.of_opened() {
            Some((side, "")) => format!("new group {side}"),
            Some((side, port)) => format!("group {side} {port}"),
            None => format!("{} {}", self.side, self.end),
        }
    }
}

impl NodeShape {
    pub fn port(&self, port: &Port) -> Option<&PortShape> {
        self.ports.iter().find(|shape| shape.port == *port)
    }

    pub fn side(&self, side: Side) -> impl Iterator<Item = &PortShape> {
        self.ports.iter().filter(move |shape| shape.port.side == side)
    }
}

impl Scene {
    /// Of a document. A node that gives a picture has room for it from the start, so that nothing moves when the
    /// picture comes.
    pub fn new(document: &Document, catalog: Catalog) -> Self {
        let mut wired: HashMap<&str, Vec<&Wire>> = HashMap::new();
        for wire in &document.wires {
            wired.entry(&wire.from.node).or_default().push(wire);
            if wire.to.node != wire.from.node {
                wired.entry(&wire.to.node).or_default().push(wire);
            }
        }
        let mut nodes = Vec::with_capacity(document.nodes.len());
        for (name, node) in &document.nodes {
            let wires = wired.get(name.as_str()).map_or(&[][..], Vec::as_slice);
            let spec = catalog.find(&node.type_id);
            let mut shape = NodeShape {
                name: name.clone(),
                type_id: node.type_id.clone(),
                category: spec.map(|spec| spec.category),
                has_picture: spec.is_some_and(gives_picture),
                is_group: node.inside.is_some(),
                mute: node.mute,
                bypass: node.bypass,
                header: if node.type_id == *name { HEADER } else { HEADER + SUBTITLE },
                ..NodeShape::default()
            };
            shape.ports = ports(&shape, node, catalog, wires);
            let rows = [Side::Input, Side::Output].map(|side| shape.side(side).count());
            let picture = if shape.has_picture { THUMBNAIL } else { 0.0 };
            let height = shape.header + rows[0].max(rows[1]) as f32 * ROW + picture + FOOTER + 2.0 * PAD;
            shape.rect = Rect::from_min_size(Pos2::ZERO, vec2(WIDTH, height));
            nodes.push(shape);
        }
        let by_name = nodes.iter().enumerate().map(|(idx, node)| (node.name.clone(), idx)).collect();
        let mut scene = Self { nodes, by_name, ..Self::default() };
        scene.place(document);
        let bends = |wire| document.bends.get(wire).map_or(&[][..], Vec::as_slice);
        scene.wires = document.wires.iter().filter_map(|wire| scene.wire(wire, bends(wire))).collect();
        scene
    }

    /// With the ports of the group that the document is the inside of.
    pub fn with_edges(mut self, document: &Document) -> Self {
        self.edges = edge::panels(document, self.all_bounds());
        for link in edge::links(document) {
            let Some(shape) = self.wire(&link, &[]) else { continue };
            self.wires.push(shape);
            let ends =
                [Port { end: link.from, side: Side::Output }, Port { end: link.to, side: Side::Input }];
            let ports = self.nodes.iter_mut().flat_map(|node| &mut node.ports);
            ports.filter(|port| ends.contains(&port.port)).for_each(|port| port.is_wired = true);
        }
        self
    }

    pub fn node(&self, name: &str) -> Option<&NodeShape> {
        Some(&self.nodes[*self.by_name.get(name)?])
    }

    pub fn port(&self, port: &Port) -> Option<&PortShape> {
        let edge = || self.edges.iter().find(|edge| edge.name == port.end.node);
        self.node(&port.end.node).or_else(edge)?.port(port)
    }

    /// What all nodes, or those of these names, cover; nothing for none.
    pub fn bounds<'a>(&self, names: impl IntoIterator<Item = &'a String>) -> Rect {
        let rects = names.into_iter().filter_map(|name| self.node(name)).map(|node| node.rect);
        rects.fold(Rect::NOTHING, Rect::union)
    }

    pub fn all_bounds(&self) -> Rect {
        self.nodes.iter().chain(&self.edges).map(|node| node.rect).fold(Rect::NOTHING, Rect::union)
    }

    /// Where every node stands, for a document that is to keep it.
    pub fn places(&self) -> impl Iterator<Item = (&str, [f64; 2])> {
        self.nodes.iter().map(|node| (node.name.as_str(), [node.rect.min.x, node.rect.min.y].map(f64::from)))
    }

    pub fn node_at(&self, point: Pos2) -> Option<&NodeShape> {
        self.nodes.iter().rev().find(|node| node.rect.contains(point))
    }

    pub fn edge_at(&self, point: Pos2) -> Option<&NodeShape> {
        self.edges.iter().find(|edge| edge.rect.contains(point))
    }

    /// The port nearest to a point, within `reach`.
    pub fn port_at(&self, point: Pos2, reach: f32) -> Option<&PortShape> {
        let all = self.nodes.iter().chain(&self.edges);
        let ports = all.filter(|node| node.rect.expand(reach).contains(point));
        let ports = ports.flat_map(|node| &node.ports);
        let near = ports.map(|port| (port.at.distance(point), port)).filter(|(far, _)| *far <= reach);
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, port)| port)
    }

    /// The wire nearest to a point, within `reach`.
    pub fn wire_at(&self, point: Pos2, reach: f32) -> Option<&WireShape> {
        let near = self.wires.iter().filter(|wire| wire.bounds().expand(reach).contains(point));
        let near = near.map(|wire| (distance(&curve(&wire.points, 1.0, 24), point), wire));
        near.filter(|(far, _)| *far <= reach).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, wire)| wire)
    }

    /// The nearest node from `name` in a direction: what lies aside counts double, what lies behind not.
    pub fn next(&self, name: &str, direction: Vec2) -> Option<&NodeShape> {
        let here = self.node(name)?.rect.center();
        let far = |node: &&NodeShape| {
            let to = node.rect.center() - here;
            let along = to.dot(direction);
            let aside = (to - direction * along).length();
            (along > aside * 0.5 && along > 1.0).then_some(along + 2.0 * aside)
        };
        let others = self.nodes.iter().filter_map(|node| Some((far(&node)?, node)));
        others.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, node)| node)
    }

    fn wire(&self, wire: &Wire, bends: &[[f64; 2]]) -> Option<WireShape> {
        let from = self.port(&Port { end: wire.from.clone(), side: Side::Output })?;
        let to = self.port(&Port { end: wire.to.clone(), side: Side::Input })?;
        let bends = bends.iter().map(|[x, y]| pos2(*x as f32, *y as f32));
        let points = std::iter::once(from.at).chain(bends).chain([to.at]).collect();
        Some(WireShape { wire: wire.clone(), kind: from.kind.or(to.kind), points })
    }

    /// Moves every node to where it belongs.
    fn place(&mut self, document: &Document) {
        let missing: Vec<&str> = document.nodes.keys().map(String::as_str).collect();
        let missing: Vec<&str> =
            missing.into_iter().filter(|name| !document.layout.contains_key(*name)).collect();
        let mut places = document.layout.clone();
        if !missing.is_empty() {
            let size = |name: &str| self.node(name).map_or([0.0; 2], |node| size_of(node.rect));
            let placed = |(name, [_, y]): (&String, &[f64; 2])| y + size(name)[1];
            let below = document.layout.iter().map(placed).fold(f64::NEG_INFINITY, f64::max);
            let below = if below.is_finite() { below + 48.0 } else { 0.0 };
            let all = layered(document, size);
            for name in missing {
                let [x, y] = all[name];
                places.insert(name.to_owned(), [x, y + below]);
            }
        }
        for node in &mut self.nodes {
            let [x, y] = places[&node.name].map(|x| x as f32);
            let shift = vec2(x, y);
            node.rect = node.rect.translate(shift);
            for port in &mut node.ports {
                port.at += shift;
            }
        }
    }
}

/// Whether a node of this kind is run for a picture to look at: one that writes files is not.
fn gives_picture(spec: &NodeSpec) -> bool {
    let writes = spec.params.iter().any(|param| matches!(param.kind, ParamKind::OutPath));
    !writes && spec.outputs.iter().any(|port| port.kind == PortType::Image)
}

pub fn size_of(rect: Rect) -> [f64; 2] {
    [rect.width(), rect.height()].map(f64::from)
}

impl Default for NodeShape {
    fn default() -> Self {
        Self {
            name: String::new(),
            type_id: String::new(),
            category: None,
            is_group: false,
            has_picture: false,
            mute: false,
            bypass: false,
            rect: Rect::ZERO,
            header: HEADER,
            ports: Vec::new(),
        }
    }
}

/// Ports of a node at the origin: those of its kind, then those that only wires name.
fn ports(shape: &NodeShape, node: &Node, catalog: Catalog, wires: &[&Wire]) -> Vec<PortShape> {
    let mut found = Vec::new();
    for side in [Side::Input, Side::Output] {
        let own_end = |wire: &&Wire| match side {
            Side::Input => wire.to.clone(),
            Side::Output => wire.from.clone(),
        };
        let ends: Vec<End> = wires.iter().map(own_end).filter(|end| end.node == shape.name).collect();
        let specs = match side {
            Side::Input => node.inputs(catalog),
            Side::Output => node.outputs(catalog),
        };
        let mut row = 0;
        let mut push = |end: End, spec: Option<PortSpec>, found: &mut Vec<PortShape>| {
            let x = if side == Side::Input { 0.0 } else { WIDTH };
            found.push(PortShape {
                is_wired: ends.contains(&end),
                beside: None,
                port: Port { end, side },
                kind: spec.map(|spec| spec.kind),
                many: spec.is_some_and(|spec| spec.many),
                doc: spec.map_or("no such port; remove its wires".to_owned(), |spec| spec.doc.to_owned()),
                at: pos2(x, shape.header + PAD + (row as f32 + 0.5) * ROW),
                is_required: side == Side::Input && spec.is_some_and(|spec| spec.absent.is_none()),
            });
            row += 1;
        };
        for port in specs.unwrap_or_default() {
            push(End::new(&shape.name, port.name), Some(port.spec), &mut found);
        }
        for end in &ends {
            let is_known = found.iter().any(|port| port.port.side == side && port.port.end == *end);
            if !is_known {
                push(end.clone(), None, &mut found);
            }
        }
    }
    let n_inputs = found.iter().filter(|port| port.port.side == Side::Input).count();
    let (inputs, outputs) = found.split_at_mut(n_inputs);
    for (input, output) in inputs.iter_mut().zip(outputs) {
        input.beside = Some(output.port.end.port.clone());
        output.beside = Some(input.port.end.port.clone());
    }
    found
}

impl WireShape {
    /// "wire sun.light -> split.lights", for AccessKit.
    pub fn label(&self) -> String {
        format!("wire {}", self.wire)
    }

    /// Around the curve: a cubic lies inside of the hull of its control points.
    pub fn bounds(&self) -> Rect {
        let pairs = self.points.windows(2);
        let hulls = pairs.map(|pair| Rect::from_points(&controls(pair[0], pair[1], 1.0)));
        hulls.fold(Rect::NOTHING, Rect::union)
    }

    /// The middle of the curve.
    pub fn middle(&self) -> Pos2 {
        let curve = curve(&self.points, 1.0, 24);
        curve[curve.len() / 2]
    }
}

/// A cubic's four points between two places; `scale` is the zoom of their space.
fn controls(a: Pos2, b: Pos2, scale: f32) -> [Pos2; 4] {
    let (dx, dy) = (b.x - a.x, (b.y - a.y).abs());
    // A wire that leads back swings out as far as it must to be told from the node's edge.
    let reach = if dx >= 0.0 { dx * 0.5 } else { (-dx * 0.6).min(160.0 * scale) };
    let reach = reach.max((24.0 * scale).min(dy * 0.5 + dx.abs()));
    [a, a + vec2(reach, 0.0), b - vec2(reach, 0.0), b]
}

/// Points on a wire through `points`, `n` segments between each two.
pub fn curve(points: &[Pos2], scale: f32, n: usize) -> Vec<Pos2> {
    let mut found = Vec::with_capacity((points.len().max(1) - 1) * n + 1);
    found.extend(points.first());
    for pair in points.windows(2) {
        let [a, b, c, d] = controls(pair[0], pair[1], scale).map(Pos2::to_vec2);
        found.extend((1..=n).map(|i| {
            let t = i as f32 / n as f32;
            let s = 1.0 - t;
            (a * (s * s * s) + b * (3.0 * s * s * t) + c * (3.0 * s * t * t) + d * (t * t * t)).to_pos2()
        }));
    }
    found
}

/// From a point to a line of segments.
pub fn distance(line: &[Pos2], point: Pos2) -> f32 {
    let to_segment = |pair: &[Pos2]| {
        let (along, to) = (pair[1] - pair[0], point - pair[0]);
        let t = (to.dot(along) / along.length_sq().max(1e-12)).clamp(0.0, 1.0);
        (to - along * t).length()
    };
    line.windows(2).map(to_segment).fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests;
