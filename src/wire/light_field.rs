//! All light in a medium as one lobe a cell: what a scheme makes that has no beams.

use std::sync::Arc;

use super::Channels;
use crate::gpu::Texture;

/// A light field, on the grid of the beams that it travels with.
#[derive(Clone)]
pub struct LightField {
    /// phi [W/m²] and F [W/m²] of each cell in an Rgba32Float texel; channels stand along z, as in
    /// [`super::Residual::moments`].
    pub moments: Arc<Texture>,
    /// Which channels they are.
    pub channels: Channels,
}
