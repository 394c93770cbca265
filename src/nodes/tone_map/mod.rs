//! `tone_map`: from radiance to the display.
//!
//! The formulas and their sources stand in [`crate::image::tonemap`], which is also the reference on the
//! CPU. Only the beauty is mapped; other layers stay radiance.

use super::{NodeKind, Rules, Run, no_files};
use crate::gpu::Bind;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::tonemap::{ACES_FIT, ACES_IN, ACES_OUT, CEILING, HABLE, HABLE_GAIN, HABLE_WHITE};
use crate::image::{BEAUTY, Image};
use crate::mirror;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "tone_map",
    version: 1,
    category: Category::Image,
    purpose: "Maps radiance to the display: exposure and a tone curve.",
    doc: "Multiplies by 2 to the power of exposure_ev and bends the result: none leaves it linear, filmic is Hable's curve, aces Hill's \
          fit of ACES. The result is linear display light; save_image encodes a PNG as sRGB.",
    inputs: &[PortSpec::new("image", PortType::Image, "radiance")],
    outputs: &[PortSpec::new("image", PortType::Image, "display light, 0 to 1 with a curve")],
    params: &[
        ParamSpec::float("exposure_ev", 0.0)
            .unit("EV")
            .between(-100.0, 100.0)
            .soft(-8.0, 8.0)
            .doc("One more is twice as bright."),
        ParamSpec::choice("curve", &["none", "filmic", "aces"]).doc("The tone curve."),
    ],
};

mirror! {
    /// `ToneParams` of `shaders/tone_map.wgsl`.
    pub(super) struct ToneParams {
        n_pixels: u32,
        width: u32,
        curve: u32,
        gain: f32,
        aces_in: [[f32; 4]; 3],
        aces_out: [[f32; 4]; 3],
        aces_fit: [f32; 4],
        ends: [f32; 4],
        hable: [[f32; 4]; 2],
    }
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let gpu = run.gpu;
    let picture: &Image = run.inputs.one("image");
    let rows = |matrix: [[f32; 3]; 3]| matrix.map(|row| [row[0], row[1], row[2], 0.0]);
    let params = ToneParams {
        n_pixels: (picture.width * picture.height) as u32,
        width: picture.width as u32,
        curve: match run.params.text("curve") {
            "filmic" => 1,
            "aces" => 2,
            _ => 0,
        },
        gain: (run.params.f64("exposure_ev") as f32).exp2(),
        aces_in: rows(ACES_IN),
        aces_out: rows(ACES_OUT),
        aces_fit: [ACES_FIT[0], ACES_FIT[1], ACES_FIT[2], ACES_FIT[3]],
        ends: [ACES_FIT[4], CEILING, HABLE_GAIN, HABLE_WHITE],
        hable: [[HABLE[0], HABLE[1], HABLE[2], HABLE[3]], [HABLE[4], HABLE[5], 0.0, 0.0]],
    };
    let remedy = "lower camera.width or camera.height";
    let radiance = gpu.buffer_from("radiance", picture.beauty(), remedy)?;
    let display = gpu.buffer("display light", radiance.bytes(), remedy)?;
    let bound =
        gpu.stage("tone_map", &[])?.bind(gpu, &params, &[Bind::Buffer(&radiance)], &[Bind::Buffer(&display)]);
    let mut recorder = gpu.recorder("tone_map");
    recorder.dispatch(&bound, [picture.width, picture.height, 1]);
    run.finish(recorder)?;
    let mut mapped: Vec<f32> = gpu.read_buffer(&display)?;
    mapped.truncate(picture.beauty().len());
    let mut image = picture.clone();
    image.insert(BEAUTY, 3, mapped);
    Ok(vec![Value::new(PortType::Image, image.bytes(), image)])
}

#[cfg(test)]
mod tests;
