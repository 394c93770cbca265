//! f64 oracle of the widening peak, on a grid that is aligned with the light.
//!
//! In: extinction [1/m] at cells whose third axis runs along the light, their edge [m], and what surfaces
//! block. Out, for light of 1 W/m²: E* at the faces between slices, in the middles of columns; and the means
//! of E* over the cells. Tested by closed forms and by the conservation of power; the radii of pencil beams,
//! with the residual, in `oracle_scene/tests/pencils.rs`.

use super::{LEAST_POWER, LEAST_SHARE};
use crate::optics::delta::DeltaScaled;
use crate::optics::transmittance::mean_transmittance;
use crate::volume::field::Field;

/// A homogeneous set of parameters.
#[derive(Debug, Clone, Copy)]
pub struct Widening {
    /// Edge of a cell [m].
    pub h: f64,
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Mean cosine of the phase function.
    pub g: f64,
}

/// What the march leaves.
#[derive(Debug, Clone)]
pub struct Widened {
    /// E* at the faces, one more than slices.
    pub star: Field<f64>,
    /// The same without widening and surfaces.
    pub straight: Field<f64>,
    /// Mean of E* over the cells.
    pub mean: Field<f64>,
    /// What left through the sides [W/m² of a column].
    pub leaked: f64,
}

/// A column: light that was not scattered, light of the peak, and the peak's covariance of place and angle
/// and variance of angle, along one axis, times its power [W/m² · 1, m, 1].
#[derive(Debug, Clone, Copy, Default)]
struct Column {
    straight: f64,
    unscattered: f64,
    peak: [f64; 3],
}

impl Widening {
    /// Marches slice by slice; `is_lit(column, face)` tells whether the light passes from the face before
    /// (from the source, for the first) to this one.
    pub fn propagate(&self, sigma_t: &Field<f64>, is_lit: impl Fn([usize; 2], usize) -> bool) -> Widened {
        let [nx, ny, nz] = sigma_t.dims;
        let scaled = DeltaScaled::new(self.albedo, self.g);
        let mut columns = vec![Column { straight: 1.0, unscattered: 1.0, peak: [0.0; 3] }; nx * ny];
        let mut widened = Widened {
            star: Field::filled([nx, ny, nz + 1], 0.0),
            straight: Field::filled([nx, ny, nz + 1], 0.0),
            mean: Field::filled(sigma_t.dims, 0.0),
            leaked: 0.0,
        };
        for face in 0..=nz {
            for (idx, column) in columns.iter_mut().enumerate() {
                let at = [idx % nx, idx / nx];
                if !is_lit(at, face) {
                    *column = Column { straight: column.straight, ..Column::default() };
                }
                let to = widened.star.idx([at[0], at[1], face]);
                widened.star.data[to] = column.unscattered + column.peak[0];
                widened.straight.data[to] = column.straight;
            }
            if face == nz {
                break;
            }
            let mut numbers = vec![0.0; nx * ny];
            for (idx, column) in columns.iter_mut().enumerate() {
                let cell = widened.mean.idx([idx % nx, idx / nx, face]);
                let sigma = sigma_t.data[cell];
                widened.mean.data[cell] = self.pass(column, &scaled, sigma);
                numbers[idx] = diffusion_number(column, self.h);
            }
            let before: f64 = columns.iter().map(|column| column.peak[0]).sum();
            for y in 0..ny {
                let row: Vec<usize> = (0..nx).map(|x| x + nx * y).collect();
                diffuse(&mut columns, &numbers, &row);
            }
            for x in 0..nx {
                let row: Vec<usize> = (0..ny).map(|y| x + nx * y).collect();
                diffuse(&mut columns, &numbers, &row);
            }
            widened.leaked += before - columns.iter().map(|column| column.peak[0]).sum::<f64>();
        }
        widened
    }

    /// Through a cell of this extinction, straight; the mean of E*.
    fn pass(&self, column: &mut Column, scaled: &DeltaScaled, sigma_t: f64) -> f64 {
        let h = self.h;
        let depth = scaled.k * sigma_t * h;
        let (kept, mean) = ((-depth).exp(), mean_transmittance(depth));
        let entering = column.unscattered + column.peak[0];
        let em = entering * mean;
        // Variance of angle, an axis, that a meter adds.
        let spread = sigma_t * self.albedo * scaled.f * (1.0 - self.g) / 6.0;
        let [_, covariance, variance] = column.peak;
        column.unscattered *= (-sigma_t * h).exp();
        column.peak = [
            (entering * kept - column.unscattered).max(0.0),
            covariance * kept + h * variance * kept + 0.5 * spread * h * h * em,
            variance * kept + spread * h * em,
        ];
        column.straight *= kept;
        em
    }
}

/// What diffusion across the beam is a slice long: the covariance is half of the growth of the variance of
/// place.
fn diffusion_number(column: &Column, h: f64) -> f64 {
    let [power, covariance, _] = column.peak;
    let least = (LEAST_SHARE * (column.unscattered + power)).max(LEAST_POWER);
    covariance / (power.max(least) * h)
}

/// One backward-Euler step of diffusion along a row of columns, dark outside.
fn diffuse(columns: &mut [Column], numbers: &[f64], row: &[usize]) {
    let n = row.len();
    let mut upper = vec![0.0; n];
    for i in 0..n {
        let own = numbers[row[i]];
        let left = if i > 0 { 0.5 * (own + numbers[row[i - 1]]) } else { own };
        let right = if i + 1 < n { 0.5 * (own + numbers[row[i + 1]]) } else { own };
        let (below, before) = if i > 0 { (upper[i - 1], columns[row[i - 1]].peak) } else { (0.0, [0.0; 3]) };
        let pivot = 1.0 + left + right - left * below;
        upper[i] = right / pivot;
        let peak = &mut columns[row[i]].peak;
        for q in 0..3 {
            peak[q] = (peak[q] + left * before[q]) / pivot;
        }
    }
    for i in (0..n.saturating_sub(1)).rev() {
        let after = columns[row[i + 1]].peak;
        let peak = &mut columns[row[i]].peak;
        for q in 0..3 {
            peak[q] += upper[i] * after[q];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nodes::testing::Random;

    const ALL: fn([usize; 2], usize) -> bool = |_, _| true;

    #[test]
    fn wide_light_is_a_straight_beam() {
        // In the middle of a slab so wide that its sides are not felt: nothing changes but by what comes back
        // from the sides, which falls by a factor of more than 2 a column.
        let widening = Widening { h: 0.1, albedo: 1.0, g: 0.9 };
        let sigma_t = Field::from_fn([61, 61, 10], |[_, _, z]| 2.0 + z as f64);
        let widened = widening.propagate(&sigma_t, ALL);
        let mut tau = 0.0;
        for z in 0..=10 {
            let expected = (-0.19_f64 * tau).exp();
            assert!((widened.star.at([30, 30, z]) / expected - 1.0).abs() < 1e-8, "{z}");
            assert!((widened.straight.at([30, 30, z]) / expected - 1.0).abs() < 1e-14, "{z}");
            tau += 0.1 * (2.0 + z as f64);
        }
    }

    #[test]
    fn the_variance_of_a_pencil_is_nearly_that_of_fermi_and_eyges() {
        // Along an axis across the beam T L³/3 for all that is left of it. The diffusion by the local C/Ep is
        // stronger on the axis, where light is young, and the slices add half of one each: a third too wide at 10
        // slices, a fifth at 40 (the root, a tenth).
        let (length, sigma, g) = (1.0, 2.0, 0.9);
        let mut before = 1.35;
        for n in [10, 20, 40] {
            let h = length / n as f64;
            let widening = Widening { h, albedo: 1.0, g };
            let (wide, middle) = (2 * n + 1, n);
            let sigma_t = Field::filled([wide, wide, n], sigma);
            let widened = widening.propagate(&sigma_t, |at, face| face > 0 || at == [middle; 2]);
            let (mut power, mut second) = (0.0, 0.0);
            for y in 0..wide {
                for x in 0..wide {
                    let exit = widened.star.at([x, y, n]);
                    power += exit;
                    second += exit * ((x as f64 - middle as f64) * h).powi(2);
                }
            }
            // The sides are 10 standard deviations away, but backward Euler has long tails.
            assert!((power / (-0.19 * sigma).exp() - 1.0).abs() < 1e-3, "{power}");
            let expected = sigma * g * g * (1.0 - g) / 6.0 * length.powi(3) / 3.0;
            let found = second / power;
            assert!((1.0..before).contains(&(found / expected)), "{n}: {found} against {expected}");
            before = found / expected - 0.03;
        }
    }

    #[test]
    fn power_is_conserved_and_never_negative() {
        let mut random = Random(5);
        for (g, albedo, scale) in
            [(0.9, 1.0, 3.0), (0.999, 0.9, 1e4), (0.5, 1.0, 1e-6), (0.0, 0.5, 2.0), (-0.7, 1.0, 2.0)]
        {
            let widening = Widening { h: 0.5, albedo, g };
            let sigma_t = Field::from_fn([7, 5, 6], |_| scale * random.unit());
            let widened = widening.propagate(&sigma_t, |[x, _], face| face > 0 || x < 4);
            assert!(widened.star.data.iter().all(|value| (0.0..1.5).contains(value)));
            // What goes in is what leaves, at the end and at the sides, and what is scattered or absorbed.
            let k = DeltaScaled::new(albedo, g).k;
            let lost: f64 = sigma_t.data.iter().zip(&widened.mean.data).map(|(s, e)| k * s * 0.5 * e).sum();
            let out: f64 = (0..35).map(|i| widened.star.at([i % 7, i / 7, 6])).sum();
            let total = lost + out + widened.leaked;
            assert!((total / 20.0 - 1.0).abs() < 1e-12, "g {g}: {total}");
            if g <= 0.0 {
                assert_eq!(widened.leaked, 0.0);
                let straight = Widening { h: 0.5, albedo, g }.propagate(&sigma_t, ALL);
                // Two products of one number, and their sum: three roundings a slice.
                let apart = straight.star.data.iter().zip(&straight.straight.data).map(|(a, b)| a / b - 1.0);
                assert!(apart.fold(0.0, |most: f64, x| most.max(x.abs())) < 1e-14);
            }
        }
    }

    #[test]
    fn nothing_passes_a_wall() {
        let widening = Widening { h: 0.5, albedo: 1.0, g: 0.8 };
        let widened = widening.propagate(&Field::filled([5, 5, 6], 1.0), |_, face| face != 3);
        for z in 0..=6 {
            assert_eq!(widened.star.at([2, 2, z]) > 0.0, z < 3, "{z}");
        }
    }
}
