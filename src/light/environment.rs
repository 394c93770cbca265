//! Light from all directions: a constant, or a lat-long map.
//!
//! Maps follow OpenEXR's lat-long convention: longitude π − 2πu, 0 is +Z at the picture's center, +X at
//! u = 1/4, +Y on the top row; bilinear between texel centers, around the seam. `rotate_y` turns the map
//! right-handed about +Y: +90° takes what was in +Z to +X. Radiance in W/(m² sr), linear Rec. 709.

use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

/// Radiance for each direction.
#[derive(Debug, Clone, PartialEq)]
pub enum Environment {
    /// The same from everywhere.
    Constant([f64; 3]),
    /// A picture of all directions.
    Map(Map),
}

/// A lat-long picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Texels around.
    pub width: usize,
    /// Texels from +Y to −Y.
    pub height: usize,
    /// Row by row, top first; before `scale`.
    pub texels: Arc<Vec<[f32; 3]>>,
    /// What radiance is multiplied by.
    pub scale: f64,
    /// Turn about +Y in radians.
    pub rotate_y: f64,
    /// What shines through a medium, where prefilter has made it.
    pub stack: Option<Arc<Stack>>,
}

/// Numbers of forward scatterings that the levels of a [`Stack`] are for.
pub const STACK_X: [f64; 16] =
    [0.0, 0.125, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0];

/// What of a map shines forward through x scatterings, for each x of [`STACK_X`].
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Texels around.
    pub width: usize,
    /// Texels from +Y to −Y.
    pub height: usize,
    /// Level after level, each row by row as the map's own; times `scale`, before `rotate_y`.
    pub texels: Vec<[f32; 3]>,
}

impl Environment {
    /// The least radiance of each channel: what comes from everywhere.
    pub fn minimum(&self) -> [f64; 3] {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Map(map) => std::array::from_fn(|c| {
                let least = map.texels.iter().map(|texel| texel[c]).fold(f32::INFINITY, f32::min);
                f64::from(least) * map.scale
            }),
        }
    }
}

impl Map {
    /// Unit vector towards (u, v), both 0..=1, v down, in the world.
    pub fn direction(&self, u: f64, v: f64) -> DVec3 {
        let latitude = 0.5 * PI - PI * v;
        let longitude = PI - 2.0 * PI * u + self.rotate_y;
        DVec3::new(latitude.cos() * longitude.sin(), latitude.sin(), latitude.cos() * longitude.cos())
    }

    /// Solid angle of a texel of this row in sr, exact.
    pub fn solid_angle(&self, row: usize) -> f64 {
        let edge = |row: usize| (0.5 * PI - PI * row as f64 / self.height as f64).sin();
        2.0 * PI / self.width as f64 * (edge(row) - edge(row + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(rotate_y: f64) -> Map {
        Map { width: 8, height: 4, texels: Arc::new(vec![[1.0; 3]; 32]), scale: 2.0, rotate_y, stack: None }
    }

    #[test]
    fn directions_follow_the_convention() {
        // Cosines of a handful of multiplications: 1e-15.
        let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-14, "{a} {b}");
        near(map(0.0).direction(0.5, 0.5), DVec3::Z);
        near(map(0.0).direction(0.25, 0.5), DVec3::X);
        near(map(0.0).direction(0.3, 0.0), DVec3::Y);
        near(map(0.5 * PI).direction(0.5, 0.5), DVec3::X);
    }

    #[test]
    fn solid_angles_fill_the_sphere() {
        let sum: f64 = (0..4).map(|row| 8.0 * map(0.0).solid_angle(row)).sum();
        assert!((sum - 4.0 * PI).abs() < 1e-13);
    }

    #[test]
    fn the_minimum_is_scaled() {
        assert_eq!(Environment::Map(map(0.0)).minimum(), [2.0; 3]);
        assert_eq!(Environment::Constant([1.0, 2.0, 3.0]).minimum(), [1.0, 2.0, 3.0]);
    }
}
