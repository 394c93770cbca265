//! Nodes come, go and get other names; wires, places, bends and the ports of the group follow.

use super::no_node;
use crate::graph::document::{Document, End, Node, Wire, is_node_name};
use crate::graph::ports::Side;

impl Document {
    /// `like`, or `like_2`, `like_3`, ..: the first that no node has. A number at its end is counted on.
    pub fn free_name(&self, like: &str) -> String {
        self.free_name_beside(like, &[])
    }

    /// As [`Self::free_name`], and none of `others`.
    pub(super) fn free_name_beside(&self, like: &str, others: &[String]) -> String {
        let is_free =
            |name: &str| !self.nodes.contains_key(name) && !others.iter().any(|other| other == name);
        if is_free(like) {
            return like.to_owned();
        }
        let stem = match like.rsplit_once('_') {
            Some((stem, number)) if !stem.is_empty() && number.parse::<u32>().is_ok() => stem,
            _ => like,
        };
        let mut numbered = (2_u64..).map(|number| format!("{stem}_{number}"));
        numbered.find(|name| is_free(name)).expect("a graph has fewer nodes than there are numbers")
    }

    /// Adds a node under a free name like `like`, and gives the name.
    pub fn add_node(&mut self, like: &str, node: Node, at: [f64; 2]) -> String {
        let name = self.free_name(like);
        self.nodes.insert(name.clone(), node);
        self.layout.insert(name.clone(), at);
        name
    }

    /// Gives a node another name; it keeps its place in the order.
    ///
    /// # Errors
    /// Where there is no such node, or the name is no name or taken; the document is then as it was.
    pub fn rename(&mut self, from: &str, to: &str) -> Result<(), String> {
        let idx = self.nodes.get_index_of(from).ok_or_else(|| no_node(self, from))?;
        if from == to {
            return Ok(());
        }
        if !is_node_name(to) {
            return Err(format!("'{to}' is no name of a node; write letters, digits, '_' and '-'"));
        }
        if self.nodes.contains_key(to) {
            let free = self.free_name(to);
            return Err(format!("there is a node '{to}' already; '{free}' is free"));
        }
        self.nodes.replace_index(idx, to.to_owned()).expect("the name is free");
        if let Some(idx) = self.layout.get_index_of(from) {
            self.layout.replace_index(idx, to.to_owned()).expect("the name is free");
        }
        self.map_ends(|end| {
            if end.node == from {
                end.node = to.to_owned();
            }
        });
        Ok(())
    }

    /// Removes nodes with their wires, places, bends and the ports that stand for them. Names that are not
    /// there do not count.
    pub fn remove(&mut self, names: &[String]) {
        let stays = |end: &End| !names.contains(&end.node);
        self.nodes.retain(|name, _| !names.contains(name));
        self.layout.retain(|name, _| !names.contains(name));
        self.wires.retain(|wire| stays(&wire.from) && stays(&wire.to));
        self.outputs.retain(|_, end| stays(end));
        self.inputs.retain(|_, ends| {
            ends.retain(stays);
            !ends.is_empty()
        });
        self.drop_bends();
    }

    /// Changes each end of a wire, bend and port of the group.
    pub(super) fn map_ends(&mut self, mut change: impl FnMut(&mut End)) {
        self.map_ports(|_, end| change(end));
    }

    /// As [`Self::map_ends`], told on which side of its node each is.
    pub(super) fn map_ports(&mut self, mut change: impl FnMut(Side, &mut End)) {
        let mut change_wire = |wire: &mut Wire| {
            change(Side::Output, &mut wire.from);
            change(Side::Input, &mut wire.to);
        };
        self.wires.iter_mut().for_each(&mut change_wire);
        let bends = std::mem::take(&mut self.bends).into_iter();
        self.bends = bends
            .map(|(mut wire, points)| {
                change_wire(&mut wire);
                (wire, points)
            })
            .collect();
        self.inputs.values_mut().flatten().for_each(|end| change(Side::Input, end));
        self.outputs.values_mut().for_each(|end| change(Side::Output, end));
    }

    /// Forgets the bends of wires that are gone.
    pub(super) fn drop_bends(&mut self) {
        let wires = &self.wires;
        self.bends.retain(|wire, _| wires.contains(wire));
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const TEXT: &str = r#"{"tyndall": 1, "nodes": {"a": {"type": "x"}, "b": {"type": "y"}, "c": {"type": "y"}},
        "wires": ["a.out -> b.in", "b.out -> c.in"], "layout": {"a": [0, 1], "b": [2, 3]},
        "bends": {"a.out -> b.in": [[1, 1]]}, "inputs": {"in": ["a.in", "b.in"]}, "outputs": {"out": "a.out"}}"#;

    fn document() -> Document {
        Document::parse(TEXT, Path::new("")).unwrap()
    }

    #[test]
    fn all_that_names_a_node_follows_its_name() {
        let mut document = document();
        document.rename("a", "sun").unwrap();
        let expected = TEXT.replace("\"a\"", "\"sun\"").replace("a.out", "sun.out").replace("a.in", "sun.in");
        assert_eq!(document.to_json(), Document::parse(&expected, Path::new("")).unwrap().to_json());
        document.rename("sun", "a").unwrap();
        // Maps are equal in any order, the text is not.
        assert_eq!(document.to_json(), self::document().to_json());
    }

    #[test]
    fn a_wrong_name_changes_nothing() {
        let mut document = document();
        let mut refused = |from: &str, to: &str| document.rename(from, to).unwrap_err();
        assert_eq!(refused("a", "b"), "there is a node 'b' already; 'b_2' is free");
        assert_eq!(refused("a", "a.b"), "'a.b' is no name of a node; write letters, digits, '_' and '-'");
        assert_eq!(refused("d", "e"), "'d': there is no such node; nodes are a, b, c");
        document.rename("a", "a").unwrap();
        assert_eq!(document, self::document());
    }

    #[test]
    fn what_belongs_to_a_node_goes_with_it() {
        let mut document = document();
        document.remove(&["a".to_owned(), "nobody".to_owned()]);
        let left = r#"{"tyndall": 1, "nodes": {"b": {"type": "y"}, "c": {"type": "y"}}, "wires": ["b.out -> c.in"],
            "layout": {"b": [2, 3]}, "inputs": {"in": "b.in"}}"#;
        assert_eq!(document, Document::parse(left, Path::new("")).unwrap());
    }

    #[test]
    fn a_free_name_counts_up() {
        let mut document = document();
        assert_eq!((document.free_name("d"), document.free_name("a")), ("d".to_owned(), "a_2".to_owned()));
        document.rename("a", "b_2").unwrap();
        assert_eq!(
            (document.free_name("b"), document.free_name("b_2")),
            ("b_3".to_owned(), "b_3".to_owned())
        );
        assert_eq!(document.add_node("b", Node::new("x"), [5.0, 6.0]), "b_3");
        assert_eq!(document.layout["b_3"], [5.0, 6.0]);
    }
}
