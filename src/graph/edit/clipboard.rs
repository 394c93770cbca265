//! Nodes as text, for the clipboard: a graph of their own, with the wires, bends and places among them.

use std::path::{Path, PathBuf};

use serde_json::Value as Json;

use super::no_node;
use crate::graph::document::{Document, DocumentError, End, Node, Wire, parse_json};
use crate::graph::spec::Catalog;

/// In the text of a copy, the folder at which its relative paths start.
const BASE: &str = "base";

impl Document {
    /// The nodes of these names as text, in the order of the document: a graph with the field `base`, the
    /// folder at which its relative paths start.
    pub fn copy(&self, names: &[String]) -> String {
        let mut fields = self.part(names).to_fields();
        // The empty path is the working directory, which `absolute` refuses.
        let base = if self.base.as_os_str().is_empty() { Path::new(".") } else { &self.base };
        if let Some(base) = std::path::absolute(base).ok().as_deref().and_then(Path::to_str) {
            fields.insert(BASE.to_owned(), base.into());
        }
        Json::Object(fields).to_string()
    }

    /// Adds the nodes of a text that [`Self::copy`] gave, or of any graph, moved by `offset`, and gives their
    /// names. Relative paths lead to the same files from here.
    ///
    /// # Errors
    /// Where the text is no graph; the document is then as it was.
    pub fn paste_text(
        &mut self,
        catalog: Catalog,
        text: &str,
        offset: [f64; 2],
    ) -> Result<Vec<String>, DocumentError> {
        let mut json = parse_json(text).map_err(DocumentError::Json)?;
        let base = json.as_object_mut().and_then(|fields| fields.shift_remove(BASE));
        let base = base.as_ref().and_then(Json::as_str).map_or(self.base.clone(), PathBuf::from);
        let mut part = Document::from_json(json, &base)?;
        part.rebase(catalog, &self.base);
        Ok(self.paste(&part, offset))
    }

    /// Adds a preset as one group under a free name like `like`, and gives the name. Its relative paths lead
    /// to the same files from here.
    pub fn insert_preset(&mut self, catalog: Catalog, preset: &Document, like: &str, at: [f64; 2]) -> String {
        let mut inside = preset.clone();
        inside.rebase(catalog, &self.base);
        inside.frame = None;
        self.add_node(like, Node::group(inside), at)
    }

    /// Copies nodes in place, moved by `offset`, and gives the names of the copies. Wires from other nodes
    /// go to the copies too.
    ///
    /// # Errors
    /// Where there is no such node.
    pub fn duplicate(&mut self, names: &[String], offset: [f64; 2]) -> Result<Vec<String>, String> {
        if let Some(missing) = names.iter().find(|name| !self.nodes.contains_key(*name)) {
            return Err(no_node(self, missing));
        }
        let part = self.part(names);
        let originals: Vec<String> = part.nodes.keys().cloned().collect();
        let copies = self.paste(&part, offset);
        let from_outside = self.wires.iter().filter_map(|wire| {
            let at = originals.iter().position(|name| *name == wire.to.node)?;
            let is_outside = !originals.contains(&wire.from.node);
            let to = End { node: copies[at].clone(), port: wire.to.port.clone() };
            is_outside.then(|| Wire { from: wire.from.clone(), to })
        });
        let from_outside: Vec<Wire> = from_outside.collect();
        self.wires.extend(from_outside);
        Ok(copies)
    }

    /// These nodes with what is among them, as a graph of their own.
    pub fn part(&self, names: &[String]) -> Document {
        let is_in = |name: &String| names.contains(name);
        let inside = |wire: &Wire| is_in(&wire.from.node) && is_in(&wire.to.node);
        let nodes = self.nodes.iter().filter(|(name, _)| is_in(name));
        let layout = self.layout.iter().filter(|(name, _)| is_in(name));
        let bends = self.bends.iter().filter(|(wire, _)| inside(wire));
        Document {
            nodes: nodes.map(|(name, node)| (name.clone(), node.clone())).collect(),
            wires: self.wires.iter().filter(|wire| inside(wire)).cloned().collect(),
            layout: layout.map(|(name, at)| (name.clone(), *at)).collect(),
            bends: bends.map(|(wire, points)| (wire.clone(), points.clone())).collect(),
            base: self.base.clone(),
            ..Document::default()
        }
    }

    /// Adds what another graph holds, moved by `offset` points, under names that are free, and says which. Its
    /// ports as a group are left out.
    pub fn paste(&mut self, part: &Document, [dx, dy]: [f64; 2]) -> Vec<String> {
        let mut part = part.clone();
        let mut names: Vec<String> = Vec::new();
        for name in part.nodes.keys() {
            names.push(self.free_name_beside(name, &names));
        }
        let olds: Vec<String> = part.nodes.keys().cloned().collect();
        let new = |old: &str| olds.iter().position(|name| name == old).map(|at| names[at].clone());
        part.map_ends(|end| end.node = new(&end.node).unwrap_or_else(|| end.node.clone()));
        let moved = |[x, y]: [f64; 2]| [x + dx, y + dy];
        let is_known = |end: &End| names.contains(&end.node);
        self.wires.extend(part.wires.into_iter().filter(|wire| is_known(&wire.from) && is_known(&wire.to)));
        let bends = part.bends.into_iter();
        self.bends.extend(bends.map(|(wire, points)| (wire, points.into_iter().map(moved).collect())));
        let layout = part.layout.into_iter().filter_map(|(old, at)| Some((new(&old)?, moved(at))));
        self.layout.extend(layout.collect::<Vec<_>>());
        self.frames.extend(part.frames.into_iter().map(|mut frame| {
            frame.at = moved(frame.at);
            frame
        }));
        self.nodes.extend(names.iter().cloned().zip(part.nodes.into_values()));
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::toy::CATALOG;

    const TEXT: &str = r#"{"tyndall": 1, "nodes": {"file": {"type": "file", "path": "../data/a.vdb"},
          "medium": {"type": "medium"}, "one": {"type": "number"}, "sum": {"type": "sum"}, "sum_2": {"type": "sum"}},
        "wires": ["file.volume -> medium.volume", "one.light -> sum.lights", "sum.light -> sum_2.lights"],
        "layout": {"sum": [1, 2], "sum_2": [3, 4]}, "bends": {"sum.light -> sum_2.lights": [[2, 2]]}}"#;

    fn document() -> Document {
        Document::parse(TEXT, Path::new("/graphs/mine")).unwrap()
    }

    fn strings(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    fn wires(document: &Document) -> Vec<String> {
        document.wires.iter().map(Wire::to_string).collect()
    }

    #[test]
    fn pasted_nodes_have_fresh_names_and_the_wires_among_them() {
        let mut document = document();
        let text = document.copy(&strings(&["sum_2", "sum"]));
        let names = document.paste_text(CATALOG, &text, [10.0, 20.0]).unwrap();
        assert_eq!(names, ["sum_3", "sum_4"]);
        assert_eq!(wires(&document)[3..], ["sum_3.light -> sum_4.lights"]);
        assert_eq!((document.layout["sum_3"], document.layout["sum_4"]), ([11.0, 22.0], [13.0, 24.0]));
        assert_eq!(document.bends[1], [[12.0, 22.0]]);
        let error = document.paste_text(CATALOG, "no graph", [0.0; 2]).unwrap_err().to_string();
        assert!(error.starts_with("the graph is not valid JSON"), "{error}");
    }

    #[test]
    fn paths_lead_to_the_same_file_from_another_folder() {
        let text = document().copy(&strings(&["file"]));
        let mut other = Document { base: "/graphs".into(), ..Document::default() };
        other.paste_text(CATALOG, &text, [0.0; 2]).unwrap();
        assert_eq!(other.nodes["file"].params["path"], "data/a.vdb");
        // Out of a group and into one, too.
        let mut grouped = document();
        grouped.make_group(&strings(&["file"]), "g").unwrap();
        assert_eq!(grouped.inside("g").unwrap().copy(&strings(&["file"])), text);
        other.make_group(&strings(&["file"]), "g").unwrap();
        let inside = other.inside_mut("g").unwrap();
        inside.paste_text(CATALOG, &text, [0.0; 2]).unwrap();
        assert_eq!(inside.nodes["file_2"].params["path"], "data/a.vdb");
        let preset = grouped.preset_of("g").unwrap();
        other.insert_preset(CATALOG, &preset, "p", [0.0; 2]);
        assert_eq!(other.node("p/file").unwrap().params["path"], "data/a.vdb");
        let mut same = document();
        same.paste_text(CATALOG, &text, [0.0; 2]).unwrap();
        assert_eq!(same.nodes["file_2"].params["path"], "../data/a.vdb");
    }

    #[test]
    fn a_duplicate_reads_what_the_original_reads() {
        let mut document = document();
        assert_eq!(document.duplicate(&strings(&["sum"]), [1.0, 1.0]).unwrap(), ["sum_3"]);
        assert_eq!(wires(&document)[3..], ["one.light -> sum_3.lights"]);
        document.duplicate(&strings(&["sum", "sum_2"]), [1.0, 1.0]).unwrap();
        assert_eq!(wires(&document)[4..], ["sum_4.light -> sum_5.lights", "one.light -> sum_4.lights"]);
        assert!(document.duplicate(&strings(&["nobody"]), [0.0; 2]).is_err());
    }
}
