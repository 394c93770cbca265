//! `environment`: light from all directions, constant or from a picture.

use std::path::PathBuf;
use std::sync::Arc;

use super::{NodeKind, Rules, Run};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, Params, PortSpec, PortType, Value};
use crate::image;
use crate::light::environment::{Environment, Map};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "environment",
    version: 1,
    category: Category::Light,
    purpose: "Light from all directions: a constant radiance, or a lat-long picture (.exr, .hdr).",
    doc: "Pictures follow OpenEXR's lat-long convention: +Z is at the center, +X a quarter from the left, +Y on the top row. \
          With a path the picture is used, without one the constant radiance.",
    inputs: &[],
    outputs: &[PortSpec::new(
        "environment",
        PortType::Environment,
        "for light_decomposition and, to be seen, raymarch",
    )],
    params: &[
        ParamSpec::path("path").or_null().doc("A lat-long picture; null for a constant radiance."),
        ParamSpec::rgb("radiance", [1.0; 3])
            .unit("W/(m2 sr)")
            .at_least(0.0)
            .soft(0.0, 5.0)
            .doc("The constant radiance, linear Rec. 709."),
        ParamSpec::float("scale", 1.0)
            .at_least(0.0)
            .soft(0.0, 10.0)
            .doc("What the radiance is multiplied by."),
        ParamSpec::float("rotate_y_deg", 0.0)
            .unit("deg")
            .soft(-180.0, 180.0)
            .doc("Turns the picture right-handed about +Y: +90 takes +Z to +X."),
    ],
};

fn files(params: &Params) -> Result<Vec<PathBuf>, NodeError> {
    Ok(if params.is_set("path") { vec![params.path("path").to_owned()] } else { Vec::new() })
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let scale = run.params.f64("scale");
    let environment = if run.params.is_set("path") {
        let picture = image::read_environment(run.params.path("path")).map_err(NodeError::new)?;
        Environment::Map(Map {
            width: picture.width,
            height: picture.height,
            texels: Arc::new(picture.pixels().to_vec()),
            scale,
            rotate_y: run.params.f64("rotate_y_deg").to_radians(),
            stack: None,
        })
    } else {
        Environment::Constant(run.params.rgb("radiance").map(|c| c * scale))
    };
    let bytes = match &environment {
        Environment::Map(map) => size_of_val(map.texels.as_slice()) as u64,
        Environment::Constant(_) => 0,
    };
    Ok(vec![Value::new(PortType::Environment, bytes, environment)])
}
