//! The thread that solves: it owns the session, so that the window never waits.
//!
//! A request is answered coarse first and then full ([`preview`](super::preview)); while the pointer is
//! down only as much as keeps up. A new request cancels the one that runs between its stages, unless
//! both are part of a drag: then the running picture is finished, so that a drag shows pictures at all, and
//! of the waiting requests only the newest is taken. Where the full fields are cached (only the camera
//! moved) they are kept, and the picture alone gets smaller. Each reply carries the number of its request.
//!
//! It runs at a lower priority than the window (on Linux, where that is a matter of the thread).
//!
//! A device that is lost, or out of memory, is told, opened anew (its cache forgotten), and the request is
//! tried once more; after that it waits for the next request. A panic in a node counts as a lost device.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

use super::player::LOADER;
use super::preview::{self, Level, Pace};
use crate::gpu::{AdapterChoice, GpuError, OUT_OF_MEMORY};
use crate::graph::{CancelToken, Category, Document, Evaluation, Event, Outcome, PortType, Target, Value};
use crate::nodes::catalog;
use crate::session::{NodeCost, Session};

/// What the window asks for.
#[derive(Debug, Clone, Default)]
pub struct Ask {
    /// The graph.
    pub document: Document,
    /// The nodes that make the picture: these are previewed.
    pub looked_at: Vec<String>,
    /// Nodes that are run after the picture is there, for what they tell.
    pub rest: Vec<String>,
    /// Nodes that are shown over the pictures: solved as far as these, and before them.
    pub beside: Vec<String>,
    /// Nodes of which all values are wanted, not the pictures alone.
    pub wanted: Vec<String>,
    /// Frames of which it is wanted whether they are still kept, the most wanted last.
    pub frames: Vec<i64>,
    /// The pointer is down: as much as keeps up.
    pub is_drag: bool,
    /// The device is to be opened anew first.
    pub is_restart: bool,
}

/// What the worker tells.
#[derive(Debug)]
pub enum Reply {
    /// A device is open: its name and driver.
    Opened(String),
    /// A node began, ended, failed or was skipped.
    Event {
        /// What happened.
        event: Event,
        /// Of the document itself, not of a preview.
        is_full: bool,
        /// The frame that was asked for.
        frame: Option<i64>,
    },
    /// Values that came to be.
    Solved(Solved),
    /// Which of the frames that were asked about are kept.
    Kept {
        /// Their files have been read.
        loaded: BTreeSet<i64>,
        /// Their pictures are there, as large as they are to be.
        cached: BTreeSet<i64>,
    },
    /// Nothing is left to do.
    Rested,
    /// The device is gone, out of memory, or there is none.
    Trouble {
        /// What happened.
        message: String,
        /// It is tried again by itself.
        retries: bool,
    },
}

/// What came of one level of a request.
#[derive(Debug)]
pub struct Solved {
    /// How much was computed.
    pub level: Level,
    /// The frame that was asked for.
    pub frame: Option<i64>,
    /// Pictures and cameras by node and output, and all values of the wanted nodes.
    pub values: Vec<(String, &'static str, Value)>,
    /// Of each node that ran.
    pub costs: Vec<NodeCost>,
    /// Wall clock of all, in ms.
    pub wall_ms: f64,
    /// What the cache holds, in bytes.
    pub cache_bytes: u64,
    /// What is held on the device, in bytes.
    pub gpu_bytes: u64,
}

struct Request {
    number: u64,
    ask: Ask,
    cancel: CancelToken,
}

/// The window's end of the thread.
pub struct Worker {
    /// Dropped to end the thread.
    requests: Option<Sender<Request>>,
    thread: Option<JoinHandle<()>>,
    replies: Receiver<(u64, Reply)>,
    number: u64,
    cancel: CancelToken,
    is_drag: bool,
}

impl Worker {
    /// Starts the thread; `wake` is called after each reply.
    pub fn start(adapter: &AdapterChoice, wake: impl Fn() + Send + 'static) -> Self {
        let (requests, to_do) = channel::<Request>();
        let (done, replies) = channel();
        let adapter = adapter.clone();
        let thread = std::thread::spawn(move || {
            step_back();
            let tell = |number, reply| {
                // A window that is gone needs no replies.
                let _ = done.send((number, reply));
                wake();
            };
            serve(&adapter, &to_do, &tell);
        });
        let (requests, thread) = (Some(requests), Some(thread));
        Self { requests, thread, replies, number: 0, cancel: CancelToken::new(), is_drag: false }
    }

    /// Asks, and gives the number of the request. What was asked before is cancelled, but for a picture of
    /// the same drag.
    pub fn ask(&mut self, ask: Ask) -> u64 {
        if !(self.is_drag && ask.is_drag) {
            self.cancel.cancel();
            self.cancel = CancelToken::new();
        }
        self.is_drag = ask.is_drag;
        self.number += 1;
        // The thread ends with the window alone.
        let request = Request { number: self.number, ask, cancel: self.cancel.clone() };
        if let Some(requests) = &self.requests {
            let _ = requests.send(request);
        }
        self.number
    }

    /// What came since the last call, each with the number of its request.
    pub fn replies(&self) -> Vec<(u64, Reply)> {
        self.replies.try_iter().collect()
    }
}

impl Drop for Worker {
    /// Waits for the stage that runs: a program that ends while its thread opens a driver is aborted by it.
    fn drop(&mut self) {
        self.cancel.cancel();
        self.requests = None;
        // A panic of the thread was told when it happened.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Lets the window's frames go first. Where there is no GPU the driver's threads, which inherit it, would
/// otherwise keep every core from them.
fn step_back() {
    #[cfg(target_os = "linux")]
    // Of two threads that want a core, one of nice 5 gets a quarter. Refused, the window is less smooth.
    let _ = rustix::process::nice(5);
}

fn serve(adapter: &AdapterChoice, to_do: &Receiver<Request>, tell: &dyn Fn(u64, Reply)) {
    let mut bench = Bench { session: None, coarse: Pace::default(), fine: Pace::default() };
    // Opened at once, so that the first request need not wait for it.
    if let Err(message) = bench.open(adapter, tell) {
        tell(0, Reply::Trouble { message, retries: false });
    }
    while let Ok(mut request) = to_do.recv() {
        while let Ok(newer) = to_do.try_recv() {
            let is_restart = request.ask.is_restart || newer.ask.is_restart;
            request = newer;
            request.ask.is_restart = is_restart;
        }
        if request.ask.is_restart {
            bench.session = None;
        }
        let mut is_second_try = false;
        while let Err(message) = bench.answer(adapter, &request, tell) {
            // What the device held is lost with it.
            bench.session = None;
            tell(request.number, Reply::Trouble { message, retries: !is_second_try });
            if std::mem::replace(&mut is_second_try, true) {
                break;
            }
        }
    }
}

/// The session, and what is known of its speed.
struct Bench {
    session: Option<Session>,
    coarse: Pace,
    fine: Pace,
}

impl Bench {
    fn open(&mut self, adapter: &AdapterChoice, tell: &dyn Fn(u64, Reply)) -> Result<(), String> {
        if self.session.is_none() {
            let session = Session::open(adapter).map_err(|error| error.to_string())?;
            let report = session.gpu().report();
            tell(0, Reply::Opened(format!("{} · {}", report.name, report.backend)));
            self.session = Some(session);
        }
        Ok(())
    }

    /// Answers a request, or says why the device has to be opened anew.
    fn answer(
        &mut self,
        adapter: &AdapterChoice,
        request: &Request,
        tell: &dyn Fn(u64, Reply),
    ) -> Result<(), String> {
        self.open(adapter, tell)?;
        let answered = catch_unwind(AssertUnwindSafe(|| self.levels_of(request, tell)));
        let message = |panic: Box<dyn std::any::Any + Send>| {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("a panic");
            format!("an internal error, please report it: {text}")
        };
        answered.map_err(message)?
    }

    fn levels_of(&mut self, request: &Request, tell: &dyn Fn(u64, Reply)) -> Result<(), String> {
        let Ask { looked_at, beside, rest, .. } = &request.ask;
        for level in self.levels(&request.ask) {
            for nodes in [beside, looked_at] {
                self.solve(request, level, nodes, tell)?;
                if request.cancel.is_cancelled() {
                    return Ok(());
                }
            }
        }
        if !request.ask.is_drag {
            self.solve(request, Level::FULL, rest, tell)?;
            self.tell_kept(request, tell);
        }
        if !request.cancel.is_cancelled() {
            tell(request.number, Reply::Rested);
        }
        Ok(())
    }

    /// Says which frames are kept. Each look makes what it finds the most recently used, so that of many frames
    /// those are kept that are the most wanted.
    fn tell_kept(&mut self, request: &Request, tell: &dyn Fn(u64, Reply)) {
        let Ask { document, looked_at, frames, .. } = &request.ask;
        let Some(session) = self.session.as_mut().filter(|_| !frames.is_empty()) else { return };
        let loaders = document.nodes.iter().filter(|(_, node)| node.type_id == LOADER);
        let loaders: Vec<&str> = loaders.map(|(name, _)| name.as_str()).collect();
        let mut target = names(looked_at);
        target.extend(&loaders);
        let (mut loaded, mut cached) = (BTreeSet::new(), BTreeSet::new());
        for frame in frames {
            if request.cancel.is_cancelled() {
                return;
            }
            let document = Document { frame: Some(*frame), ..document.clone() };
            let found = session.recall(&document, Target::Nodes(&target));
            let is_there = |name: &&str| matches!(found.nodes.get(*name), Some(Outcome::Done { .. }));
            if !loaders.is_empty() && loaders.iter().all(is_there) {
                loaded.insert(*frame);
            }
            if !looked_at.is_empty() && names(looked_at).iter().all(is_there) {
                cached.insert(*frame);
            }
        }
        tell(request.number, Reply::Kept { loaded, cached });
    }

    /// In which steps a request is answered.
    fn levels(&mut self, ask: &Ask) -> Vec<Level> {
        let Some(session) = &mut self.session else { return Vec::new() };
        if ask.looked_at.is_empty() {
            return if ask.beside.is_empty() { Vec::new() } else { vec![Level::FULL] };
        }
        let small = Level { share: self.fine.share(), is_coarse: false };
        let names = names(&ask.looked_at);
        let is_there = |evaluation: &Evaluation| missing(evaluation, &ask.document).is_empty();
        if is_there(&session.recall(&ask.document, Target::Nodes(&names))) {
            return vec![Level::FULL];
        }
        let found = session.recall(&preview::at(&ask.document, small), Target::Nodes(&names));
        // A camera costs nothing; what rests on its view, importance, is a category of its own.
        let is_cheap =
            |category: &Option<Category>| matches!(category, Some(Category::Image | Category::Camera));
        let has_fields = missing(&found, &ask.document).iter().all(is_cheap);
        match (ask.is_drag, has_fields) {
            (true, true) => vec![small],
            (true, false) => vec![Level { share: self.coarse.share(), is_coarse: true }],
            // As quick as the small picture would be seen.
            (false, true) if self.fine.full_ms() < 400.0 => vec![Level::FULL],
            (false, true) => vec![small, Level::FULL],
            (false, false) => vec![Level::FIRST, Level::FULL],
        }
    }

    /// Solves one level and tells what came of it.
    fn solve(
        &mut self,
        request: &Request,
        level: Level,
        nodes: &[String],
        tell: &dyn Fn(u64, Reply),
    ) -> Result<(), String> {
        let Some(session) = &mut self.session else { return Ok(()) };
        if nodes.is_empty() {
            return Ok(());
        }
        let start = Instant::now();
        let frame = request.ask.document.frame;
        let document = preview::at(&request.ask.document, level);
        let target = names(nodes);
        let solved = session.solve(&document, Target::Nodes(&target), &request.cancel, &mut |event| {
            tell(request.number, Reply::Event { event: event.clone(), is_full: level.is_full(), frame });
        });
        let wall_ms = start.elapsed().as_secs_f64() * 1e3;
        if let Err(error @ GpuError::Lost(_)) = session.gpu().check("the picture") {
            return Err(error.to_string());
        }
        let short = solved.evaluation.failures().find(|(_, why)| why.starts_with(OUT_OF_MEMORY));
        if let Some((name, why)) = short {
            return Err(format!("{name}: {why}"));
        }
        // What was kept says nothing of the machine's speed.
        let is_new = |name: &String| solved.costs.iter().any(|cost| cost.name == *name && !cost.cached);
        if !solved.evaluation.cancelled && request.ask.looked_at.iter().any(is_new) {
            match (level.is_full(), level.is_coarse) {
                (true, _) => {}
                (_, true) => self.coarse.measured(level.share, wall_ms),
                (_, false) => self.fine.measured(level.share, wall_ms),
            }
        }
        let values = values(&solved.evaluation, &request.ask.wanted);
        let (cache_bytes, gpu_bytes) = (session.cached_bytes(), session.gpu().bytes_now());
        let solved = Solved { level, frame, values, costs: solved.costs, wall_ms, cache_bytes, gpu_bytes };
        tell(request.number, Reply::Solved(solved));
        Ok(())
    }
}

fn names(nodes: &[String]) -> Vec<&str> {
    nodes.iter().map(String::as_str).collect()
}

/// Categories of the nodes that have no value; `None` for a kind that nobody knows.
fn missing(evaluation: &Evaluation, document: &Document) -> Vec<Option<Category>> {
    let without = evaluation.nodes.iter().filter(|(_, outcome)| !matches!(outcome, Outcome::Done { .. }));
    let category = |job: &String| {
        let name = job.split('@').next().unwrap_or(job);
        Some(catalog().find(&document.nodes.get(name)?.type_id)?.category)
    };
    without.map(|(name, _)| category(name)).collect()
}

fn values(evaluation: &Evaluation, wanted: &[String]) -> Vec<(String, &'static str, Value)> {
    let mut found = Vec::new();
    for (name, outcome) in &evaluation.nodes {
        let Outcome::Done { spec, outputs, .. } = outcome else { continue };
        for (port, value) in spec.outputs.iter().zip(outputs.values()) {
            if matches!(port.kind, PortType::Image | PortType::Camera) || wanted.contains(name) {
                found.push((name.clone(), port.name, value.clone()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests;
