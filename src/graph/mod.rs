//! The node graph: what nodes are, the file, its checks, the order, the cache and the evaluation.
//!
//! From text to values: `Document` (the file as it stands) → `flatten` (without groups, mutes and bypasses)
//! → `check` (everything wrong with it, at once) → `Plan` (what to run, in which order) → `evaluate` (runs it through a `Host`, with a `Cache` by
//! `Key`). What a node is stands in its `NodeSpec` alone. The graph knows no concrete node, no GPU and
//! no UI: values are opaque, and the host that runs nodes is handed in.
//!
//! Data flow can be read as: names and JSON → validated parameters → keys → values.

pub mod cache;
pub mod check;
pub mod document;
pub mod edit;
pub mod eval;
pub mod file;
pub mod flat;
pub mod key;
pub mod layout;
mod node;
pub mod params;
pub mod plan;
mod ports;
mod report;
pub mod spec;
mod suggest;
pub mod value;

#[cfg(test)]
mod toy;

pub use cache::Cache;
pub use check::{Problem, check};
pub use document::{
    Document, DocumentError, End, Frame, GROUP, Node, RESERVED, Wire, is_node_name, node_name_from,
};
pub use edit::SetError;
pub use eval::{
    CancelToken, Evaluation, Event, Host, Inputs, NodeError, NodeJob, Outcome, Outputs, evaluate,
};
pub use file::FileState;
pub use flat::{Flattened, Silence, flatten};
pub use key::Key;
pub use params::{Moment, ParamProblem, ParamValue, Params, check_value};
pub use plan::{Job, Plan, Source, Target, Work};
pub use ports::{Port, Side};
pub use report::{Decision, Report, StageWork};
pub use spec::{Catalog, Category, Limits, NodeSpec, ParamKind, ParamSpec, PortSpec, PortType, Timing};
pub use suggest::did_you_mean;
pub use value::Value;
