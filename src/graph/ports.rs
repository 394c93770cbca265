//! The ports of a node: those of its kind, or those of a group, which have the types of what they stand for.
//!
//! Tested by a group with ports of every sort.

use std::fmt;

use super::document::{Document, End, Node};
use super::spec::{Catalog, PortSpec};

/// On which side of its node a port is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// What it reads.
    Input,
    /// What it gives.
    Output,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Input => "input",
            Self::Output => "output",
        })
    }
}

/// A port as it is seen from outside.
#[derive(Debug, Clone, Copy)]
pub struct Port<'a> {
    /// Name in a wire.
    pub name: &'a str,
    /// What it takes or gives. Of a group the port inside, whose own name differs.
    pub spec: PortSpec,
}

impl Node {
    /// What can be wired into it; `None` for an unknown kind.
    ///
    /// A port of a group that stands for several takes many wires only where all of them do, and may stay
    /// empty only where all of them may.
    pub fn inputs(&self, catalog: Catalog) -> Option<Vec<Port<'_>>> {
        let Some(inside) = &self.inside else {
            return Some(own(catalog.find(&self.type_id)?.inputs));
        };
        let of_group = inside.inputs.iter().filter_map(|(name, ends)| {
            let mut specs = ends.iter().filter_map(|end| inside.input(catalog, end));
            let first = specs.next()?;
            let spec = specs.fold(first, |all, spec| PortSpec {
                many: all.many && spec.many,
                absent: all.absent.and(spec.absent),
                ..all
            });
            Some(Port { name, spec })
        });
        Some(of_group.collect())
    }

    /// What it gives; `None` for an unknown kind.
    pub fn outputs(&self, catalog: Catalog) -> Option<Vec<Port<'_>>> {
        let Some(inside) = &self.inside else {
            return Some(own(catalog.find(&self.type_id)?.outputs));
        };
        let of_group = inside.outputs.iter();
        Some(
            of_group
                .filter_map(|(name, end)| Some(Port { name, spec: inside.output(catalog, end)? }))
                .collect(),
        )
    }
}

impl Document {
    /// The input at the end of a wire, if there is one.
    pub fn input(&self, catalog: Catalog, end: &End) -> Option<PortSpec> {
        find(self.nodes.get(&end.node)?.inputs(catalog)?, &end.port)
    }

    /// The output at the start of a wire, if there is one.
    pub fn output(&self, catalog: Catalog, end: &End) -> Option<PortSpec> {
        find(self.nodes.get(&end.node)?.outputs(catalog)?, &end.port)
    }
}

fn own(specs: &'static [PortSpec]) -> Vec<Port<'static>> {
    specs.iter().map(|spec| Port { name: spec.name, spec: *spec }).collect()
}

fn find(ports: Vec<Port>, name: &str) -> Option<PortSpec> {
    ports.iter().find(|port| port.name == name).map(|port| port.spec)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::graph::spec::PortType;
    use crate::graph::toy::CATALOG;

    #[test]
    fn ports_of_a_group_are_what_all_of_them_are() {
        let text = r#"{"tyndall": 1, "nodes": {"g": {"type": "group",
            "nodes": {"sum": {"type": "sum"}, "pair": {"type": "pair"}, "fade": {"type": "fade"}, "odd": {"type": "x"}},
            "wires": [],
            "inputs": {"many": "sum.lights", "one": ["sum.lights", "pair.a"], "maybe": ["pair.b", "fade.light"],
                "must": ["fade.light", "pair.a"], "unknown": "odd.x"},
            "outputs": {"out": "pair.total", "none": "sum.nothing"}}}}"#;
        let document = Document::parse(text, Path::new("")).unwrap();
        let group = &document.nodes["g"];
        let inputs = group.inputs(CATALOG).unwrap();
        let described: Vec<_> =
            inputs.iter().map(|port| (port.name, port.spec.many, port.spec.absent.is_some())).collect();
        assert_eq!(
            described,
            [("many", true, false), ("one", false, false), ("maybe", false, true), ("must", false, false)]
        );
        let outputs = group.outputs(CATALOG).unwrap();
        assert_eq!(outputs.len(), 1);
        assert_eq!((outputs[0].name, outputs[0].spec.kind), ("out", PortType::Light));
        assert!(Node::new("x").inputs(CATALOG).is_none());
        let end = |text: &str| text.parse::<End>().unwrap();
        assert!(document.output(CATALOG, &end("g.out")).is_some());
        assert!(document.input(CATALOG, &end("g.out")).is_none());
    }
}
