//! The command line: one file a subcommand, nothing but clients of the library.
//!
//! A subcommand gives its exit code, or an error that is printed here as `error: ..`: 0 is done, 1 is
//! "some frames failed" (`render`) or "too different" (`compare`), 2 is wrong usage or input, 130 is
//! Ctrl-C. What is wrong in a graph file is printed a line each, with the file's name before it. Results
//! go to stdout, complaints and progress to stderr; colors are for terminals alone. Every path on the
//! command line is relative to the working directory. Tested by running the program, in `tests/cli.rs`.

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use tyndall::gpu::AdapterChoice;
use tyndall::graph::did_you_mean;

mod compare;
mod doctor;
mod explain;
mod frames;
mod inspect;
mod new;
mod nodes;
mod output;
mod progress;
mod render;
mod scene;
mod stats;

/// Light in smoke, fire, cloud and any other participating medium, as a graph of nodes.
#[derive(Parser)]
#[command(name = "tyndall", version, override_usage = USAGE, after_help = EDITOR)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Render(render::Args),
    Explain(explain::Args),
    Inspect(inspect::Args),
    Compare(compare::Args),
    Nodes(nodes::Args),
    New(new::Args),
    Doctor(doctor::Args),
    #[command(external_subcommand)]
    Other(Vec<OsString>),
}

const USAGE: &str = "tyndall [GRAPH | VOLUME | FOLDER]\n       tyndall <COMMAND>";

const EDITOR: &str = "\
Without a command the editor is opened, on a graph if one is named:
  tyndall                    its start page: presets, recent graphs; drop a .vdb on it
  tyndall graphs/smoke.json  a graph
  tyndall cloud.vdb          a volume, or a folder of numbered ones, lit and framed";

/// Wrong usage or input, or nothing could be done.
const REFUSED: u8 = 2;

/// The window, handed in by `main`, because it is no part of the command line.
type OpenEditor = fn(Option<&Path>, &AdapterChoice) -> anyhow::Result<()>;

/// Runs what the command line says.
pub fn main(open_editor: OpenEditor) -> ExitCode {
    let edit = |graph: Option<&Path>| {
        open_editor(graph, &AdapterChoice::Auto)?;
        Ok(ExitCode::SUCCESS)
    };
    let result = match Cli::parse().command {
        None => edit(None),
        Some(Command::Render(args)) => render::run(&args),
        Some(Command::Explain(args)) => explain::run(&args),
        Some(Command::Inspect(args)) => inspect::run(&args),
        Some(Command::Compare(args)) => compare::run(&args),
        Some(Command::Nodes(args)) => nodes::run(&args),
        Some(Command::New(args)) => new::run(&args),
        Some(Command::Doctor(args)) => doctor::run(&args),
        Some(Command::Other(words)) => match (graph(&words), &words[..]) {
            (Some(path), [_]) => edit(Some(path)),
            (Some(_), _) => Err(too_many(&words)),
            (None, _) => Err(unknown(&words)),
        },
    };
    result.unwrap_or_else(|error| {
        match error.downcast_ref::<output::Lines>() {
            Some(lines) => output::complain(lines),
            None => output::error(&error.to_string()),
        }
        ExitCode::from(REFUSED)
    })
}

/// A first word that is no subcommand may be a graph to open; no subcommand has an ending.
fn graph(words: &[OsString]) -> Option<&Path> {
    let path = Path::new(words.first()?);
    (path.extension().is_some() || path.exists()).then_some(path)
}

/// The editor has one graph.
fn too_many(words: &[OsString]) -> anyhow::Error {
    let more: Vec<_> = words[1..].iter().map(|word| word.to_string_lossy()).collect();
    anyhow::anyhow!(
        "the editor is opened on one graph or volume; leave out {}, or name a subcommand first, such as render",
        more.join(" ")
    )
}

/// Or a slip of the finger.
fn unknown(words: &[OsString]) -> anyhow::Error {
    let word = words.first().map(|word| word.to_string_lossy()).unwrap_or_default();
    let command = Cli::command();
    let names: Vec<&str> =
        command.get_subcommands().map(clap::Command::get_name).filter(|name| *name != "help").collect();
    let near = did_you_mean(&word, names.iter().copied());
    anyhow::anyhow!("there is no subcommand '{word}';{near} allowed are {}", names.join(", "))
}
