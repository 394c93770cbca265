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
        let old = std::mem::replace(&mut self.base, base.to_owned());
        if old != base {
            move_paths(self, catalog, &old, base);
        }
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
