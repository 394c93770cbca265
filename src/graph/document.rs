//! The graph file: JSON made to be read and diffed by people.
//!
//! `{"tyndall": 1, "about": .., "nodes": {name: {"type": .., ..}}, "wires": ["a.port -> b.port"],
//! "layout": {name: [x, y]}}`. Names are the ids; order is kept. Reading is strict: an unknown field, a
//! name given twice, a newer version are errors that say what is allowed. What needs the list of node
//! kinds (types, parameters, ports) is checked in `check`, so that a document with such mistakes can
//! still be opened and repaired. Files of older versions are migrated step by step. Tested by round
//! trips, by the exact text of every error and by the graphs of the truth set.

mod strict;
mod write;

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use indexmap::IndexMap;
use serde_json::{Map, Value as Json};

use super::params::Params;
use super::spec::Catalog;
use super::suggest::did_you_mean;

pub(super) use strict::parse_json;

/// One step of migration: changes a file of version i + 1, for place i in the list, into the next.
type Migration = fn(&mut Map<String, Json>);

const MIGRATIONS: &[Migration] = &[];
const FIELDS: [&str; 5] = ["tyndall", "about", "nodes", "wires", "layout"];

/// The version that is written.
pub const VERSION: u64 = MIGRATIONS.len() as u64 + 1;

/// A graph as its file says it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// What it is for, in a line; empty for nothing.
    pub about: String,
    /// Nodes by name.
    pub nodes: IndexMap<String, Node>,
    /// Wires; their order is the order of a port that takes many.
    pub wires: Vec<Wire>,
    /// Places on the canvas, in points.
    pub layout: IndexMap<String, [f64; 2]>,
    /// The folder at which relative paths start; empty for the working directory. Not part of the file.
    pub base: PathBuf,
    /// The frame that is looked at; without one sequences and keys are at their first. Not part of the file.
    pub frame: Option<i64>,
}

/// A node as its file says it.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Id of its kind.
    pub type_id: String,
    /// What is given; the rest has defaults.
    pub params: Map<String, Json>,
}

/// A connection, written `from.port -> to.port`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Wire {
    /// The output.
    pub from: End,
    /// The input.
    pub to: End,
}

/// One end of a wire, written `node.port`.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct End {
    /// Name of the node.
    pub node: String,
    /// Name of its port.
    pub port: String,
}

/// Why a file is no document.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// The file cannot be read.
    #[error("cannot read the graph '{}': {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is no JSON, or a name is given twice in an object.
    #[error("the graph is not valid JSON: {0}")]
    Json(serde_json::Error),
    /// It is of another program or of a later one.
    #[error("{0}")]
    Version(String),
    /// Its parts have not the form they should; one line each.
    #[error("{}", .0.join("\n"))]
    Form(Vec<String>),
}

impl Document {
    /// Reads a file; relative paths inside start at its folder.
    ///
    /// # Errors
    /// Says what is wrong and what is allowed.
    pub fn load(path: &Path) -> Result<Self, DocumentError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| DocumentError::Read { path: path.to_owned(), source })?;
        Self::parse(&text, path.parent().unwrap_or(Path::new("")))
    }

    /// Reads JSON text; relative paths inside start at `base`.
    ///
    /// # Errors
    /// Says what is wrong and what is allowed.
    pub fn parse(text: &str, base: &Path) -> Result<Self, DocumentError> {
        let mut root = match parse_json(text).map_err(DocumentError::Json)? {
            Json::Object(root) => root,
            other => {
                return Err(DocumentError::Form(vec![form("the graph", &other, "an object")]));
            }
        };
        migrate(&mut root, MIGRATIONS)?;
        from_fields(root, base)
    }

    /// The text of the file, with a line end.
    pub fn to_json(&self) -> String {
        let object = |entries: Vec<(String, Json)>| Json::Object(entries.into_iter().collect());
        let nodes = self.nodes.iter().map(|(name, node)| {
            let mut fields = Map::from_iter([("type".to_owned(), node.type_id.clone().into())]);
            fields.extend(node.params.clone());
            (name.clone(), Json::Object(fields))
        });
        let wires = self.wires.iter().map(|wire| wire.to_string().into());
        let mut root = vec![("tyndall".to_owned(), VERSION.into())];
        if !self.about.is_empty() {
            root.push(("about".to_owned(), self.about.clone().into()));
        }
        root.push(("nodes".to_owned(), object(nodes.collect())));
        root.push(("wires".to_owned(), Json::Array(wires.collect())));
        if !self.layout.is_empty() {
            let places = self.layout.iter().map(|(name, place)| {
                let place = place.map(|x| Json::Number(super::spec::json_number(x)));
                (name.clone(), Json::Array(place.to_vec()))
            });
            root.push(("layout".to_owned(), object(places.collect())));
        }
        write::pretty(&object(root))
    }

    /// Whether some node can be another in another frame.
    pub fn varies(&self, catalog: Catalog) -> bool {
        self.nodes.values().any(|node| node.varies(catalog))
    }

    /// The names of all nodes, for messages.
    pub(super) fn node_names(&self) -> String {
        let names: Vec<&str> = self.nodes.keys().map(String::as_str).collect();
        names.join(", ")
    }
}

impl Node {
    /// Whether its own parameters can be others in another frame.
    pub(super) fn varies(&self, catalog: Catalog) -> bool {
        catalog.find(&self.type_id).is_some_and(|spec| Params::vary(spec.params, &self.params))
    }
}

/// Brings the fields to the version that this program reads.
fn migrate(root: &mut Map<String, Json>, steps: &[Migration]) -> Result<(), DocumentError> {
    let newest = steps.len() as u64 + 1;
    let refuse = |message: String| Err(DocumentError::Version(message));
    let Some(version) = root.get("tyndall") else {
        return refuse(format!(
            "this is no graph: the field \"tyndall\" is missing; write \"tyndall\": {newest}"
        ));
    };
    let Some(version) = version.as_u64().filter(|version| *version >= 1) else {
        return refuse(format!(
            "the version \"tyndall\" is {version}; write a whole number from 1 to {newest}"
        ));
    };
    if version > newest {
        return refuse(format!(
            "the graph is of version {version}, this program reads up to {newest}; use a later one"
        ));
    }
    for step in &steps[version as usize - 1..] {
        step(root);
    }
    Ok(())
}

fn from_fields(root: Map<String, Json>, base: &Path) -> Result<Document, DocumentError> {
    let mut document = Document { base: base.to_owned(), ..Document::default() };
    let mut problems = Vec::new();
    if !root.contains_key("nodes") {
        problems.push("the field \"nodes\" is missing; write \"nodes\": {}".to_owned());
    }
    for (field, json) in root {
        match (field.as_str(), json) {
            ("tyndall", _) => {}
            ("about", Json::String(about)) => document.about = about,
            ("about", other) => problems.push(form("about", &other, "a string")),
            ("nodes", Json::Object(nodes)) => {
                for (name, json) in nodes {
                    match read_node(&name, json) {
                        Ok(node) => drop(document.nodes.insert(name, node)),
                        Err(found) => problems.push(found),
                    }
                }
            }
            ("nodes", other) => problems.push(form("nodes", &other, "an object of nodes by name")),
            ("wires", Json::Array(wires)) => {
                for (idx, json) in wires.into_iter().enumerate() {
                    match json.as_str().and_then(|text| text.parse().ok()) {
                        Some(wire) => document.wires.push(wire),
                        None => problems.push(form(
                            &format!("wires[{idx}]"),
                            &json,
                            "\"node.output -> node.input\"",
                        )),
                    }
                }
            }
            ("wires", other) => problems.push(form("wires", &other, "a list of wires")),
            ("layout", Json::Object(places)) => {
                for (name, json) in places {
                    match read_place(&json) {
                        Some(place) => drop(document.layout.insert(name, place)),
                        None => problems.push(form(&format!("layout.{name}"), &json, "[x, y]")),
                    }
                }
            }
            ("layout", other) => problems.push(form("layout", &other, "an object of [x, y]")),
            (unknown, _) => problems.push(format!(
                "unknown field '{unknown}';{} allowed are {}",
                did_you_mean(unknown, FIELDS),
                FIELDS.join(", ")
            )),
        }
    }
    let homeless = document.layout.keys();
    let homeless = homeless.filter(|name| !document.nodes.contains_key(*name));
    problems.extend(homeless.map(|name| {
        let near = did_you_mean(name, document.nodes.keys().map(String::as_str));
        format!("layout.{name} is the place of no node;{near} remove it or add the node")
    }));
    if problems.is_empty() { Ok(document) } else { Err(DocumentError::Form(problems)) }
}

fn read_node(name: &str, json: Json) -> Result<Node, String> {
    if !is_node_name(name) {
        return Err(format!("'{name}' is no name of a node; write letters, digits, '_' and '-'"));
    }
    let Json::Object(mut params) = json else {
        return Err(form(&format!("nodes.{name}"), &json, "an object"));
    };
    // shift_remove keeps the order of what stays.
    match params.shift_remove("type") {
        Some(Json::String(type_id)) => Ok(Node { type_id, params }),
        Some(other) => Err(form(&format!("nodes.{name}.type"), &other, "a string")),
        None => Err(format!("nodes.{name} has no \"type\"; 'tyndall nodes' lists them")),
    }
}

/// Whether a node may have this name: it must survive in a wire and on the command line.
pub fn is_node_name(name: &str) -> bool {
    let allowed = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    !name.is_empty() && name.chars().all(allowed)
}

fn read_place(json: &Json) -> Option<[f64; 2]> {
    match json.as_array()?.as_slice() {
        [x, y] => Some([x.as_f64()?, y.as_f64()?]),
        _ => None,
    }
}

fn form(what: &str, found: &Json, allowed: &str) -> String {
    format!("{what} is {}; write {allowed}", super::params::describe(found))
}

impl FromStr for Wire {
    type Err = ();

    /// Fails for what is not `node.port -> node.port`.
    fn from_str(text: &str) -> Result<Self, ()> {
        let (from, to) = text.split_once("->").ok_or(())?;
        Ok(Self { from: from.parse()?, to: to.parse()? })
    }
}

impl FromStr for End {
    type Err = ();

    /// Fails for what is not `node.port`.
    fn from_str(text: &str) -> Result<Self, ()> {
        let (node, port) = text.trim().split_once('.').ok_or(())?;
        if !is_node_name(node) || !is_node_name(port) {
            return Err(());
        }
        Ok(Self { node: node.to_owned(), port: port.to_owned() })
    }
}

impl fmt::Display for Wire {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} -> {}", self.from, self.to)
    }
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.node, self.port)
    }
}

#[cfg(test)]
mod tests;
