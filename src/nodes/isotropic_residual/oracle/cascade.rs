//! How the residual's sweeps are ordered: the cascade, V-cycles, and the reference.
//!
//! Cascade: from darkness on the coarsest grid, sweeps, prolongation, sweeps, … to the finest; each
//! sweep is rebalanced by one number, so power in is power out at any number of sweeps.
//!
//! Thick: where transport takes hundreds of sweeps, a full-approximation V-cycle
//! x ← T x, y ← T x, z solves z = T_H z + R y − T_H R x from z = R y on the next coarser grid,
//! x ← y + P (z − R y), with phi kept within [¼, 4] of the swept value and |F| ≤ phi; 60 sweeps on
//! the coarsest grid. One cycle a level from the coarsest, two on the finest, one rebalanced sweep
//! after each; none inside, where T must stay the fixed-point map.
//!
//! Reference: from there V-cycle and rebalanced sweep until phi changes by less than 1e-5 of its
//! sum in a round. Limits: past some 5 optical depths a cell at albedo 1 a round of the reference
//! removes a few percent of the error only; it gives up after 400 rounds, and the change is told.
//!
//! Tested by closed forms, symmetry and linearity, and each against the reference.

use glam::DVec4;

use super::level::{Level, box_average, prolong};
use super::sweep::{Balance, Swept, realizable, sweep};
use super::{Options, Quality, Scheme};
use crate::optics::directions::LineDirection;
use crate::volume::field::Field;

/// Sweeps on the coarsest grid of a V-cycle.
const COARSEST_SWEEPS: usize = 60;
/// Change of phi at which the reference ends, relative in the sum of absolute values.
const REFERENCE_CHANGE: f64 = 1e-5;
/// Rounds after which the reference gives up.
const REFERENCE_ROUNDS: usize = 400;

/// The residual and how it came about.
#[derive(Clone, Debug)]
pub struct Solution {
    /// (phi, F) [W/m²].
    pub state: Field<DVec4>,
    /// Power after the last rebalanced sweep.
    pub balance: Balance,
    /// The last sweep's rebalancing factor on each grid, coarsest first: 1 where converged.
    pub factors: Vec<f64>,
    /// Change of phi in the last round of the reference, relative; NaN for the other qualities.
    pub change: f64,
}

/// Solves for the residual.
pub fn solve(level: Level, options: Options) -> Solution {
    let solver = Solver {
        levels: level.with_coarser(),
        directions: options.lines.directions(),
        scheme: options.scheme,
    };
    match options.quality {
        Quality::Draft => solver.cascade(1, 4),
        Quality::Fast => solver.cascade(1, 8),
        Quality::Default => solver.cascade(4, 16),
        Quality::Thick => solver.nested_cycles(),
        Quality::Reference => solver.converged(),
    }
}

struct Solver {
    /// Finest first.
    levels: Vec<Level>,
    directions: Vec<LineDirection>,
    scheme: Scheme,
}

impl Solver {
    /// `finest` rebalanced sweeps on the finest grid, `coarser` on the others; a single grid gets
    /// the coarse count.
    fn cascade(&self, finest: usize, coarser: usize) -> Solution {
        self.nested(|depth, state| {
            let is_coarse = depth > 0 || self.levels.len() == 1;
            self.rebalanced_sweeps(depth, state, if is_coarse { coarser } else { finest })
        })
    }

    /// The quality `thick`.
    fn nested_cycles(&self) -> Solution {
        self.nested(|depth, state| {
            if depth == self.coarsest() {
                return self.rebalanced_sweeps(depth, state, COARSEST_SWEEPS);
            }
            let cycled = self.v_cycle(depth, state, None);
            let cycled = if depth == 0 { self.v_cycle(0, cycled, None) } else { cycled };
            self.rebalanced_sweeps(depth, cycled, 1)
        })
    }

    /// The quality `reference`.
    fn converged(&self) -> Solution {
        let mut solution = self.nested_cycles();
        for _ in 0..REFERENCE_ROUNDS {
            let cycled = self.v_cycle(0, solution.state.clone(), None);
            let (swept, factor) = self.rebalanced_sweeps(0, cycled, 1);
            solution.change = change(&solution.state, &swept.state);
            solution.state = swept.state;
            solution.balance = swept.balance;
            *solution.factors.last_mut().expect("at least one grid") = factor;
            if solution.change < REFERENCE_CHANGE {
                break;
            }
        }
        solution
    }

    /// From darkness on the coarsest grid to the finest, `work` done on each.
    fn nested(&self, work: impl Fn(usize, Field<DVec4>) -> (Swept, f64)) -> Solution {
        let dims = self.levels[self.coarsest()].sigma_t.dims;
        let (mut swept, factor) = work(self.coarsest(), Field::filled(dims, DVec4::ZERO));
        let mut factors = vec![factor];
        for depth in (0..self.coarsest()).rev() {
            let (finer, factor) = work(depth, prolong(&swept.state));
            swept = finer;
            factors.push(factor);
        }
        Solution { state: swept.state, balance: swept.balance, factors, change: f64::NAN }
    }

    fn coarsest(&self) -> usize {
        self.levels.len() - 1
    }

    fn sweep(&self, depth: usize, state: &Field<DVec4>) -> Swept {
        sweep(&self.levels[depth], state, &self.directions, self.scheme)
    }

    /// `count` ≥ 1 sweeps, and the last one's factor.
    fn rebalanced_sweeps(&self, depth: usize, mut state: Field<DVec4>, count: usize) -> (Swept, f64) {
        for _ in 1..count {
            state = self.sweep(depth, &state).rebalanced().0.state;
        }
        self.sweep(depth, &state).rebalanced()
    }

    /// One sweep, plus what the finer grid wants added.
    fn corrected_sweep(
        &self,
        depth: usize,
        state: &Field<DVec4>,
        correction: Option<&Field<DVec4>>,
    ) -> Field<DVec4> {
        let mut swept = self.sweep(depth, state).state;
        if let Some(correction) = correction {
            for (light, correction) in swept.data.iter_mut().zip(&correction.data) {
                *light = realizable(*light + *correction);
            }
        }
        swept
    }

    fn v_cycle(&self, depth: usize, state: Field<DVec4>, correction: Option<&Field<DVec4>>) -> Field<DVec4> {
        if depth == self.coarsest() {
            return (0..COARSEST_SWEEPS)
                .fold(state, |state, _| self.corrected_sweep(depth, &state, correction));
        }
        let x = self.corrected_sweep(depth, &state, correction);
        let y = self.corrected_sweep(depth, &x, correction);
        let coarse_y = box_average(&y);
        let coarse_swept = self.sweep(depth + 1, &box_average(&x)).state;
        let wanted = combine(&coarse_y, &coarse_swept, |y, swept| y - swept);
        let z = self.v_cycle(depth + 1, coarse_y.clone(), Some(&wanted));
        let step = prolong(&combine(&z, &coarse_y, |z, y| z - y));
        combine(&y, &step, |y, step| {
            let mut light = y + step;
            light.x = light.x.clamp(0.25 * y.x, 4.0 * y.x);
            realizable(light)
        })
    }
}

fn combine(a: &Field<DVec4>, b: &Field<DVec4>, value: impl Fn(DVec4, DVec4) -> DVec4) -> Field<DVec4> {
    let data = a.data.iter().zip(&b.data).map(|(a, b)| value(*a, *b)).collect();
    Field { dims: a.dims, data }
}

/// Σ|Δphi|/Σphi.
fn change(before: &Field<DVec4>, after: &Field<DVec4>) -> f64 {
    let moved: f64 = before.data.iter().zip(&after.data).map(|(a, b)| (a.x - b.x).abs()).sum();
    let total: f64 = after.data.iter().map(|light| light.x).sum();
    if total > 0.0 { moved / total } else { 0.0 }
}

#[cfg(test)]
mod tests;
