//! What a graph means: without groups, muted and bypassed nodes.
//!
//! A group is replaced by what it holds: `group/inner` are the names from here on, in events, errors,
//! statistics and on the command line. A muted node is as if it and its wires were not there. Of a bypassed
//! node each output gives what the first wired input of its type gets; an output without such an input is as
//! if the node were muted. A group as a whole is muted and bypassed as a node is, by the types of its ports.
//!
//! Wires into a group stand before those inside of it, which is the order that a port with many wires sees.
//! What went away is written down in [`Flattened`], so that an input that is empty for its sake can say so.
//! Tested by plans that are as if the node were not there, and by groups whose plan has the same keys.

use std::borrow::Cow;
use std::collections::HashSet;

use indexmap::IndexMap;

use super::check::{Problem, no_such_port};
use super::document::{Document, End, Node, Wire};
use super::spec::Catalog;

/// What became of nodes that are in the file and not in the flat document.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Flattened {
    /// Muted and bypassed nodes, and groups as a whole.
    pub silent: IndexMap<String, Silence>,
    /// Inputs that lost a wire, and the silent node that it came from.
    pub emptied: IndexMap<End, String>,
    /// Wires to ports that a group does not have.
    pub(super) problems: Vec<Problem>,
}

/// Why a node does not run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Silence {
    /// It is as if it were not there.
    Muted,
    /// Its inputs go through.
    Bypassed,
}

impl Flattened {
    /// Why a node does not run: it is silent itself, or a group around it is. With the name of that one.
    pub fn silence(&self, path: &str) -> Option<(&str, Silence)> {
        let ends = path.match_indices('/').map(|(at, _)| at).chain([path.len()]);
        let mut around = ends.filter_map(|end| self.silent.get_key_value(&path[..end]));
        around.next().map(|(name, silence)| (name.as_str(), *silence))
    }
}

/// The document without groups, muted and bypassed nodes; one without any is given back as it is.
pub fn flatten(document: &Document, catalog: Catalog) -> Cow<'_, Document> {
    let is_plain = |node: &Node| !is_silent(node) && node.inside.is_none();
    if document.nodes.values().all(is_plain) {
        return Cow::Borrowed(document);
    }
    Cow::Owned(silence(expand(document, |node| !is_silent(node)), catalog))
}

impl Document {
    /// The output of the flat document that gives what this output gives; `group/inner` is a node in a group.
    /// `None` where nothing does.
    pub fn source_of(&self, catalog: Catalog, output: &End) -> Option<End> {
        let mut output = output.clone();
        let open_group = |path: &str| {
            let node = self.node(path).filter(|node| !is_silent(node));
            node.and_then(|node| node.inside.as_ref())
        };
        while let Some(inside) = open_group(&output.node) {
            let inner = inside.outputs.get(&output.port)?;
            output = End { node: format!("{}/{}", output.node, inner.node), port: inner.port.clone() };
        }
        let open = expand(self, |node| !is_silent(node));
        open.nodes.contains_key(&output.node).then(|| source(&open, catalog, &output))?
    }

    /// The nodes of the flat document that are meant by the name of a node or of a group: those behind its
    /// outputs, or all that it holds where it has none.
    pub(super) fn meant_by(&self, catalog: Catalog, flat: &Document, path: &str) -> Vec<String> {
        let Some(inside) = self.node(path).and_then(|node| node.inside.as_ref()) else {
            return vec![path.to_owned()];
        };
        if flat.nodes.contains_key(path) || flat.flat.silence(path).is_some() {
            return vec![path.to_owned()];
        }
        let outputs = inside.outputs.keys();
        let behind = outputs.filter_map(|port| {
            let output = End { node: path.to_owned(), port: port.clone() };
            Some(self.source_of(catalog, &output)?.node)
        });
        let behind: Vec<String> = behind.collect();
        if !behind.is_empty() {
            return behind;
        }
        let held = flat
            .nodes
            .keys()
            .filter(|name| name.strip_prefix(path).is_some_and(|rest| rest.starts_with('/')));
        held.cloned().collect()
    }
}

fn is_silent(node: &Node) -> bool {
    node.mute || node.bypass
}

/// Replaces the groups that are open by what they hold.
pub(super) fn expand(document: &Document, is_open: fn(&Node) -> bool) -> Document {
    let mut flat = Document {
        about: document.about.clone(),
        base: document.base.clone(),
        frame: document.frame,
        flat: document.flat.clone(),
        ..Document::default()
    };
    Level { document, prefix: String::new(), is_open }.expand_into(&mut flat);
    flat
}

/// A document inside of others.
struct Level<'a> {
    document: &'a Document,
    /// `group/`, or nothing.
    prefix: String,
    is_open: fn(&Node) -> bool,
}

impl<'a> Level<'a> {
    /// The level inside of a node, if it is an open group.
    fn inside(&self, name: &str) -> Option<Level<'a>> {
        let node = self.document.nodes.get(name).filter(|node| (self.is_open)(node))?;
        let document = node.inside.as_ref()?;
        Some(Level { document, prefix: format!("{}{name}/", self.prefix), is_open: self.is_open })
    }

    fn full(&self, end: &End) -> End {
        End { node: format!("{}{}", self.prefix, end.node), port: end.port.clone() }
    }

    fn expand_into(&self, flat: &mut Document) {
        for wire in &self.document.wires {
            let tos = self.readers(&wire.to).unwrap_or_else(|message| {
                flat.flat.problems.push(Problem {
                    node: self.full(&wire.to).node,
                    field: wire.to.port.clone(),
                    message,
                });
                Vec::new()
            });
            match self.giver(&wire.from) {
                Ok(from) => flat.wires.extend(tos.into_iter().map(|to| Wire { from: from.clone(), to })),
                Err(message) => {
                    flat.flat.problems.extend(tos.into_iter().map(|End { node, port }| Problem {
                        node,
                        field: port,
                        message: message.clone(),
                    }))
                }
            }
        }
        for (name, node) in &self.document.nodes {
            match self.inside(name) {
                Some(level) => level.expand_into(flat),
                None => drop(flat.nodes.insert(format!("{}{name}", self.prefix), node.clone())),
            }
        }
    }

    /// The output that an output stands for.
    fn giver(&self, end: &End) -> Result<End, String> {
        let Some(level) = self.inside(&end.node) else {
            return Ok(self.full(end));
        };
        let Some(inner) = level.document.outputs.get(&end.port) else {
            let what = format!("'{}' (group) gives no output '{}'", self.full(end).node, end.port);
            let names = level.document.outputs.keys().map(String::as_str);
            return Err(no_such_port(&what, &end.port, names));
        };
        level.giver(inner)
    }

    /// The inputs that an input stands for.
    fn readers(&self, end: &End) -> Result<Vec<End>, String> {
        let Some(level) = self.inside(&end.node) else {
            return Ok(vec![self.full(end)]);
        };
        let Some(inner) = level.document.inputs.get(&end.port) else {
            let what = format!("'{}' (group) takes no input '{}'", self.full(end).node, end.port);
            let names = level.document.inputs.keys().map(String::as_str);
            return Err(no_such_port(&what, &end.port, names));
        };
        let readers: Result<Vec<_>, _> = inner.iter().map(|end| level.readers(end)).collect();
        Ok(readers?.concat())
    }
}

/// Takes muted and bypassed nodes out of a document whose open groups have been replaced.
fn silence(open: Document, catalog: Catalog) -> Document {
    let mut flat = Document { nodes: IndexMap::new(), wires: Vec::new(), ..open.clone() };
    let is_there = |name: &str| !open.nodes.get(name).is_some_and(is_silent);
    for wire in open.wires.iter().filter(|wire| is_there(&wire.to.node)) {
        match source(&open, catalog, &wire.from) {
            Some(from) if from == wire.from => flat.wires.push(wire.clone()),
            Some(from) => {
                let wire = Wire { from, to: wire.to.clone() };
                // Two ways of the same value into one input are one.
                if !open.wires.contains(&wire) && !flat.wires.contains(&wire) {
                    flat.wires.push(wire);
                }
            }
            None => drop(flat.flat.emptied.insert(wire.to.clone(), wire.from.node.clone())),
        }
    }
    for (name, node) in open.nodes {
        if is_silent(&node) {
            let silence = if node.mute { Silence::Muted } else { Silence::Bypassed };
            flat.flat.silent.insert(name, silence);
        } else {
            flat.nodes.insert(name, node);
        }
    }
    flat
}

/// The output that is read where `output` is wired; `None` where a silent node has nothing to give.
fn source(open: &Document, catalog: Catalog, output: &End) -> Option<End> {
    // Depth first, without recursion: a chain of bypassed nodes may be long, and may be a cycle.
    let mut stack = vec![output.clone()];
    let mut seen = HashSet::new();
    while let Some(end) = stack.pop() {
        let Some(node) = open.nodes.get(&end.node).filter(|node| is_silent(node)) else {
            return Some(end);
        };
        if node.mute || !seen.insert(end.clone()) {
            continue;
        }
        let Some(kind) = open.output(catalog, &end).map(|port| port.kind) else {
            continue;
        };
        let inputs =
            node.inputs(catalog).unwrap_or_default().into_iter().filter(|port| port.spec.kind == kind);
        let first = stack.len();
        for port in inputs {
            let to_it = |wire: &&Wire| wire.to.node == end.node && wire.to.port == port.name;
            stack.extend(open.wires.iter().filter(to_it).map(|wire| wire.from.clone()));
        }
        stack[first..].reverse();
    }
    None
}

#[cfg(test)]
mod tests;
