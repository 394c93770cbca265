//! What the f64 oracles of light transport share: one channel of a medium and of its light.
//!
//! The oracles (`nodes/*/oracle.rs`) are the whole chain once more, clear before fast, in f64: the
//! reference that the shaders are compared with. They work on one color channel and in the index
//! space of the solver's grid: cells are cubes of edge `h` (m), cell centers sit at integer
//! coordinates, cell corner (i, j, k) at (i, j, k) − ½; a corner field has one value more on each
//! axis. Directions are unit vectors of index space. Tested with closed forms in each oracle, and
//! as a chain against adding–doubling slabs and Monte Carlo spheres in `tests.rs`.

pub mod corners;

use std::f64::consts::PI;

use glam::{DMat4, DVec3, DVec4};

use crate::light::Window;
use crate::optics::blackbody::blackbody_rgb;
use crate::optics::delta::DeltaScaled;
use crate::volume::field::Field;

/// One channel of a medium on the solver's grid.
#[derive(Clone, Debug)]
pub struct OracleMedium {
    /// Extinction at the cell centers [1/m].
    pub sigma_t: Field<f64>,
    /// Edge of a cell (m).
    pub h: f64,
    /// Single-scattering albedo, in 0..=1.
    pub albedo: f64,
    /// Mean cosine of the phase function, in (−1, 1).
    pub g: f64,
}

impl OracleMedium {
    /// What delta scaling makes of it.
    pub fn scaled(&self) -> DeltaScaled {
        DeltaScaled::new(self.albedo, self.g)
    }
}

/// Light that travels along known directions before it is scattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamLight {
    /// All along one direction.
    Parallel {
        /// Unit direction of travel.
        direction: DVec3,
        /// Irradiance on a plane across it, unattenuated [W/m²].
        irradiance: f64,
        /// |mean direction| of what the beam stands for, in (0, 1]; 1 for a sun.
        spread: f64,
    },
    /// From one point.
    Point {
        /// Where it sits, in index coordinates.
        position_in_index: DVec3,
        /// Radiant intensity [W/sr].
        intensity: f64,
    },
}

impl BeamLight {
    /// Unit direction of travel at a point of index space; zero on a point light itself.
    pub fn direction_at(&self, p_in_index: DVec3) -> DVec3 {
        match *self {
            Self::Parallel { direction, .. } => direction,
            Self::Point { position_in_index, .. } => (p_in_index - position_in_index).normalize_or_zero(),
        }
    }

    /// |mean direction|, in (0, 1].
    pub fn spread(&self) -> f64 {
        match *self {
            Self::Parallel { spread, .. } => spread,
            Self::Point { .. } => 1.0,
        }
    }

    /// What a unit of light is to be multiplied by: irradiance [W/m²] or intensity [W/sr].
    pub fn power(&self) -> f64 {
        match *self {
            Self::Parallel { irradiance, .. } => irradiance,
            Self::Point { intensity, .. } => intensity,
        }
    }
}

/// A light with the optical depth that it has passed.
#[derive(Clone, Debug)]
pub struct OracleBeam {
    /// The light.
    pub light: BeamLight,
    /// Unscaled optical depth from the light, at the cells' corners.
    pub tau_corners: Field<f64>,
    /// The depth that is ahead of it there, where light goes to and fro along it.
    pub ahead_corners: Option<Field<f64>>,
    /// What of its forward light the environment's stack carries instead.
    pub window: Option<Window>,
}

/// One channel of what glowing gas emits: its grids at their own voxels, trilinear, the black body after
/// that.
#[derive(Clone, Debug)]
pub struct OracleEmission {
    /// emission_scale · flame, 0 outside.
    pub flame: Field<f64>,
    /// From index space to the flame's voxels.
    pub flame_from_index: DMat4,
    /// T above what it is outside [K].
    pub kelvin_above: Field<f64>,
    /// T outside [K].
    pub kelvin_outside: f64,
    /// From index space to the temperature's voxels.
    pub kelvin_from_index: DMat4,
    /// Where luminance is 1.
    pub reference_kelvin: f64,
    /// Of linear Rec. 709.
    pub channel: usize,
}

impl OracleEmission {
    /// Emitted radiance per meter [W/(m³ sr)] at an index position.
    pub fn at(&self, p: DVec3) -> f64 {
        let flame = self.flame.trilinear_zero(self.flame_from_index.transform_point3(p));
        if flame == 0.0 {
            return 0.0;
        }
        let above = self.kelvin_above.trilinear_zero(self.kelvin_from_index.transform_point3(p));
        flame * blackbody_rgb(self.kelvin_outside + above, self.reference_kelvin)[self.channel]
    }
}

/// The state (phi, F) of a constant radiance from everywhere.
pub fn constant_light(dims: [usize; 3], radiance: f64) -> Field<DVec4> {
    Field::filled(dims, DVec4::new(4.0 * PI * radiance, 0.0, 0.0, 0.0))
}

#[cfg(test)]
mod tests;
