//! What travels on wires with fields on the GPU: media, beams, importance, residuals, surfaces.
//!
//! Nodes never know each other; these types are what they agree on. Light, ordinates, cameras and
//! pictures are plain values of their own modules. All fields are in the index space of the medium's
//! [`Lattice`](crate::volume::Lattice), where a cell's center sits at its integer index; its corner
//! (i, j, k) sits at (i - 1/2, j - 1/2, k - 1/2).

mod beams;
mod channels;
mod emission;
mod importance;
mod light_field;
mod medium;
mod radial;
mod residual;
mod surface_light;
mod surfaces;

pub use beams::{AtlasLayout, Beam, BeamTexel, Beams, Depths, Place, RepackParams, TauAtlas};
pub use channels::Channels;
pub use emission::{Emission, Heat};
pub use importance::Importance;
pub use light_field::LightField;
pub use medium::{Blocks, Homogeneous, Medium, OccupancyParams, ShapeTexel, occupancy};
pub use radial::{Fineness, RadialGrids, RadialTexel, Spacing};
pub use residual::Residual;
pub use surface_light::SurfaceLight;
pub use surfaces::{SurfaceNode, SurfaceTriangle, Surfaces};
