//! `importance_propagation`: where light matters to a picture, sent from the camera through the medium as a
//! light would be (DESIGN 6.6).
//!
//! Two things leave it: the distribution over directions for the decomposition (`view.rs`), from the
//! optical depths of 32 × 32 rays over the picture, and the field of the camera's own optical depth at the
//! corners of cells, a walk as to a point light. What it takes off the error of 16 ordinates: at g 0.9 half,
//! over four skies (0.137 to 0.069; `tests/importance.rs` holds two of them); over two skies, 40 % at 0.7,
//! 6 % at 0.5, nothing at 0. Limits: what is between rays is not seen, so matter thinner than 1/32 of the
//! picture may be missed; no light that surfaces send. Tested against an f64 oracle.

use glam::DVec3;

use super::{NodeKind, Rules, Run, no_files, walk};
use crate::camera::Camera;
use crate::gpu::Bind;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::mirror;
use crate::wire::{Beam, Importance, Medium, Place, ShapeTexel};

#[cfg(test)]
pub(super) mod oracle;
mod view;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::None };

static SPEC: NodeSpec = NodeSpec {
    id: "importance_propagation",
    version: 1,
    category: Category::Transport,
    purpose: "Finds out from which directions light matters to the picture.",
    doc: "Looks from the camera through the medium: what scatters forward shows the light behind it. With it \
          light_decomposition spends its ordinates there. It helps where matter scatters forward, g over 0.5.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what the camera looks through"),
        PortSpec::new("camera", PortType::Camera, "the view"),
    ],
    outputs: &[PortSpec::new("importance", PortType::Importance, "for light_decomposition.importance")],
    params: &[ParamSpec::float("strength", 0.5).between(0.0, 1.0).doc(
        "Share of the importance that is about the view; the rest is the same for all directions. 0: light alone decides.",
    )],
};

/// Rays across the picture, and down.
const N_RAYS: usize = 32;

mirror! {
    /// `ViewParams` of `shaders/importance_propagation.wgsl`.
    pub(super) struct ViewParams {
        shape: ShapeTexel,
        eye: [f32; 3],
        cell_m: f32,
        forward: [f32; 3],
        n_rays: u32,
        right: [f32; 3],
        pad_0: u32,
        up: [f32; 3],
        pad_1: u32,
    }
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let camera: &Camera = run.inputs.one("camera");
    let frame = camera.frame().map_err(NodeError::new)?;
    let depths = depths(run, medium, camera.position, frame)?;
    let rays: Vec<view::Ray> = depths
        .iter()
        .enumerate()
        .map(|(idx, tau)| view::Ray { direction: ray_direction(frame, idx), tau: f64::from(*tau) })
        .collect();
    let albedo = medium.albedo.iter().sum::<f64>() / 3.0;
    let light = view::importance(&rays, frame[0], albedo, medium.g, run.params.f64("strength"));
    let eye = medium.lattice.index_from_world().transform_point3(camera.position);
    let tau = walk::walk(
        run,
        medium,
        &[Beam { place: Place::Point(eye), power: [1.0; 3], a0: 1.0, window: None, facing: None }],
    )?;
    let bytes = tau.texture.bytes();
    let importance = Importance { light, tau, lattice: medium.lattice.clone() };
    Ok(vec![Value::new(PortType::Importance, bytes, importance)])
}

/// Unit vector along a ray of the grid, in the space of the frame.
fn ray_direction([forward, right, up]: [DVec3; 3], idx: usize) -> DVec3 {
    let at = |n: usize| (n as f64 + 0.5) / N_RAYS as f64;
    let (x, y) = (2.0 * at(idx % N_RAYS) - 1.0, 1.0 - 2.0 * at(idx / N_RAYS));
    (forward + x * right + y * up).normalize()
}

/// Optical depths of the rays, row by row.
fn depths(run: &Run, medium: &Medium, position: DVec3, frame: [DVec3; 3]) -> Result<Vec<f32>, NodeError> {
    let (gpu, lattice) = (run.gpu, &medium.lattice);
    let [forward, right, up] = frame.map(|v| lattice.turned(v).as_vec3().to_array());
    let params = ViewParams {
        shape: medium.shape(),
        eye: lattice.index_from_world().transform_point3(position).as_vec3().to_array(),
        cell_m: lattice.cell_m as f32,
        forward,
        n_rays: N_RAYS as u32,
        right,
        pad_0: 0,
        up,
        pad_1: 0,
    };
    let depths = gpu.buffer("depths of camera rays", (4 * N_RAYS * N_RAYS) as u64, "")?;
    let sampler = gpu.linear_sampler();
    let inputs = [Bind::Texture(&medium.sigma_t), Bind::Sampler(&sampler)];
    let bound =
        gpu.stage("importance_propagation", &[])?.bind(gpu, &params, &inputs, &[Bind::Buffer(&depths)]);
    let mut recorder = gpu.recorder("importance of the view");
    recorder.dispatch(&bound, [N_RAYS, N_RAYS, 1]);
    run.finish(recorder)?;
    Ok(gpu.read_buffer(&depths)?)
}

#[cfg(test)]
mod tests;
