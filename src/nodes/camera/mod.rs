//! `camera`: the view.

use glam::DVec3;

use super::{NodeKind, Rules, Run, no_files};
use crate::camera::Camera;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "camera",
    version: 1,
    category: Category::Camera,
    purpose: "A pinhole camera: position, target, vertical angle and picture size.",
    doc: "World: right-handed, Y up, meters. Row 0 of the picture is on top; a pixel is a square.",
    inputs: &[],
    outputs: &[PortSpec::new("camera", PortType::Camera, "the view")],
    params: &[
        ParamSpec::vector("position", &[0.0, 0.0, 5.0]).unit("m").doc("Where the camera stands."),
        ParamSpec::vector("look_at", &[0.0, 0.0, 0.0])
            .unit("m")
            .doc("The point in the middle of the picture."),
        ParamSpec::direction("up", [0.0, 1.0, 0.0]).doc("What is up in the picture."),
        ParamSpec::float("fov_y_deg", 40.0)
            .unit("deg")
            .between(0.0, 180.0)
            .open()
            .soft(5.0, 120.0)
            .doc("Full vertical angle of view."),
        ParamSpec::int("width", 512)
            .unit("px")
            .between(1.0, 16384.0)
            .soft(64.0, 4096.0)
            .doc("Pixels across."),
        ParamSpec::int("height", 512).unit("px").between(1.0, 16384.0).soft(64.0, 4096.0).doc("Pixels down."),
    ],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let camera = Camera {
        position: DVec3::from_array(run.params.vec("position")),
        look_at: DVec3::from_array(run.params.vec("look_at")),
        up: DVec3::from_array(run.params.vec("up")),
        fov_y_deg: run.params.f64("fov_y_deg"),
        width: run.params.i64("width") as usize,
        height: run.params.i64("height") as usize,
    };
    camera.frame().map_err(NodeError::new)?;
    Ok(vec![Value::new(PortType::Camera, size_of::<Camera>() as u64, camera)])
}
