//! The same march in f64 on the CPU.

use glam::DVec3;

use super::Point;
use crate::nodes::scalar::Scalar;

/// How the march goes.
pub struct March<'a> {
    /// The field.
    pub scalar: &'a Scalar,
    /// Control points.
    pub points: &'a [Point],
    /// Of opacity 1 [1/m].
    pub extinction: f64,
    /// Longest step in voxels.
    pub step: f64,
}

impl March<'_> {
    /// Light and coverage of a ray, `direction` of unit length in the world.
    pub fn ray(&self, eye: DVec3, direction: DVec3) -> ([f64; 3], f64) {
        let (from, to) = (self.scalar.index_of(eye), self.scalar.index_of(eye + direction));
        let direction = to - from;
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let last = self.scalar.dense.dims[axis] as f64;
            let (a, b) = ((-1.0 - from[axis]) / direction[axis], (last - from[axis]) / direction[axis]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        if enter >= leave {
            return ([0.0; 3], 0.0);
        }
        let n = ((leave - enter) * direction.length() / self.step - 1e-3).ceil().max(1.0);
        let h = (leave - enter) / n;
        let (mut light, mut transmittance) = ([0.0; 3], 1.0);
        for k in 0..n as usize {
            let value = self.scalar.at(from + (enter + (k as f64 + 0.5) * h) * direction);
            let (color, opacity) = self.look_up(value);
            let passes = (-self.extinction * opacity * h).exp();
            for (sum, color) in light.iter_mut().zip(color) {
                *sum += transmittance * (1.0 - passes) * color;
            }
            transmittance *= passes;
        }
        (light, 1.0 - transmittance)
    }

    /// Color and opacity of a value.
    pub fn look_up(&self, value: f64) -> ([f64; 3], f64) {
        let next = self.points.partition_point(|point| point.value <= value);
        let last = self.points.len() - 1;
        let (low, high) = (&self.points[next.max(1) - 1], &self.points[next.min(last)]);
        let span = high.value - low.value;
        let share = if span > 0.0 { ((value - low.value) / span).clamp(0.0, 1.0) } else { 0.0 };
        let mix = |a: f64, b: f64| a + share * (b - a);
        let color = std::array::from_fn(|n| mix(low.color[n], high.color[n]));
        (color, mix(low.opacity, high.opacity))
    }
}
