//! Runs a plan: each node once, after those that it reads, unless the cache has its result.
//!
//! An error belongs to its node; what reads it, directly or not, is skipped, everything else goes on. It
//! stops between nodes, and a node may ask the token between its stages; what was finished before stays
//! in the cache. A node that writes a file runs again where the file is no longer as it left it. A node
//! without outputs is there for its effect: it always runs and is never cached.
//! Values live until the evaluation is dropped. Tested with toy nodes that count their runs.

use std::sync::Arc;
use std::time::Instant;

use indexmap::IndexMap;

use super::cache::Cache;
use super::key::{InputKey, Key};
use super::plan::{Job, Plan, Source, Work};
use super::report::Report;
use super::spec::NodeSpec;
use super::value::Value;

pub use super::node::{CancelToken, Inputs, NodeError, NodeJob, Outputs};

/// Who knows the concrete nodes.
pub trait Host {
    /// What the result depends on beside parameters and inputs: path, size and time of files, shader
    /// text, and of frame and viewport what the node reads.
    ///
    /// # Errors
    /// For instance when a file is missing.
    fn identity(&self, job: &NodeJob) -> Result<Vec<u8>, NodeError>;

    /// Runs the node; gives one value for each output of its spec.
    ///
    /// # Errors
    /// What was found, what is allowed, what to do.
    fn run(&self, job: &NodeJob, inputs: &Inputs) -> Result<Outputs, NodeError>;
}

/// What happens, as it happens.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A node begins to run; one whose result is cached does not.
    Started {
        /// The node.
        name: String,
    },
    /// A node has its outputs.
    Finished {
        /// The node.
        name: String,
        /// They were in the cache.
        cached: bool,
        /// Wall clock of its run, 0 if cached, in ms.
        cpu_ms: f64,
        /// Size of its outputs, in bytes.
        bytes: u64,
        /// What it says of its run, also where that was long ago.
        report: Arc<Report>,
    },
    /// A node cannot run, or its run failed.
    Failed {
        /// The node.
        name: String,
        /// Without the node's name.
        message: String,
    },
    /// A node reads one that failed, directly or not.
    Skipped {
        /// The node.
        name: String,
        /// The node that failed.
        because: String,
    },
    /// It was told to stop; nothing follows.
    Cancelled,
}

/// What came of each node that was reached.
#[derive(Debug)]
pub struct Evaluation {
    /// By name, in the order of the plan.
    pub nodes: IndexMap<String, Outcome>,
    /// It was told to stop before all were reached.
    pub cancelled: bool,
}

/// What came of a node.
#[derive(Debug)]
pub enum Outcome {
    /// It has outputs.
    Done {
        /// Its kind.
        spec: &'static NodeSpec,
        /// Hash of all that they depend on.
        key: Key,
        /// One value for each output.
        outputs: Outputs,
    },
    /// It has none; the message is without its name.
    Failed(String),
    /// It reads, directly or not, this node, which failed.
    Skipped(String),
}

impl Evaluation {
    /// The value of an output; `None` when the node did not get so far or has no such output.
    pub fn value(&self, node: &str, port: &str) -> Option<&Value> {
        let Outcome::Done { spec, outputs, .. } = self.nodes.get(node)? else {
            return None;
        };
        Some(&outputs.values()[spec.output(port)?.0])
    }

    /// Nodes that failed, with their messages.
    pub fn failures(&self) -> impl Iterator<Item = (&str, &str)> {
        self.nodes.iter().filter_map(|(name, outcome)| match outcome {
            Outcome::Failed(message) => Some((name.as_str(), message.as_str())),
            _ => None,
        })
    }
}

/// Runs the plan.
pub fn evaluate(
    plan: &Plan,
    host: &dyn Host,
    cache: &mut Cache,
    cancel: &CancelToken,
    on_event: &mut dyn FnMut(Event),
) -> Evaluation {
    let mut evaluation = Evaluation { nodes: IndexMap::new(), cancelled: false };
    for job in &plan.jobs {
        let outcome = cancel.check().and_then(|()| run_job(job, &evaluation, host, cache, cancel, on_event));
        let name = job.name.clone();
        let outcome = match outcome {
            Ok(outcome) => outcome,
            Err(NodeError::Failed(message)) => {
                let event = Event::Failed { name: name.clone(), message: message.clone() };
                on_event(event);
                Outcome::Failed(message)
            }
            Err(NodeError::Cancelled) => {
                on_event(Event::Cancelled);
                evaluation.cancelled = true;
                break;
            }
        };
        evaluation.nodes.insert(name, outcome);
    }
    evaluation
}

fn run_job(
    job: &Job,
    evaluation: &Evaluation,
    host: &dyn Host,
    cache: &mut Cache,
    cancel: &CancelToken,
    on_event: &mut dyn FnMut(Event),
) -> Result<Outcome, NodeError> {
    let name = &job.name;
    let work = job.work.as_ref().map_err(NodeError::new)?;
    let (inputs, input_keys) = match gather(work, evaluation) {
        Ok(gathered) => gathered,
        Err(because) => {
            on_event(Event::Skipped { name: name.clone(), because: because.clone() });
            return Ok(Outcome::Skipped(because));
        }
    };
    let spec = work.spec;
    let node = NodeJob { name, spec, params: &work.params, cancel };
    let identity = host.identity(&node)?;
    let key = Key::new(spec, &work.params, &input_keys, &identity);
    // A file that somebody changed or removed is written again.
    let found = cache.get(&key).filter(Outputs::are_current);
    let cached = found.is_some();
    let mut cpu_ms = 0.0;
    let outputs = match found {
        Some(outputs) => outputs,
        None => {
            on_event(Event::Started { name: name.clone() });
            let start = Instant::now();
            let outputs = host.run(&node, &inputs)?;
            cpu_ms = start.elapsed().as_secs_f64() * 1e3;
            assert_outputs(spec, &outputs);
            if !spec.outputs.is_empty() {
                cache.insert(key, outputs.clone());
            }
            outputs
        }
    };
    let report = Arc::clone(outputs.report());
    on_event(Event::Finished { name: name.clone(), cached, cpu_ms, bytes: outputs.bytes(), report });
    Ok(Outcome::Done { spec, key, outputs })
}

type InputKeys = Vec<Vec<InputKey>>;

/// The values and keys that a node reads, or the failed node because of which it cannot.
fn gather(work: &Work, evaluation: &Evaluation) -> Result<(Inputs, InputKeys), String> {
    let mut inputs = Inputs::new(work.spec);
    let mut keys = Vec::with_capacity(work.sources.len());
    for (port, sources) in work.spec.inputs.iter().zip(&work.sources) {
        let mut port_keys: Vec<InputKey> = Vec::with_capacity(sources.len());
        let mut values: Vec<&Value> = Vec::with_capacity(sources.len());
        for Source { job_idx, output_idx, share } in sources {
            let (name, outcome) = evaluation.nodes.get_index(*job_idx).expect("run before");
            match outcome {
                Outcome::Done { key, outputs, .. } => {
                    let same = |found: &&mut InputKey| (found.key, found.output_idx) == (*key, *output_idx);
                    match port_keys.iter_mut().find(same).filter(|_| port.faded_by.is_some()) {
                        // From one value to the same there is no fade, so that it is one result, not one a frame.
                        Some(found) => found.share = 1.0,
                        None => {
                            port_keys.push(InputKey { key: *key, output_idx: *output_idx, share: *share });
                            values.push(&outputs.values()[*output_idx]);
                        }
                    }
                }
                Outcome::Failed(_) => return Err(name.clone()),
                Outcome::Skipped(because) => return Err(because.clone()),
            }
        }
        for (value, key) in values.into_iter().zip(&port_keys) {
            inputs.push_share(port.name, value.clone(), key.share);
        }
        keys.push(port_keys);
    }
    Ok((inputs, keys))
}

/// A node that gives other values than its spec declares is our own mistake.
fn assert_outputs(spec: &NodeSpec, outputs: &Outputs) {
    let given: Vec<_> = outputs.values().iter().map(|value| value.kind).collect();
    let declared: Vec<_> = spec.outputs.iter().map(|port| port.kind).collect();
    assert_eq!(given, declared, "outputs of {}", spec.id);
}

#[cfg(test)]
mod tests;
