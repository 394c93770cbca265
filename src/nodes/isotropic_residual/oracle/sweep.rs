//! One transport sweep along the lines of the lattice.
//!
//! The line through a cell's center along an integer vector e goes through centers only, so a line
//! needs no neighbors. Segment s = |e| h, tube h³/s. In a cell of extinction t = sigma_t*, with the
//! source q per steradian, S = q/t, o = t s, incoming radiance I, mean c and outgoing radiance O:
//! - order 2: A = 2/s, c = (q + A I)/(t + A), O = 2c − I; where negative c = (q + A I/2)/t, O = 0;
//! - linear source: S rises by ±hs about the cell's mean, hs = (S_next − S_before)/4, one-sided
//!   halves beside void or boundary, |hs| ≤ S; O = I − (I − S)E + hs G, c = S + (I − O)/o,
//!   evaluated as I M + S (1 − M) − hs G/o with M = E/o, which does not cancel;
//! - t = 0: c = I + q s/2, O = I + q s.
//!
//! In each of them t c s + O = I + q s: power is conserved line by line, so Σ q + entering =
//! Σ t c + leaving. phi = Σ w c, F = Σ w c ω. Lines start at the boundary with the ambient
//! radiance. A segment to the next cell that meets a surface ends there, into the surface, and starts anew with
//! nothing but the ambient light that neither scattering nor absorption has met: what surfaces hide of that and
//! what they send back are sources. Tested by that balance to rounding over the extremes of media, by closed forms
//! and by symmetry.

use glam::{DVec3, DVec4, IVec3};
use rayon::prelude::*;

use super::level::Level;
use crate::optics::directions::LineDirection;
use crate::optics::lobe::SquaredLinearLobe;
use crate::optics::transmittance::{
    linear_source_weight, mean_transmittance, one_minus_exp, one_minus_mean_transmittance,
};
use crate::volume::field::Field;

/// Transport through one cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Order 2 ("diamond"): the mean is the average of what enters and what leaves.
    Diamond,
    /// Exact for a source that is linear along the segment.
    LinearSource,
}

/// Where the power of a sweep went (W).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Given by Q0.
    pub source: f64,
    /// Brought in by the ambient radiance.
    pub entering: f64,
    /// Carried out of the grid, by the face: −x, +x, −y, +y, −z, +z. A line that leaves through an
    /// edge or a corner counts for the last of its axes.
    pub leaving: [f64; 6],
    /// Carried into surfaces inside of the grid.
    pub into_surfaces: f64,
    /// Absorbed: Σ sigma_a phi h³.
    pub absorbed: f64,
}

impl Balance {
    /// Source and entering power.
    pub fn incoming(&self) -> f64 {
        self.source + self.entering
    }

    /// Leaving and absorbed power, also that which surfaces take.
    pub fn outgoing(&self) -> f64 {
        self.leaving.iter().sum::<f64>() + self.into_surfaces + self.absorbed
    }

    /// What phi, F and the outgoing power must be multiplied by so that as much leaves as comes.
    pub fn factor(&self) -> f64 {
        let outgoing = self.outgoing();
        if outgoing > 0.0 { self.incoming() / outgoing } else { 1.0 }
    }
}

/// Result of a sweep.
#[derive(Clone, Debug)]
pub struct Swept {
    /// (phi, F).
    pub state: Field<DVec4>,
    /// The power.
    pub balance: Balance,
}

impl Swept {
    /// The result times the one number that balances its power; the number too.
    pub fn rebalanced(mut self) -> (Self, f64) {
        let factor = self.balance.factor();
        self.state.data.iter_mut().for_each(|value| *value *= factor);
        self.balance.leaving = self.balance.leaving.map(|power| power * factor);
        self.balance.into_surfaces *= factor;
        self.balance.absorbed *= factor;
        (self, factor)
    }
}

/// The lobes of the cells' sources [W/(m³ sr)] when the light is `state`.
pub fn lobes(level: &Level, state: &Field<DVec4>) -> Field<SquaredLinearLobe> {
    let data = (0..state.data.len())
        .map(|idx| {
            let sigma_s = level.sigma_t.data[idx] * level.scaled.sigma_s_ratio;
            let light = state.data[idx];
            let q = sigma_s * light.x + level.sources.q0.data[idx];
            let v = sigma_s * level.scaled.g_star * flux_of(light) + level.sources.q1.data[idx];
            SquaredLinearLobe::new(q, v)
        })
        .collect();
    Field { dims: state.dims, data }
}

/// One sweep of all directions: the light that the sources of `state` make.
pub fn sweep(level: &Level, state: &Field<DVec4>, directions: &[LineDirection], scheme: Scheme) -> Swept {
    let lobes = lobes(level, state);
    let swept: Vec<_> =
        directions.par_iter().map(|line| sweep_direction(level, &lobes, line, scheme)).collect();
    let volume = level.h.powi(3);
    let mut result = Field::filled(state.dims, DVec4::ZERO);
    let mut balance = Balance {
        source: level.sources.q0.data.iter().sum::<f64>() * volume,
        entering: 0.0,
        leaving: [0.0; 6],
        into_surfaces: 0.0,
        absorbed: 0.0,
    };
    for (line, one) in directions.iter().zip(&swept) {
        let moments = line.weight * DVec4::from((1.0, line.unit()));
        for (sum, mean) in result.data.iter_mut().zip(&one.mean) {
            *sum += *mean * moments;
        }
        balance.entering += one.entering;
        balance.into_surfaces += one.into_surfaces;
        for (sum, power) in balance.leaving.iter_mut().zip(one.leaving) {
            *sum += power;
        }
    }
    result.data.iter_mut().for_each(|light| *light = realizable(*light));
    let absorbed = result.data.iter().zip(&level.sigma_t.data).map(|(light, t)| light.x * t);
    balance.absorbed = absorbed.sum::<f64>() * level.scaled.sigma_a_ratio * volume;
    Swept { state: result, balance }
}

/// The state nearest to `light` with phi ≥ 0 and |F| ≤ phi.
pub fn realizable(light: DVec4) -> DVec4 {
    let phi = light.x.max(0.0);
    let flux = flux_of(light);
    let length = flux.length();
    let flux = if length > phi { flux * (phi / length) } else { flux };
    DVec4::from((phi, flux))
}

/// F of a state.
pub fn flux_of(light: DVec4) -> DVec3 {
    DVec3::new(light.y, light.z, light.w)
}

/// What one direction brings.
struct SweptDirection {
    /// Mean radiance of each cell.
    mean: Vec<f64>,
    /// Power over the direction's solid angle that came in (W).
    entering: f64,
    /// And that went out, by the face.
    leaving: [f64; 6],
    /// And into surfaces.
    into_surfaces: f64,
}

fn sweep_direction(
    level: &Level,
    lobes: &Field<SquaredLinearLobe>,
    line: &LineDirection,
    scheme: Scheme,
) -> SweptDirection {
    let unit = line.unit();
    let segment = line.step_length() * level.h;
    let power_per_radiance = line.weight * level.h.powi(3) / segment;
    let dims = level.sigma_t.dims;
    let extinction = |idx: usize| level.sigma_t.data[idx] * level.scaled.k;
    let source_function = |idx: usize| {
        let t = extinction(idx);
        (t > 0.0).then(|| lobes.data[idx].eval(unit) / t)
    };
    let mut swept = SweptDirection {
        mean: vec![0.0; lobes.data.len()],
        entering: 0.0,
        leaving: [0.0; 6],
        into_surfaces: 0.0,
    };
    for start in 0..lobes.data.len() {
        let first = IVec3::from_array(lobes.index_of(start).map(|i| i as i32));
        if inside(first - line.e, dims).is_some() {
            continue;
        }
        let mut radiance = level.sources.ambient;
        let mut ambient = radiance;
        swept.entering += power_per_radiance * radiance;
        let (mut cell, mut idx, mut before) = (first, start, None);
        loop {
            let next = inside(cell + line.e, dims);
            let (t, q) = (extinction(idx), lobes.data[idx].eval(unit));
            let (mean, outgoing) = if t == 0.0 {
                (radiance + 0.5 * q * segment, radiance + q * segment)
            } else if scheme == Scheme::Diamond {
                diamond(radiance, q, t, segment)
            } else {
                let half_rise = half_rise(before, q / t, next.and_then(source_function));
                linear_source(radiance, q / t, half_rise, t * segment)
            };
            swept.mean[idx] = mean;
            radiance = outgoing;
            if !level.surfaces.is_empty() {
                // Of ambient light nothing is left but what is not yet absorbed or scattered.
                ambient = match scheme {
                    _ if t == 0.0 => ambient,
                    Scheme::Diamond => diamond(ambient, 0.0, t, segment).1,
                    Scheme::LinearSource => ambient * (-t * segment).exp(),
                };
                if next.is_some() && level.is_walled(cell, line.e) {
                    swept.into_surfaces += power_per_radiance * (radiance - ambient);
                    radiance = ambient;
                }
            }
            before = source_function(idx);
            cell += line.e;
            match next {
                Some(next) => idx = next,
                None => break,
            }
        }
        swept.leaving[exit_face(cell, dims)] += power_per_radiance * radiance;
    }
    swept
}

/// Mean and outgoing radiance by the order-2 rule; t > 0.
fn diamond(incoming: f64, q: f64, t: f64, segment: f64) -> (f64, f64) {
    let a = 2.0 / segment;
    let mean = (q + a * incoming) / (t + a);
    let outgoing = 2.0 * mean - incoming;
    if outgoing < 0.0 { ((q + 0.5 * a * incoming) / t, 0.0) } else { (mean, outgoing) }
}

/// Mean and outgoing radiance for the source function `s` ± `half_rise` over the depth `o` > 0.
fn linear_source(incoming: f64, s: f64, half_rise: f64, o: f64) -> (f64, f64) {
    let g = linear_source_weight(o);
    let outgoing = incoming - (incoming - s) * one_minus_exp(o) + half_rise * g;
    let mean = incoming * mean_transmittance(o) + s * one_minus_mean_transmittance(o) - half_rise * g / o;
    (mean.max(0.0), outgoing)
}

/// Half of what the source function rises by across a cell, from those of its neighbors on the
/// line; `None` beside void and boundary. Limited so that the source stays positive.
fn half_rise(before: Option<f64>, here: f64, next: Option<f64>) -> f64 {
    let half_rise = match (before, next) {
        (Some(before), Some(next)) => 0.25 * (next - before),
        (None, Some(next)) => 0.5 * (next - here),
        (Some(before), None) => 0.5 * (here - before),
        (None, None) => 0.0,
    };
    half_rise.clamp(-here, here)
}

/// Where a cell stands, if it is in the grid.
fn inside(cell: IVec3, dims: [usize; 3]) -> Option<usize> {
    let [nx, ny, nz] = dims.map(|n| n as i32);
    let is_inside = (0..nx).contains(&cell.x) && (0..ny).contains(&cell.y) && (0..nz).contains(&cell.z);
    is_inside.then(|| (cell.x + nx * (cell.y + ny * cell.z)) as usize)
}

/// The face (−x, +x, … +z) behind which a cell lies; the last one of several.
fn exit_face(cell: IVec3, dims: [usize; 3]) -> usize {
    let axis = (0..3)
        .rev()
        .find(|axis| !(0..dims[*axis] as i32).contains(&cell[*axis]))
        .expect("a line ends outside the grid");
    2 * axis + usize::from(cell[axis] > 0)
}

#[cfg(test)]
mod tests;
