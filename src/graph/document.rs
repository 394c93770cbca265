//! The graph file: JSON made to be read and diffed by people.
//!
//! `{"tyndall": 1, "about": .., "nodes": {name: {"type": .., ..}}, "wires": ["a.port -> b.port"],
//! "layout": {name: [x, y]}, "bends": {"a.port -> b.port": [[x, y]]}, "frames": [{"title": .., "at": [x, y],
//! "size": [w, h]}]}`. Names are the ids; order is kept. A node of type `group` holds such an object of its
//! own, and says in `"inputs": {port: "node.port"}` and `"outputs"` what its ports stand for; a document may
//! say so too, for when it is inserted as a group. So a group's inside is a [`Document`] as well, and what is
//! done to a graph can be done inside of a group.
//!
//! Reading is strict: an unknown field, a name given twice, a newer version are errors that say what is
//! allowed; for the editor there is [`Document::open_leniently`], which leaves out what it does not
//! understand and says so. What needs the list of node kinds (types, parameters, ports) is checked in
//! `check`, so that a document with such mistakes can still be opened and repaired. Files of older versions
//! are migrated step by step. Tested by round trips, by the exact text of every error and by the graphs of
//! the truth set.

mod read;
mod strict;
mod write;

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use indexmap::IndexMap;
use serde_json::{Map, Value as Json};

use super::flat::Flattened;
use super::params::Params;
use super::spec::Catalog;

use read::form;

pub use read::{is_node_name, node_name_from};
pub(super) use strict::parse_json;

/// One step of migration: changes a file of version i + 1, for place i in the list, into the next.
type Migration = fn(&mut Map<String, Json>);

const MIGRATIONS: &[Migration] = &[];

/// The type of a node that holds nodes of its own. No kind of the catalog has this name.
pub const GROUP: &str = "group";
/// Fields of a node that are no parameters. No parameter of any kind has these names.
pub const RESERVED: [&str; 3] = ["type", "mute", "bypass"];

/// The version that is written.
pub const VERSION: u64 = MIGRATIONS.len() as u64 + 1;

/// A graph as its file says it, or the inside of a group.
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
    /// Points through which a wire is drawn, from its output on.
    pub bends: IndexMap<Wire, Vec<[f64; 2]>>,
    /// Comments around parts of the canvas.
    pub frames: Vec<Frame>,
    /// As a group: what its inputs stand for, each for one input of a node inside or for several.
    pub inputs: IndexMap<String, Vec<End>>,
    /// As a group: what its outputs stand for.
    pub outputs: IndexMap<String, End>,
    /// The folder at which relative paths start; empty for the working directory. That of a group is its
    /// graph's. Not part of the file.
    pub base: PathBuf,
    /// The frame that is looked at; without one sequences and keys are at their first. Not part of the file.
    pub frame: Option<i64>,
    /// Of a document without groups, mutes and bypasses, what became of them. Not part of the file.
    pub flat: Flattened,
}

/// A node as its file says it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Node {
    /// Id of its kind.
    pub type_id: String,
    /// What is given; the rest has defaults.
    pub params: Map<String, Json>,
    /// As if it and its wires were not there.
    pub mute: bool,
    /// Each output gives what the first wired input of its type gets.
    pub bypass: bool,
    /// Of a group: what it holds.
    pub inside: Option<Box<Document>>,
}

/// A comment around a part of the canvas, in points.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Frame {
    /// What it says.
    pub title: String,
    /// Its upper left corner.
    pub at: [f64; 2],
    /// Its width and height, both above 0.
    pub size: [f64; 2],
    /// sRGB, each 0..=1; the editor's own where there is none.
    pub color: Option<[f64; 3]>,
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
        Self::from_json(parse_json(text).map_err(DocumentError::Json)?, base)
    }

    /// As [`Self::parse`], of JSON that has been read.
    pub(super) fn from_json(json: Json, base: &Path) -> Result<Self, DocumentError> {
        let mut root = object(json)?;
        migrate(&mut root, MIGRATIONS)?;
        let (document, problems) = read::graph(root, base);
        if problems.is_empty() { Ok(document) } else { Err(DocumentError::Form(problems)) }
    }

    /// Reads JSON text as [`Self::parse`] does, but leaves out what it does not understand, of a later version
    /// too, and says what that is, a line each.
    ///
    /// # Errors
    /// Where it is no JSON object with a version.
    pub fn open_leniently(text: &str, base: &Path) -> Result<(Self, Vec<String>), DocumentError> {
        let mut root = object(parse_json(text).map_err(DocumentError::Json)?)?;
        let mut left_out = Vec::new();
        match root.get("tyndall").and_then(Json::as_u64).filter(|version| *version > VERSION) {
            Some(version) => left_out.push(format!(
                "the graph is of version {version}, this program reads up to {VERSION}; what it does not \
                 know is left out"
            )),
            None => migrate(&mut root, MIGRATIONS)?,
        }
        let (document, problems) = read::graph(root, base);
        left_out.extend(problems);
        Ok((document, left_out))
    }

    /// The text of the file, with a line end.
    pub fn to_json(&self) -> String {
        write::pretty(&Json::Object(self.to_fields()))
    }

    /// The fields of the file.
    pub(super) fn to_fields(&self) -> Map<String, Json> {
        let mut root = Map::from_iter([("tyndall".to_owned(), VERSION.into())]);
        root.extend(write::fields(self));
        root
    }

    /// The node of this name, or of `group/inner`.
    pub fn node(&self, path: &str) -> Option<&Node> {
        // A flat document has names with slashes.
        self.nodes.get(path).or_else(|| {
            let (group, inner) = path.split_once('/')?;
            self.nodes.get(group)?.inside.as_ref()?.node(inner)
        })
    }

    /// As [`Self::node`].
    pub fn node_mut(&mut self, path: &str) -> Option<&mut Node> {
        if self.nodes.contains_key(path) {
            return self.nodes.get_mut(path);
        }
        let (group, inner) = path.split_once('/')?;
        self.nodes.get_mut(group)?.inside.as_mut()?.node_mut(inner)
    }

    /// The inside of a group, `outer/inner` for one in another; of the empty path, itself.
    pub fn inside(&self, path: &str) -> Option<&Document> {
        match path {
            "" => Some(self),
            path => self.node(path)?.inside.as_deref(),
        }
    }

    /// As [`Self::inside`].
    pub fn inside_mut(&mut self, path: &str) -> Option<&mut Document> {
        match path {
            "" => Some(self),
            path => self.node_mut(path)?.inside.as_deref_mut(),
        }
    }

    /// Says at which folder relative paths start, in groups too.
    pub(super) fn set_base(&mut self, base: &Path) {
        self.base = base.to_owned();
        let insides = self.nodes.values_mut().filter_map(|node| node.inside.as_mut());
        insides.for_each(|inside| inside.set_base(base));
    }

    /// Whether two documents are one, also in the order of nodes and of a group's ports, which equality of maps does
    /// not see.
    pub fn is_as(&self, other: &Self) -> bool {
        let is_inside_as = || {
            let pairs = self.nodes.values().zip(other.nodes.values());
            let mut insides = pairs.filter_map(|(a, b)| a.inside.as_ref().zip(b.inside.as_ref()));
            insides.all(|(a, b)| a.is_as(b))
        };
        let is_ordered_as = || {
            self.nodes.keys().eq(other.nodes.keys())
                && self.inputs.keys().eq(other.inputs.keys())
                && self.outputs.keys().eq(other.outputs.keys())
        };
        self == other && is_ordered_as() && is_inside_as()
    }

    /// Whether some node can be another in another frame.
    pub fn varies(&self, catalog: Catalog) -> bool {
        self.nodes.values().any(|node| node.varies(catalog))
    }

    /// The names of all nodes, those in groups as `group/inner`.
    pub fn paths(&self) -> Vec<String> {
        let of_node = |(name, node): (&String, &Node)| {
            let inner = node.inside.iter().flat_map(|inside| inside.paths());
            let inner: Vec<String> = inner.map(|inner| format!("{name}/{inner}")).collect();
            std::iter::once(name.clone()).chain(inner)
        };
        self.nodes.iter().flat_map(of_node).collect()
    }
}

impl Node {
    /// A node that says nothing but its type.
    pub fn new(type_id: &str) -> Self {
        Self { type_id: type_id.to_owned(), ..Self::default() }
    }

    /// A group that holds a document.
    pub fn group(inside: Document) -> Self {
        Self { inside: Some(Box::new(inside)), ..Self::new(GROUP) }
    }

    /// Whether its own parameters can be others in another frame.
    pub(super) fn varies(&self, catalog: Catalog) -> bool {
        match &self.inside {
            Some(inside) => inside.varies(catalog),
            None => catalog.find(&self.type_id).is_some_and(|spec| Params::vary(spec.params, &self.params)),
        }
    }
}

fn object(json: Json) -> Result<Map<String, Json>, DocumentError> {
    match json {
        Json::Object(fields) => Ok(fields),
        other => Err(DocumentError::Form(vec![form("the graph", &other, "an object")])),
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

impl End {
    /// A port of a node.
    pub fn new(node: &str, port: &str) -> Self {
        Self { node: node.to_owned(), port: port.to_owned() }
    }
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
