//! The graph as the command line wants it: parameters set, outputs chosen, everything checked.
//!
//! Whatever is written is written by a save node, pictures by save_image and tables by save_table. `--node` of
//! another node, or `-o` for a graph without any, adds one to the graph in memory, which of the two is said by the
//! ending of `-o`. Nothing is rendered before all problems are known.

use std::path::{Path, PathBuf};

use serde_json::Value as Json;
use tyndall::graph::{Document, DocumentError, End, Node, PortType, Target, Wire, check, did_you_mean};
use tyndall::image::{Format, atomic, table};
use tyndall::nodes::catalog;

use super::frames;
use super::output::Lines;
use super::render::Args;

/// What is written: the node that writes it, what it reads, what that is called, and a node that gives it.
struct Kind {
    save: &'static str,
    port: PortType,
    /// The name of the input.
    input: &'static str,
    giver: &'static str,
    file: &'static str,
}

const PICTURE: Kind = Kind {
    save: "save_image",
    port: PortType::Image,
    input: "image",
    giver: "raymarch",
    file: "picture.exr",
};
const TABLE: Kind =
    Kind { save: "save_table", port: PortType::Table, input: "table", giver: "histogram", file: "table.csv" };
const CAMERA: &str = "camera";

/// What is to be rendered.
pub struct Scene {
    /// The graph.
    pub document: Document,
    /// What is written.
    pub outputs: Vec<Output>,
}

/// A picture or table to be written.
#[derive(Debug, Clone)]
pub struct Output {
    /// The save_image or save_table node.
    pub node: String,
    /// Relative to the working directory; may be a pattern with `#` for the frame.
    pub path: PathBuf,
}

impl Scene {
    /// Reads the graph and applies the command line.
    ///
    /// # Errors
    /// All that is wrong in the graph, as [`Lines`]; else the first thing that is wrong on the command
    /// line.
    pub fn load(args: &Args) -> anyhow::Result<Self> {
        let mut document = read(&args.graph, &args.set, args.size)?;
        let nodes = choose(&mut document, args)?;
        let names: Vec<&str> = nodes.iter().map(String::as_str).collect();
        refuse_problems(&document, Target::Nodes(&names), &args.graph)?;
        let outputs = nodes.into_iter().map(|node| {
            let path = match &args.output {
                Some(path) => path.clone(),
                None => document.base.join(saved_path(&document.nodes[&node])),
            };
            Output { node, path }
        });
        let outputs: Vec<Output> = outputs.collect();
        check_outputs(&document, &outputs, args.frames.is_some())?;
        if args.frames.is_some() && !document.varies(catalog()) {
            anyhow::bail!(
                "--frames: nothing in the graph changes with the frame, no load_vdb and no parameter with keys; leave it out"
            );
        }
        Ok(Self { document, outputs })
    }

    /// The graph of one picture, which is written to `outputs`: at this frame, if there are frames.
    ///
    /// # Errors
    /// When a path is not UTF-8 or the working directory cannot be read.
    pub fn document_of(&self, frame: Option<i64>, outputs: &[Output]) -> anyhow::Result<Document> {
        let mut document = Document { frame, ..self.document.clone() };
        for output in outputs {
            // Relative paths in a document start at the graph.
            let path = std::path::absolute(&output.path)
                .map_err(|error| anyhow::anyhow!("the working directory cannot be read: {error}"))?;
            let text = path.to_str().ok_or_else(|| {
                anyhow::anyhow!("{}: the path is not UTF-8; write to another", path.display())
            })?;
            document.nodes[&output.node].params.insert("path".to_owned(), text.into());
        }
        Ok(document)
    }

    /// The outputs of a frame.
    pub fn outputs_of(&self, frame: i64) -> Vec<Output> {
        let at_frame =
            |output: &Output| Output { node: output.node.clone(), path: frames::file(&output.path, frame) };
        self.outputs.iter().map(at_frame).collect()
    }
}

/// A graph with the parameters and the size of the command line.
///
/// # Errors
/// All that is wrong in the file, as [`Lines`]; else the first thing that is wrong on the command line.
pub fn read(path: &Path, settings: &[String], size: Option<[u32; 2]>) -> anyhow::Result<Document> {
    let mut document = Document::load(path).map_err(|error| unreadable(path, error))?;
    set_params(&mut document, settings)?;
    if let Some([width, height]) = size {
        set_size(&mut document, width, height)?;
    }
    Ok(document)
}

/// Fails where what the target needs could not run.
///
/// # Errors
/// All problems of the graph, as [`Lines`].
pub fn refuse_problems(document: &Document, target: Target, path: &Path) -> anyhow::Result<()> {
    let problems = check(document, catalog(), target);
    if problems.is_empty() {
        return Ok(());
    }
    let lines = problems.iter().map(|problem| format!("{}: {problem}", path.display()));
    Err(Lines(lines.collect()).into())
}

/// A graph file that is none; several problems of its form are a line each.
fn unreadable(path: &Path, error: DocumentError) -> anyhow::Error {
    if matches!(error, DocumentError::Read { .. }) {
        return error.into();
    }
    let lines = error.to_string();
    Lines(lines.lines().map(|line| format!("{}: {line}", path.display())).collect()).into()
}

/// `--set`: all that is wrong, at once.
fn set_params(document: &mut Document, settings: &[String]) -> anyhow::Result<()> {
    let mut wrong = Vec::new();
    for setting in settings {
        match setting.split_once('=') {
            Some((name, value)) => {
                if let Err(error) = document.set(catalog(), name.trim(), value) {
                    wrong.push(error.to_string());
                }
            }
            None => wrong.push(format!("--set '{setting}' has no value; write node.parameter=value")),
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(super::output::errors(&wrong).into()) }
}

/// `--size`, for every camera.
fn set_size(document: &mut Document, width: u32, height: u32) -> anyhow::Result<()> {
    let cameras = document.nodes.iter().filter(|(_, node)| node.type_id == CAMERA);
    let cameras: Vec<String> = cameras.map(|(name, _)| name.clone()).collect();
    if cameras.is_empty() {
        anyhow::bail!("--size: the graph has no camera whose size could change; leave it out");
    }
    for camera in cameras {
        for (side, pixels) in [("width", width), ("height", height)] {
            document.set(catalog(), &format!("{camera}.{side}"), &pixels.to_string())?;
        }
    }
    Ok(())
}

/// What a path is the file of: `.csv` of a table, all else of a picture.
fn kind_of(output: Option<&Path>) -> &'static Kind {
    match output {
        Some(path) if table::check_ending(path).is_ok() => &TABLE,
        _ => &PICTURE,
    }
}

fn is_save(node: &Node) -> bool {
    [PICTURE, TABLE].iter().any(|kind| kind.save == node.type_id)
}

/// The save nodes that are to run; one is added where another node is to be looked at.
fn choose(document: &mut Document, args: &Args) -> anyhow::Result<Vec<String>> {
    let kind = kind_of(args.output.as_deref());
    let Kind { save, file, .. } = kind;
    if let Some(name) = &args.node {
        let Some(node) = document.nodes.get(name) else {
            let names: Vec<&str> = document.nodes.keys().map(String::as_str).collect();
            let near = did_you_mean(name, names.iter().copied());
            anyhow::bail!("--node '{name}': there is no such node;{near} nodes are {}", names.join(", "));
        };
        if is_save(node) {
            return Ok(vec![name.clone()]);
        }
        // Without -o it is not known what was meant; any of the two is as good for the message below.
        let is_table =
            args.output.is_none() && port(node, &PICTURE).is_none() && port(node, &TABLE).is_some();
        let kind = if is_table { &TABLE } else { kind };
        if port(node, kind).is_none() {
            let (what, giver) = (kind.input, kind.giver);
            let givers = list(document, |node| port(node, kind).is_some());
            if givers.is_empty() {
                anyhow::bail!("--node '{name}' gives no {what}, nor does another node; add a {giver}");
            }
            anyhow::bail!("--node '{name}' gives no {what}; those that do are {givers}");
        }
        if args.output.is_none() {
            let Kind { save, file, .. } = kind;
            anyhow::bail!("--node '{name}' is no {save}; say where to write with -o {file}");
        }
        return Ok(vec![add_save(document, &name.clone(), kind)]);
    }
    let is_meant = |node: &Node| match &args.output {
        Some(_) => node.type_id == *save,
        None => is_save(node),
    };
    let saves = document.nodes.iter().filter(|(_, node)| is_meant(node));
    let saves: Vec<String> = saves.map(|(name, _)| name.clone()).collect();
    match (saves.len(), &args.output) {
        (0, None) => {
            anyhow::bail!("the graph has no {save} node; say where to write with -o {file}")
        }
        (0, Some(_)) => Ok(vec![add_save(document, &last_giver(document, kind)?, kind)]),
        (1, _) | (_, None) => Ok(saves),
        _ => anyhow::bail!(
            "the graph has several {save} nodes ({}); say with --node which of them -o is for",
            saves.join(", ")
        ),
    }
}

/// The one node that gives an image, or a table, which nobody reads.
fn last_giver(document: &Document, kind: &Kind) -> anyhow::Result<String> {
    let Kind { input: what, giver, .. } = kind;
    let is_read = |name: &String| document.wires.iter().any(|wire| wire.from.node == *name);
    let mut last = document.nodes.iter().filter(|(name, node)| port(node, kind).is_some() && !is_read(name));
    match (last.next(), last.next()) {
        (Some((name, _)), None) => Ok(name.clone()),
        (None, _) => {
            let article = if *what == "image" { "an" } else { "a" };
            anyhow::bail!("no node of the graph gives {article} {what}; add a {giver}")
        }
        _ => {
            let article = if *what == "image" { "an" } else { "a" };
            let givers = list(document, |node| port(node, kind).is_some());
            anyhow::bail!("several nodes give {article} {what} ({givers}); say with --node which to write")
        }
    }
}

/// Adds a save node that reads `giver`, and gives its name.
fn add_save(document: &mut Document, giver: &str, kind: &Kind) -> String {
    let mut name = "output".to_owned();
    while document.nodes.contains_key(&name) {
        name.push('_');
    }
    let port = port(&document.nodes[giver], kind).unwrap_or_default();
    let end = |node: &str, port: &str| End { node: node.to_owned(), port: port.to_owned() };
    document.wires.push(Wire { from: end(giver, port), to: end(&name, kind.input) });
    document.nodes.insert(name.clone(), Node { type_id: kind.save.to_owned(), params: Default::default() });
    name
}

/// The first output of a node that is an image, or a table.
fn port(node: &Node, kind: &Kind) -> Option<&'static str> {
    let spec = catalog().find(&node.type_id)?;
    spec.outputs.iter().find(|port| port.kind == kind.port).map(|port| port.name)
}

fn list(document: &Document, is_meant: impl Fn(&Node) -> bool) -> String {
    let names = document.nodes.iter().filter(|(_, node)| is_meant(node));
    let names: Vec<&str> = names.map(|(name, _)| name.as_str()).collect();
    names.join(", ")
}

/// The path of a save node whose parameters have been checked.
fn saved_path(node: &Node) -> String {
    let spec = catalog().find(&node.type_id).and_then(|spec| spec.param("path"));
    let default = spec.and_then(|spec| spec.default_json());
    let path = node.params.get("path").cloned().or(default);
    path.as_ref().and_then(Json::as_str).unwrap_or_default().to_owned()
}

/// Refuses, before anything is rendered, what could not be written afterwards.
fn check_outputs(document: &Document, outputs: &[Output], has_frames: bool) -> anyhow::Result<()> {
    for (idx, output) in outputs.iter().enumerate() {
        match document.nodes[&output.node].type_id == TABLE.save {
            true => table::check_ending(&output.path)?,
            false => drop(Format::of(&output.path)?),
        }
        if !has_frames && frames::is_pattern(&output.path) {
            anyhow::bail!(
                "{}: # stands for a frame's number; add --frames 1-100, or write a name without #",
                output.path.display()
            );
        }
        if let Some(other) = outputs[..idx].iter().find(|other| other.path == output.path) {
            anyhow::bail!(
                "'{}' and '{}' both write {}; give them two paths, or choose one with --node",
                other.node,
                output.node,
                output.path.display()
            );
        }
        atomic::check(&output.path)?;
    }
    Ok(())
}
