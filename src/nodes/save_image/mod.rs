//! `save_image`: writes a picture to a file.

use super::{NodeKind, Rules, Run, no_files};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::{self, Image};

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "save_image",
    version: 1,
    category: Category::Image,
    purpose: "Writes a picture: .exr with all layers, or .png.",
    doc: "The file appears whole or not at all; its folder is made where it is missing. EXR holds 32-bit floats: R G B of the beauty, \
          A the coverage, Z the depth in meters, other layers as layer.R. PNG is sRGB with 8 bits; without a tone_map node before it, \
          at exposure 0 and clipped at 1.",
    inputs: &[PortSpec::new("image", PortType::Image, "the picture")],
    outputs: &[PortSpec::new("image", PortType::Image, "the same picture")],
    params: &[ParamSpec::out_path("path", "out/picture.exr")
        .endings(image::ENDINGS)
        .doc("Where to write, .exr or .png; relative to the graph file.")],
};

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let picture: &Image = run.inputs.one("image");
    image::write(run.params.path("path"), picture).map_err(NodeError::new)?;
    Ok(run.inputs.values("image").to_vec())
}
