//! Light: what sources emit, and the directions that light from afar is split into.
//!
//! Suns and point lights are exact; an environment is a radiance for each direction. A decomposition
//! turns suns and environments into [`Ordinate`]s, parallel beams of a direction, an irradiance and a
//! spread, and the constant part of an environment into `ambient`, which needs no beams.

pub mod environment;
pub mod importance;

use glam::DVec3;

/// The most irradiance, radiance or intensity that is computed: sums over all cells are still 32-bit numbers.
pub const BRIGHTEST: f64 = 1e28;

/// A source that is not an environment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// Parallel light.
    Sun {
        /// Unit vector along which it travels.
        direction: DVec3,
        /// On a plane across it [W/m²], linear Rec. 709.
        irradiance: [f64; 3],
        /// Of the disk in the sky.
        angular_diameter_deg: f64,
    },
    /// A point that shines evenly.
    Point {
        /// In the world, in meters.
        position: DVec3,
        /// [W/sr], linear Rec. 709.
        intensity: [f64; 3],
    },
    /// A virtual light: what a small piece of a surface sends back, by the cosine, from its front alone.
    Surface {
        /// In the world, in meters.
        position: DVec3,
        /// Unit vector away from the lit side.
        normal: DVec3,
        /// Watts, linear Rec. 709: radiant intensity is power cos / pi.
        power: [f64; 3],
    },
}

/// A principal ordinate: parallel light that stands for a region of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ordinate {
    /// Unit vector along which it travels, in the world.
    pub direction: DVec3,
    /// On a plane across it [W/m²].
    pub irradiance: [f64; 3],
    /// Spread that its beams use, in (0, 1]: of a sun its disk's mean cosine, of a region 1 until prefilter
    /// sets it.
    pub a0: f64,
    /// Of an environment's region the length of its mean direction, in (0, 1].
    pub region: Option<f64>,
    /// Set where what goes nearly straight on comes from the environment's stack instead.
    pub window: Option<Window>,
}

/// What of the light of an environment's regions comes from its stack, not from ordinates: `share` of what is
/// scattered by less than `inner_deg`, none of what is scattered by more than `outer_deg`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Where the stack's share begins to fall in degrees.
    pub inner_deg: f64,
    /// Where the stack's share ends in degrees.
    pub outer_deg: f64,
    /// The stack's share within, 0..=1.
    pub share: f64,
}

impl Window {
    /// Cosines of the inner and the outer angle.
    pub fn cosines(self) -> [f64; 2] {
        [self.inner_deg, self.outer_deg].map(|angle| angle.to_radians().cos())
    }
}

/// What a decomposition gives.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ordinates {
    /// The beams.
    pub ordinates: Vec<Ordinate>,
    /// Radiance that comes from everywhere [W/(m² sr)].
    pub ambient: [f64; 3],
    /// Into how many regions the environment was split, of which black ones have no beam; while one split fades into
    /// another, each. 0 where nothing was split.
    pub n_regions: usize,
}

/// The scale and the chromaticity of a color: its largest component, and the color over it.
/// Black is no chromaticity.
pub fn chromaticity(color: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let scale = color.into_iter().fold(0.0, f64::max);
    (scale > 0.0).then(|| (scale, color.map(|c| c / scale)))
}
