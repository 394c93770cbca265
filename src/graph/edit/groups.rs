//! A selection becomes a group, and a group becomes nodes again; groups as documents of their own.
//!
//! The picture stays: a flat plan before and after has the same keys. Where an input that takes many has
//! wires from inside before wires from outside, that order is kept by leading the wires from inside out of
//! the group and in again, because those from outside come first otherwise.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use indexmap::IndexMap;

use super::no_node;
use crate::graph::document::{Document, End, Node, Wire, is_node_name};

impl Document {
    /// Makes a group of nodes, under a free name like `like`, and gives the name. Wires that cross its edge
    /// become its ports; inputs that read the same share one.
    ///
    /// # Errors
    /// Without nodes, where one of them is not there, or where `like` is no name.
    pub fn make_group(&mut self, names: &[String], like: &str) -> Result<String, String> {
        if names.is_empty() {
            return Err("nothing is selected; select the nodes of the group".to_owned());
        }
        if let Some(missing) = names.iter().find(|name| !self.nodes.contains_key(*name)) {
            return Err(no_node(self, missing));
        }
        if !is_node_name(like) {
            return Err(format!("'{like}' is no name of a node; write letters, digits, '_' and '-'"));
        }
        let is_in = |end: &End| names.contains(&end.node);
        let idx = self.nodes.get_index_of(&names[0]).expect("asked above");
        let first = names.iter().filter_map(|name| self.nodes.get_index_of(name)).min().unwrap_or(idx);
        let mut inside = self.part(names);
        let mut rest = self.clone();
        rest.nodes.retain(|name, _| !names.contains(name));
        let group = rest.free_name(like);
        let of_group = |port: String| End { node: group.clone(), port };
        let mut wires = Vec::new();
        let mut bends = IndexMap::new();
        for (at, wire) in self.wires.iter().enumerate() {
            let goes_around = is_in(&wire.from)
                && is_in(&wire.to)
                && self.wires[at + 1..].iter().any(|later| later.to == wire.to && !is_in(&later.from));
            if is_in(&wire.from) && is_in(&wire.to) && !goes_around {
                continue;
            }
            let mut new = wire.clone();
            if is_in(&wire.from) {
                new.from = of_group(port_of(&mut inside.outputs, &wire.from, wire.from.clone()));
            }
            if is_in(&wire.to) {
                new.to = of_group(port_of(&mut inside.inputs, &wire.to, vec![wire.to.clone()]));
            }
            if goes_around {
                inside.wires.retain(|inner| inner != wire);
                inside.drop_bends();
            } else if let Some(points) = self.bends.get(wire) {
                bends.insert(new.clone(), points.clone());
            }
            wires.push(new);
        }
        for end in rest.inputs.values_mut().flatten().filter(|end| is_in(end)) {
            *end = of_group(port_of(&mut inside.inputs, end, vec![end.clone()]));
        }
        for end in rest.outputs.values_mut().filter(|end| is_in(end)) {
            *end = of_group(port_of(&mut inside.outputs, end, end.clone()));
        }
        (rest.wires, rest.bends) = (wires, bends);
        join_inputs(&mut inside, &mut rest, &group);
        rest.layout.retain(|name, _| !names.contains(name));
        rest.layout.extend(middle(&inside).map(|at| (group.clone(), at)));
        let n_before = self.nodes.keys().take(first).filter(|name| !names.contains(name)).count();
        rest.nodes.shift_insert(n_before, group.clone(), Node::group(inside));
        *self = rest;
        Ok(group)
    }

    /// Puts what a group holds in its place, and gives the names of the nodes. Its nodes are muted where it
    /// is.
    ///
    /// # Errors
    /// Where it is no group, or bypassed: what it holds would run.
    pub fn ungroup(&mut self, name: &str) -> Result<Vec<String>, String> {
        let node = self.nodes.get(name).ok_or_else(|| no_node(self, name))?;
        let Some(inside) = node.inside.as_deref() else {
            return Err(format!("'{name}' is no group; it is a {}", node.type_id));
        };
        if node.bypass && !node.mute {
            return Err(format!("the group '{name}' is bypassed; take that back first"));
        }
        let mut inside = inside.clone();
        if node.mute {
            inside.nodes.values_mut().for_each(|node| node.mute = true);
        }
        let Document { inputs, outputs, .. } = inside.clone();
        (inside.inputs, inside.outputs) = Default::default();
        let idx = self.nodes.get_index_of(name).expect("found above");
        let mut rest = self.clone();
        let (wires, bends) = (std::mem::take(&mut rest.wires), std::mem::take(&mut rest.bends));
        let (group_inputs, group_outputs) =
            (std::mem::take(&mut rest.inputs), std::mem::take(&mut rest.outputs));
        rest.nodes.shift_remove(name);
        rest.layout.shift_remove(name);
        let olds: Vec<String> = inside.nodes.keys().cloned().collect();
        let offset = match (self.layout.get(name), middle(&inside)) {
            (Some(place), Some(middle)) => [place[0] - middle[0], place[1] - middle[1]],
            _ => [0.0; 2],
        };
        let n_nodes = rest.nodes.len();
        let names = rest.paste(&inside, offset);
        let inner_wires = std::mem::take(&mut rest.wires);
        // The nodes take the group's place in the order.
        for (at, _) in names.iter().enumerate() {
            rest.nodes.move_index(n_nodes + at, idx + at);
        }
        let new = |end: &End| {
            let at = olds.iter().position(|old| *old == end.node);
            End { node: at.map_or_else(|| end.node.clone(), |at| names[at].clone()), port: end.port.clone() }
        };
        let readers = |end: &End| match (end.node == name, inputs.get(&end.port)) {
            (true, Some(ends)) => ends.iter().map(new).collect(),
            (true, None) => Vec::new(),
            (false, _) => vec![end.clone()],
        };
        let giver = |end: &End| match (end.node == name, outputs.get(&end.port)) {
            (true, inner) => inner.map(new),
            (false, _) => Some(end.clone()),
        };
        for wire in wires {
            let Some(from) = giver(&wire.from) else {
                continue;
            };
            for to in readers(&wire.to) {
                let moved = Wire { from: from.clone(), to };
                if let Some(points) = bends.get(&wire) {
                    rest.bends.insert(moved.clone(), points.clone());
                }
                rest.wires.push(moved);
            }
        }
        rest.wires.extend(inner_wires);
        let of_ports =
            group_inputs.into_iter().map(|(port, ends)| (port, ends.iter().flat_map(readers).collect()));
        rest.inputs = of_ports.filter(|(_, ends): &(_, Vec<End>)| !ends.is_empty()).collect();
        rest.outputs =
            group_outputs.into_iter().filter_map(|(port, end)| Some((port, giver(&end)?))).collect();
        *self = rest;
        Ok(names)
    }

    /// What a group holds, as a graph of its own that keeps its ports.
    ///
    /// # Errors
    /// Where it is no group.
    pub fn preset_of(&self, name: &str) -> Result<Document, String> {
        let node = self.nodes.get(name).ok_or_else(|| no_node(self, name))?;
        let Some(inside) = node.inside.as_deref() else {
            return Err(format!("'{name}' is no group; group it first"));
        };
        Ok(inside.clone())
    }
}

/// The middle of the places of nodes, in whole points as people like to read them.
fn middle(document: &Document) -> Option<[f64; 2]> {
    let count = document.layout.len() as f64;
    let mean = |axis: usize| (document.layout.values().map(|at| at[axis]).sum::<f64>() / count).round();
    (count > 0.0).then(|| [mean(0), mean(1)])
}

/// Makes one port of a new group's inputs that read the same outputs in the same order, and are the same inputs of the
/// graph around: the first keeps its name. Of inputs that share a part of what they read each keeps its own.
fn join_inputs(inside: &mut Document, around: &mut Document, group: &str) {
    let mut known: HashMap<(Vec<End>, Vec<String>), String> = HashMap::new();
    let ports: Vec<String> = inside.inputs.keys().cloned().collect();
    for port in ports {
        let this = End::new(group, &port);
        let wires = around.wires.iter().filter(|wire| wire.to == this);
        let outputs = wires.map(|wire| wire.from.clone()).collect();
        let inputs = around.inputs.iter().filter(|(_, ends)| ends.contains(&this));
        let inputs = inputs.map(|(name, _)| name.clone()).collect();
        match known.entry((outputs, inputs)) {
            Entry::Vacant(entry) => drop(entry.insert(port)),
            Entry::Occupied(entry) => {
                let ends = inside.inputs.shift_remove(&port).unwrap_or_default();
                inside.inputs[entry.get()].extend(ends);
                around.wires.retain(|wire| wire.to != this);
                around.drop_bends();
                around.inputs.values_mut().for_each(|ends| ends.retain(|end| *end != this));
            }
        }
    }
}

/// The port of a group that stands for `end`; a new one has the port's own name, or `node_port` where that is
/// taken.
pub(super) fn port_of<T: PartialEq>(ports: &mut IndexMap<String, T>, end: &End, stands_for: T) -> String {
    if let Some((name, _)) = ports.iter().find(|(_, known)| **known == stands_for) {
        return name.clone();
    }
    let mut name = end.port.clone();
    if ports.contains_key(&name) {
        name = format!("{}_{}", end.node, end.port);
    }
    while ports.contains_key(&name) {
        name.push('_');
    }
    ports.insert(name.clone(), stands_for);
    name
}

#[cfg(test)]
mod tests;
