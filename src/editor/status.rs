//! What every node tells: what it does now, what it cost, what was left out.

use std::collections::HashMap;
use std::sync::Arc;

use crate::graph::Report;

/// What a node does now.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum NodeState {
    /// It never ran, or no output needs it.
    #[default]
    Idle,
    /// It ran, and something that it depends on changed since.
    Stale,
    /// It runs.
    Running,
    /// It has its outputs.
    Done,
    /// Why it has none.
    Failed(String),
    /// The node that failed, because of which it cannot run.
    Skipped(String),
}

/// What is known of a node.
#[derive(Debug, Clone, Default)]
pub struct NodeStatus {
    /// What it does now.
    pub state: NodeState,
    /// Whether its last result came from the cache.
    pub cached: bool,
    /// Wall clock of its last run in ms.
    pub cpu_ms: f64,
    /// Of its stages in ms.
    pub gpu_ms: f64,
    /// What its outputs hold.
    pub bytes: u64,
    /// What it said of its run: what was left out, and why.
    pub report: Arc<Report>,
}

/// By node.
pub type Statuses = HashMap<String, NodeStatus>;
