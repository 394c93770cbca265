//! `environment`: light from all directions, constant or from a picture.

use std::path::PathBuf;
use std::sync::Arc;

use super::{NodeKind, Rules, Run};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, Params, PortSpec, PortType, Value};
use crate::image;
use crate::light::BRIGHTEST;
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
        ParamSpec::path("path")
            .or_null()
            .endings(image::ENVIRONMENT_ENDINGS)
            .doc("A lat-long picture; null for a constant radiance."),
        ParamSpec::rgb("radiance", [1.0; 3])
            .unit("W/(m2 sr)")
            .between(0.0, BRIGHTEST)
            .soft(0.0, 5.0)
            .doc("The constant radiance, linear Rec. 709."),
        ParamSpec::float("scale", 1.0)
            .between(0.0, BRIGHTEST)
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
    let brightest = match &environment {
        Environment::Constant(radiance) => radiance.iter().copied().fold(0.0, f64::max),
        Environment::Map(map) => scale * f64::from(map.texels.iter().flatten().copied().fold(0.0, f32::max)),
    };
    if brightest > BRIGHTEST {
        return Err(NodeError::new(format!(
            "scale {scale:?} makes the brightest radiance {brightest:?} W/(m2 sr), at most {BRIGHTEST:?} is computed: lower scale"
        )));
    }
    let bytes = match &environment {
        Environment::Map(map) => size_of_val(map.texels.as_slice()) as u64,
        Environment::Constant(_) => 0,
    };
    Ok(vec![Value::new(PortType::Environment, bytes, environment)])
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use crate::image::{Image, write};
    use crate::nodes::testing::{gpu, run};

    #[test]
    fn what_is_too_bright_is_refused() {
        let Some(gpu) = gpu() else { return };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sky.exr");
        write(&path, &Image::new(2, 1, vec![1.0, 4.0, 2.0, 0.0, 0.0, 0.0])).unwrap();
        assert!(run(gpu, "environment", json!({ "path": path, "scale": 2.5e27 }), &[]).is_ok());
        let remedy = "at most 1e28 is computed: lower scale";
        for params in [json!({ "path": path, "scale": 3e27 }), json!({ "radiance": 1.2, "scale": 1e28 })] {
            let error = run(gpu, "environment", params, &[]).unwrap_err().to_string();
            assert!(error.contains(" 1.2e28 W/(m2 sr), ") && error.ends_with(remedy), "{error}");
        }
    }
}
