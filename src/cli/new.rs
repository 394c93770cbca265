//! `tyndall new`: a graph for a volume, from a preset.
//!
//! The same functions light a volume that is dropped on the editor's window ([`tyndall::template`]).

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use tyndall::graph::{Document, did_you_mean};
use tyndall::image::atomic;
use tyndall::template;

use super::output::print;

/// Make a graph for a volume: density scale from its optical depth, camera from its bounding box.
#[derive(clap::Args)]
pub struct Args {
    /// A preset's name, such as smoke, or its file; `lit` is a plain sun and sky.
    preset: String,
    /// A .vdb file, a pattern with ####, or a folder of numbered files.
    volume: PathBuf,
    /// Where the graph is written; else it is printed.
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Writes the graph.
///
/// # Errors
/// When preset or volume cannot be read, or the graph not be written.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let volume = template::measure(&args.volume, false)?;
    let document = match args.preset.as_str() {
        "lit" => template::new_graph(&volume),
        name => template::fit(preset(name)?, &volume)?,
    };
    let text = document.to_json();
    match &args.output {
        Some(path) => atomic::write(path, text.as_bytes())?,
        None => print(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}

fn preset(name: &str) -> anyhow::Result<Document> {
    let path = Path::new(name);
    if path.extension().is_some() {
        return Ok(template::absolute(Document::load(path)?));
    }
    let Some(folder) = template::presets() else {
        anyhow::bail!("the folder 'graphs' is not beside the program; give the preset's file");
    };
    let path = folder.join(format!("{name}.json"));
    if !path.is_file() {
        let names = std::fs::read_dir(&folder)?
            .filter_map(|entry| Some(entry.ok()?.path().file_stem()?.to_str()?.to_owned()));
        let mut names: Vec<String> = names.chain(["lit".to_owned()]).collect();
        names.sort_unstable();
        let near = did_you_mean(name, names.iter().map(String::as_str));
        anyhow::bail!("there is no preset '{name}';{near} allowed are {}", names.join(", "));
    }
    Ok(template::absolute(Document::load(&path)?))
}
