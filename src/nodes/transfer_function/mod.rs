//! `transfer_function`: a volume as colors and opacities of its values, seen by a camera.
//!
//! Emission and absorption (N. Max, *Optical models for direct volume rendering*, 1995, eq. 6): a way of h meters through
//! a value of color c and opacity a adds T c (1 − exp(−a·extinction·h)) and T falls by exp(−a·extinction·h), the value
//! taken in the middle of the step, the steps of a ray equally long. Nothing is lit: the colors are what is seen. Values
//! are interpolated and then looked up. Radiance, coverage.
//! Limits: a border of one voxel fades to what stands outside, so a curve that colors values between the two draws a
//! shell there. Tested by the closed form of one color, and against an oracle in f64.

use glam::{DMat3, DVec3};

use super::scalar::{GRID, Scalar, range};
use super::{NodeKind, Rules, Run, no_files};
use crate::camera::Camera;
use crate::gpu::{Bind, Format};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::image::{ALPHA, Colormap, Image, colormap};
use crate::mirror;
use crate::volume::Volume;

#[cfg(test)]
mod oracle;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "transfer_function",
    version: 1,
    category: Category::Image,
    purpose: "Shows a volume by a color and an opacity for each value, without light.",
    doc: "Each value has a color and an opacity, by control points or by a map with rising opacity; opacity times extinction is what a \
          meter of it absorbs. What absorbs glows in its color. Layers: beauty, alpha (coverage).",
    inputs: &[
        PortSpec::new("volume", PortType::Volume, "the grids"),
        PortSpec::new("camera", PortType::Camera, "the view"),
    ],
    outputs: &[PortSpec::new("image", PortType::Image, "colors of the values, linear Rec. 709")],
    params: &[
        GRID,
        ParamSpec::curve("points", COLUMNS)
            .between(0.0, 1.0)
            .doc("Control points in units of the grid, colors linear Rec. 709; null: colormap over range."),
        ParamSpec::choice("colormap", colormap::NAMES).doc("Colors where points is null."),
        ParamSpec::vector("range", &[0.0, 1.0]).or_null().doc(
            "Values of the map's two ends, at which opacity is 0 and 1; null is the least and the largest value.",
        ),
        ParamSpec::float("extinction", 1.0)
            .unit("1/m")
            .or_null()
            .at_least(0.0)
            .soft(0.0, 100.0)
            .doc("What opacity 1 absorbs; null is 10 over the volume's diagonal."),
        ParamSpec::float("step", 0.5)
            .unit("voxels")
            .between(0.01, 4.0)
            .soft(0.1, 2.0)
            .doc("Longest step along the ray."),
        ParamSpec::rgb("background", [0.0; 3]).at_least(0.0).doc("What stands behind the volume."),
    ],
};

const COLUMNS: &[&str] = &["value", "r", "g", "b", "opacity"];
/// Of a map: its table's entries.
const MAP_POINTS: usize = 256;
/// Optical depth of the diagonal where every value is opaque and no extinction is given.
const DEPTH_OF_DIAGONAL: f64 = 10.0;
/// Pixels that are marched at once, about: a cancel is heard between them.
const BAND_PIXELS: usize = 1 << 18;

mirror! {
    /// `TransferParams` of `shaders/transfer_function.wgsl`.
    pub(super) struct TransferParams {
        eye: [f32; 3],
        step: f32,
        forward: [f32; 3],
        extinction: f32,
        right: [f32; 3],
        n_points: u32,
        up: [f32; 3],
        width: u32,
        tan: [f32; 2],
        height: u32,
        row: u32,
        dims: [u32; 3],
        n_rows: u32,
        background: [f32; 3],
        pad: u32,
    }
}

mirror! {
    /// `Point` of `shaders/transfer_function.wgsl`.
    pub(super) struct PointTexel {
        color: [f32; 3],
        value: f32,
        opacity: f32,
        pad_0: f32,
        pad_1: f32,
        pad_2: f32,
    }
}

/// A control point.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Point {
    value: f64,
    color: [f64; 3],
    opacity: f64,
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let gpu = run.gpu;
    let scalar = Scalar::of_grid(run.inputs.one::<Volume>("volume"), run.params.text("grid"))?;
    let camera: &Camera = run.inputs.one("camera");
    let points = points(run, &scalar)?;
    let extinction = extinction(run, &scalar);
    let padded = scalar.dense.padded(scalar.outside as f32, |value| value);
    let voxels = gpu.texture3_from(
        "the grid's voxels",
        padded.dims,
        Format::R32Float,
        &padded.values,
        "crop the grid",
    )?;
    let texels = points.iter().map(|point| PointTexel {
        color: point.color.map(|x| x as f32),
        value: point.value as f32,
        opacity: point.opacity as f32,
        pad_0: 0.0,
        pad_1: 0.0,
        pad_2: 0.0,
    });
    let texels = gpu.buffer_from("control points", &texels.collect::<Vec<_>>(), "give fewer points")?;
    let (width, height) = (camera.width, camera.height);
    let band = (BAND_PIXELS / width).clamp(1, height);
    let pixels = gpu.buffer("pixels", (band * width * 16) as u64, "lower camera.width")?;
    let (stage, sampler) = (gpu.stage("transfer_function", &[])?, gpu.linear_sampler());
    let inputs = [Bind::Texture(&voxels), Bind::Sampler(&sampler), Bind::Buffer(&texels)];
    let view = view(run, &scalar, camera, points.len(), extinction)?;
    let mut texels: Vec<[f32; 4]> = Vec::with_capacity(width * height);
    for row in (0..height).step_by(band) {
        let n_rows = band.min(height - row);
        let params = TransferParams { row: row as u32, n_rows: n_rows as u32, ..view };
        let mut recorder = gpu.recorder("transfer_function");
        recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&pixels)]), [width, n_rows, 1]);
        run.finish(recorder)?;
        texels.extend_from_slice(&gpu.read_buffer::<[f32; 4]>(&pixels)?[..n_rows * width]);
    }
    let mut image = Image::new(width, height, texels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect());
    image.insert(ALPHA, 1, texels.iter().map(|texel| texel[3]).collect());
    Ok(vec![Value::new(PortType::Image, image.bytes(), image)])
}

fn view(
    run: &Run,
    scalar: &Scalar,
    camera: &Camera,
    n_points: usize,
    extinction: f64,
) -> Result<TransferParams, NodeError> {
    let frame = camera.frame().map_err(NodeError::new)?;
    let turn = DMat3::from_mat4(scalar.dense.world_from_index).inverse();
    let [forward, right, up] = frame.map(|v| (turn * v).as_vec3().to_array());
    Ok(TransferParams {
        eye: scalar.index_of(camera.position).as_vec3().to_array(),
        step: run.params.f64("step") as f32,
        forward,
        extinction: extinction as f32,
        right,
        n_points: n_points as u32,
        up,
        width: camera.width as u32,
        tan: [frame[1].length() as f32, frame[2].length() as f32],
        height: camera.height as u32,
        row: 0,
        dims: scalar.dense.dims.map(|n| n as u32),
        n_rows: 0,
        background: run.params.rgb("background").map(|x| x as f32),
        pad: 0,
    })
}

fn extinction(run: &Run, scalar: &Scalar) -> f64 {
    if run.params.is_set("extinction") {
        return run.params.f64("extinction");
    }
    let corners = scalar.corners();
    let diagonal = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f64::max);
    DEPTH_OF_DIAGONAL / diagonal
}

/// The control points that are given, or else those of the map.
fn points(run: &Run, scalar: &Scalar) -> Result<Vec<Point>, NodeError> {
    if let Some(rows) = run.params.rows("points") {
        let point =
            |row: &Vec<f64>| Point { value: row[0], color: [row[1], row[2], row[3]], opacity: row[4] };
        return Ok(rows.iter().map(point).collect());
    }
    let [low, high] = range(run, scalar.range())?;
    let map = Colormap::named(run.params.text("colormap")).expect("a choice of the spec");
    // A field of one value is its upper end.
    let count = if high > low { MAP_POINTS } else { 1 };
    let point = |n: usize| {
        let t = if count > 1 { n as f64 / (count - 1) as f64 } else { 1.0 };
        let color = DVec3::from_array(map.linear(t).map(f64::from)).to_array();
        Point { value: low + t * (high - low), color, opacity: t }
    };
    Ok((0..count).map(point).collect())
}

#[cfg(test)]
mod tests;
