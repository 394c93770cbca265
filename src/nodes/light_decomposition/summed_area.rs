//! Sums over any rectangle of a picture in four reads (Crow 1984), in f64.
//!
//! Limits: differences of sums over the whole picture, so a rectangle's is known to 1e-16 of that times the
//! number of rows; what is black may come out as ±1e-13 of the whole. Tested against plain sums.

use rayon::prelude::*;

/// A rectangle of texels: rows `top..bottom`, columns `left..right`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rect {
    pub top: usize,
    pub bottom: usize,
    pub left: usize,
    pub right: usize,
}

impl Rect {
    /// Columns.
    pub(super) fn width(&self) -> usize {
        self.right - self.left
    }

    /// Rows.
    pub(super) fn height(&self) -> usize {
        self.bottom - self.top
    }
}

/// Running sums from the top left corner.
pub(super) struct SummedArea {
    /// Columns and one more.
    stride: usize,
    sums: Vec<f64>,
}

impl SummedArea {
    /// Of a picture whose rows `fill` writes.
    pub(super) fn new(width: usize, height: usize, fill: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let stride = width + 1;
        let mut sums = vec![0.0; stride * (height + 1)];
        sums[stride..].par_chunks_mut(stride).enumerate().for_each(|(row, line)| {
            fill(row, &mut line[1..]);
            let mut sum = 0.0;
            for value in &mut line[1..] {
                sum += *value;
                *value = sum;
            }
        });
        for row in 1..=height {
            let (above, below) = sums.split_at_mut(row * stride);
            for (sum, above) in below[..stride].iter_mut().zip(&above[(row - 1) * stride..]) {
                *sum += above;
            }
        }
        Self { stride, sums }
    }

    /// Sum over a rectangle.
    pub(super) fn sum(&self, rect: Rect) -> f64 {
        let at = |row: usize, column: usize| self.sums[row * self.stride + column];
        at(rect.bottom, rect.right) - at(rect.top, rect.right) - at(rect.bottom, rect.left)
            + at(rect.top, rect.left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_are_plain_sums() {
        let value = |row: usize, column: usize| ((row * 7 + column * 13) % 11) as f64 + 0.25;
        let table = SummedArea::new(9, 5, |row, line| {
            for (column, out) in line.iter_mut().enumerate() {
                *out = value(row, column);
            }
        });
        for (top, bottom, left, right) in [(0, 5, 0, 9), (1, 2, 3, 4), (2, 5, 0, 1), (0, 1, 4, 9)] {
            let plain: f64 =
                (top..bottom).flat_map(|row| (left..right).map(move |column| value(row, column))).sum();
            // Quarters: exact.
            assert_eq!(table.sum(Rect { top, bottom, left, right }), plain);
        }
    }
}
