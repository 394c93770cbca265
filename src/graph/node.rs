//! What a node meets when it runs: its job, its inputs, its outputs, its errors, and the token that
//! tells it to stop.
//!
//! Nodes hold no state; everything that a result depends on stands in the job, the inputs, or the
//! identity that the host adds. Asking for a port that the spec does not declare, or for a type that it
//! does not carry, is our own mistake and panics. Tested here and in `eval`.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::file::FileState;
use super::params::Params;
use super::report::Report;
use super::spec::NodeSpec;
use super::value::Value;

/// One node to run.
#[derive(Debug, Clone, Copy)]
pub struct NodeJob<'a> {
    /// Its name, for progress; a result must not depend on it.
    pub name: &'a str,
    /// Its kind.
    pub spec: &'static NodeSpec,
    /// Its parameters.
    pub params: &'a Params,
    /// To be asked between stages.
    pub cancel: &'a CancelToken,
}

/// Values by input.
#[derive(Debug, Clone)]
pub struct Inputs {
    spec: &'static NodeSpec,
    /// For each input of the spec, in the order of the wires.
    ports: Vec<Vec<Value>>,
    /// What each value counts for.
    shares: Vec<Vec<f64>>,
}

impl Inputs {
    /// All inputs empty.
    pub fn new(spec: &'static NodeSpec) -> Self {
        let n_inputs = spec.inputs.len();
        Self { spec, ports: vec![Vec::new(); n_inputs], shares: vec![Vec::new(); n_inputs] }
    }

    /// Adds a value after those that the input has.
    ///
    /// # Panics
    /// When the input is not declared or takes another kind or no second value.
    pub fn push(&mut self, port: &str, value: Value) {
        self.push_share(port, value, 1.0);
    }

    /// Adds a value that counts for a share of one, to an input that fades; elsewhere it is 1.
    ///
    /// # Panics
    /// As `push` does.
    pub fn push_share(&mut self, port: &str, value: Value, share: f64) {
        let idx = self.place(port);
        let spec = &self.spec.inputs[idx];
        assert_eq!(value.kind, spec.kind, "{}.{port}", self.spec.id);
        let takes_many = spec.many || spec.faded_by.is_some();
        assert!(takes_many || self.ports[idx].is_empty(), "{}.{port} takes one value", self.spec.id);
        self.ports[idx].push(value);
        self.shares[idx].push(share);
    }

    /// The value of an input that must be wired.
    pub fn one<T: 'static>(&self, port: &str) -> &T {
        let value = self.maybe(port);
        value.unwrap_or_else(|| panic!("{}.{port} is empty", self.spec.id))
    }

    /// The value of an optional input.
    pub fn maybe<T: 'static>(&self, port: &str) -> Option<&T> {
        self.ports[self.place(port)].first().map(Value::get)
    }

    /// The values of an input that takes many, in the order of the wires.
    pub fn many<T: 'static>(&self, port: &str) -> Vec<&T> {
        self.values(port).iter().map(Value::get).collect()
    }

    /// The values of an input that fades, none or those of one or two frames, with shares that add up to 1.
    pub fn faded<T: 'static>(&self, port: &str) -> Vec<(&T, f64)> {
        self.many(port).into_iter().zip(self.shares[self.place(port)].iter().copied()).collect()
    }

    /// The values themselves, for a node that passes one on.
    pub fn values(&self, port: &str) -> &[Value] {
        &self.ports[self.place(port)]
    }

    /// The values of all inputs.
    pub fn all(&self) -> impl Iterator<Item = &Value> {
        self.ports.iter().flatten()
    }

    fn place(&self, port: &str) -> usize {
        let place = self.spec.inputs.iter().position(|spec| spec.name == port);
        place.unwrap_or_else(|| panic!("{} declares no input '{port}'", self.spec.id))
    }
}

/// Values by output, in the order of the spec.
#[derive(Debug, Clone)]
pub struct Outputs {
    values: Arc<[Value]>,
    written: Arc<[FileState]>,
    report: Arc<Report>,
}

impl Outputs {
    /// One value for each output.
    pub fn new(values: impl Into<Arc<[Value]>>) -> Self {
        Self { values: values.into(), written: Arc::default(), report: Arc::default() }
    }

    /// And the files that the node wrote, as it left them.
    pub fn with_written(self, files: impl Into<Arc<[FileState]>>) -> Self {
        Self { written: files.into(), ..self }
    }

    /// And what the node says of its run.
    pub fn with_report(self, report: Report) -> Self {
        Self { report: Arc::new(report), ..self }
    }

    /// What the node said when it ran.
    pub fn report(&self) -> &Arc<Report> {
        &self.report
    }

    /// One value for each output.
    pub fn values(&self) -> &[Value] {
        &self.values
    }

    /// Whether every file that the node wrote is still as the node left it.
    pub fn are_current(&self) -> bool {
        self.written.iter().all(FileState::holds)
    }

    /// Memory that all values hold now, in bytes.
    pub fn bytes(&self) -> u64 {
        let sizes = self.values.iter().map(Value::bytes);
        sizes.fold(0, u64::saturating_add)
    }
}

/// Why a node gave nothing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NodeError {
    /// What was found, what is allowed, what to do; the graph adds the node's name.
    #[error("{0}")]
    Failed(String),
    /// It was told to stop.
    #[error("cancelled")]
    Cancelled,
}

impl NodeError {
    /// From any error or text: `.map_err(NodeError::new)`.
    pub fn new(message: impl fmt::Display) -> Self {
        Self::Failed(message.to_string())
    }
}

/// Tells a running evaluation to stop; clones are the same token.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// A token that has not been used.
    pub fn new() -> Self {
        Self::default()
    }

    /// Tells all who ask to stop.
    pub fn cancel(&self) {
        // Nothing else is published with the flag.
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether to stop.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// To be asked between stages, with `?`.
    ///
    /// # Errors
    /// `NodeError::Cancelled` when it is time to stop.
    pub fn check(&self) -> Result<(), NodeError> {
        if self.is_cancelled() {
            return Err(NodeError::Cancelled);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::spec::{Category, PortSpec, PortType};

    static SPEC: NodeSpec = NodeSpec {
        id: "kind",
        version: 1,
        category: Category::Light,
        purpose: "",
        doc: "",
        inputs: &[
            PortSpec::new("a", PortType::Light, "").optional(""),
            PortSpec::new("b", PortType::Light, "").many(),
        ],
        outputs: &[],
        params: &[],
    };

    fn light(x: u8) -> Value {
        Value::new(PortType::Light, 1, x)
    }

    #[test]
    fn inputs_keep_order() {
        let mut inputs = Inputs::new(&SPEC);
        assert_eq!(inputs.maybe::<u8>("a"), None);
        inputs.push("b", light(2));
        inputs.push("b", light(1));
        inputs.push("a", light(7));
        assert_eq!(*inputs.one::<u8>("a"), 7);
        assert_eq!(inputs.many::<u8>("b"), [&2, &1]);
        assert_eq!(inputs.values("b").len(), 2);
    }

    #[test]
    #[should_panic(expected = "kind.a is empty")]
    fn an_empty_input_is_no_value() {
        Inputs::new(&SPEC).one::<u8>("a");
    }

    #[test]
    #[should_panic(expected = "kind declares no input 'c'")]
    fn undeclared_input() {
        Inputs::new(&SPEC).many::<u8>("c");
    }

    #[test]
    #[should_panic(expected = "kind.a takes one value")]
    fn second_value() {
        let mut inputs = Inputs::new(&SPEC);
        inputs.push("a", light(1));
        inputs.push("a", light(1));
    }

    #[test]
    #[should_panic(expected = "kind.a")]
    fn other_kind() {
        let image = Value::new(PortType::Image, 1, 1_u8);
        Inputs::new(&SPEC).push("a", image);
    }

    #[test]
    fn clones_of_a_token_are_the_same() {
        let token = CancelToken::new();
        let clone = token.clone();
        assert_eq!(clone.check(), Ok(()));
        token.cancel();
        assert_eq!(clone.check(), Err(NodeError::Cancelled));
    }
}
