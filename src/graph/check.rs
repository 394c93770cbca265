//! Everything that is wrong with a graph, at once: types, parameters, ports, wires, empty inputs, cycles.
//!
//! Each problem belongs to a node, so that the editor can mark it and the evaluation can go on around
//! it. Parameters are checked in all nodes; an input that must be wired is missed only in nodes that the
//! target needs, because a node that nothing reads may wait on the canvas. Tested by the exact text of
//! every problem.

use std::fmt;

use super::document::{Document, End, Wire};
use super::flat::{Silence, flatten};
use super::params::{Moment, Params};
use super::plan::{Target, needed, order};
use super::spec::{Catalog, NodeSpec, PortSpec};
use super::suggest::did_you_mean;

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The node that cannot run.
    pub node: String,
    /// The parameter or port; `type` for the kind, empty for the whole node.
    pub field: String,
    /// What was found, what is allowed, what to do.
    pub message: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node '{}': {}", self.node, self.message)
    }
}

/// All problems, in the order of the document: targets, nodes, wires, inputs, cycles. Empty when the
/// graph can run.
pub fn check(document: &Document, catalog: Catalog, target: Target) -> Vec<Problem> {
    let flat = flatten(document, catalog);
    let names = names_of(document, &flat, catalog, target);
    let names: Option<Vec<&str>> = names.as_ref().map(|names| names.iter().map(String::as_str).collect());
    check_flat(&flat, catalog, names.as_deref().map_or(Target::Sinks, Target::Nodes))
}

/// The nodes of the flat document that a target names.
pub(super) fn names_of(
    document: &Document,
    flat: &Document,
    catalog: Catalog,
    target: Target,
) -> Option<Vec<String>> {
    match target {
        Target::Sinks => None,
        Target::Nodes(names) => {
            Some(names.iter().flat_map(|name| document.meant_by(catalog, flat, name)).collect())
        }
    }
}

/// As [`check()`], for what [`flatten`] gives.
pub(super) fn check_flat(document: &Document, catalog: Catalog, target: Target) -> Vec<Problem> {
    let mut problems = missing_targets(document, target);
    problems.extend(document.flat.problems.iter().cloned());
    let moment = Moment { is_aside: false, frame: document.frame };
    for name in document.nodes.keys() {
        if let Err(found) = resolve(document, catalog, name, moment) {
            problems.extend(found);
        }
    }
    for (idx, wire) in document.wires.iter().enumerate() {
        problems.extend(check_wire(document, catalog, wire, &document.wires[..idx]));
    }
    for (idx, is_needed) in needed(document, target).into_iter().enumerate() {
        let (name, node) = document.nodes.get_index(idx).expect("one flag a node");
        if let Some(spec) = catalog.find(&node.type_id) {
            for port in spec.inputs {
                problems.extend(check_input(document, catalog, name, port, is_needed));
            }
        }
    }
    problems.extend(order(document).cycles.iter().map(|cycle| {
        let name = |idx: &usize| document.nodes.get_index(*idx).expect("an index of a node").0;
        let mut names: Vec<&str> = cycle.iter().map(|idx| name(idx).as_str()).collect();
        names.push(names[0]);
        let message = format!("is in the cycle {}; remove a wire of it", names.join(" -> "));
        problem(names[0], "", message)
    }));
    problems
}

/// The kind and the parameters of one node of the document at a moment.
pub(super) fn resolve(
    document: &Document,
    catalog: Catalog,
    name: &str,
    moment: Moment,
) -> Result<(&'static NodeSpec, Params), Vec<Problem>> {
    let node = &document.nodes[name];
    let Some(spec) = catalog.find(&node.type_id) else {
        let message = unknown_type(&node.type_id, catalog);
        return Err(vec![problem(name, "type", message)]);
    };
    let params = Params::resolve(spec.params, &node.params, &document.base, moment);
    match params {
        Ok(params) => Ok((spec, params)),
        Err(found) => {
            Err(found.into_iter().map(|param| problem(name, &param.field, param.message)).collect())
        }
    }
}

/// Text for a kind that is not there.
pub(super) fn unknown_type(type_id: &str, catalog: Catalog) -> String {
    let ids: Vec<&str> = catalog.0.iter().map(|spec| spec.id).collect();
    let near = did_you_mean(type_id, ids.iter().copied());
    format!("unknown type '{type_id}';{near} allowed are {}", ids.join(", "))
}

/// Text for a node that is not there.
pub(super) fn unknown_node(document: &Document, name: &str) -> String {
    match document.flat.silence(name) {
        Some((silent, Silence::Muted)) => return format!("'{silent}' is muted; unmute it"),
        Some((silent, Silence::Bypassed)) => return format!("'{silent}' is bypassed; take that back"),
        None => {}
    }
    let paths = document.paths();
    let near = did_you_mean(name, paths.iter().map(String::as_str));
    format!("there is no such node;{near} nodes are {}", paths.join(", "))
}

fn problem(node: &str, field: &str, message: String) -> Problem {
    Problem { node: node.to_owned(), field: field.to_owned(), message }
}

fn missing_targets(document: &Document, target: Target) -> Vec<Problem> {
    let names = match target {
        Target::Sinks => &[],
        Target::Nodes(names) => names,
    };
    let missing = names.iter().filter(|name| !document.nodes.contains_key(**name));
    missing.map(|name| problem(name, "", unknown_node(document, name))).collect()
}

/// A wire's own problem, which belongs to the node that reads it.
fn check_wire(document: &Document, catalog: Catalog, wire: &Wire, earlier: &[Wire]) -> Option<Problem> {
    let refuse = |message: String| Some(problem(&wire.to.node, &wire.to.port, message));
    let near = |name: &str| did_you_mean(name, document.nodes.keys().map(String::as_str));
    if earlier.contains(wire) {
        return refuse(format!("the wire '{wire}' stands twice; keep one"));
    }
    if !document.nodes.contains_key(&wire.from.node) {
        return refuse(format!(
            "the wire '{wire}' starts at no node;{} nodes are {}",
            near(&wire.from.node),
            document.paths().join(", ")
        ));
    }
    if !document.nodes.contains_key(&wire.to.node) {
        return refuse(format!(
            "the wire '{wire}' ends at no node;{} nodes are {}",
            near(&wire.to.node),
            document.paths().join(", ")
        ));
    }
    fit(document, catalog, wire).err().and_then(refuse)
}

/// Why a wire between two nodes of the document does not fit. Of the ports of an unknown kind nothing is
/// known.
pub(super) fn fit(document: &Document, catalog: Catalog, wire: &Wire) -> Result<(), String> {
    let (giver, reader) = (&document.nodes[&wire.from.node], &document.nodes[&wire.to.node]);
    let Some(inputs) = reader.inputs(catalog) else {
        return Ok(());
    };
    let Some(input) = document.input(catalog, &wire.to) else {
        let what = format!("{} takes no input '{}'", reader.type_id, wire.to.port);
        return Err(no_such_port(&what, &wire.to.port, inputs.iter().map(|port| port.name)));
    };
    let Some(outputs) = giver.outputs(catalog) else {
        return Ok(());
    };
    let Some(output) = document.output(catalog, &wire.from) else {
        let what = format!("'{}' ({}) gives no output '{}'", wire.from.node, giver.type_id, wire.from.port);
        return Err(no_such_port(&what, &wire.from.port, outputs.iter().map(|port| port.name)));
    };
    if input.kind != output.kind {
        let givers = givers(catalog, &input);
        return Err(format!(
            "cannot wire {} into {}; '{}' takes {}, which {givers}",
            output.kind, input.kind, wire.to, input.kind
        ));
    }
    Ok(())
}

/// Text for a port that is not there.
pub(super) fn no_such_port<'a>(what: &str, found: &str, names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    let near = did_you_mean(found, names.iter().copied());
    match names.as_slice() {
        [] => format!("{what}; it has none, remove the wire"),
        names => format!("{what};{near} allowed are {}", names.join(", ")),
    }
}

/// `load_vdb.volume or shape.volume give`.
fn givers(catalog: Catalog, input: &PortSpec) -> String {
    match catalog.givers_of(input.kind).as_slice() {
        [] => "nothing gives".to_owned(),
        [one] => format!("{one} gives"),
        [head @ .., last] => format!("{} or {last} give", head.join(", ")),
    }
}

fn check_input(
    document: &Document,
    catalog: Catalog,
    name: &str,
    port: &PortSpec,
    is_needed: bool,
) -> Option<Problem> {
    let mut sources: Vec<String> = Vec::new();
    for wire in &document.wires {
        let from = wire.from.to_string();
        if wire.to.node == name && wire.to.port == port.name && !sources.contains(&from) {
            sources.push(from);
        }
    }
    let message = match sources.len() {
        0 if is_needed && port.absent.is_none() => {
            let (givers, kind) = (givers(catalog, port), port.kind);
            let end = End { node: name.to_owned(), port: port.name.to_owned() };
            let giver = document.flat.emptied.get(&end);
            let why = match giver.and_then(|giver| document.flat.silence(giver)) {
                Some((silent, Silence::Muted)) => format!(", because '{silent}' is muted; unmute it or"),
                Some((silent, Silence::Bypassed)) => {
                    format!(", because '{silent}' is bypassed and has no {kind} to pass on;")
                }
                None => ";".to_owned(),
            };
            format!("input '{}' is empty{why} wire {kind} into it, which {givers}", port.name)
        }
        0 | 1 => return None,
        _ if port.many => return None,
        count => format!(
            "input '{}' takes one wire and has {count}, from {}; keep one",
            port.name,
            sources.join(", ")
        ),
    };
    Some(problem(name, port.name, message))
}

#[cfg(test)]
mod tests;
