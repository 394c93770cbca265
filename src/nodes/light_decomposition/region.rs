//! Regions of an environment, and the ordinates that stand for them: what all methods share.
//!
//! Only what a map has beyond its minimum is split, suns apart: they are ordinates as they are, so that no region
//! is drawn towards one. Of a region: E = Σ L dω per channel, direction and
//! spread those of the luminance-weighted mean direction, so that the regions' luminance times spread times
//! direction add up to the map's Σ L ω dω. Units: radiance [W/(m² sr)], irradiance [W/m²]. Black regions are
//! left out; of a region that shines from all sides alike the direction is noise: its light joins the
//! ambient. Tested by each method.

use std::f64::consts::PI;
use std::ops::Range;

use glam::DVec3;

use crate::light::Ordinate;
use crate::light::environment::Map;
use crate::optics::spectrum::luminance;

/// A mean direction shorter than this is none.
const NO_DIRECTION: f64 = 1e-9;

/// What a map has beyond what comes from everywhere.
pub(super) struct Excess<'a> {
    /// The map.
    pub map: &'a Map,
    minimum: [f64; 3],
    /// Towards each column on the horizon.
    meridians: Vec<DVec3>,
    /// Texels that are lights of their own, in order.
    set_aside: Vec<usize>,
}

/// Light summed up.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Region {
    irradiance: [f64; 3],
    /// Luminance, and the direction towards the light times it.
    weight: f64,
    direction: DVec3,
}

impl<'a> Excess<'a> {
    /// Of a map with this minimum.
    pub(super) fn new(map: &'a Map, minimum: [f64; 3]) -> Self {
        let meridian = |column| map.direction((column as f64 + 0.5) / map.width as f64, 0.5);
        Self { map, minimum, meridians: (0..map.width).map(meridian).collect(), set_aside: Vec::new() }
    }

    /// Takes the map's suns out; gives each as an ordinate that is no region.
    pub(super) fn take_suns(&mut self) -> Vec<Ordinate> {
        let suns = self.map.suns();
        let ordinate = |sun: &Vec<usize>| {
            let mut sum = Region::default();
            for idx in sun {
                let (row, column) = (idx / self.map.width, idx % self.map.width);
                self.texels(row, column..column + 1).for_each(|texel| sum.add(&texel));
            }
            sum.ordinate().map(|ordinate| Ordinate {
                a0: ordinate.region.unwrap_or(1.0),
                region: None,
                ..ordinate
            })
        };
        let ordinates = suns.iter().filter_map(ordinate).collect();
        self.set_aside = suns.into_iter().flatten().collect();
        self.set_aside.sort_unstable();
        ordinates
    }

    /// Radiance of a texel; black where it is a light of its own.
    pub(super) fn radiance(&self, row: usize, column: usize) -> [f64; 3] {
        let idx = row * self.map.width + column;
        if self.set_aside.binary_search(&idx).is_ok() {
            return [0.0; 3];
        }
        let texel = self.map.texels[idx];
        std::array::from_fn(|c| f64::from(texel[c]) * self.map.scale - self.minimum[c])
    }

    /// The texels of a part of a row.
    pub(super) fn texels(&self, row: usize, columns: Range<usize>) -> impl Iterator<Item = Region> {
        let solid_angle = self.map.solid_angle(row);
        let latitude = PI * (0.5 - (row as f64 + 0.5) / self.map.height as f64);
        let (sin, cos) = latitude.sin_cos();
        columns.map(move |column| {
            let irradiance = self.radiance(row, column).map(|l| l * solid_angle);
            let weight = luminance(irradiance);
            let direction = weight * (cos * self.meridians[column] + sin * DVec3::Y);
            Region { irradiance, weight, direction }
        })
    }
}

impl Region {
    /// Takes `other` in.
    pub(super) fn add(&mut self, other: &Self) {
        for (sum, e) in self.irradiance.iter_mut().zip(other.irradiance) {
            *sum += e;
        }
        self.weight += other.weight;
        self.direction += other.direction;
    }

    fn ordinate(&self) -> Option<Ordinate> {
        let mean = self.direction / self.weight;
        let spread = mean.length();
        (self.weight > 0.0 && spread > NO_DIRECTION).then(|| Ordinate {
            direction: -mean / spread,
            irradiance: self.irradiance,
            a0: 1.0,
            region: Some(spread.min(1.0)),
            window: None,
        })
    }
}

/// The ordinates of regions, and the radiance of what has no direction.
pub(super) fn ordinates(regions: &[Region]) -> (Vec<Ordinate>, [f64; 3]) {
    let mut from_all_sides = [0.0; 3];
    for region in regions.iter().filter(|region| region.ordinate().is_none()) {
        for (sum, e) in from_all_sides.iter_mut().zip(region.irradiance) {
            *sum += e / (4.0 * PI);
        }
    }
    (regions.iter().filter_map(Region::ordinate).collect(), from_all_sides)
}
