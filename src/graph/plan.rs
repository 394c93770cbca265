//! What to run, in which order: the nodes that the target needs, each after those that it reads.
//!
//! Order: Kahn's algorithm (Commun. ACM 5, 558, 1962), among several ready nodes the first in the
//! document, so that the same file always runs the same way. A cycle is cut out whole and named; what
//! stands after it is still ordered. A node with a problem stays in the plan with its message, so that
//! the evaluation can go on around it. A node that is needed at several moments is several jobs, those for
//! the sake of another frame named `camera@8`. Tested by orders, targets, cycles and fades.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::check::{check_flat, names_of, resolve};
use super::document::Document;
use super::flat::flatten;
use super::params::{Moment, Params};
use super::spec::{Catalog, NodeSpec};
use moments::Moments;

mod moments;

/// What is asked for.
#[derive(Debug, Clone, Copy)]
pub enum Target<'a> {
    /// The wired nodes that nobody reads; when nothing is wired, all nodes.
    Sinks,
    /// These nodes.
    Nodes(&'a [&'a str]),
}

/// Nodes in the order in which they run.
#[derive(Debug)]
pub struct Plan {
    /// What runs.
    pub jobs: Vec<Job>,
    /// Names of the nodes that the target does not need, in the order of the document.
    pub left_out: Vec<String>,
}

/// One node of a plan.
#[derive(Debug)]
pub struct Job {
    /// Its node's name; with a frame where it is looked at for the sake of another.
    pub name: String,
    /// What it needs to run, or why it cannot: problems, joined with "; also ".
    pub work: Result<Work, String>,
}

/// All that a node needs to run, but for the values.
#[derive(Debug)]
pub struct Work {
    /// Its kind.
    pub spec: &'static NodeSpec,
    /// Its parameters.
    pub params: Params,
    /// For each input of the spec, what is wired to it, in the order of the wires.
    pub sources: Vec<Vec<Source>>,
}

/// An output of a job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Place in `Plan::jobs`, always before the reader.
    pub job_idx: usize,
    /// Place among the outputs of its kind.
    pub output_idx: usize,
    /// Of an input that fades, what this value counts for; else 1.
    pub share: f64,
}

impl Plan {
    /// The plan for `target`; never fails, because problems belong to their nodes.
    pub fn new(document: &Document, catalog: Catalog, target: Target) -> Self {
        let flat = flatten(document, catalog);
        let names = names_of(document, &flat, catalog, target);
        let names: Option<Vec<&str>> = names.as_ref().map(|names| names.iter().map(String::as_str).collect());
        Self::of_flat(&flat, catalog, names.as_deref().map_or(Target::Sinks, Target::Nodes))
    }

    fn of_flat(document: &Document, catalog: Catalog, target: Target) -> Self {
        let problems = check_flat(document, catalog, target);
        let order = order(document);
        let needed = needed(document, target);
        let moments = Moments::new(document, catalog, &order.nodes, &needed);
        let mut jobs: Vec<Job> = Vec::new();
        for &idx in &order.nodes {
            let (name, _) = document.nodes.get_index(idx).expect("an index of a node");
            let own = problems.iter().filter(|problem| problem.node == *name);
            let mut messages: Vec<&str> = own.map(|problem| problem.message.as_str()).collect();
            if messages.is_empty() && order.cycles.iter().any(|cycle| cycle.contains(&idx)) {
                messages.push("is in a cycle; remove a wire of it");
            }
            for moment in moments.of_node(idx) {
                let work = if messages.is_empty() {
                    resolve(document, catalog, name, moment).map(|(spec, params)| {
                        let sources = sources(document, catalog, &jobs, &moments, (name, moment), spec);
                        Work { spec, params, sources }
                    })
                } else {
                    Err(Vec::new())
                };
                let work = work.map_err(|problems| {
                    let own = problems.iter().map(|problem| problem.message.as_str());
                    messages.iter().copied().chain(own).collect::<Vec<_>>().join("; also ")
                });
                jobs.push(Job { name: job_name(name, moment), work });
            }
        }
        let unknown = problems.iter().filter(|problem| {
            matches!(target, Target::Nodes(names) if names.contains(&problem.node.as_str()))
                && !document.nodes.contains_key(&problem.node)
        });
        jobs.extend(
            unknown.map(|problem| Job { name: problem.node.clone(), work: Err(problem.message.clone()) }),
        );
        let left_out = document.nodes.keys().zip(needed);
        let left_out = left_out.filter(|(_, is_needed)| !is_needed);
        Self { jobs, left_out: left_out.map(|(name, _)| name.clone()).collect() }
    }

    /// The job of this name.
    pub fn job(&self, name: &str) -> Option<&Job> {
        self.jobs.iter().find(|job| job.name == name)
    }
}

/// `camera`, or `camera@8` for the sake of another frame.
fn job_name(node: &str, moment: Moment) -> String {
    match moment {
        Moment { is_aside: true, frame: Some(frame) } => format!("{node}@{frame}"),
        _ => node.to_owned(),
    }
}

/// What is wired to each input of a node whose wires have been checked, at a moment.
fn sources(
    document: &Document,
    catalog: Catalog,
    jobs: &[Job],
    moments: &Moments,
    (name, moment): (&str, Moment),
    spec: &NodeSpec,
) -> Vec<Vec<Source>> {
    let source = |from: &super::document::End, moment, share| {
        let giver_name = job_name(&from.node, moment);
        let job_idx = jobs.iter().position(|job| job.name == giver_name);
        let giver = catalog.find(&document.nodes[&from.node].type_id);
        let output = giver.and_then(|giver| giver.output(&from.port));
        Source {
            job_idx: job_idx.expect("the giver stands before"),
            // A node of an unknown kind fails, so nobody reads its outputs; the reader is skipped.
            output_idx: output.map_or(0, |(idx, _)| idx),
            share,
        }
    };
    let of_port = |port: &super::spec::PortSpec| {
        let wires = document.wires.iter();
        let wires = wires.filter(|wire| wire.to.node == name && wire.to.port == port.name);
        let read = wires.flat_map(|wire| {
            let moments = moments.of_wire(wire, moment).into_iter();
            moments.map(|(moment, share)| source(&wire.from, moment, share))
        });
        read.collect()
    };
    spec.inputs.iter().map(of_port).collect()
}

/// For each node of the document, whether the target needs it. Wires to nodes that are not there and
/// targets that are not there do not count.
pub(super) fn needed(document: &Document, target: Target) -> Vec<bool> {
    let edges = edges(document);
    let nodes = 0..document.nodes.len();
    let mut stack: Vec<usize> = match target {
        Target::Nodes(names) => {
            let known = names.iter();
            known.filter_map(|name| document.nodes.get_index_of(*name)).collect()
        }
        Target::Sinks if edges.is_empty() => nodes.collect(),
        Target::Sinks => nodes
            .filter(|idx| edges.iter().any(|(_, to)| to == idx))
            .filter(|idx| edges.iter().all(|(from, _)| from != idx))
            .collect(),
    };
    let mut needed = vec![false; document.nodes.len()];
    while let Some(idx) = stack.pop() {
        if !needed[idx] {
            needed[idx] = true;
            let read = edges.iter().filter(|(_, to)| *to == idx);
            stack.extend(read.map(|(from, _)| *from));
        }
    }
    needed
}

/// All nodes of a document, ordered.
pub(super) struct Order {
    /// Places in the document, each after those that it reads, but for the members of a cycle.
    pub nodes: Vec<usize>,
    /// Cycles in the direction of their wires, each from its first node in the document on.
    pub cycles: Vec<Vec<usize>>,
}

pub(super) fn order(document: &Document) -> Order {
    let edges = edges(document);
    let n_nodes = document.nodes.len();
    let mut waits_for = vec![0_usize; n_nodes];
    let mut readers = vec![Vec::new(); n_nodes];
    for (from, to) in &edges {
        waits_for[*to] += 1;
        readers[*from].push(*to);
    }
    let is_ready = |idx: &usize| waits_for[*idx] == 0;
    let mut ready: BinaryHeap<_> = (0..n_nodes).filter(is_ready).map(Reverse).collect();
    let mut order = Order { nodes: Vec::with_capacity(n_nodes), cycles: Vec::new() };
    let mut done = vec![false; n_nodes];
    while order.nodes.len() < n_nodes {
        let next = match ready.pop() {
            Some(Reverse(idx)) => vec![idx],
            None => {
                let cycle = find_cycle(&edges, &done);
                order.cycles.push(cycle.clone());
                cycle
            }
        };
        for idx in &next {
            done[*idx] = true;
        }
        for idx in &next {
            for reader in &readers[*idx] {
                waits_for[*reader] -= 1;
                if waits_for[*reader] == 0 && !done[*reader] {
                    ready.push(Reverse(*reader));
                }
            }
        }
        order.nodes.extend(next);
    }
    order
}

/// A cycle among the nodes that are not done, each of which reads another that is not done: walking
/// against the wires must come back to where it was.
fn find_cycle(edges: &[(usize, usize)], done: &[bool]) -> Vec<usize> {
    let first = done.iter().position(|is_done| !is_done);
    let mut path = vec![first.expect("a node that is not done")];
    loop {
        let here = path[path.len() - 1];
        let read = edges.iter().find(|(from, to)| *to == here && !done[*from]);
        let (from, _) = read.expect("a node that waits reads one that waits");
        if let Some(start) = path.iter().position(|idx| idx == from) {
            let mut cycle = path.split_off(start);
            cycle.reverse();
            let first = (0..cycle.len()).min_by_key(|place| cycle[*place]);
            cycle.rotate_left(first.expect("a cycle has a node"));
            return cycle;
        }
        path.push(*from);
    }
}

/// Wires as places in the document, from and to, for those whose both ends are there.
fn edges(document: &Document) -> Vec<(usize, usize)> {
    let place = |name: &str| document.nodes.get_index_of(name);
    let wires = document.wires.iter();
    wires.filter_map(|wire| Some((place(&wire.from.node)?, place(&wire.to.node)?))).collect()
}

#[cfg(test)]
mod tests;
