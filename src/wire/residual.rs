//! Light that has lost its direction: one lobe a cell and channel.

use std::sync::Arc;

use super::{Channels, SurfaceLight};
use crate::gpu::Texture;
use crate::volume::Lattice;

/// The residual field of a medium.
#[derive(Clone)]
pub struct Residual {
    /// phi [W/m²] and F [W/m²] of each cell in an Rgba32Float texel; channels stand along z. One cell for all
    /// where they are the same everywhere.
    pub moments: Arc<Texture>,
    /// Whether they are 0 everywhere: then they need not be looked at.
    pub is_dark: bool,
    /// The grid of the medium that was solved.
    pub lattice: Lattice,
    /// Which channels they are.
    pub channels: Channels,
    /// The last sweep's power in / (out + absorbed), per channel: 1 where it had settled.
    pub balance: [f64; 3],
    /// What arrives on surfaces, where there are any.
    pub surface_light: Option<Arc<SurfaceLight>>,
}
