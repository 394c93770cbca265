//! One resolution of the residual's problem, and the ways between two of them.
//!
//! Coarser: sigma_t, Q0, Q1 are box averages over 2³ cells, so power is kept; halved while the
//! longest axis is over 8 cells and all axes are even. Finer: trilinear between cell centers, the
//! outermost value continued, so states stay within the bounds of what they come from. Tested by
//! the power, by constants and by lines.

use glam::{DVec3, DVec4, IVec3};

use super::Sources;
use crate::geometry::oracle::{Ray, nearest};
use crate::nodes::oracle_scene::OracleMedium;
use crate::optics::delta::DeltaScaled;
use crate::volume::field::{Field, Weigh};

/// The longest axis at which halving ends.
const COARSEST: usize = 8;

/// A grid with its medium and sources.
#[derive(Clone, Debug)]
pub struct Level {
    /// Unscaled extinction [1/m].
    pub sigma_t: Field<f64>,
    /// Ratios of the delta-scaled cross sections to it.
    pub scaled: DeltaScaled,
    /// Edge of a cell (m).
    pub h: f64,
    /// Sources.
    pub sources: Sources,
    /// Triangles of surfaces, in index space.
    pub surfaces: Vec<[DVec3; 3]>,
}

impl Level {
    /// The finest grid.
    pub fn new(medium: &OracleMedium, sources: Sources) -> Self {
        assert_eq!(medium.sigma_t.dims, sources.q0.dims, "sources on another grid");
        let sigma_t = medium.sigma_t.clone();
        Self { sigma_t, scaled: medium.scaled(), h: medium.h, sources, surfaces: Vec::new() }
    }

    /// The same with surfaces inside.
    pub fn behind(self, surfaces: Vec<[DVec3; 3]>) -> Self {
        Self { surfaces, ..self }
    }

    /// Whether a surface stands between the centers of a cell and the one at `e` from it.
    pub fn is_walled(&self, cell: IVec3, e: IVec3) -> bool {
        let ray = Ray { origin: cell.as_dvec3(), direction: e.as_dvec3() };
        nearest(&self.surfaces, ray, 0.0, 0.0).is_some_and(|hit| hit.t < 1.0)
    }

    /// This grid and all coarser ones, finest first.
    pub fn with_coarser(self) -> Vec<Self> {
        let mut levels = vec![self];
        while let Some(coarser) = levels[levels.len() - 1].coarser() {
            levels.push(coarser);
        }
        levels
    }

    /// The grid of half the resolution, if there is one.
    fn coarser(&self) -> Option<Self> {
        let dims = self.sigma_t.dims;
        let can_be_halved = dims.iter().all(|n| n % 2 == 0) && dims.iter().any(|n| *n > COARSEST);
        can_be_halved.then(|| Self {
            sigma_t: box_average(&self.sigma_t),
            scaled: self.scaled,
            h: 2.0 * self.h,
            sources: Sources {
                q0: box_average(&self.sources.q0),
                q1: box_average::<DVec3>(&self.sources.q1),
                ambient: self.sources.ambient,
            },
            surfaces: self.surfaces.iter().map(|corners| corners.map(|p| 0.5 * (p + 0.5) - 0.5)).collect(),
        })
    }
}

/// The mean over blocks of 2³ cells; all axes even.
pub fn box_average<T: Weigh>(field: &Field<T>) -> Field<T> {
    Field::from_fn(field.dims.map(|n| n / 2), |[x, y, z]| {
        let mut sum = T::default();
        for (dx, dy, dz) in (0..8).map(|corner| (corner & 1, corner >> 1 & 1, corner >> 2)) {
            sum = sum + field.at([2 * x + dx, 2 * y + dy, 2 * z + dz]);
        }
        sum.weighed(0.125)
    })
}

/// The state on a grid of twice the resolution.
pub fn prolong(state: &Field<DVec4>) -> Field<DVec4> {
    Field::from_fn(state.dims.map(|n| 2 * n), |index| {
        let center = index.map(|i| (i as f64 + 0.5) / 2.0 - 0.5);
        state.trilinear_clamp(DVec3::from_array(center))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(dims: [usize; 3]) -> Level {
        let value = |[x, y, z]: [usize; 3]| (1 + x + 3 * y + 7 * z) as f64;
        let sigma_t = Field::from_fn(dims, value);
        let mut sources = Sources::new(dims, 0.5);
        sources.q0 = Field::from_fn(dims, |index| 2.0 * value(index));
        sources.q1 = Field::from_fn(dims, |index| DVec3::new(0.0, value(index), -1.0));
        Level::new(&OracleMedium { sigma_t, h: 0.25, albedo: 0.5, g: 0.0 }, sources)
    }

    #[test]
    fn halves_while_over_eight_and_even() {
        let dims_of =
            |dims| -> Vec<_> { level(dims).with_coarser().iter().map(|level| level.sigma_t.dims).collect() };
        assert_eq!(dims_of([16, 48, 32]), [[16, 48, 32], [8, 24, 16], [4, 12, 8], [2, 6, 4]]);
        assert_eq!(dims_of([8, 8, 2]), [[8, 8, 2]]);
        assert_eq!(dims_of([10, 6, 4]), [[10, 6, 4], [5, 3, 2]]);
        assert_eq!(dims_of([15, 16, 16]), [[15, 16, 16]]);
    }

    #[test]
    fn coarser_grids_keep_the_power() {
        let levels = level([16, 4, 8]).with_coarser();
        assert_eq!(levels.len(), 2);
        let power = |level: &Level| level.sources.q0.data.iter().sum::<f64>() * level.h.powi(3);
        assert_eq!(power(&levels[0]), power(&levels[1]));
        assert_eq!(levels[1].sources.q1.at([0, 0, 0]).z, -1.0);
        assert_eq!((levels[1].h, levels[1].sources.ambient), (0.5, 0.5));
    }

    #[test]
    fn prolongation_keeps_constants_and_lines() {
        let constant = DVec4::new(3.0, 1.0, -2.0, 0.5);
        let fine = prolong(&Field::filled([1, 3, 2], constant));
        assert!(fine.data.iter().all(|value| *value == constant));
        let line = Field::from_fn([4, 1, 1], |[x, _, _]| DVec4::splat(x as f64));
        let fine = prolong(&line);
        assert_eq!(fine.at([3, 1, 0]).x, 1.25);
        assert_eq!(fine.at([0, 0, 0]).x, 0.0);
        assert_eq!(fine.at([7, 0, 0]).x, 3.0);
    }
}
