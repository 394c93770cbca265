//! What a frame of the canvas works on: one level of the document, seen as if it were the whole.
//!
//! Selection, statuses and requests name a node in a group `group/inner`; here it is `inner`. What a group
//! tells is the sum of what it holds.

use std::collections::HashMap;

use egui::{Id, TextureHandle};

use super::Request;
use crate::editor::{NodeState, NodeStatus, Project, Selection, Statuses};
use crate::graph::Document;

/// The level, and what the editor hands in.
pub struct Desk<'a> {
    pub project: &'a mut Project,
    /// Names of this level.
    pub selection: Selection,
    pub requests: Vec<Request>,
    outer: &'a mut Selection,
    statuses: &'a Statuses,
    thumbnails: &'a HashMap<String, TextureHandle>,
    group: String,
}

impl<'a> Desk<'a> {
    pub fn new(
        project: &'a mut Project,
        outer: &'a mut Selection,
        statuses: &'a Statuses,
        thumbnails: &'a HashMap<String, TextureHandle>,
        group: &str,
    ) -> Self {
        let inner = outer.nodes.iter().filter_map(|path| inner_name(group, path));
        let mut selection = Selection { nodes: inner.map(str::to_owned).collect() };
        let document = project.document().inside(group);
        selection.nodes.retain(|name| document.is_some_and(|document| document.nodes.contains_key(name)));
        let group = group.to_owned();
        Self { project, selection, requests: Vec::new(), outer, statuses, thumbnails, group }
    }

    /// Names of all levels again.
    pub fn close(self, group: &str) -> Vec<Request> {
        self.outer.nodes = self.selection.nodes.iter().map(|name| path(group, name)).collect();
        let full = |request| match request {
            Request::Show(name) => Request::Show(path(group, &name)),
            Request::Inspect(name) => Request::Inspect(path(group, &name)),
            Request::SavePreset(name) => Request::SavePreset(path(group, &name)),
        };
        self.requests.into_iter().map(full).collect()
    }

    pub fn document(&self) -> &Document {
        let document = self.project.document();
        document.inside(&self.group).unwrap_or(document)
    }

    /// One step of undo.
    pub fn edit(&mut self, label: &str, change: impl FnOnce(&mut Document)) {
        let group = &self.group;
        self.project.edit(label, |document| {
            document.edit_inside(group, change);
        });
    }

    /// One step of undo that leads values anew; what it refuses is no step.
    pub fn wire(
        &mut self,
        label: &str,
        change: impl FnOnce(&mut Document) -> Result<(), String>,
    ) -> Result<(), String> {
        let group = &self.group;
        let mut done = Ok(());
        self.project.edit(label, |document| done = document.wire_inside(group, change));
        done
    }

    /// Why such a step would be refused.
    pub fn refusal(&self, change: impl FnOnce(&mut Document) -> Result<(), String>) -> Option<String> {
        self.project.document().clone().wire_inside(&self.group, change).err()
    }

    /// One step of undo of the whole graph, for what a group is seen as from outside.
    pub fn edit_graph(&mut self, label: &str, change: impl FnOnce(&mut Document)) {
        self.project.edit(label, change);
    }

    /// Part of a gesture.
    pub fn edit_during(&mut self, gesture: Id, label: &str, change: impl FnOnce(&mut Document)) {
        let group = &self.group;
        self.project.edit_during(gesture, label, |document| {
            document.edit_inside(group, change);
        });
    }

    /// The group of this name, and the group that is opened for the empty one.
    pub fn group_path(&self, name: &str) -> String {
        if name.is_empty() { self.group.clone() } else { path(&self.group, name) }
    }

    /// Whether the inside of a group is shown.
    pub fn is_in_group(&self) -> bool {
        !self.group.is_empty()
    }

    pub fn thumbnail(&self, name: &str) -> Option<&TextureHandle> {
        self.thumbnails.get(&path(&self.group, name))
    }

    /// What a node tells.
    pub fn status(&self, name: &str) -> NodeStatus {
        let path = path(&self.group, name);
        let is_group = self.document().nodes.get(name).is_some_and(|node| node.inside.is_some());
        match self.statuses.get(&path) {
            Some(status) => status.clone(),
            None if is_group => {
                let inside = format!("{path}/");
                let mut held: Vec<_> =
                    self.statuses.iter().filter(|(path, _)| path.starts_with(&inside)).collect();
                // Of a map in no order, whose first failure is told.
                held.sort_by_key(|(path, _)| path.as_str());
                sum(held.into_iter().map(|(path, status)| (&path[inside.len()..], status)))
            }
            None => NodeStatus::default(),
        }
    }
}

/// `group/name`, or `name` at the top.
pub fn path(group: &str, name: &str) -> String {
    if group.is_empty() { name.to_owned() } else { format!("{group}/{name}") }
}

/// The other way; `None` for a node of another level.
pub fn inner_name<'a>(group: &str, path: &'a str) -> Option<&'a str> {
    let name = if group.is_empty() { path } else { path.strip_prefix(group)?.strip_prefix('/')? };
    (!name.contains('/')).then_some(name)
}

/// What several nodes tell together: the state that most wants to be seen, and what they cost in all.
fn sum<'a>(parts: impl Iterator<Item = (&'a str, &'a NodeStatus)>) -> NodeStatus {
    let rank = |state: &NodeState| match state {
        NodeState::Idle => 0,
        NodeState::Done => 1,
        NodeState::Stale => 2,
        NodeState::Skipped(_) => 3,
        NodeState::Failed(_) => 4,
        NodeState::Running => 5,
    };
    let mut all = NodeStatus { cached: true, ..NodeStatus::default() };
    for (name, part) in parts {
        if rank(&part.state) > rank(&all.state) {
            all.state = match &part.state {
                NodeState::Failed(message) => NodeState::Failed(format!("{name}: {message}")),
                state => state.clone(),
            };
        }
        all.cached &= part.cached;
        all.cpu_ms += part.cpu_ms;
        all.gpu_ms += part.gpu_ms;
        all.bytes += part.bytes;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_a_level() {
        assert_eq!((path("", "a"), path("g/h", "a")), ("a".to_owned(), "g/h/a".to_owned()));
        assert_eq!(inner_name("", "a"), Some("a"));
        assert_eq!(inner_name("", "g/a"), None);
        assert_eq!(inner_name("g", "g/a"), Some("a"));
        assert_eq!((inner_name("g", "g/h/a"), inner_name("g", "gg/a")), (None, None));
    }

    #[test]
    fn a_group_tells_what_it_holds() {
        let status = |state, cpu_ms| NodeStatus { state, cpu_ms, bytes: 1, ..NodeStatus::default() };
        let parts = [status(NodeState::Done, 1.0), status(NodeState::Failed("no".into()), 2.0)];
        let all = sum(["a", "b"].into_iter().zip(&parts));
        assert_eq!(all.state, NodeState::Failed("b: no".to_owned()));
        assert_eq!((all.cpu_ms, all.bytes, all.cached), (3.0, 2, false));
    }
}
