//! At which moments each node of a document is needed.
//!
//! All at the document's frame, but for what an input that fades reads: that is needed at two frames around
//! it, the multiples of a number of frames next to it, and so is what it reads in turn. They do not depend on
//! the frames that are rendered, so that a frame comes out the same whichever others do, and in which order.
//! What no frame changes is needed once. Tested with the plan.

use std::collections::BTreeSet;

use crate::graph::check::resolve;
use crate::graph::document::{Document, Wire};
use crate::graph::params::Moment;
use crate::graph::spec::{Catalog, PortSpec};

/// When nodes are needed, by their place in the document.
pub(super) struct Moments<'a> {
    document: &'a Document,
    catalog: Catalog,
    main: Moment,
    /// Whether a frame changes it or something that it reads.
    varies: Vec<bool>,
    needed: Vec<BTreeSet<Moment>>,
}

impl<'a> Moments<'a> {
    /// Of the nodes that are `needed`, given in an `order` in which each stands after those that it reads.
    pub(super) fn new(document: &'a Document, catalog: Catalog, order: &[usize], needed: &[bool]) -> Self {
        let main = Moment { is_aside: false, frame: document.frame };
        let n_nodes = document.nodes.len();
        let mut moments = Self {
            document,
            catalog,
            main,
            varies: vec![false; n_nodes],
            needed: vec![BTreeSet::new(); n_nodes],
        };
        let reads = |idx: usize| {
            let (name, _) = document.nodes.get_index(idx).expect("an index of a node");
            document.wires.iter().filter(move |wire| wire.to.node == *name)
        };
        for &idx in order {
            let own = document.nodes[idx].varies(catalog);
            moments.varies[idx] =
                own || reads(idx).any(|wire| moments.giver(wire).is_some_and(|from| moments.varies[from]));
        }
        for &idx in order.iter().rev().filter(|idx| needed[**idx]) {
            // Nobody who was here before reads it: it is wanted for itself, or stands in a cycle.
            if moments.needed[idx].is_empty() {
                moments.needed[idx].insert(main);
            }
            for moment in moments.needed[idx].clone() {
                for wire in reads(idx) {
                    if let Some(from) = moments.giver(wire) {
                        let read: Vec<_> =
                            moments.of_wire(wire, moment).into_iter().map(|(moment, _)| moment).collect();
                        moments.needed[from].extend(read);
                    }
                }
            }
        }
        moments
    }

    /// When a node is needed: the document's frame first, then others in order.
    pub(super) fn of_node(&self, idx: usize) -> impl Iterator<Item = Moment> {
        self.needed[idx].iter().copied()
    }

    /// The moments that a node at `moment` reads through a wire, and what each counts for.
    pub(super) fn of_wire(&self, wire: &Wire, moment: Moment) -> Vec<(Moment, f64)> {
        if !self.giver(wire).is_some_and(|from| self.varies[from]) {
            return vec![(self.main, 1.0)];
        }
        let (Some(frame), Some(apart)) = (moment.frame, self.frames_apart(wire, moment)) else {
            return vec![(moment, 1.0)];
        };
        let since = frame.rem_euclid(apart);
        if since == 0 {
            return vec![(moment, 1.0)];
        }
        let aside = |frame| Moment { is_aside: true, frame: Some(frame) };
        let share = since as f64 / apart as f64;
        let before = frame.saturating_sub(since);
        vec![(aside(before), 1.0 - share), (aside(before.saturating_add(apart)), share)]
    }

    /// How many frames apart the values of a wire are, if it fades.
    fn frames_apart(&self, wire: &Wire, moment: Moment) -> Option<i64> {
        let kind = self.catalog.find(&self.document.nodes.get(&wire.to.node)?.type_id)?;
        let PortSpec { faded_by, .. } = kind.input(&wire.to.port)?;
        // A node whose parameters are wrong does not run.
        let (_, params) = resolve(self.document, self.catalog, &wire.to.node, moment).ok()?;
        faded_by.map(|param| params.i64(param)).filter(|apart| *apart > 1)
    }

    fn giver(&self, wire: &Wire) -> Option<usize> {
        self.document.nodes.get_index_of(&wire.from.node)
    }
}
