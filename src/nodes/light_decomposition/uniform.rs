//! Regions of even solid angle: an environment split without looking at it.
//!
//! The partition is Leopardi's (A partition of the unit sphere into regions of equal area and small
//! diameter, 2006): two polar caps and collars of equal regions. A texel belongs to the region its
//! center lies in. Tested by the areas of its regions and by the light they keep.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::region::{Excess, Region, ordinates};
use crate::light::Ordinate;

/// The ordinates of a map, and the radiance of what has no direction.
pub(super) fn split(excess: &Excess, count: usize) -> (Vec<Ordinate>, [f64; 3]) {
    let partition = Partition::new(count);
    let sums = (0..excess.map.height)
        .into_par_iter()
        .map(|row| sum_row(excess, row, &partition))
        .collect::<Vec<_>>()
        .into_iter()
        // In order of the rows, so that the sums are the same on every run.
        .fold(vec![Region::default(); count], |mut all, row| {
            for (region, part) in all.iter_mut().zip(&row) {
                region.add(part);
            }
            all
        });
    ordinates(&sums)
}

fn sum_row(excess: &Excess, row: usize, partition: &Partition) -> Vec<Region> {
    let mut regions = vec![Region::default(); partition.count];
    let v = (row as f64 + 0.5) / excess.map.height as f64;
    for (column, texel) in excess.texels(row, 0..excess.map.width).enumerate() {
        let u = (column as f64 + 0.5) / excess.map.width as f64;
        regions[partition.find(PI * v, 2.0 * PI * u)].add(&texel);
    }
    regions
}

struct Partition {
    count: usize,
    /// From the north pole: lower edge of each band (colatitude), first region, regions.
    bands: Vec<(f64, usize, usize)>,
}

impl Partition {
    fn new(count: usize) -> Self {
        if count == 1 {
            return Self { count, bands: vec![(PI, 0, 1)] };
        }
        let area = 4.0 * PI / count as f64;
        // Colatitude of the cap that holds so many regions.
        let cap = |regions: f64| (1.0 - regions * area / (2.0 * PI)).clamp(-1.0, 1.0).acos();
        let polar = cap(1.0);
        let n_collars =
            if count == 2 { 0 } else { (((PI - 2.0 * polar) / area.sqrt()).round() as usize).max(1) };
        let mut bands = vec![(polar, 0, 1)];
        let mut done = 1;
        let mut owed = 0.0;
        for collar in 0..n_collars {
            let edge = |n: usize| polar + (PI - 2.0 * polar) * n as f64 / n_collars as f64;
            let ideal = 2.0 * PI * (edge(collar).cos() - edge(collar + 1).cos()) / area + owed;
            let regions = if collar + 1 == n_collars { count - 1 - done } else { ideal.round() as usize };
            owed = ideal - regions as f64;
            bands.push((cap((done + regions) as f64), done, regions));
            done += regions;
        }
        bands.push((PI, count - 1, 1));
        Self { count, bands }
    }

    fn find(&self, colatitude: f64, azimuth: f64) -> usize {
        let band =
            self.bands.iter().find(|band| colatitude <= band.0).unwrap_or(&self.bands[self.bands.len() - 1]);
        let (_, first, regions) = *band;
        first + ((azimuth / (2.0 * PI) * regions as f64) as usize).min(regions.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::light::environment::{Environment, Map};

    /// Of what an environment has beyond its minimum.
    fn split(environment: &Environment, count: usize) -> (Vec<Ordinate>, [f64; 3]) {
        let Environment::Map(map) = environment else { panic!("a constant is not split") };
        super::split(&Excess::new(map, environment.minimum()), count)
    }

    fn map(texel: impl Fn(usize, usize) -> [f32; 3]) -> Environment {
        let (width, height) = (256, 128);
        let texels = (0..width * height).map(|n| texel(n % width, n / width)).collect();
        Environment::Map(Map {
            width,
            height,
            texels: Arc::new(texels),
            scale: 1.5,
            rotate_y: 0.4,
            stack: None,
        })
    }

    #[test]
    fn fluence_is_kept_for_any_count() {
        let environment =
            map(|x, y| [1.0 + x as f32 / 256.0, 2.0 + y as f32 / 64.0, 0.5 + (x * y % 7) as f32]);
        let ambient = environment.minimum();
        let Environment::Map(pixels) = &environment else { unreachable!() };
        for count in [1, 2, 3, 7, 32, 1000] {
            let (ordinates, rest) = split(&environment, count);
            for (c, ambient) in ambient.into_iter().enumerate() {
                let exact: f64 = (0..128)
                    .flat_map(|y| (0..256).map(move |x| (x, y)))
                    .map(|(x, y)| f64::from(pixels.texels[y * 256 + x][c]) * 1.5 * pixels.solid_angle(y))
                    .sum();
                let kept: f64 =
                    ordinates.iter().map(|o| o.irradiance[c]).sum::<f64>() + 4.0 * PI * (ambient + rest[c]);
                // Sums of 3e4 terms in f64.
                assert!((kept / exact - 1.0).abs() < 1e-11, "count {count}: {kept} {exact}");
            }
            assert!(ordinates.len() <= count);
            assert!(ordinates.iter().all(|o| o.region > Some(0.0)
                && o.region <= Some(1.0)
                && (o.direction.length() - 1.0).abs() < 1e-12));
        }
    }

    #[test]
    fn regions_are_even() {
        // A fine map puts within 12 % as many texels, weighted, into each of 50 regions.
        let partition = Partition::new(50);
        let mut area = vec![0.0; 50];
        let Environment::Map(pixels) = map(|_, _| [1.0; 3]) else { unreachable!() };
        for y in 0..128 {
            for x in 0..256 {
                let (u, v) = ((x as f64 + 0.5) / 256.0, (y as f64 + 0.5) / 128.0);
                area[partition.find(PI * v, 2.0 * PI * u)] += pixels.solid_angle(y);
            }
        }
        let mean = 4.0 * PI / 50.0;
        assert!(area.iter().all(|a| (a / mean - 1.0).abs() < 0.12), "{area:?}");
    }

    #[test]
    fn one_hot_texel_is_one_ordinate() {
        let environment = map(|x, y| if (x, y) == (10, 20) { [1e5; 3] } else { [0.0; 3] });
        let (ordinates, _) = split(&environment, 32);
        assert_eq!(ordinates.len(), 1);
        assert!(ordinates[0].a0 == 1.0 && ordinates[0].region > Some(1.0 - 1e-12));
        assert_eq!(split(&map(|_, _| [0.0; 3]), 32), (vec![], [0.0; 3]));
    }

    #[test]
    fn light_without_a_direction_is_not_lost() {
        // Even around and about the equator: one region has no mean direction.
        let environment = map(|_, y| [if (32..96).contains(&y) { 1.0 } else { 0.0 }; 3]);
        let Environment::Map(pixels) = &environment else { unreachable!() };
        let exact: f64 = (32..96).map(|y| 256.0 * 1.5 * pixels.solid_angle(y)).sum();
        let (ordinates, rest) = split(&environment, 1);
        let kept = ordinates.iter().map(|o| o.irradiance[0]).sum::<f64>() + 4.0 * PI * rest[0];
        // Sums of 3e4 terms in f64.
        assert!((kept / exact - 1.0).abs() < 1e-11, "{kept} {exact}");
    }
}
