//! Leaving out what the catalog does not know, of a graph that a later version wrote.
//!
//! Values that their parameter refuses stay: they are a mistake that its node names, not a thing from the future.
//! Tested by a graph that says what is left out, and checks without a problem afterwards.

use crate::graph::Document;
use crate::graph::document::Wire;
use crate::graph::spec::Catalog;

impl Document {
    /// Leaves out nodes of unknown types, unknown parameters, and wires to ports that are not there, in groups too;
    /// says what, a line each.
    pub fn leave_out_unknown(&mut self, catalog: Catalog) -> Vec<String> {
        let mut said = Vec::new();
        self.leave_out("", catalog, &mut said);
        said
    }

    fn leave_out(&mut self, prefix: &str, catalog: Catalog, said: &mut Vec<String>) {
        let mut unknown = Vec::new();
        for (name, node) in &mut self.nodes {
            if let Some(inside) = &mut node.inside {
                inside.leave_out(&format!("{prefix}{name}/"), catalog, said);
                continue;
            }
            let Some(spec) = catalog.find(&node.type_id) else {
                said.push(format!("node '{prefix}{name}' of the unknown type '{}'", node.type_id));
                unknown.push(name.clone());
                continue;
            };
            node.params.retain(|param, _| {
                let is_known = spec.param(param).is_some();
                if !is_known {
                    said.push(format!("parameter '{prefix}{name}.{param}'"));
                }
                is_known
            });
        }
        self.remove(&unknown);
        let has_ports = |wire: &Wire| {
            self.output(catalog, &wire.from).is_some() && self.input(catalog, &wire.to).is_some()
        };
        let wrong: Vec<Wire> = self.wires.iter().filter(|wire| !has_ports(wire)).cloned().collect();
        for wire in &wrong {
            said.push(format!("wire '{wire}'"));
            self.disconnect(wire);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::graph::toy::CATALOG;
    use crate::graph::{Document, Target, check};

    #[test]
    fn what_is_known_is_left_and_the_rest_is_said() {
        let text = r#"{"tyndall": 1, "nodes": {
            "a": {"type": "number", "x": 3, "spin": 1}, "warp": {"type": "wormhole"},
            "paint": {"type": "paint"},
            "inner": {"type": "group", "nodes": {"b": {"type": "number", "charm": 2}, "c": {"type": "tachyon"}},
                "wires": [], "outputs": {"light": "b.light", "other": "c.light"}}
        }, "wires": ["a.light -> paint.light", "a.glow -> paint.light", "warp.out -> paint.light",
            "inner.other -> paint.light"], "bends": {"a.glow -> paint.light": [[1, 2]]}}"#;
        let mut document = Document::parse(text, Path::new("")).unwrap();
        assert_ne!(check(&document, CATALOG, Target::Sinks), []);
        assert_eq!(
            document.leave_out_unknown(CATALOG),
            [
                "parameter 'a.spin'",
                "node 'warp' of the unknown type 'wormhole'",
                "parameter 'inner/b.charm'",
                "node 'inner/c' of the unknown type 'tachyon'",
                "wire 'a.glow -> paint.light'",
                "wire 'inner.other -> paint.light'",
            ]
        );
        assert_eq!(check(&document, CATALOG, Target::Sinks), []);
        assert_eq!(document.nodes["a"].params["x"], 3);
        assert!(document.bends.is_empty());
        assert_eq!(document.leave_out_unknown(CATALOG), [] as [&str; 0]);
    }
}
