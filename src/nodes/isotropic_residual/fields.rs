//! Light fields that come with the beams, added to the residual: a propagation that has no beams has
//! made all of its light already (`scheme: literal`), and the camera is to see it.
//!
//! They are no sources: what they scatter is part of them. Tested by a field that comes out as it went in,
//! alone and beside other light.

use std::sync::Arc;

use super::super::Run;
use super::level::REMEDY;
use crate::gpu::{Bind, Format};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::{LightField, Residual};

mirror! {
    /// `FieldParams` of `add_field.wgsl`.
    pub(super) struct FieldParams {
        dims: [u32; 3],
        n_channels: u32,
        color: [f32; 4],
        n_field_channels: u32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

/// The residual with a field; `field` has one channel, or as many as the residual.
pub(super) fn add(run: &Run, residual: Residual, field: &LightField) -> Result<Residual, NodeError> {
    let gpu = run.gpu;
    let dims = residual.lattice.dims;
    let n_channels = residual.channels.count;
    let layers = [dims[0], dims[1], dims[2] * n_channels];
    let moments = gpu.texture3("moments", layers, Format::Rgba32Float, REMEDY)?;
    // One channel stands for one color, which both then have.
    let color = if n_channels == 1 { [1.0; 3] } else { field.channels.color }.map(|share| share as f32);
    let params = FieldParams {
        dims: dims.map(|n| n as u32),
        n_channels: n_channels as u32,
        color: [color[0], color[1], color[2], 0.0],
        n_field_channels: field.channels.count as u32,
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
    };
    let inputs = [Bind::Texture(&field.moments), Bind::Texture(&residual.moments)];
    let stage = gpu.stage("isotropic_residual/add_field", &[])?;
    let mut recorder = gpu.recorder("light fields");
    recorder.dispatch(&stage.bind(gpu, &params, &inputs, &[Bind::Texture(&moments)]), layers);
    run.finish(recorder)?;
    Ok(Residual { moments: Arc::new(moments), ..residual })
}

#[cfg(test)]
mod tests;
