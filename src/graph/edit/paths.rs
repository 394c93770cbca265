//! The folder of a graph changes: its relative paths still lead to the same files.

use std::path::{Component, Path, PathBuf};

use serde_json::{Map, Value as Json};

use crate::graph::document::Document;
use crate::graph::spec::{Catalog, ParamKind, ParamSpec};

impl Document {
    /// Moves the graph to another folder. Relative paths of files are written anew, so that they lead to the
    /// same files from there, relative where that is possible; with an empty `base` they become absolute.
    /// Absolute paths stay. Paths of what is written stay too: a picture belongs beside its graph.
    pub fn rebase(&mut self, catalog: Catalog, base: &Path) {
        let old = self.base.clone();
        if old != base {
            move_paths(self, catalog, &old, base);
        }
        self.set_base(base);
    }
}

fn move_paths(document: &mut Document, catalog: Catalog, old: &Path, new: &Path) {
    for node in document.nodes.values_mut() {
        match (&mut node.inside, catalog.find(&node.type_id)) {
            (Some(inside), _) => move_paths(inside, catalog, old, new),
            (None, Some(spec)) => move_params(&mut node.params, spec.params, old, new),
            (None, None) => {}
        }
    }
}

fn move_params(params: &mut Map<String, Json>, specs: &[ParamSpec], old: &Path, new: &Path) {
    for spec in specs {
        match (spec.kind, params.get_mut(spec.name)) {
            (ParamKind::Path, Some(Json::String(text))) => {
                if let Some(moved) = moved(text, old, new) {
                    *text = moved;
                }
            }
            (ParamKind::Record(members), Some(Json::Object(record))) => {
                move_params(record, members, old, new);
            }
            _ => {}
        }
    }
}

/// `None` where the path stays: it is absolute, empty, or no folder is known.
fn moved(text: &str, old: &Path, new: &Path) -> Option<String> {
    if text.is_empty() || Path::new(text).is_absolute() {
        return None;
    }
    let file = std::path::absolute(old.join(text)).ok()?;
    let path = match new.as_os_str().is_empty() {
        true => simple(&file),
        false => relative(&simple(&file), &simple(&std::path::absolute(new).ok()?)),
    };
    path.to_str().map(str::to_owned)
}

/// Without `..`, where what stands before it is a name. Symbolic links are not asked: a graph and its data are
/// moved together by people who see names.
fn simple(path: &Path) -> PathBuf {
    let mut simple = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir if simple.file_name().is_some() => drop(simple.pop()),
            Component::CurDir => {}
            part => simple.push(part),
        }
    }
    simple
}

/// `file` as it is seen from `folder`; absolute on another drive.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let n_common = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if n_common == 0 {
        return file.to_owned();
    }
    let up = folder.components().skip(n_common).map(|_| Component::ParentDir);
    up.chain(file.components().skip(n_common)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::toy::CATALOG;

    fn path_after(path: &str, old: &str, new: &str) -> String {
        let text = format!(
            r#"{{"tyndall": 1, "nodes": {{"g": {{"type": "group", "nodes": {{"f": {{"type": "file", "path": "{path}"}},
                "save": {{"type": "save", "path": "out.png"}}}}}}}}}}"#
        );
        let mut document = Document::parse(&text, Path::new(old)).unwrap();
        document.rebase(CATALOG, Path::new(new));
        assert_eq!(document.inside("g").unwrap().base, Path::new(new));
        assert_eq!(document.node("g/save").unwrap().params["path"], "out.png");
        document.node("g/f").unwrap().params["path"].as_str().unwrap().to_owned()
    }

    #[test]
    fn relative_paths_lead_to_the_same_files() {
        assert_eq!(path_after("../data/a.vdb", "/x/graphs", "/x/graphs"), "../data/a.vdb");
        assert_eq!(path_after("../data/a.vdb", "/x/graphs", "/x"), "data/a.vdb");
        assert_eq!(path_after("a.vdb", "/x/graphs", "/x/presets/mine"), "../../graphs/a.vdb");
        assert_eq!(path_after("./b/../a.vdb", "/x/graphs", "/y"), "../x/graphs/a.vdb");
        assert_eq!(path_after("../data/a.vdb", "/x/graphs", ""), "/x/data/a.vdb");
        assert_eq!(path_after("/data/a.vdb", "/x/graphs", "/x"), "/data/a.vdb");
        // A graph without a folder is in the working directory.
        let here = std::env::current_dir().unwrap();
        assert_eq!(path_after("a.vdb", "", here.to_str().unwrap()), "a.vdb");
    }
}
