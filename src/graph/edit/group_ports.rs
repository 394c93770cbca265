//! The ports of a group: which inputs and outputs inside are seen from outside, under which names and in which
//! order; and changes inside of a group, which may concern what is outside.
//!
//! A port is made, led to more inputs, moved and removed inside of the group, where it stands for ends of nodes
//! ([`Document::expose`], [`Document::lead`], [`Document::unlead`], [`Document::shift_port`],
//! [`Document::remove_port`]). What is wired to it outside follows where the change goes by
//! [`Document::edit_inside`]; where it can close a cycle that leads through the outside, by
//! [`Document::wire_inside`], which refuses it. A name is seen on both sides, so [`Document::rename_port`] is
//! asked of the whole graph. Tested by the graph before and after, and by the text of every refusal.

use super::groups::port_of;
use super::no_node;
use super::wires::closed_cycle;
use crate::graph::check::no_such_port;
use crate::graph::document::{Document, End, is_node_name};
use crate::graph::ports::Side;
use crate::graph::spec::{Catalog, PortSpec};

impl Document {
    /// Makes an input or output of a node a port of the group that this is the inside of, and gives its name.
    ///
    /// # Errors
    /// Those of [`Self::can_expose`]; the document is then as it was.
    pub fn expose(&mut self, catalog: Catalog, side: Side, end: &End) -> Result<String, String> {
        self.can_expose(catalog, side, end)?;
        Ok(match side {
            Side::Input => port_of(&mut self.inputs, end, vec![end.clone()]),
            Side::Output => port_of(&mut self.outputs, end, end.clone()),
        })
    }

    /// Whether an input or output of a node can become a port of the group.
    ///
    /// # Errors
    /// Where there is no such port, it is one of the group already, or it is an input that takes one wire and
    /// has it.
    pub fn can_expose(&self, catalog: Catalog, side: Side, end: &End) -> Result<(), String> {
        let spec = self.port_inside(catalog, side, end)?;
        if let Some(port) = self.group_port_of(side, end) {
            return Err(format!("'{end}' is the group's {side} '{port}' already"));
        }
        let is_full = side == Side::Input && !spec.many;
        match self.wires.iter().find(|wire| is_full && wire.to == *end) {
            Some(wire) => Err(format!("'{end}' takes one wire and has '{wire}'; unplug it first")),
            None => Ok(()),
        }
    }

    /// Lets a port of the group stand for this input too, or for this output instead. What is wired to an input
    /// that takes one goes.
    ///
    /// # Errors
    /// Where one of the two is not there, or their types differ; the document is then as it was.
    pub fn lead(&mut self, catalog: Catalog, side: Side, port: &str, end: &End) -> Result<(), String> {
        let spec = self.port_inside(catalog, side, end)?;
        let known = match side {
            Side::Input => self.inputs.get(port).and_then(|ends| ends.first()),
            Side::Output => self.outputs.get(port),
        };
        let known = known.cloned().ok_or_else(|| self.no_group_port(side, port))?;
        // Of a port of an unknown kind nothing is known.
        let kind = self.port_inside(catalog, side, &known).ok().map(|spec| spec.kind);
        if let Some(kind) = kind.filter(|kind| *kind != spec.kind) {
            return Err(format!(
                "cannot lead '{port}' to '{end}'; '{port}' is {kind}, '{end}' is {}",
                spec.kind
            ));
        }
        if side == Side::Output {
            self.outputs.insert(port.to_owned(), end.clone());
        } else if !self.inputs[port].contains(end) {
            if !spec.many {
                self.wires.retain(|wire| wire.to != *end);
                self.drop_bends();
                self.forget_input(end);
            }
            self.inputs[port].push(end.clone());
        }
        Ok(())
    }

    /// A port of the group stands no longer for this end, and goes with the last; whether it did.
    pub fn unlead(&mut self, side: Side, port: &str, end: &End) -> bool {
        match side {
            Side::Output if self.outputs.get(port) == Some(end) => self.outputs.shift_remove(port).is_some(),
            Side::Output => false,
            Side::Input => {
                let Some(ends) = self.inputs.get_mut(port) else { return false };
                let n_ends = ends.len();
                ends.retain(|other| other != end);
                let n_left = ends.len();
                if n_left == 0 {
                    self.inputs.shift_remove(port);
                }
                n_left < n_ends
            }
        }
    }

    /// Removes a port of the group; whether it was there.
    pub fn remove_port(&mut self, side: Side, port: &str) -> bool {
        match side {
            Side::Input => self.inputs.shift_remove(port).is_some(),
            Side::Output => self.outputs.shift_remove(port).is_some(),
        }
    }

    /// Moves a port of the group by so many places among those of its side, as far as there are such.
    ///
    /// # Errors
    /// Where there is no such port.
    pub fn shift_port(&mut self, side: Side, port: &str, by: isize) -> Result<(), String> {
        let (from, count) = match side {
            Side::Input => (self.inputs.get_index_of(port), self.inputs.len()),
            Side::Output => (self.outputs.get_index_of(port), self.outputs.len()),
        };
        let from = from.ok_or_else(|| self.no_group_port(side, port))?;
        let to = from.saturating_add_signed(by).min(count - 1);
        match side {
            Side::Input => self.inputs.move_index(from, to),
            Side::Output => self.outputs.move_index(from, to),
        }
        Ok(())
    }

    /// Gives a port of a group another name, inside and in the wires outside; it keeps its place.
    ///
    /// # Errors
    /// Where there is no such group or port, or the name is no name or taken; the document is then as it was.
    pub fn rename_port(&mut self, group: &str, side: Side, from: &str, to: &str) -> Result<(), String> {
        let (around, name) = group.rsplit_once('/').unwrap_or(("", group));
        let inside = self.inside(group).ok_or_else(|| no_group(self, group))?;
        if !inside.has_port(side, from) {
            return Err(inside.no_group_port(side, from));
        }
        if from == to {
            return Ok(());
        }
        if !is_node_name(to) {
            return Err(format!("'{to}' is no name of a port; write letters, digits, '_' and '-'"));
        }
        if inside.has_port(side, to) {
            return Err(format!("the group has an {side} '{to}' already; choose another name"));
        }
        let outside = self.inside_mut(around).expect("around what was found above");
        outside.map_ports(|at, end| {
            if at == side && end.node == name && end.port == from {
                end.port = to.to_owned();
            }
        });
        let inside = self.inside_mut(group).expect("found above");
        match side {
            Side::Input => {
                let idx = inside.inputs.get_index_of(from).expect("asked above");
                inside.inputs.replace_index(idx, to.to_owned()).expect("the name is free");
            }
            Side::Output => {
                let idx = inside.outputs.get_index_of(from).expect("asked above");
                inside.outputs.replace_index(idx, to.to_owned()).expect("the name is free");
            }
        }
        Ok(())
    }

    /// Changes the inside of a group, or of the empty path the graph itself. What was wired to ports that the
    /// group has no longer goes, on each level around it. `None` where there is no such group.
    pub fn edit_inside<T>(&mut self, group: &str, change: impl FnOnce(&mut Document) -> T) -> Option<T> {
        if group.is_empty() {
            return Some(change(self));
        }
        let (name, rest) = group.split_once('/').unwrap_or((group, ""));
        let inside = self.nodes.get_mut(name)?.inside.as_deref_mut()?;
        let ports = |inside: &Document| {
            let inputs = inside.inputs.keys().map(|port| (Side::Input, port.clone()));
            inputs.chain(inside.outputs.keys().map(|port| (Side::Output, port.clone()))).collect::<Vec<_>>()
        };
        let before = ports(inside);
        let result = inside.edit_inside(rest, change)?;
        let after = ports(inside);
        for (side, port) in before.into_iter().filter(|port| !after.contains(port)) {
            self.forget_port(side, &End::new(name, &port));
        }
        Some(result)
    }

    /// As [`Self::edit_inside`], for a change that leads values anew.
    ///
    /// # Errors
    /// Those of the change; where it closes a cycle, also one that leads through the outside; and where there is
    /// no such group. The document is then as it was.
    pub fn wire_inside<T>(
        &mut self,
        group: &str,
        change: impl FnOnce(&mut Document) -> Result<T, String>,
    ) -> Result<T, String> {
        let mut changed = self.clone();
        let done = changed.edit_inside(group, change).ok_or_else(|| no_group(self, group))??;
        if let Some(cycle) = closed_cycle(self, &changed) {
            return Err(format!(
                "that would close the cycle {}; what is outside of the group counts too",
                cycle.join(" -> ")
            ));
        }
        *self = changed;
        Ok(done)
    }

    /// The port of the group that stands for this end.
    pub fn group_port_of(&self, side: Side, end: &End) -> Option<&str> {
        let found = match side {
            Side::Input => self.inputs.iter().find(|(_, ends)| ends.contains(end)).map(|(port, _)| port),
            Side::Output => self.outputs.iter().find(|(_, other)| *other == end).map(|(port, _)| port),
        };
        found.map(String::as_str)
    }

    /// An input is no longer what ports of the group stand for; those that stood for it alone go.
    pub(super) fn forget_input(&mut self, end: &End) {
        self.inputs.retain(|_, ends| {
            ends.retain(|other| other != end);
            !ends.is_empty()
        });
    }

    /// Takes away what is wired to a port that is no more.
    fn forget_port(&mut self, side: Side, end: &End) {
        match side {
            Side::Input => {
                self.wires.retain(|wire| wire.to != *end);
                self.forget_input(end);
            }
            Side::Output => {
                self.wires.retain(|wire| wire.from != *end);
                self.outputs.retain(|_, other| other != end);
            }
        }
        self.drop_bends();
    }

    fn has_port(&self, side: Side, port: &str) -> bool {
        match side {
            Side::Input => self.inputs.contains_key(port),
            Side::Output => self.outputs.contains_key(port),
        }
    }

    fn port_inside(&self, catalog: Catalog, side: Side, end: &End) -> Result<PortSpec, String> {
        let node = self.nodes.get(&end.node).ok_or_else(|| no_node(self, &end.node))?;
        let (found, all) = match side {
            Side::Input => (self.input(catalog, end), node.inputs(catalog)),
            Side::Output => (self.output(catalog, end), node.outputs(catalog)),
        };
        found.ok_or_else(|| {
            let what = format!("'{}' ({}) has no {side} '{}'", end.node, node.type_id, end.port);
            missing(&what, &end.port, all.unwrap_or_default().iter().map(|port| port.name).collect())
        })
    }

    fn no_group_port(&self, side: Side, port: &str) -> String {
        let names: Vec<&str> = match side {
            Side::Input => self.inputs.keys().map(String::as_str).collect(),
            Side::Output => self.outputs.keys().map(String::as_str).collect(),
        };
        missing(&format!("the group has no {side} '{port}'"), port, names)
    }
}

fn missing(what: &str, found: &str, names: Vec<&str>) -> String {
    if names.is_empty() {
        format!("{what}, and no other")
    } else {
        no_such_port(what, found, names.into_iter())
    }
}

fn no_group(document: &Document, path: &str) -> String {
    match document.node(path) {
        None => no_node(document, path),
        Some(node) => format!("'{path}' is no group; it is a {}", node.type_id),
    }
}

#[cfg(test)]
mod tests;
