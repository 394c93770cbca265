//! What a graph would do: every rule's decision, sizes and times, without the expensive nodes.
//!
//! What costs little is run (files, media, decompositions, importance), because decisions rest on what is
//! found there; propagations, residuals and marches only foretell what they would do, from the same functions
//! that they run by. What follows from a picture is unknown and not run, so that nothing is written.

use std::sync::Arc;

use super::{NodeHost, Session};
use crate::gpu::GpuError;
use crate::graph::{
    CancelToken, Document, Event, Inputs, NodeError, Outcome, Outputs, Plan, Report, Target, Value, evaluate,
};
use crate::nodes::{self, Rules, Run};
use crate::planner::cost;

/// What a graph would do.
pub struct Explained {
    /// In the order in which they run.
    pub nodes: Vec<Explanation>,
    /// Nodes that no output needs.
    pub left_out: Vec<String>,
    /// Nodes that cannot run, with their messages.
    pub failures: Vec<(String, String)>,
    /// What the device copies [GB/s, read and written].
    pub copy_gb_per_s: f64,
}

/// What a node would do.
pub struct Explanation {
    /// The node.
    pub name: String,
    /// Its kind.
    pub kind: &'static str,
    /// Whether it was run to know this; else it was foretold.
    pub was_run: bool,
    /// The wall clock of that run, 0 where its result was there already; else the prediction, which is the device's own
    /// time. `None` where nobody knows, in ms.
    pub ms: Option<f64>,
    /// Of its outputs; `None` where nobody knows in bytes.
    pub bytes: Option<u64>,
    /// What it says of itself.
    pub report: Arc<Report>,
    /// The inputs that stay empty, and what that means.
    pub absent: Vec<(&'static str, &'static str)>,
}

impl Session {
    /// What `target` would do.
    ///
    /// # Errors
    /// [`GpuError`] where the device cannot even copy.
    pub fn explain(&mut self, document: &Document, target: Target) -> Result<Explained, GpuError> {
        let copy_gb_per_s = self.gpu.copy_gb_per_s()?;
        let plan = Plan::new(document, nodes::catalog(), target);
        let host = NodeHost { foretells: true, ..NodeHost::new(&self.gpu, self.prune) };
        let mut ran = Vec::new();
        let evaluation = evaluate(&plan, &host, &mut self.cache, &CancelToken::new(), &mut |event| {
            if let Event::Finished { name, cpu_ms, .. } = event {
                ran.push((name, cpu_ms));
            }
        });
        let is_cpu = self.gpu.is_cpu();
        let explain = |(name, cpu_ms): (String, f64)| {
            let Some(Outcome::Done { spec, outputs, .. }) = evaluation.nodes.get(&name) else {
                unreachable!("it has finished")
            };
            let report = Arc::clone(outputs.report());
            let is_unknown = outputs.values().iter().any(Value::is_unknown);
            let is_foretold =
                matches!(nodes::kind(spec.id).map(|kind| &kind.rules), Some(Rules::Foretold(_)));
            let was_run = !is_foretold && !is_unknown;
            let predicted = || {
                let times =
                    report.stages.iter().map(|stage| cost::predicted_ms(stage, copy_gb_per_s, is_cpu));
                times.sum::<Option<f64>>()
            };
            let absent = plan.job(&name).and_then(|job| job.work.as_ref().ok()).map(|work| {
                let empty = work.spec.inputs.iter().zip(&work.sources).filter(|(_, wired)| wired.is_empty());
                empty.filter_map(|(port, _)| Some((port.name, port.absent?))).collect()
            });
            Explanation {
                kind: spec.id,
                was_run,
                ms: if was_run { Some(cpu_ms) } else { predicted().filter(|_| is_foretold) },
                bytes: report.bytes.or(was_run.then(|| outputs.bytes())),
                report,
                absent: absent.unwrap_or_default(),
                name,
            }
        };
        Ok(Explained {
            nodes: ran.into_iter().map(explain).collect(),
            left_out: plan.left_out.clone(),
            failures: evaluation.failures().map(|(name, why)| (name.to_owned(), why.to_owned())).collect(),
            copy_gb_per_s,
        })
    }
}

/// What a node would give: runs it where that costs little.
pub(super) fn foretell(run: &Run, kind: &nodes::NodeKind, inputs: &Inputs) -> Result<Outputs, NodeError> {
    let values = match kind.rules {
        _ if inputs.all().any(Value::is_unknown) => {
            kind.spec.outputs.iter().map(|port| Value::unknown(port.kind)).collect()
        }
        Rules::Foretold(foretell) => foretell(run)?,
        Rules::Cheap | Rules::None => (kind.run)(run)?,
    };
    Ok(Outputs::new(values))
}
