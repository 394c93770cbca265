//! `tyndall nodes`: every kind of node, or one of them with its ports and parameters.
//!
//! All of it comes from the nodes' own specifications.

use std::fmt::Write;
use std::process::ExitCode;

use serde::Serialize;
use serde_json::Value as Json;
use tyndall::graph::{Limits, NodeSpec, ParamKind, ParamSpec, PortSpec, did_you_mean};
use tyndall::nodes::catalog;

use super::output::{NAME, TITLE, columns, print, print_json};

/// List the kinds of nodes, or show one with its ports and parameters.
#[derive(clap::Args)]
pub struct Args {
    /// A kind, such as medium.
    name: Option<String>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Prints.
///
/// # Errors
/// When there is no such kind.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let all = catalog().0;
    let Some(name) = &args.name else {
        if args.json {
            print_json(&all.iter().copied().map(NodeJson::of).collect::<Vec<_>>())?;
        } else {
            print(&list(all))?;
        }
        return Ok(ExitCode::SUCCESS);
    };
    let Some(spec) = catalog().find(name) else {
        let near = did_you_mean(name, all.iter().map(|spec| spec.id));
        anyhow::bail!("there is no node '{name}';{near} `tyndall nodes` lists them");
    };
    if args.json {
        print_json(&NodeJson::of(spec))?
    } else {
        print(&describe(spec))?
    }
    Ok(ExitCode::SUCCESS)
}

/// By category, in the menu's order.
fn list(all: &[&NodeSpec]) -> String {
    let mut categories: Vec<_> = all.iter().map(|spec| spec.category).collect();
    categories.sort_unstable();
    categories.dedup();
    let width = all.iter().map(|spec| spec.id.len()).max().unwrap_or(0);
    let mut text = String::new();
    for category in categories {
        let _ = writeln!(text, "{TITLE}{category}{TITLE:#}");
        for spec in all.iter().filter(|spec| spec.category == category) {
            let _ = writeln!(text, "  {NAME}{:<width$}{NAME:#}  {}", spec.id, spec.purpose);
        }
    }
    text + "`tyndall nodes NAME` shows ports and parameters. Numbers, vectors, colors and directions may change with\n\
            the frame: {\"keys\": [[1, 0.5], [48, 2]]} goes from 0.5 in frame 1 to 2 in frame 48.\n\
            Every node may have \"mute\": true (as if it were not there) or \"bypass\": true (what comes in goes through).\n\
            A node of type group holds \"nodes\" and \"wires\" of its own; its \"inputs\" and \"outputs\" say what its\n\
            ports stand for: {\"image\": \"march.image\"}. Such nodes are group/march on the command line.\n"
}

fn describe(spec: &NodeSpec) -> String {
    let mut text = format!("{TITLE}{}{TITLE:#} ({}): {}\n", spec.id, spec.category, spec.purpose);
    if !spec.doc.is_empty() {
        let _ = writeln!(text, "{}", spec.doc);
    }
    for (title, ports) in [("inputs", spec.inputs), ("outputs", spec.outputs)] {
        if !ports.is_empty() {
            let _ = writeln!(text, "\n{TITLE}{title}{TITLE:#}");
            text += &columns(&ports.iter().map(port_row).collect::<Vec<_>>());
        }
    }
    if !spec.params.is_empty() {
        let _ = writeln!(text, "\n{TITLE}parameters{TITLE:#}");
        for param in spec.params {
            describe_param(param, "  ", &mut text);
        }
    }
    text
}

fn port_row(port: &PortSpec) -> Vec<String> {
    let how = match (port.many, port.absent.is_some()) {
        (false, false) => "",
        (true, false) => " (many)",
        (false, true) => " (optional)",
        (true, true) => " (many, optional)",
    };
    let absent = port.absent.map_or(String::new(), |meaning| format!("; without it {meaning}"));
    vec![port.name.to_owned(), format!("{}{how}", port.kind), format!("{}{absent}", port.doc)]
}

fn describe_param(param: &ParamSpec, indent: &str, text: &mut String) {
    let unit = if param.unit.is_empty() { String::new() } else { format!(" [{}]", param.unit) };
    let default = match param.default_json() {
        Some(default) => format!("default {default}"),
        None => "required".to_owned(),
    };
    let _ = writeln!(text, "{indent}{NAME}{}{NAME:#}{unit}: {}; {default}", param.name, param.form());
    if !param.doc.is_empty() {
        let _ = writeln!(text, "{indent}    {}", param.doc);
    }
    if let ParamKind::Record(members) = param.kind {
        for member in members {
            describe_param(member, &format!("{indent}    "), text);
        }
    }
}

/// A kind of node for scripts; the field names are a contract.
#[derive(Serialize)]
struct NodeJson {
    #[serde(rename = "type")]
    id: &'static str,
    version: u32,
    category: String,
    purpose: &'static str,
    doc: &'static str,
    inputs: Vec<PortJson>,
    outputs: Vec<PortJson>,
    params: Vec<ParamJson>,
}

#[derive(Serialize)]
struct PortJson {
    name: &'static str,
    #[serde(rename = "type")]
    kind: String,
    many: bool,
    optional: bool,
    /// What it means that it stays empty.
    #[serde(skip_serializing_if = "Option::is_none")]
    absent: Option<&'static str>,
    /// The parameter that says how many frames apart its values are, between which it fades.
    #[serde(skip_serializing_if = "Option::is_none")]
    faded_by: Option<&'static str>,
    doc: &'static str,
}

#[derive(Serialize)]
struct ParamJson {
    name: &'static str,
    /// float, int, int_choice, bool, text, choice, path, out_path, vector, rgb, direction, record.
    #[serde(rename = "type")]
    kind: &'static str,
    unit: &'static str,
    required: bool,
    default: Option<Json>,
    /// May change with the frame.
    keys: bool,
    min: Option<f64>,
    max: Option<f64>,
    /// The end itself is not allowed.
    open_min: bool,
    open_max: bool,
    /// What a slider spans.
    soft: Option<(f64, f64)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    choices: Option<Json>,
    /// Of the rows of a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    columns: Option<&'static [&'static str]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    length: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    members: Option<Vec<ParamJson>>,
    doc: &'static str,
}

impl NodeJson {
    fn of(spec: &'static NodeSpec) -> Self {
        Self {
            id: spec.id,
            version: spec.version,
            category: spec.category.to_string(),
            purpose: spec.purpose,
            doc: spec.doc,
            inputs: spec.inputs.iter().map(PortJson::of).collect(),
            outputs: spec.outputs.iter().map(PortJson::of).collect(),
            params: spec.params.iter().map(ParamJson::of).collect(),
        }
    }
}

impl PortJson {
    fn of(port: &'static PortSpec) -> Self {
        let PortSpec { name, kind, many, absent, faded_by, doc } = *port;
        Self { name, kind: kind.to_string(), many, optional: absent.is_some(), absent, faded_by, doc }
    }
}

impl ParamJson {
    fn of(param: &'static ParamSpec) -> Self {
        let (kind, choices, length, members) = match param.kind {
            ParamKind::Float => ("float", None, None, None),
            ParamKind::Int => ("int", None, None, None),
            ParamKind::Bool => ("bool", None, None, None),
            ParamKind::Text => ("text", None, None, None),
            ParamKind::Grid => ("grid", None, None, None),
            ParamKind::Curve(columns) => ("curve", None, Some(columns.len()), None),
            ParamKind::IntChoice(choices) => ("int_choice", Some(choices.into()), None, None),
            ParamKind::Choice(choices) => ("choice", Some(choices.into()), None, None),
            ParamKind::Path => ("path", None, None, None),
            ParamKind::OutPath => ("out_path", None, None, None),
            ParamKind::Vector(length) => ("vector", None, Some(length), None),
            ParamKind::Rgb => ("rgb", None, Some(3), None),
            ParamKind::Direction => ("direction", None, Some(3), None),
            ParamKind::Record(members) => ("record", None, None, Some(members)),
        };
        let default = param.default_json();
        let Limits { min, max, open_min, open_max } = param.hard;
        Self {
            name: param.name,
            kind,
            unit: param.unit,
            required: default.is_none(),
            default,
            keys: param.kind.takes_keys(),
            min,
            max,
            open_min,
            open_max,
            soft: param.soft,
            choices,
            columns: match param.kind {
                ParamKind::Curve(columns) => Some(columns),
                _ => None,
            },
            length,
            members: members.map(|members| members.iter().map(Self::of).collect()),
            doc: param.doc,
        }
    }
}
