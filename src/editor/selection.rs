//! Which nodes are selected, and which one of them was selected last.

use indexmap::IndexSet;

/// Names of nodes of the document, in the order of their selection.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Selection {
    /// All of them.
    pub nodes: IndexSet<String>,
}

impl Selection {
    /// The one that the inspector shows: the last.
    pub fn active(&self) -> Option<&str> {
        self.nodes.last().map(String::as_str)
    }

    /// Selects one and nothing else.
    pub fn only(&mut self, name: &str) {
        self.nodes.clear();
        self.nodes.insert(name.to_owned());
    }
}
