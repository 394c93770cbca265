//! Light that has lost its direction: one lobe a cell and channel.

use std::sync::Arc;

use super::Channels;
use crate::gpu::Texture;

/// The residual field of a medium.
#[derive(Clone)]
pub struct Residual {
    /// phi [W/m²] and F [W/m²] of each cell in an Rgba32Float texel; channels stand along z.
    pub moments: Arc<Texture>,
    /// Which channels they are.
    pub channels: Channels,
    /// Power that entered and was left over, per channel, for the health check: in / (out + absorbed).
    pub balance: [f64; 3],
}
