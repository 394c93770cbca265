//! Median cut: rectangles of a lat-long map that matter alike (Debevec, A median cut algorithm for light
//! probe sampling, 2005; DESIGN 6.6).
//!
//! From the whole map on, the rectangle of the largest weight, luminance × solid angle × importance, is
//! halved at its median, across the side that is longer as an angle, until there are `count` of them. A
//! single texel is set aside, so that a sun does not stop the cut; a black rectangle is dropped and not
//! counted. Importance decides where is cut and nothing else. Weights come from a summed-area table in f64.
//! Limits: the map's seam stays an edge of rectangles; importance is held to be even within 1/512 of the
//! map's width. Tested by what every cut must keep, at the extremes of maps, and by where it spends its
//! rectangles.

use glam::DVec3;
use rayon::prelude::*;

use super::region::{Excess, Region, ordinates};
use super::summed_area::{Rect, SummedArea};
use crate::light::Ordinate;
use crate::light::environment::Map;
use crate::light::importance::Importance;
use crate::optics::spectrum::luminance;

/// Importance is evaluated for so many columns and half as many rows at most.
const IMPORTANCE_COLUMNS: usize = 512;

/// A rectangle whose weight is under this share of the map's may be black: it is looked at.
const MAY_BE_BLACK: f64 = 1e-12;

/// At most `count` ordinates of a map, and the radiance of what has no direction.
pub(super) fn split(
    excess: &Excess,
    count: usize,
    importance: Option<&Importance>,
) -> (Vec<Ordinate>, [f64; 3]) {
    let regions: Vec<Region> = cut(excess, count, importance).iter().map(|rect| sum(excess, rect)).collect();
    ordinates(&regions)
}

fn cut(excess: &Excess, count: usize, importance: Option<&Importance>) -> Vec<Rect> {
    let map = excess.map;
    let factor = importance.map(|importance| ImportanceGrid::new(map, importance));
    let weights = SummedArea::new(map.width, map.height, |row, line| {
        let solid_angle = map.solid_angle(row);
        for (column, weight) in line.iter_mut().enumerate() {
            let factor = factor.as_ref().map_or(1.0, |grid| grid.at(map, row, column));
            *weight = luminance(excess.radiance(row, column)) * solid_angle * factor;
        }
    });
    let whole = Rect { top: 0, bottom: map.height, left: 0, right: map.width };
    let total = weights.sum(whole);
    let is_lit = |rect: &Rect| {
        weights.sum(*rect) > MAY_BE_BLACK * total
            || (rect.top..rect.bottom)
                .any(|row| (rect.left..rect.right).any(|column| excess.radiance(row, column) != [0.0; 3]))
    };
    let mut open: Vec<Rect> = vec![whole];
    open.retain(is_lit);
    let mut texels = Vec::new();
    while open.len() + texels.len() < count {
        // The first of equals, so that the cut is the same on every run.
        let heaviest =
            (0..open.len()).rev().max_by(|&a, &b| weights.sum(open[a]).total_cmp(&weights.sum(open[b])));
        let Some(heaviest) = heaviest else { break };
        let rect = open.swap_remove(heaviest);
        match halves(map, &weights, rect) {
            Some(halves) => open.extend(halves.into_iter().filter(is_lit)),
            None => texels.push(rect),
        }
    }
    open.extend(texels);
    open
}

/// A rectangle cut at its median across its longer side; `None` for a texel.
fn halves(map: &Map, weights: &SummedArea, rect: Rect) -> Option<[Rect; 2]> {
    let middle = 0.5 * (rect.top + rect.bottom) as f64 / map.height as f64;
    let across = rect.width() as f64 / map.width as f64 * 2.0 * (std::f64::consts::PI * middle).sin();
    let down = rect.height() as f64 / map.height as f64;
    let by_columns = match (rect.width(), rect.height()) {
        (1, 1) => return None,
        (1, _) => false,
        (_, 1) => true,
        _ => across >= down,
    };
    let half = 0.5 * weights.sum(rect);
    if by_columns {
        let at = median(rect.left, rect.right, |right| weights.sum(Rect { right, ..rect }) < half);
        Some([Rect { right: at, ..rect }, Rect { left: at, ..rect }])
    } else {
        let at = median(rect.top, rect.bottom, |bottom| weights.sum(Rect { bottom, ..rect }) < half);
        Some([Rect { bottom: at, ..rect }, Rect { top: at, ..rect }])
    }
}

/// The first place between `first` and `last`, both left out, up to which there is half of the weight; the
/// last one if there is none.
fn median(first: usize, last: usize, is_less: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (first + 1, last - 1);
    while low < high {
        let middle = low.midpoint(high);
        if is_less(middle) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    low
}

fn sum(excess: &Excess, rect: &Rect) -> Region {
    let rows = (rect.top..rect.bottom).into_par_iter().map(|row| {
        let mut sum = Region::default();
        excess.texels(row, rect.left..rect.right).for_each(|texel| sum.add(&texel));
        sum
    });
    // In order of the rows, so that the sums are the same on every run.
    rows.collect::<Vec<_>>().iter().fold(Region::default(), |mut all, row| {
        all.add(row);
        all
    })
}

/// Importance on a lat-long grid that is no finer than it needs to be.
struct ImportanceGrid {
    size: [usize; 2],
    values: Vec<f64>,
}

impl ImportanceGrid {
    fn new(map: &Map, importance: &Importance) -> Self {
        let [width, height] = [map.width.min(IMPORTANCE_COLUMNS), map.height.min(IMPORTANCE_COLUMNS / 2)];
        let value = |idx: usize| {
            let [u, v] = [(idx % width) as f64 / width as f64, (idx / width) as f64 / height as f64];
            let direction: DVec3 = map.direction(u + 0.5 / width as f64, v + 0.5 / height as f64);
            importance.at(direction)
        };
        Self { size: [width, height], values: (0..width * height).into_par_iter().map(value).collect() }
    }

    fn at(&self, map: &Map, row: usize, column: usize) -> f64 {
        let [width, height] = self.size;
        self.values[row * height / map.height * width + column * width / map.width]
    }
}

#[cfg(test)]
mod tests;
