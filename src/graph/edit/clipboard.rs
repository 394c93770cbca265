//! Nodes as text, for the clipboard: a graph of their own, with the wires, bends and places among them.

use std::path::Path;

use super::no_node;
use crate::graph::document::{Document, DocumentError, End, Node, Wire};
use crate::graph::spec::Catalog;

impl Document {
    /// The nodes of these names as text, in the order of the document. Relative paths are made absolute, so
    /// that they lead to the same files wherever the text is pasted.
    pub fn copy(&self, catalog: Catalog, names: &[String]) -> String {
        let mut part = self.part(names);
        part.rebase(catalog, Path::new(""));
        part.to_json()
    }

    /// Adds the nodes of a text that [`Self::copy`] gave, moved by `offset`, and gives their names.
    ///
    /// # Errors
    /// Where the text is no graph; the document is then as it was.
    pub fn paste_text(
        &mut self,
        catalog: Catalog,
        text: &str,
        offset: [f64; 2],
    ) -> Result<Vec<String>, DocumentError> {
        let mut part = Document::parse(text, Path::new(""))?;
        part.rebase(catalog, &self.base);
        Ok(self.paste(&part, offset))
    }

    /// Adds a preset as one group under a free name like `like`, and gives the name. Its relative paths lead
    /// to the same files from here.
    pub fn insert_preset(&mut self, catalog: Catalog, preset: &Document, like: &str, at: [f64; 2]) -> String {
        let mut inside = preset.clone();
        inside.rebase(catalog, &self.base);
        (inside.base, inside.frame) = Default::default();
        self.add_node(like, Node::group(inside), at)
    }

    /// Copies nodes in place, moved by `offset`, and gives the names of the copies. Wires from other nodes
    /// go to the copies too.
    ///
    /// # Errors
    /// Where there is no such node.
    pub fn duplicate(&mut self, names: &[String], offset: [f64; 2]) -> Result<Vec<String>, String> {
        if let Some(missing) = names.iter().find(|name| !self.nodes.contains_key(*name)) {
            return Err(no_node(self, missing));
        }
        let part = self.part(names);
        let originals: Vec<String> = part.nodes.keys().cloned().collect();
        let copies = self.paste(&part, offset);
        let from_outside = self.wires.iter().filter_map(|wire| {
            let at = originals.iter().position(|name| *name == wire.to.node)?;
            let is_outside = !originals.contains(&wire.from.node);
            let to = End { node: copies[at].clone(), port: wire.to.port.clone() };
            is_outside.then(|| Wire { from: wire.from.clone(), to })
        });
        let from_outside: Vec<Wire> = from_outside.collect();
        self.wires.extend(from_outside);
        Ok(copies)
    }

    /// These nodes with what is among them, as a graph of their own.
    pub fn part(&self, names: &[String]) -> Document {
        let is_in = |name: &String| names.contains(name);
        let inside = |wire: &Wire| is_in(&wire.from.node) && is_in(&wire.to.node);
        let nodes = self.nodes.iter().filter(|(name, _)| is_in(name));
        let layout = self.layout.iter().filter(|(name, _)| is_in(name));
        let bends = self.bends.iter().filter(|(wire, _)| inside(wire));
        Document {
            nodes: nodes.map(|(name, node)| (name.clone(), node.clone())).collect(),
            wires: self.wires.iter().filter(|wire| inside(wire)).cloned().collect(),
            layout: layout.map(|(name, at)| (name.clone(), *at)).collect(),
            bends: bends.map(|(wire, points)| (wire.clone(), points.clone())).collect(),
            base: self.base.clone(),
            ..Document::default()
        }
    }

    /// Adds what another graph holds, moved by `offset` points, under names that are free, and says which. Its
    /// ports as a group are left out.
    pub fn paste(&mut self, part: &Document, [dx, dy]: [f64; 2]) -> Vec<String> {
        let mut part = part.clone();
        let mut names: Vec<String> = Vec::new();
        for name in part.nodes.keys() {
            names.push(self.free_name_beside(name, &names));
        }
        let olds: Vec<String> = part.nodes.keys().cloned().collect();
        let new = |old: &str| olds.iter().position(|name| name == old).map(|at| names[at].clone());
        part.map_ends(|end| end.node = new(&end.node).unwrap_or_else(|| end.node.clone()));
        let moved = |[x, y]: [f64; 2]| [x + dx, y + dy];
        let is_known = |end: &End| names.contains(&end.node);
        self.wires.extend(part.wires.into_iter().filter(|wire| is_known(&wire.from) && is_known(&wire.to)));
        let bends = part.bends.into_iter();
        self.bends.extend(bends.map(|(wire, points)| (wire, points.into_iter().map(moved).collect())));
        let layout = part.layout.into_iter().filter_map(|(old, at)| Some((new(&old)?, moved(at))));
        self.layout.extend(layout.collect::<Vec<_>>());
        self.frames.extend(part.frames.into_iter().map(|mut frame| {
            frame.at = moved(frame.at);
            frame
        }));
        self.nodes.extend(names.iter().cloned().zip(part.nodes.into_values()));
        names
    }
}
