//! `tyndall render`: pictures of a graph, one or a whole sequence.

use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use tyndall::gpu::AdapterChoice;
use tyndall::graph::{CancelToken, Document, Evaluation, Plan, Target};
use tyndall::image::{Image, Table, atomic};
use tyndall::nodes::catalog;
use tyndall::session::{Session, Solved};

use super::REFUSED;
use super::frames::Frames;
use super::output::{Lines, error, near, size};
use super::progress::Progress;
use super::scene::{Output, Scene};
use super::stats::Stats;

const SOME_FAILED: u8 = 1;
/// What shells give a program that Ctrl-C ended.
const INTERRUPTED: u8 = 130;

/// Render a graph to a picture, or each frame of a sequence.
///
/// Exit code 0: done, 1: some frames failed, 2: wrong usage or input, 130: Ctrl-C. Pictures appear whole
/// or not at all; started again, a sequence keeps the frames that are there, whatever they were made with.
#[derive(clap::Args)]
pub struct Args {
    /// The graph, a JSON file.
    pub graph: PathBuf,
    /// The picture, .exr or .png, or the table, .csv, instead of the path in the graph's save node; with
    /// --frames, #### is the frame's number.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Set a parameter to a JSON value, such as medium.g=0.8; may be given several times.
    #[arg(long, value_name = "NODE.PARAM=VALUE")]
    pub set: Vec<String>,
    /// The save node to run, or another node whose image or table -o is to show.
    #[arg(long, value_name = "NAME")]
    pub node: Option<String>,
    /// Frames to render: 7, 1-100 or 1-100x2 (every second); sets `frame` of every load_vdb
    /// and the moment of parameters with keys.
    #[arg(long, value_name = "FIRST-LAST[xSTEP]")]
    pub frames: Option<Frames>,
    /// Render the frames whose files are there again; without it they are kept, whatever they were made
    /// with.
    #[arg(long, requires = "frames")]
    pub overwrite: bool,
    /// Size of every camera, in pixels.
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Write what it cost, as JSON: times, memory, each node.
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
    /// Model everything, also what the scene does not require (`tyndall explain` says what that is): to see
    /// what that costs and changes.
    #[arg(long)]
    pub full: bool,
    /// auto, cpu, or a part of an adapter's name (`tyndall doctor` lists them).
    #[arg(long, value_name = "ADAPTER", default_value = "auto", value_parser = AdapterChoice::from_str)]
    pub adapter: AdapterChoice,
}

/// `640x480`.
///
/// # Errors
/// What to write instead.
pub fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |digits: &str| digits.parse::<u32>().ok().filter(|pixels| *pixels > 0);
    let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.ok_or_else(|| "write the width, x, the height, both at least 1: 640x480".to_owned())
}

/// Renders.
///
/// # Errors
/// When it cannot begin; a node that fails is reported and counted.
pub fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let scene = Scene::load(args)?;
    if let Some(path) = &args.stats {
        atomic::check(path)?;
    }
    let cancel = CancelToken::new();
    listen_to_ctrl_c(&cancel)?;
    let mut job = Job { args, cancel, session: None, stats: Stats::default() };
    let code = match &args.frames {
        None => job.picture(&scene)?,
        Some(frames) => job.sequence(&scene, frames)?,
    };
    if let Some(path) = &args.stats
        && code != REFUSED
        && code != INTERRUPTED
    {
        job.stats.write(path, job.session.as_ref().map(Session::gpu))?;
    }
    Ok(ExitCode::from(code))
}

/// The first Ctrl-C stops between two stages, the second at once.
fn listen_to_ctrl_c(cancel: &CancelToken) -> anyhow::Result<()> {
    let cancel = cancel.clone();
    let heard = move || {
        if cancel.is_cancelled() {
            std::process::exit(INTERRUPTED.into());
        }
        cancel.cancel();
    };
    ctrlc::set_handler(heard).map_err(|error| anyhow::anyhow!("cannot listen to Ctrl-C: {error}"))
}

/// A render on its way.
struct Job<'a> {
    args: &'a Args,
    cancel: CancelToken,
    session: Option<Session>,
    stats: Stats,
}

/// What came of a picture.
enum Shot {
    Done(String),
    Failed(Lines),
    Interrupted,
}

impl Job<'_> {
    /// A single picture.
    fn picture(&mut self, scene: &Scene) -> anyhow::Result<u8> {
        let start = Instant::now();
        let mut progress = Progress::new(n_runs(&scene.document, &scene.outputs));
        match self.shoot(scene, None, &scene.outputs, &mut progress)? {
            Shot::Done(written) => {
                progress.print(&format!("{written}, {:.2} s", start.elapsed().as_secs_f64()))?;
                Ok(0)
            }
            Shot::Failed(lines) => {
                progress.complain(&lines);
                Ok(REFUSED)
            }
            Shot::Interrupted => {
                drop(progress);
                error("interrupted; nothing was written");
                Ok(INTERRUPTED)
            }
        }
    }

    /// All frames; those whose files are there are kept, unless they are to be overwritten.
    fn sequence(&mut self, scene: &Scene, frames: &Frames) -> anyhow::Result<u8> {
        let start = Instant::now();
        let overwrite = self.args.overwrite;
        let is_kept = |outputs: &[Output]| !overwrite && outputs.iter().all(|output| output.path.is_file());
        let missing = frames.0.iter().filter(|frame| !is_kept(&scene.outputs_of(**frame)));
        let mut n_missing = missing.count();
        let mut progress = Progress::new(n_missing * n_runs(&scene.document, &scene.outputs));
        let (mut n_written, mut n_kept, mut n_failed) = (0, 0, 0);
        let mut interrupted = false;
        for frame in &frames.0 {
            let outputs = scene.outputs_of(*frame);
            // Asked again, because another machine may share the work.
            if is_kept(&outputs) {
                n_kept += 1;
                let paths: Vec<String> = outputs.iter().map(|output| near(&output.path)).collect();
                progress.print(&format!("frame {frame}: {} is there, kept", paths.join(", ")))?;
                continue;
            }
            // Of a fade, frames run different numbers of nodes.
            let n_left = n_missing * n_runs(&scene.document_of(Some(*frame), &outputs)?, &outputs);
            progress.begin_frame(*frame, n_left);
            n_missing = n_missing.saturating_sub(1);
            let began = Instant::now();
            match self.shoot(scene, Some(*frame), &outputs, &mut progress)? {
                Shot::Done(written) => {
                    n_written += 1;
                    let secs = began.elapsed().as_secs_f64();
                    progress.print(&format!("frame {frame}: {written}, {secs:.2} s"))?;
                }
                Shot::Failed(lines) => {
                    n_failed += 1;
                    progress.complain(&lines);
                }
                Shot::Interrupted => {
                    interrupted = true;
                    break;
                }
            }
        }
        let secs = start.elapsed().as_secs_f64();
        let again = if n_kept > 0 { " (--overwrite renders them again)" } else { "" };
        progress
            .print(&format!("{n_written} written, {n_kept} kept{again}, {n_failed} failed, {secs:.2} s"))?;
        drop(progress);
        Ok(match () {
            () if interrupted => {
                error("interrupted; type the same again to go on");
                INTERRUPTED
            }
            () if n_failed == 0 => 0,
            () if n_written + n_kept == 0 => REFUSED,
            () => SOME_FAILED,
        })
    }

    fn shoot(
        &mut self,
        scene: &Scene,
        frame: Option<i64>,
        outputs: &[Output],
        progress: &mut Progress,
    ) -> anyhow::Result<Shot> {
        let document = scene.document_of(frame, outputs)?;
        let names: Vec<&str> = outputs.iter().map(|output| output.node.as_str()).collect();
        let session = match &mut self.session {
            Some(session) => session,
            none => none.insert(Session::open(&self.args.adapter)?),
        };
        session.set_pruning(!self.args.full);
        let show = &mut |event: &_| progress.show(event);
        let solved = session.solve(&document, Target::Nodes(&names), &self.cancel, show);
        if solved.evaluation.cancelled {
            return Ok(Shot::Interrupted);
        }
        if solved.evaluation.failures().next().is_some() {
            return Ok(Shot::Failed(self.failures(&solved, frame)));
        }
        let written: Vec<String> =
            outputs.iter().map(|output| describe(output, &solved.evaluation)).collect();
        self.stats.add(solved, frame);
        Ok(Shot::Done(written.join("; ")))
    }

    fn failures(&self, solved: &Solved, frame: Option<i64>) -> Lines {
        let file = self.args.graph.display();
        let frame = frame.map_or(String::new(), |frame| format!("frame {frame}: "));
        let failures = solved.evaluation.failures();
        Lines(failures.map(|(name, why)| format!("{file}: {frame}node '{name}': {why}")).collect())
    }
}

/// How many nodes run for a picture.
fn n_runs(document: &Document, outputs: &[Output]) -> usize {
    let names: Vec<&str> = outputs.iter().map(|output| output.node.as_str()).collect();
    Plan::new(document, catalog(), Target::Nodes(&names)).jobs.len()
}

/// `out.exr: 32x32, 12.3 KiB`.
fn describe(output: &Output, evaluation: &Evaluation) -> String {
    let mut text = near(&output.path);
    if let Some(value) = evaluation.value(&output.node, "image") {
        let image: &Image = value.get();
        text += &format!(": {}x{}", image.width, image.height);
    }
    if let Some(value) = evaluation.value(&output.node, "table") {
        let table: &Table = value.get();
        text += &format!(": {} rows", table.rows.len());
    }
    if let Ok(found) = std::fs::metadata(&output.path) {
        text += &format!(", {}", size(found.len()));
    }
    text
}
