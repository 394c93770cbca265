//! Wires: which fit, and what comes and goes with them.

use std::collections::HashSet;

use super::no_node;
use crate::graph::check::fit;
use crate::graph::document::{Document, End, Wire};
use crate::graph::flat::expand;
use crate::graph::ports::{Port, Side};
use crate::graph::spec::Catalog;

impl Document {
    /// Whether a wire may lead from an output to an input, whatever is wired to that now.
    ///
    /// # Errors
    /// Says what is allowed: an end that is not there, types that do not fit, a cycle.
    pub fn fits(&self, catalog: Catalog, from: &End, to: &End) -> Result<(), String> {
        for End { node, .. } in [from, to] {
            if !self.nodes.contains_key(node) {
                return Err(no_node(self, node));
            }
        }
        let wire = Wire { from: from.clone(), to: to.clone() };
        fit(self, catalog, &wire)?;
        match self.cycle_by(&wire) {
            None => Ok(()),
            Some(cycle) => Err(format!(
                "'{wire}' would close the cycle {}; wire it from a node that does not read '{}'",
                cycle.join(" -> "),
                wire.to.node
            )),
        }
    }

    /// Adds a wire. What is wired to an input that takes one goes; of an input that takes many nothing does.
    ///
    /// # Errors
    /// Those of [`Self::fits`]; the document is then as it was.
    pub fn connect(&mut self, catalog: Catalog, wire: Wire) -> Result<(), String> {
        self.fits(catalog, &wire.from, &wire.to)?;
        if self.wires.contains(&wire) {
            return Ok(());
        }
        let takes_many = self.input(catalog, &wire.to).is_none_or(|port| port.many);
        if !takes_many {
            self.wires.retain(|other| other.to != wire.to);
            self.drop_bends();
            self.forget_input(&wire.to);
        }
        self.wires.push(wire);
        Ok(())
    }

    /// Removes a wire with its bends; whether it was there.
    pub fn disconnect(&mut self, wire: &Wire) -> bool {
        let n_wires = self.wires.len();
        self.wires.retain(|other| other != wire);
        self.bends.shift_remove(wire);
        self.wires.len() < n_wires
    }

    /// Leads a wire through a node: by its first input of the wire's type that is empty or takes many, and its
    /// first output of that type. Both take the wire's place in the order.
    ///
    /// # Errors
    /// Where the wire is not there, the node has no such ports, or a cycle would come to be; the document is
    /// then as it was.
    pub fn insert_on(&mut self, catalog: Catalog, wire: &Wire, name: &str) -> Result<(), String> {
        let Some(at) = self.wires.iter().position(|other| other == wire) else {
            return Err(format!("there is no wire '{wire}'"));
        };
        let node = self.nodes.get(name).ok_or_else(|| no_node(self, name))?;
        let Some(kind) = self.output(catalog, &wire.from).map(|port| port.kind) else {
            return Err(format!("nothing is known of what goes through '{wire}'"));
        };
        let end = |port: &str| End { node: name.to_owned(), port: port.to_owned() };
        let is_empty = |end: End| {
            self.wires.iter().all(|other| other.to != end) && self.group_port_of(Side::Input, &end).is_none()
        };
        let is_open = |port: &Port| port.spec.kind == kind && (port.spec.many || is_empty(end(port.name)));
        let input = node.inputs(catalog).unwrap_or_default().into_iter().find(is_open);
        let output =
            node.outputs(catalog).unwrap_or_default().into_iter().find(|port| port.spec.kind == kind);
        let (Some(input), Some(output)) = (input, output) else {
            return Err(format!(
                "'{name}' does not fit on '{wire}'; it takes a node with an empty input and an output for {kind}"
            ));
        };
        let before = Wire { from: wire.from.clone(), to: end(input.name) };
        let after = Wire { from: end(output.name), to: wire.to.clone() };
        let mut changed = self.clone();
        changed.wires.remove(at);
        changed.fits(catalog, &before.from, &before.to)?;
        changed.wires.insert(at, before);
        changed.fits(catalog, &after.from, &after.to)?;
        changed.wires.insert(at + 1, after);
        changed.drop_bends();
        *self = changed;
        Ok(())
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

    /// The cycle that a wire would close, of nodes as they are without groups, from its reader to it again.
    fn cycle_by(&self, wire: &Wire) -> Option<Vec<String>> {
        let mut before = self.clone();
        before.wires.retain(|other| other != wire);
        let mut after = before.clone();
        after.wires.push(wire.clone());
        closed_cycle(&before, &after)
    }
}

/// The cycle that what one document has wired and the other has not closes, of nodes as they are without groups,
/// from the reader of a new wire to it again.
pub(super) fn closed_cycle(before: &Document, after: &Document) -> Option<Vec<String>> {
    let old: HashSet<Wire> = expand(before, |_| true).wires.into_iter().collect();
    let flat = expand(after, |_| true);
    flat.wires.iter().filter(|wire| !old.contains(wire)).find_map(|new| {
        // Against the wires from the giver on, until the reader is met; each node keeps who led to it.
        let mut paths = vec![vec![new.from.node.as_str()]];
        let mut seen = HashSet::from([new.from.node.as_str()]);
        while let Some(path) = paths.pop() {
            let here = path[path.len() - 1];
            if here == new.to.node {
                let cycle = std::iter::once(here).chain(path.iter().rev().skip(1).copied());
                return Some(cycle.chain([here]).map(str::to_owned).collect());
            }
            for read in flat.wires.iter().filter(|other| other.to.node == here) {
                if seen.insert(&read.from.node) {
                    paths.push([path.as_slice(), &[&read.from.node]].concat());
                }
            }
        }
        None
    })
}

#[cfg(test)]
mod tests;
