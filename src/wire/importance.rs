//! Where light matters to a picture.

use super::TauAtlas;
use crate::light;
use crate::volume::Lattice;

/// What the camera's view of a medium says about light.
#[derive(Clone)]
pub struct Importance {
    /// By direction, for a decomposition.
    pub light: light::importance::Importance,
    /// Optical depth from the camera to the corners of cells: one beam, as of a point light there.
    pub tau: TauAtlas,
    /// The grid of the medium that is looked through.
    pub lattice: Lattice,
}
