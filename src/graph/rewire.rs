//! Changes of wires and nodes that keep a graph one that can run, or say why not.
//!
//! Each is a gesture of the editor as a change of the document: connect, unplug, insert on a wire, remove,
//! copy out and paste in. What is refused leaves the document as it was. Tested by documents before and
//! after, and by the exact text of every refusal.

use std::collections::HashSet;

use indexmap::IndexMap;

use super::document::{Document, End, Wire};
use super::spec::{Catalog, PortSpec};

impl Document {
    /// Why no wire may lead from the output `from` to the input `to`: the ports are not there, they carry
    /// different things, or the wire would close a cycle.
    ///
    /// # Errors
    /// The reason, in a line.
    pub fn fits(&self, catalog: Catalog, from: &End, to: &End) -> Result<(), String> {
        let output = self.output_port(catalog, from)?;
        let input = self.input_port(catalog, to)?;
        if input.kind != output.kind {
            return Err(format!("{to} takes {}, not {}", input.kind, output.kind));
        }
        if let Some(path) = self.path(&to.node, &from.node) {
            let cycle = path.join(" -> ");
            return Err(format!(
                "{to} cannot read {from}: the wire would close the cycle {cycle} -> {}",
                to.node
            ));
        }
        Ok(())
    }

    /// Adds a wire. An input that takes one loses the one that it had; one that takes many gets it last.
    ///
    /// # Errors
    /// Those of [`Document::fits`].
    pub fn connect(&mut self, catalog: Catalog, wire: Wire) -> Result<(), String> {
        self.fits(catalog, &wire.from, &wire.to)?;
        if self.wires.contains(&wire) {
            return Ok(());
        }
        if !self.input_port(catalog, &wire.to)?.many {
            self.wires.retain(|other| other.to != wire.to);
        }
        self.wires.push(wire);
        Ok(())
    }

    /// Leads a wire through a node: by its first input that fits and is empty, and its first output that
    /// fits the wire's end.
    ///
    /// # Errors
    /// Says what the node lacks.
    pub fn insert_on(&mut self, catalog: Catalog, wire: &Wire, name: &str) -> Result<(), String> {
        let kind = self.output_port(catalog, &wire.from)?.kind;
        let type_id = self.nodes.get(name).map(|node| node.type_id.as_str()).unwrap_or_default();
        let spec = catalog.find(type_id).ok_or_else(|| format!("nothing is known of the ports of {name}"))?;
        let end = |port: &PortSpec| End { node: name.to_owned(), port: port.name.to_owned() };
        let is_empty = |port: &&PortSpec| port.many || self.wires.iter().all(|other| other.to != end(port));
        let input = spec.inputs.iter().filter(|port| port.kind == kind).find(is_empty);
        let input = input.ok_or_else(|| format!("{name} has no empty input for {kind}"))?;
        let output = spec.outputs.iter().find(|port| port.kind == kind);
        let output = output.ok_or_else(|| format!("{name} gives no {kind}"))?;
        let mut changed = self.clone();
        let place = changed.wires.iter().position(|other| other == wire);
        let place = place.ok_or_else(|| format!("there is no wire {wire}"))?;
        changed.wires.remove(place);
        changed.fits(catalog, &wire.from, &end(input))?;
        changed.fits(catalog, &end(output), &wire.to)?;
        // The new end stands where the old one did, because the order of a port that takes many counts.
        changed.wires.insert(place, Wire { from: end(output), to: wire.to.clone() });
        changed.wires.insert(place, Wire { from: wire.from.clone(), to: end(input) });
        *self = changed;
        Ok(())
    }

    /// Removes nodes, with their wires and places.
    pub fn remove(&mut self, names: &[String]) {
        let is_gone = |name: &String| names.contains(name);
        self.nodes.retain(|name, _| !is_gone(name));
        self.layout.retain(|name, _| !is_gone(name));
        self.wires.retain(|wire| !is_gone(&wire.from.node) && !is_gone(&wire.to.node));
    }

    /// These nodes with the wires among them and their places, as a graph of their own.
    pub fn part(&self, names: &[String]) -> Document {
        let mut part = Document { base: self.base.clone(), ..self.clone() };
        let others: Vec<String> = self.nodes.keys().filter(|name| !names.contains(name)).cloned().collect();
        part.remove(&others);
        part.about.clear();
        part
    }

    /// Adds the nodes of another graph, moved by `offset` points, under names that are free, and says which.
    pub fn paste(&mut self, part: &Document, offset: [f64; 2]) -> Vec<String> {
        let mut names: IndexMap<&str, String> = IndexMap::new();
        for (name, node) in &part.nodes {
            let free = self.free_name(name);
            self.nodes.insert(free.clone(), node.clone());
            let [x, y] = part.layout.get(name).copied().unwrap_or_default();
            self.layout.insert(free.clone(), [x + offset[0], y + offset[1]]);
            names.insert(name, free);
        }
        let end = |end: &End| {
            let node = names.get(end.node.as_str())?.clone();
            Some(End { node, port: end.port.clone() })
        };
        let wires = part.wires.iter();
        self.wires.extend(wires.filter_map(|wire| Some(Wire { from: end(&wire.from)?, to: end(&wire.to)? })));
        names.into_values().collect()
    }

    /// The nodes that read `start`, directly or not, and `start` itself.
    pub fn downstream(&self, start: &str) -> HashSet<String> {
        self.walk(start, |wire| (&wire.from.node, &wire.to.node))
    }

    /// The nodes that `start` reads, directly or not, and `start` itself.
    pub fn upstream(&self, start: &str) -> HashSet<String> {
        self.walk(start, |wire| (&wire.to.node, &wire.from.node))
    }

    fn walk(&self, start: &str, step: fn(&Wire) -> (&String, &String)) -> HashSet<String> {
        let mut found = HashSet::from([start.to_owned()]);
        let mut stack = vec![start.to_owned()];
        while let Some(here) = stack.pop() {
            for (_, next) in self.wires.iter().map(step).filter(|(at, _)| **at == here) {
                if found.insert(next.clone()) {
                    stack.push(next.clone());
                }
            }
        }
        found
    }

    /// A path along the wires, with both ends; one name where they are the same.
    fn path(&self, from: &str, to: &str) -> Option<Vec<String>> {
        let reaching = self.upstream(to);
        let mut path = vec![from.to_owned()];
        let mut here = from;
        while here != to {
            let next = self.wires.iter().find(|wire| {
                wire.from.node == here && reaching.contains(&wire.to.node) && !path.contains(&wire.to.node)
            })?;
            here = &next.to.node;
            path.push(here.to_owned());
        }
        Some(path)
    }

    fn output_port(&self, catalog: Catalog, end: &End) -> Result<PortSpec, String> {
        let node = self.nodes.get(&end.node).ok_or_else(|| format!("there is no node {}", end.node))?;
        let spec = catalog.find(&node.type_id);
        let spec = spec.ok_or_else(|| format!("the type '{}' of {} is unknown", node.type_id, end.node))?;
        let found = spec.output(&end.port).map(|(_, port)| *port);
        found.ok_or_else(|| format!("{} gives no output '{}'", end.node, end.port))
    }

    fn input_port(&self, catalog: Catalog, end: &End) -> Result<PortSpec, String> {
        let node = self.nodes.get(&end.node).ok_or_else(|| format!("there is no node {}", end.node))?;
        let spec = catalog.find(&node.type_id);
        let spec = spec.ok_or_else(|| format!("the type '{}' of {} is unknown", node.type_id, end.node))?;
        spec.input(&end.port).copied().ok_or_else(|| format!("{} takes no input '{}'", end.node, end.port))
    }
}

#[cfg(test)]
mod tests;
