//! Optical depth at the corners of cells, and what it makes of light inside them: what the oracles
//! of parallel and of point lights share.
//!
//! The optical depth of a line is the sum of midpoint samples of the trilinear density (zero
//! outside) at most a cell apart. The mean of e^{−k tau} over a cell is, on each of the four edges
//! along the largest component of the direction, (e_a − e_b)/(k tau_b − k tau_a), so what enters an
//! edge less what leaves it is what the cell took; then the mean of the four.
//!
//! Limits: the midpoint rule errs by sigma h/8 at a jump of sigma. The mean is conservative along
//! the edges alone: across them it is a trapezoid, so a slab of 0.6 optical depths a cell, lit at
//! 60° with its normal, takes 13 % too much. Tested with linear densities and by the telescoped
//! sum.

use glam::DVec3;
use rayon::prelude::*;

use crate::optics::transmittance::mean_exp;
use crate::volume::field::Field;

/// Mean of e^{−k tau} over each cell, from tau at its corners.
pub fn mean_along_edges(tau_corners: &Field<f64>, k: f64, direction: DVec3) -> Field<f64> {
    let axis = largest_axis(direction);
    let (across, up) = ((axis + 1) % 3, (axis + 2) % 3);
    let dims = tau_corners.dims.map(|n| n - 1);
    Field::from_fn(dims, |cell| {
        let mut sum = 0.0;
        for (da, du) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let mut start = cell;
            start[across] += da;
            start[up] += du;
            let mut end = start;
            end[axis] += 1;
            sum += mean_exp(k * tau_corners.at(start), k * tau_corners.at(end));
        }
        sum / 4.0
    })
}

/// Optical depth from a point of index space along the unit vector `toward`, up to `length` cells.
pub fn tau_along(sigma_t: &Field<f64>, h: f64, from: DVec3, toward: DVec3, length: f64) -> f64 {
    // The trilinear density is zero from one cell outside the outermost centers on.
    let mut end = length;
    for axis in 0..3 {
        if toward[axis] > PARALLEL_BELOW {
            end = end.min((sigma_t.dims[axis] as f64 - from[axis]) / toward[axis]);
        } else if toward[axis] < -PARALLEL_BELOW {
            end = end.min((-1.0 - from[axis]) / toward[axis]);
        }
    }
    if end <= 0.0 {
        return 0.0;
    }
    let n_steps = end.ceil();
    let step = end / n_steps;
    let samples =
        (0..n_steps as usize).map(|i| sigma_t.trilinear_zero(from + toward * ((i as f64 + 0.5) * step)));
    samples.sum::<f64>() * step * h
}

/// A field over the cells' corners of a grid, from a function of index coordinates.
pub fn corner_field(cells: &Field<f64>, value: impl Fn(DVec3) -> f64 + Sync) -> Field<f64> {
    let dims = cells.dims.map(|n| n + 1);
    let corners = Field::from_fn(dims, |[x, y, z]| DVec3::new(x as f64, y as f64, z as f64) - 0.5);
    Field { dims, data: corners.data.par_iter().map(|corner| value(*corner)).collect() }
}

/// The first axis on which the vector is longest.
fn largest_axis(v: DVec3) -> usize {
    let [x, y, z] = v.abs().to_array();
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

/// Below this component of a unit vector a ray is taken to run along a face.
const PARALLEL_BELOW: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_density_is_exact_away_from_kinks() {
        // The midpoint rule is exact on straight pieces; steps of one cell from a corner to the
        // plane −1 end on half-integers and cover the kink at 0, with a zero density there, evenly.
        let sigma_t = Field::from_fn([1, 1, 10], |[_, _, z]| z as f64);
        let walked = tau_along(&sigma_t, 1.0, DVec3::new(0.0, 0.0, 9.0), DVec3::NEG_Z, 8.0);
        assert!((walked - 40.0).abs() < 1e-12, "{walked}");
    }

    #[test]
    fn means_are_those_of_the_four_edges_and_telescope() {
        let tau = Field::from_fn([2, 2, 9], |[x, y, z]| {
            0.3 * (z * z) as f64 * (1.0 + 0.1 * (x + 2 * y + 3 * x * y) as f64)
        });
        let k = 0.7;
        let mean = mean_along_edges(&tau, k, DVec3::new(0.1, -0.2, -0.9));
        assert_eq!(mean.dims, [1, 1, 8]);
        for z in 0..8 {
            let edge = |[x, y]: [usize; 2]| mean_exp(k * tau.at([x, y, z]), k * tau.at([x, y, z + 1]));
            let expected = [[0, 0], [1, 0], [0, 1], [1, 1]].map(edge).iter().sum::<f64>() / 4.0;
            assert!((mean.at([0, 0, z]) / expected - 1.0).abs() < 1e-14);
        }
        // What the cells of a column take, k sigma h Em, is what the beam lost: eight roundings.
        let uniform = Field::from_fn([2, 2, 9], |[_, _, z]| z as f64);
        let taken: f64 = mean_along_edges(&uniform, k, DVec3::Z).data.iter().map(|e| k * e).sum();
        assert!((taken - (1.0 - (-8.0 * k).exp())).abs() < 1e-14, "{taken}");
    }

    #[test]
    fn edges_follow_the_largest_component() {
        assert_eq!(largest_axis(DVec3::new(-0.9, 0.5, 0.5)), 0);
        assert_eq!(largest_axis(DVec3::new(0.5, -0.5, 0.1)), 0);
        assert_eq!(largest_axis(DVec3::new(0.1, 0.2, -0.3)), 2);
        let tau = Field::from_fn([3, 2, 2], |[x, _, _]| x as f64);
        let mean = mean_along_edges(&tau, 1.0, DVec3::X);
        assert!((mean.at([1, 0, 0]) - mean_exp(1.0, 2.0)).abs() < 1e-16);
    }
}
