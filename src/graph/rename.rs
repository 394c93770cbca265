//! A node under another name: its wires and its place follow, its order in the file stays.
//!
//! Tested by a round trip and by the exact text of every error.

use super::document::{Document, is_node_name};

impl Document {
    /// Gives the node `old` the name `new`.
    ///
    /// # Errors
    /// For a name that no node may have, or that another has; the document is then as it was.
    pub fn rename(&mut self, old: &str, new: &str) -> Result<(), String> {
        if old == new {
            return Ok(());
        }
        if !is_node_name(new) {
            return Err(format!("'{new}' is no name of a node; write letters, digits, '_' and '-'"));
        }
        if self.nodes.contains_key(new) {
            return Err(format!("there is a node '{new}' already; write another name"));
        }
        let follow = |name: &mut String| {
            if name == old {
                new.clone_into(name);
            }
        };
        self.nodes = std::mem::take(&mut self.nodes)
            .into_iter()
            .map(|(mut name, node)| {
                follow(&mut name);
                (name, node)
            })
            .collect();
        self.layout = std::mem::take(&mut self.layout)
            .into_iter()
            .map(|(mut name, place)| {
                follow(&mut name);
                (name, place)
            })
            .collect();
        for wire in &mut self.wires {
            follow(&mut wire.from.node);
            follow(&mut wire.to.node);
        }
        Ok(())
    }

    /// A name that no node has yet: `base` itself, else with the next free number, `sun_2`.
    pub fn free_name(&self, base: &str) -> String {
        let stem = match base.rsplit_once('_') {
            Some((stem, digits)) if !stem.is_empty() && digits.parse::<u32>().is_ok() => stem,
            _ => base,
        };
        let numbered = (2..).map(|number: u64| format!("{stem}_{number}"));
        let mut names = std::iter::once(base.to_owned()).chain(numbered);
        names.find(|name| !self.nodes.contains_key(name)).expect("some number is free")
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const TEXT: &str = r#"{"tyndall": 1, "nodes": {"a": {"type": "x"}, "b": {"type": "y"}},
        "wires": ["a.out -> b.in"], "layout": {"a": [0, 1]}}"#;

    #[test]
    fn wires_and_place_follow_a_name() {
        let before = Document::parse(TEXT, Path::new("")).unwrap();
        let mut document = before.clone();
        document.rename("a", "sun").unwrap();
        let expected = TEXT.replace("\"a\"", "\"sun\"").replace("a.out", "sun.out");
        assert_eq!(document.to_json(), Document::parse(&expected, Path::new("")).unwrap().to_json());
        document.rename("sun", "a").unwrap();
        // Maps are equal in any order, the text is not.
        assert_eq!(document.to_json(), before.to_json());
    }

    #[test]
    fn a_wrong_name_changes_nothing() {
        let before = Document::parse(TEXT, Path::new("")).unwrap();
        let mut document = before.clone();
        let refused = |document: &mut Document, name| document.rename("a", name).unwrap_err();
        assert_eq!(refused(&mut document, "b"), "there is a node 'b' already; write another name");
        let message = "'a.b' is no name of a node; write letters, digits, '_' and '-'";
        assert_eq!(refused(&mut document, "a.b"), message);
        assert_eq!(document, before);
    }

    #[test]
    fn a_free_name_counts_up() {
        let mut document = Document::parse(TEXT, Path::new("")).unwrap();
        assert_eq!((document.free_name("c"), document.free_name("a")), ("c".to_owned(), "a_2".to_owned()));
        document.rename("a", "b_2").unwrap();
        assert_eq!(document.free_name("b_2"), "b_3");
        assert_eq!(document.free_name("b"), "b_3");
    }
}
