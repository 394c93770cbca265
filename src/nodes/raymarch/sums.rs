//! What all parallel beams together send towards the eye, gathered at the corners of cells once a view (DESIGN
//! 6.5, many ordinates): the march then looks up one field instead of every beam.
//!
//! Three sums a channel, W/m² times a phase function [1/sr], as their natural logarithms: one RGBA texel of f32 a
//! corner and channel, channels one beyond the other along z. Of one beam they are as exact between corners as
//! its depth is; what several beams and a turning view add is estimated by the rule that chooses
//! (`planner::gathering`). Corners that no sample in matter reads stay empty. Tested against the f64 oracle
//! (`oracle/sums.rs`) and against the march that looks up every beam.

use super::{MarchParams, Run, has_window, plan::Plan};
use crate::gpu::{Bind, Buffer, Format, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{Beams, Medium, ShapeTexel};

mirror! {
    /// `GatherParams` of `shaders/raymarch/gather.wgsl`.
    pub(super) struct GatherParams {
        shape: ShapeTexel,
        eye: [f32; 3],
        cell_m: f32,
        corners: [u32; 3],
        n_beams: u32,
        k: [f32; 4],
        albedo: [f32; 4],
        g: f32,
        packs_per_column: u32,
        first: u32,
        reach: i32,
    }
}

/// Corners that are gathered at once, about: a cancel is heard between them.
const BAND_CORNERS: usize = 1 << 18;

/// For the view of `march`: the sums, from the beams' depths and the table of K.
///
/// # Errors
/// What the device reports.
pub(super) fn gather(
    run: &Run,
    plan: &Plan,
    beams: &Beams,
    [tau, table]: [&Texture; 2],
    list: &Buffer,
    march: &MarchParams,
) -> Result<Texture, NodeError> {
    let gpu = run.gpu;
    let medium: &Medium = run.inputs.one("medium");
    let corners = medium.lattice.dims.map(|n| n + 1);
    let n_channels = plan.channels.count;
    let dims = [corners[0], corners[1], corners[2] * n_channels];
    let remedy = "lower light_decomposition.count or medium.max_resolution";
    let sums = gpu.texture3("sums of the beams", dims, Format::Rgba32Float, remedy)?;
    let choices = [
        ("channels", n_channels.to_string()),
        ("grey", medium.is_grey().to_string()),
        ("peak", plan.has_peak.to_string()),
        ("window", has_window(beams).to_string()),
        ("pack", beams.pack().to_string()),
    ];
    let stage = gpu.stage("raymarch/gather", &choices)?;
    let sampler = gpu.linear_sampler();
    let inputs = [
        Bind::Texture(&medium.sigma_t),
        Bind::Sampler(&sampler),
        Bind::Texture(tau),
        Bind::Buffer(list),
        Bind::Texture(table),
        Bind::Texture(&medium.blocks.texture),
    ];
    let band = (BAND_CORNERS / (corners[0] * corners[1])).max(1);
    for first in (0..corners[2]).step_by(band) {
        let params = GatherParams {
            shape: march.shape,
            eye: march.eye,
            cell_m: march.cell_m,
            corners: corners.map(|n| n as u32),
            n_beams: march.n_beams,
            k: march.k,
            albedo: march.albedo,
            g: march.g,
            packs_per_column: march.packs_per_column,
            first: first as u32,
            // Between the middles of two steps.
            reach: march.step.ceil() as i32,
        };
        let mut recorder = gpu.recorder("gather beams");
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Texture(&sums)]);
        recorder.dispatch(&bound, [corners[0], corners[1], band.min(corners[2] - first)]);
        run.finish(recorder)?;
    }
    Ok(sums)
}
