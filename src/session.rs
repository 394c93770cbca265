//! The engine that editor and command line share: the device, the cache, and the running of graphs.
//!
//! A [`Session`] holds what is expensive: the open device with its compiled stages, and the results of
//! nodes by the hash of everything that they depend on. A graph goes in, events and values come out.

use std::cell::RefCell;
use std::collections::HashMap;
use std::time::Instant;

use crate::gpu::{AdapterChoice, Gpu, GpuError, shader_names, shader_text};
use crate::graph::{
    Cache, CancelToken, Decision, Document, Evaluation, Event, FileState, Host, Inputs, NodeError, NodeJob,
    Outcome, Outputs, ParamKind, Plan, Target, evaluate,
};
use crate::nodes::{self, Rules, Run};

mod explain;

pub use explain::{Explained, Explanation};

/// The cache keeps results up to so many bytes, on CPU and GPU together, unless told otherwise.
pub const CACHE_BYTES: u64 = 2 << 30;

/// An open engine.
pub struct Session {
    gpu: Gpu,
    cache: Cache,
    prune: bool,
}

/// What came of a graph.
pub struct Solved {
    /// Values and failures by node.
    pub evaluation: Evaluation,
    /// Costs of each node that ran or was cached, in order.
    pub costs: Vec<NodeCost>,
    /// Wall clock of all in ms.
    pub wall_ms: f64,
    /// The most bytes held on the device at once.
    pub peak_gpu_bytes: u64,
}

/// What a node cost.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct NodeCost {
    /// The node; `camera@8` where it ran for the sake of another frame.
    pub name: String,
    /// Its kind.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Wall clock in ms.
    pub cpu_ms: f64,
    /// Of its stages in ms.
    pub gpu_ms: f64,
    /// What its outputs hold once all nodes have run: of a file, the grids that others asked for.
    pub bytes: u64,
    /// Whether its result was there already.
    pub cached: bool,
    /// What the scene required of it, and what was left out.
    pub decisions: Vec<Decision>,
}

impl Session {
    /// Opens a device.
    ///
    /// # Errors
    /// [`GpuError::Adapter`] says what is missing.
    pub fn open(adapter: &AdapterChoice) -> Result<Self, GpuError> {
        Ok(Self { gpu: Gpu::open(adapter)?, cache: Cache::new(CACHE_BYTES), prune: true })
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Whether what a scene does not require is left out, as it is unless told otherwise; else everything is
    /// modeled, to see what that costs and changes.
    pub fn set_pruning(&mut self, prune: bool) {
        self.prune = prune;
    }

    /// Forgets all results; compiled stages stay.
    pub fn forget(&mut self) {
        self.cache.clear();
    }

    /// What its results hold now on CPU and GPU together, in bytes.
    pub fn cached_bytes(&self) -> u64 {
        self.cache.used_bytes()
    }

    /// What of `target` is there already. Nothing runs: a node that would have to has failed in what is
    /// answered, and what reads it is skipped.
    pub fn recall(&mut self, document: &Document, target: Target) -> Evaluation {
        let plan = Plan::new(document, nodes::catalog(), target);
        let host = NodeHost { recalls: true, ..NodeHost::new(&self.gpu, self.prune) };
        evaluate(&plan, &host, &mut self.cache, &CancelToken::new(), &mut |_| {})
    }

    /// Runs what `target` needs; results that are still valid are taken from the cache. The document
    /// should have been checked: a node with a problem fails, and what does not depend on it goes on.
    pub fn solve(
        &mut self,
        document: &Document,
        target: Target,
        cancel: &CancelToken,
        on_event: &mut dyn FnMut(&Event),
    ) -> Solved {
        let start = Instant::now();
        self.gpu.take_peak_bytes();
        let plan = Plan::new(document, nodes::catalog(), target);
        let host = NodeHost::new(&self.gpu, self.prune);
        let mut costs = Vec::new();
        let evaluation = evaluate(&plan, &host, &mut self.cache, cancel, &mut |event| {
            if let Event::Finished { name, cached, cpu_ms, bytes, report } = &event {
                let work = plan.job(name).and_then(|job| job.work.as_ref().ok());
                costs.push(NodeCost {
                    name: name.clone(),
                    kind: work.map_or("", |work| work.spec.id),
                    cpu_ms: *cpu_ms,
                    gpu_ms: host.gpu_ms.borrow().get(name).copied().filter(|_| !cached).unwrap_or(0.0),
                    bytes: *bytes,
                    cached: *cached,
                    decisions: report.decisions.clone(),
                });
            }
            on_event(&event);
        });
        for cost in &mut costs {
            if let Some(Outcome::Done { outputs, .. }) = evaluation.nodes.get(&cost.name) {
                cost.bytes = outputs.bytes();
            }
        }
        Solved {
            evaluation,
            costs,
            wall_ms: start.elapsed().as_secs_f64() * 1e3,
            peak_gpu_bytes: self.gpu.take_peak_bytes(),
        }
    }
}

/// Runs nodes for the graph.
struct NodeHost<'a> {
    gpu: &'a Gpu,
    shaders: [u8; 32],
    prune: bool,
    /// Expensive nodes only say what they would do.
    foretells: bool,
    /// Nothing runs: only what is cached is found.
    recalls: bool,
    gpu_ms: RefCell<HashMap<String, f64>>,
}

impl<'a> NodeHost<'a> {
    fn new(gpu: &'a Gpu, prune: bool) -> Self {
        Self {
            gpu,
            shaders: shader_hash(),
            prune,
            foretells: false,
            recalls: false,
            gpu_ms: RefCell::default(),
        }
    }
}

impl Host for NodeHost<'_> {
    fn identity(&self, job: &NodeJob) -> Result<Vec<u8>, NodeError> {
        let kind = nodes::kind(job.spec.id).expect("the plan holds kinds of the catalog");
        let mut identity = self.shaders.to_vec();
        identity.push(u8::from(!self.prune && !matches!(kind.rules, Rules::None)));
        identity.push(u8::from(self.foretells && matches!(kind.rules, Rules::Foretold(_))));
        for path in (kind.files)(job.params)? {
            // A file that is not there is the node's to report.
            identity.extend(FileState::of(&path).to_bytes());
        }
        Ok(identity)
    }

    fn run(&self, job: &NodeJob, inputs: &Inputs) -> Result<Outputs, NodeError> {
        if self.recalls {
            return Err(NodeError::new("its result is not cached"));
        }
        let kind = nodes::kind(job.spec.id).expect("the plan holds kinds of the catalog");
        let run = Run {
            params: job.params,
            inputs,
            gpu: self.gpu,
            cancel: job.cancel,
            prune: self.prune,
            report: RefCell::default(),
        };
        self.gpu.take_ms();
        let outputs = match self.foretells {
            true => explain::foretell(&run, kind, inputs),
            false => (kind.run)(&run).map(Outputs::new),
        };
        // Asked also where the node failed, so that the next node does not get this one's error.
        let reported = self.gpu.check(job.spec.id);
        let outputs = outputs?.with_report(run.report.take());
        reported?;
        self.gpu_ms.borrow_mut().insert(job.name.to_owned(), self.gpu.take_ms());
        if self.foretells {
            return Ok(outputs);
        }
        let written = job.spec.params.iter().filter(|param| matches!(param.kind, ParamKind::OutPath));
        let written = written.map(|param| FileState::of(job.params.path(param.name)));
        Ok(outputs.with_written(written.collect::<Vec<_>>()))
    }
}

/// Of all shader files: an edited shader (debug builds read them from disk) makes every result stale.
fn shader_hash() -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for name in shader_names() {
        hasher.update(name.as_bytes());
        hasher.update(shader_text(&name).unwrap_or_default().as_bytes());
    }
    *hasher.finalize().as_bytes()
}
