//! A dense box of values, in memory.
//!
//! Values sit at integer index coordinates, x fastest: `idx = x + nx (y + ny z)`. Between them the
//! field is trilinear. What stands outside the box is either zero, so that the field fades over one
//! cell (density: the background takes part in the interpolation), or the nearest value (fields
//! that the solver makes). Tested with functions that trilinear interpolation reproduces exactly.

use std::ops::Add;

use glam::{DVec3, DVec4};

/// A box of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<T> {
    /// Number of values along x, y, z; all at least 1.
    pub dims: [usize; 3],
    /// The values, x fastest.
    pub data: Vec<T>,
}

/// Values that interpolation can weigh.
pub trait Weigh: Copy + Default + Add<Output = Self> {
    /// The value times a weight.
    fn weighed(self, weight: f64) -> Self;
}

impl Weigh for f32 {
    fn weighed(self, weight: f64) -> Self {
        self * weight as f32
    }
}

impl Weigh for f64 {
    fn weighed(self, weight: f64) -> Self {
        self * weight
    }
}

impl Weigh for DVec3 {
    fn weighed(self, weight: f64) -> Self {
        self * weight
    }
}

impl Weigh for DVec4 {
    fn weighed(self, weight: f64) -> Self {
        self * weight
    }
}

impl<T: Copy> Field<T> {
    /// A box that holds `value` everywhere.
    pub fn filled(dims: [usize; 3], value: T) -> Self {
        Self { dims, data: vec![value; dims.iter().product()] }
    }

    /// A box that holds `value(index)`.
    pub fn from_fn(dims: [usize; 3], mut value: impl FnMut([usize; 3]) -> T) -> Self {
        let mut data = Vec::with_capacity(dims.iter().product());
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    data.push(value([x, y, z]));
                }
            }
        }
        Self { dims, data }
    }

    /// Where the value of an index stands in [`Field::data`].
    pub fn idx(&self, [x, y, z]: [usize; 3]) -> usize {
        x + self.dims[0] * (y + self.dims[1] * z)
    }

    /// The index of a position in [`Field::data`].
    pub fn index_of(&self, idx: usize) -> [usize; 3] {
        let [nx, ny, _] = self.dims;
        [idx % nx, idx / nx % ny, idx / (nx * ny)]
    }

    /// The value at an index.
    ///
    /// # Panics
    /// Outside the box.
    pub fn at(&self, index: [usize; 3]) -> T {
        self.data[self.idx(index)]
    }

    /// The field of `value(each value)`.
    pub fn map<U>(&self, value: impl FnMut(&T) -> U) -> Field<U> {
        Field { dims: self.dims, data: self.data.iter().map(value).collect() }
    }
}

impl<T: Weigh> Field<T> {
    /// The trilinear value at index coordinates; zero stands outside the box and takes part.
    pub fn trilinear_zero(&self, p: DVec3) -> T {
        self.trilinear(p, |index| {
            let inside = (0..3).all(|axis| (0..self.dims[axis] as i64).contains(&index[axis]));
            if inside { self.at(index.map(|i| i as usize)) } else { T::default() }
        })
    }

    /// The trilinear value at index coordinates; outside the box stands its nearest value.
    pub fn trilinear_clamp(&self, p: DVec3) -> T {
        self.trilinear(p, |index| {
            self.at(std::array::from_fn(|axis| index[axis].clamp(0, self.dims[axis] as i64 - 1) as usize))
        })
    }

    fn trilinear(&self, p: DVec3, value: impl Fn([i64; 3]) -> T) -> T {
        let low = p.floor();
        let high_weight = p - low;
        let mut sum = T::default();
        for corner in 0..8 {
            let high = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = (0..3)
                .map(|axis| if high[axis] == 1 { high_weight[axis] } else { 1.0 - high_weight[axis] })
                .product();
            if weight > 0.0 {
                let index = std::array::from_fn(|axis| low[axis] as i64 + i64::from(high[axis]));
                sum = sum + value(index).weighed(weight);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn x_is_fastest() {
        let field = Field::from_fn([2, 3, 4], |[x, y, z]| x + 10 * y + 100 * z);
        assert_eq!(field.data[..3], [0, 1, 10]);
        assert_eq!(field.at([1, 2, 3]), 321);
        for idx in 0..24 {
            assert_eq!(field.idx(field.index_of(idx)), idx);
        }
    }

    #[test]
    fn trilinear_reproduces_products_of_lines() {
        let function = |p: DVec3| (1.0 + p.x) * (2.0 - 0.5 * p.y) * (3.0 + 0.1 * p.z);
        let point = |[x, y, z]: [usize; 3]| DVec3::new(x as f64, y as f64, z as f64);
        let field = Field::from_fn([4, 5, 3], |index| function(point(index)));
        for p in [DVec3::new(0.3, 2.7, 1.9), DVec3::new(3.0, 4.0, 2.0), DVec3::new(0.0, 0.5, 0.0)] {
            // Eight products of three weights: some thirty roundings of values up to 24.
            assert!((field.trilinear_clamp(p) - function(p)).abs() < 30.0 * 24.0 * f64::EPSILON);
            assert_eq!(field.trilinear_clamp(p), field.trilinear_zero(p));
        }
    }

    #[test]
    fn outside_is_zero_or_the_nearest() {
        let field = Field::filled([2, 2, 2], 8.0);
        assert_eq!(field.trilinear_zero(DVec3::new(-0.25, 0.5, 1.0)), 6.0);
        assert_eq!(field.trilinear_zero(DVec3::new(1.5, 1.5, 1.5)), 1.0);
        assert_eq!(field.trilinear_zero(DVec3::new(-1.0, 0.0, 0.0)), 0.0);
        assert_eq!(field.trilinear_zero(DVec3::splat(1e12)), 0.0);
        assert_eq!(field.trilinear_clamp(DVec3::new(-1e12, 0.5, 9.0)), 8.0);
        let wide = field.map(|value| *value as f32);
        assert_eq!(wide.trilinear_zero(DVec3::new(1.5, 0.0, 0.0)), 4.0f32);
    }
}
