//! A handful of toy nodes for the tests: numbers that travel as light.

use std::cell::RefCell;

use super::eval::{Host, Inputs, NodeError, NodeJob, Outputs};
use super::report::{Decision, Report};
use super::spec::{Catalog, Category, NodeSpec, ParamSpec, PortSpec, PortType};
use super::value::Value;

pub const CATALOG: Catalog = Catalog(&[&NUMBER, &SUM, &PAIR, &PAINT, &SAVE, &FILE, &SHAPE, &MEDIUM, &FADE]);

const fn kind(
    id: &'static str,
    inputs: &'static [PortSpec],
    outputs: &'static [PortSpec],
    params: &'static [ParamSpec],
) -> NodeSpec {
    NodeSpec { id, version: 1, category: Category::Light, purpose: "", doc: "", inputs, outputs, params }
}

const LIGHT: PortSpec = PortSpec::new("light", PortType::Light, "");
const IMAGE: PortSpec = PortSpec::new("image", PortType::Image, "");
const VOLUME: PortSpec = PortSpec::new("volume", PortType::Volume, "");

/// Fails for x = 7.
pub static NUMBER: NodeSpec = kind("number", &[], &[LIGHT], &[ParamSpec::float("x", 1.0).between(0.0, 10.0)]);
pub static SUM: NodeSpec = kind("sum", &[PortSpec::new("lights", PortType::Light, "").many()], &[LIGHT], &[]);
/// a − b and a + b, without b the negative and a.
pub static PAIR: NodeSpec = kind(
    "pair",
    &[
        PortSpec::new("a", PortType::Light, ""),
        PortSpec::new("b", PortType::Light, "").optional("nothing is taken off"),
    ],
    &[PortSpec::new("difference", PortType::Light, ""), PortSpec::new("total", PortType::Light, "")],
    &[],
);
/// Fades from one value to the next.
pub static FADE: NodeSpec = kind(
    "fade",
    &[PortSpec::new("light", PortType::Light, "").optional("there is none").faded_by("apart")],
    &[LIGHT],
    &[ParamSpec::int("apart", 4).between(0.0, 100.0)],
);
pub static PAINT: NodeSpec = kind("paint", &[LIGHT], &[IMAGE], &[]);
pub static SAVE: NodeSpec = kind("save", &[IMAGE], &[], &[ParamSpec::out_path("path", "out.exr")]);
pub static FILE: NodeSpec = kind("file", &[], &[VOLUME], &[ParamSpec::path("path")]);
pub static SHAPE: NodeSpec = kind(
    "shape",
    &[],
    &[VOLUME],
    &[
        ParamSpec::choice("kind", &["sphere", "box", "cloud"]),
        ParamSpec::vector("window", &[30.0, 70.0]),
        ParamSpec::int("resolution", 64).between(1.0, 1024.0),
        ParamSpec::bool("loop", false),
        ParamSpec::direction("up", [0.0, 1.0, 0.0]),
        ParamSpec::int("frame", 0).or_null(),
    ],
);
pub static MEDIUM: NodeSpec = kind(
    "medium",
    &[VOLUME],
    &[PortSpec::new("medium", PortType::Medium, "")],
    &[
        ParamSpec::text("density", "density"),
        ParamSpec::rgb("albedo", [1.0; 3]).between(0.0, 1.0),
        ParamSpec::float("g", 0.0).between(-1.0, 1.0).open(),
        ParamSpec::record(
            "emission",
            &[ParamSpec::text("temperature", "temperature"), ParamSpec::text("flame", "flame")],
        ),
    ],
);

/// Runs the numbers, writes down which nodes ran, and stops in the node `stop_in`.
#[derive(Default)]
pub struct ToyHost {
    pub ran: RefCell<Vec<String>>,
    pub stop_in: &'static str,
    pub identity: RefCell<Vec<u8>>,
}

impl ToyHost {
    /// What ran since this was last asked.
    pub fn take(&self) -> Vec<String> {
        self.ran.take()
    }
}

impl Host for ToyHost {
    fn identity(&self, job: &NodeJob) -> Result<Vec<u8>, NodeError> {
        if job.spec.id == "file" {
            return Err(NodeError::new("no file here; write another path"));
        }
        let reads_identity = job.spec.id == "number";
        Ok(if reads_identity { self.identity.borrow().clone() } else { Vec::new() })
    }

    fn run(&self, job: &NodeJob, inputs: &Inputs) -> Result<Outputs, NodeError> {
        self.ran.borrow_mut().push(job.name.to_owned());
        if job.name == self.stop_in {
            job.cancel.cancel();
        }
        job.cancel.check()?;
        let light = |x: f64| Value::new(PortType::Light, 8, x);
        Ok(match job.spec.id {
            "number" => match job.params.f64("x") {
                7.0 => return Err(NodeError::new("7 is unlucky; write another number")),
                x => Outputs::new([light(x)]).with_report(Report {
                    decisions: vec![Decision::kept("toy", "the number", "it is lucky", format!("x = {x}"))],
                    ..Report::default()
                }),
            },
            // The first counts double, so that the order of the wires shows.
            "sum" => {
                let lights = inputs.many::<f64>("lights");
                Outputs::new([light(lights[0] + lights.iter().copied().sum::<f64>())])
            }
            "pair" => {
                let a: &f64 = inputs.one("a");
                let b = inputs.maybe::<f64>("b").copied();
                let difference = b.map_or(-a, |b| a - b);
                Outputs::new([light(difference), light(a + b.unwrap_or(0.0))])
            }
            "fade" => {
                let lights = inputs.faded::<f64>("light");
                Outputs::new([light(lights.iter().map(|(x, share)| share * **x).sum())])
            }
            "paint" => {
                let x: &f64 = inputs.one("light");
                Outputs::new([Value::new(PortType::Image, 16, *x)])
            }
            "save" => Outputs::new([]),
            other => return Err(NodeError::new(format!("{other} does not run"))),
        })
    }
}
