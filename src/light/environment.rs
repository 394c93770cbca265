//! Light from all directions: a constant, or a lat-long map.
//!
//! Maps follow OpenEXR's lat-long convention: longitude π − 2πu, 0 is +Z at the picture's center, +X at
//! u = 1/4, +Y on the top row; bilinear between texel centers, around the seam. `rotate_y` turns the map
//! right-handed about +Y: +90° takes what was in +Z to +X. Radiance in W/(m² sr), linear Rec. 709.
//!
//! A sun in a map is not one of many texels: it is a light of its own (`suns`), that neither a region of the
//! map nor a blurred copy of it stands for.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;

use crate::optics::spectrum::luminance;

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

/// A sun's texels are brighter than the mean of the map by more than this: skies and lamps reach some tens.
pub const SUN_CONTRAST: f64 = 100.0;
/// |mean direction| of a sun, at least: that of a disc of 14 degrees. Longer lamps are not one direction.
pub const SUN_SPREAD: f64 = 0.996;
/// Less of the map's light than this is no sun: a cut into 32 regions would not give it one.
pub const SUN_SHARE: f64 = 1.0 / 32.0;

/// Numbers of forward scatterings that the levels of a [`Stack`] are for.
pub const STACK_X: [f64; 16] =
    [0.0, 0.125, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0];

/// Angles of [`Stack::turns`].
pub const STACK_TURNS: usize = 3;
/// Ways about a ray that each of them stands for.
pub const STACK_WAYS_AROUND: usize = 4;

/// What of a map shines forward through x scatterings, for each x of [`STACK_X`].
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Texels around.
    pub width: usize,
    /// Texels from +Y to −Y.
    pub height: usize,
    /// Level after level, each row by row as the map's own; times `scale`, before `rotate_y`.
    pub texels: Vec<[f32; 3]>,
    /// Angles in radians that light has turned by after half of the scatterings: the middles of parts of even
    /// power.
    pub turns: [[f32; STACK_TURNS]; STACK_X.len()],
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

    /// The suns of the map, each the indices of its texels in order: texels that touch, each brighter than
    /// [`SUN_CONTRAST`] times the map's mean luminance, together more than [`SUN_SHARE`] of its light, and no wider
    /// than [`SUN_SPREAD`]. All suns together fill less than 1/[`SUN_CONTRAST`] of the directions.
    pub fn suns(&self) -> Vec<Vec<usize>> {
        let row_light = |row: usize| {
            let row_texels = &self.texels[row * self.width..(row + 1) * self.width];
            row_texels.iter().map(|texel| luminance(texel.map(f64::from))).sum::<f64>()
                * self.solid_angle(row)
        };
        let light: f64 = (0..self.height).map(row_light).sum();
        let threshold = SUN_CONTRAST * light / (4.0 * PI);
        let radiance = |idx: usize| luminance(self.texels[idx].map(f64::from));
        let mut waiting: BTreeSet<usize> =
            (0..self.texels.len()).filter(|idx| radiance(*idx) > threshold).collect();
        let mut suns = Vec::new();
        while let Some(first) = waiting.pop_first() {
            let mut sun = vec![first];
            let mut n_seen = 0;
            while let Some(idx) = sun.get(n_seen).copied() {
                n_seen += 1;
                let (row, column) = (idx / self.width, idx % self.width);
                for row in row.saturating_sub(1)..(row + 2).min(self.height) {
                    for across in [self.width - 1, 0, 1] {
                        let neighbor = row * self.width + (column + across) % self.width;
                        sun.extend(waiting.take(&neighbor));
                    }
                }
            }
            let mut of_sun = 0.0;
            let mut mean = DVec3::ZERO;
            for idx in &sun {
                let (row, column) = (idx / self.width, idx % self.width);
                let at = |n: usize, size: usize| (n as f64 + 0.5) / size as f64;
                let weight = radiance(*idx) * self.solid_angle(row);
                of_sun += weight;
                mean += weight * self.direction(at(column, self.width), at(row, self.height));
            }
            if of_sun > SUN_SHARE * light && mean.length() > SUN_SPREAD * of_sun {
                sun.sort_unstable();
                suns.push(sun);
            }
        }
        suns
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
    fn suns_are_bright_small_and_a_good_part_of_the_light() {
        let (width, height) = (64, 32);
        let lit = |bright: &[(usize, f32)]| {
            let mut texels = vec![[1.0; 3]; width * height];
            bright.iter().for_each(|(idx, l)| texels[*idx] = [*l; 3]);
            Map { width, height, texels: Arc::new(texels), ..map(0.3) }.suns()
        };
        assert!(lit(&[]).is_empty() && map(0.0).suns().is_empty());
        // Two texels that touch over the seam, across a corner, and one apart.
        let (left, right, apart) = (10 * width, 11 * width + width - 1, 20 * width + 7);
        let all = [(left, 3e4), (right, 2e4), (apart, 3e4)];
        assert_eq!(lit(&all), vec![vec![left, right], vec![apart]]);
        // 90 is not bright enough; and a texel next to the pole, bright enough, has 0.5 % of all light.
        assert!(lit(&[(left, 90.0)]).is_empty());
        assert_eq!(lit(&[all[0], all[1], (7, 4e3)]), vec![vec![left, right]]);
        // A lamp of 45 degrees is no one direction; one of 11 is.
        let lamp = |n: usize| (0..n).map(|column| (16 * width + column, 1e5)).collect::<Vec<_>>();
        assert_eq!((lit(&lamp(8)).len(), lit(&lamp(2)).len()), (0, 1));
        // Nothing that is wider than a hundredth of the sphere.
        let cap: Vec<_> = (0..2 * width).map(|idx| (idx, 1e6)).collect();
        assert!(lit(&cap).len() <= 1);
        let belt: Vec<_> = (14 * width..18 * width).map(|idx| (idx, 1e6)).collect();
        assert!(lit(&belt).is_empty());
    }

    #[test]
    fn the_minimum_is_scaled() {
        assert_eq!(Environment::Map(map(0.0)).minimum(), [2.0; 3]);
        assert_eq!(Environment::Constant([1.0, 2.0, 3.0]).minimum(), [1.0, 2.0, 3.0]);
    }
}
