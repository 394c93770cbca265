//! Which segments of the sweeps' lines meet a surface.
//!
//! A line goes from center to center of the cells. A segment of it that meets a surface ends there: what it carries
//! leaves the medium, into the surface, and on the other side a line without light starts. What surfaces send back
//! comes another way (`bounce.rs`), and so does what they hide of ambient light: the share of a line that is still
//! ambient, on which nothing has acted but extinction, goes on.
//!
//! One bit for each cell and pair of opposite directions, found triangle by triangle: seen along the direction, the
//! lines are points of a lattice, and those inside of the triangle's projection meet it. Two triangles see a shared
//! edge by the same numbers, so that no line slips between them. The work goes with the area of the surfaces, not
//! with the cells.
//!
//! Coarser grids look for surfaces themselves, by their own centers: what parts the fine grid parts those too, where
//! the majority of fine segments would leave a diagonal wall open. What is smaller than a coarse cell is met by
//! some of its lines or by none, right on average.
//!
//! In: triangles in index space of the finest grid. Limits: surfaces closer to each other than a cell can stand
//! between the same centers. Tested against segments that try every triangle.

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use crate::optics::directions::LineDirection;

/// Surfaces are met this far from where they stand [cells of the finest grid], so that one that lies exactly on
/// centers is on the same side of them for all lines, whatever the rounding of its f32 corners.
pub(super) const APART: DVec3 = DVec3::new(1.3e-3, 0.7e-3, 1.0e-3);

/// For each cell of the grid that has been halved so many times, a bit for each even entry of the directions: whether
/// its segment to the next cell along that direction, which the opposite direction shares, meets a surface. `None`
/// where none does.
pub(super) fn walls(
    triangles: &[[Vec3; 3]],
    dims: [usize; 3],
    n_halvings: usize,
    directions: &[LineDirection],
) -> Option<Vec<u32>> {
    let cells_per_cell = (1_u32 << n_halvings) as f64;
    let place = |p: Vec3| (p.as_dvec3() + APART + 0.5) / cells_per_cell - 0.5;
    let last = DVec3::from_array(dims.map(|n| n as f64 - 1.0));
    let near: Vec<[DVec3; 3]> = triangles
        .iter()
        .map(|corners| corners.map(place))
        .filter(|[a, b, c]| a.min(*b).min(*c).cmple(last).all() && a.max(*b).max(*c).cmpge(DVec3::ZERO).all())
        .collect();
    if near.is_empty() {
        return None;
    }
    let met: Vec<Vec<usize>> =
        directions.par_iter().step_by(2).map(|direction| segments(&near, dims, direction)).collect();
    if met.iter().all(Vec::is_empty) {
        return None;
    }
    let mut bits = vec![0; dims.iter().product()];
    for (pair, cells) in met.iter().enumerate() {
        for cell in cells {
            bits[*cell] |= 1 << pair;
        }
    }
    Some(bits)
}

/// The cells whose segments along a direction are met, some of them several times.
fn segments(triangles: &[[DVec3; 3]], dims: [usize; 3], direction: &LineDirection) -> Vec<usize> {
    let steps = direction.e.abs();
    let w = (0..3).max_by_key(|axis| steps[*axis]).unwrap_or(2);
    let (u, v) = ((w + 1) % 3, (w + 2) % 3);
    let is_reversed = direction.e[w] < 0;
    // Along the sense in which w grows.
    let e = if is_reversed { -direction.e } else { direction.e };
    let hop = e[w];
    let slope = DVec2::new(f64::from(e[u]), f64::from(e[v])) / f64::from(hop);
    let n = [u, v, w].map(|axis| dims[axis] as i32);
    let mut cells = Vec::new();
    for corners in triangles {
        let flat = corners.map(|p| DVec2::new(p[u], p[v]) - slope * p[w]);
        let low = flat[0].min(flat[1]).min(flat[2]);
        let high = flat[0].max(flat[1]).max(flat[2]);
        // A direction that hops has as many sets of lines as cells to a hop, each shifted against the last.
        for phase in 0..hop {
            let shift = -slope * f64::from(phase);
            let range = |axis: usize| {
                // Of all lines that enter the grid.
                let reach = slope[axis] * f64::from(n[2] - 1);
                let from = (low[axis] - shift[axis]).max((-reach).min(0.0) - shift[axis] - 1.0);
                let to = (high[axis] - shift[axis]).min(f64::from(n[axis]) - reach.min(0.0) - shift[axis]);
                (from.ceil() as i32, to.floor() as i32)
            };
            let ((u_from, u_to), (v_from, v_to)) = (range(0), range(1));
            for b in v_from..=v_to {
                for a in u_from..=u_to {
                    let line = DVec2::new(f64::from(a), f64::from(b)) + shift;
                    let Some(depth) = depth(&flat, corners.map(|p| p[w]), line) else { continue };
                    let hops = ((depth - f64::from(phase)) / f64::from(hop)).floor() as i32;
                    let at = [a + hops * e[u], b + hops * e[v], phase + hops * hop];
                    let next = [at[0] + e[u], at[1] + e[v], at[2] + hop];
                    let is_inside = |cell: [i32; 3]| (0..3).all(|axis| (0..n[axis]).contains(&cell[axis]));
                    if is_inside(at) && is_inside(next) {
                        let mut cell = [0; 3];
                        let owner = if is_reversed { next } else { at };
                        for (axis, index) in [u, v, w].into_iter().zip(owner) {
                            cell[axis] = index as usize;
                        }
                        cells.push(cell[0] + dims[0] * (cell[1] + dims[1] * cell[2]));
                    }
                }
            }
        }
    }
    cells
}

/// Where a line that is seen as a point meets a triangle, if it does; `w` at the corners.
fn depth(corners: &[DVec2; 3], w: [f64; 3], line: DVec2) -> Option<f64> {
    let [a, b, c] = corners.map(|p| p - line);
    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let sum: f64 = areas.iter().sum();
    let is_inside = areas.iter().all(|area| *area >= 0.0) || areas.iter().all(|area| *area <= 0.0);
    (is_inside && sum != 0.0).then(|| (0..3).map(|n| areas[n] * w[n]).sum::<f64>() / sum)
}

#[cfg(test)]
mod tests;
