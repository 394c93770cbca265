//! ꟻLIP: what an eye sees when it flips between two pictures.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: A Difference
//! Evaluator for Alternating Images", Proc. ACM CGIT 3(2), 2020 (LDR-FLIP). Color: filter by
//! the eye's contrast sensitivity in YCxCz, HyAB distance in Hunt-adjusted L*a*b*, power 0.7,
//! remapped to 0..=1. Features: edges and points of Y by derivatives of a Gaussian. Together:
//! color^(1 − features). Filters are separated as in the authors' program: the two Gaussians
//! of Cz have square roots of their weights per axis and are added at the end.
//!
//! The observer sees 67.02 pixels a degree: 0.7 m from a screen 0.7 m and 3840 pixels wide,
//! the authors' default. In and out: linear display RGB in 0..=1; values 0..=1 a pixel.
//!
//! Ours: the crates that exist (`nv-flip`) bind C++. Tested against values that the authors'
//! program (flip-evaluator 1.7) gives for flat pictures and for a pattern.

use rayon::prelude::*;

const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;
const COLOR_POWER: f64 = 0.7;
const KNEE_IN: f64 = 0.4;
const KNEE_OUT: f64 = 0.95;
const FEATURE_WIDTH_DEG: f64 = 0.082;
const FEATURE_POWER: f64 = 0.5;

/// Amplitude, and width in deg², of the Gaussians of the contrast sensitivity: Y, Cx, and two of Cz.
const SENSITIVITY: [[f64; 2]; 4] = [[1.0, 0.0047], [1.0, 0.0053], [34.1, 0.04], [13.5, 0.025]];

/// Rows of linear Rec. 709 to XYZ, D65, with the authors' digits.
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0],
    [2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0],
    [1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0],
];
/// Rows of XYZ to linear Rec. 709.
const RGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.241003275, -1.537398934, -0.498615861],
    [-0.969224334, 1.875930071, 0.041554224],
    [0.055639423, -0.204011202, 1.057148933],
];
const WHITE: [f64; 3] = [0.950428545, 1.0, 1.088900371];

/// ꟻLIP of each pixel, in 0..=1, row by row; 0 where the eye sees no difference.
///
/// # Panics
/// If a length does not fit the size.
pub fn flip(width: usize, height: usize, a: &[[f64; 3]], b: &[[f64; 3]]) -> Vec<f64> {
    assert_eq!([a.len(), b.len()], [width * height; 2]);
    let view = |rgb: &[[f64; 3]]| {
        let ycxcz: Vec<[f64; 3]> = rgb.par_iter().map(|p| ycxcz_from_rgb(*p)).collect();
        (perceived(width, height, &ycxcz), features(width, height, &ycxcz))
    };
    let ((color_a, feature_a), (color_b, feature_b)) = (view(a), view(b));
    let largest = largest_difference();
    (0..width * height)
        .into_par_iter()
        .map(|p| {
            let color = remap(hyab(color_a[p], color_b[p]).powf(COLOR_POWER), largest);
            let [edge, point] = [0, 1].map(|i| (feature_a[p][i] - feature_b[p][i]).abs());
            let feature = (edge.max(point) / 2f64.sqrt()).powf(FEATURE_POWER);
            color.powf(1.0 - feature)
        })
        .collect()
}

/// Differences up to the knee take most of the range, the rest is squeezed above it.
fn remap(difference: f64, largest: f64) -> f64 {
    let knee = KNEE_IN * largest;
    if difference < knee {
        difference * KNEE_OUT / knee
    } else {
        KNEE_OUT + (difference - knee) / (largest - knee) * (1.0 - KNEE_OUT)
    }
}

/// Between the farthest colors, pure green and pure blue.
fn largest_difference() -> f64 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(hunt_lab_from_rgb);
    hyab(green, blue).powf(COLOR_POWER)
}

fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Colors as the eye resolves them, in Hunt-adjusted L*a*b*.
fn perceived(width: usize, height: usize, ycxcz: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let pi = std::f64::consts::PI;
    let widest = SENSITIVITY.iter().fold(0.0, |w: f64, [_, b]| w.max(*b));
    let radius = (3.0 * (widest / (2.0 * pi * pi)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let kernel = |i: usize| {
        let x = (i as f64 - radius as f64) / PIXELS_PER_DEGREE;
        let falls = SENSITIVITY.map(|[_, b]| (-pi * pi * x * x / b).exp());
        // Both Gaussians of Cz pass twice, once an axis, so that each gets its root.
        let [_, _, z1, z2] = SENSITIVITY.map(|[a, b]| (a * (pi / b).sqrt()).sqrt());
        [falls[0], falls[1], z1 * falls[2], z2 * falls[3]]
    };
    let mut weights: Vec<[f64; 4]> = (0..=2 * radius).map(kernel).collect();
    let sum = |c: usize| weights.iter().map(|w| w[c]).sum::<f64>();
    let z = sum(2).hypot(sum(3));
    let norms = [sum(0), sum(1), z, z];
    for weight in &mut weights {
        for (w, norm) in weight.iter_mut().zip(norms) {
            *w /= norm;
        }
    }
    let split: Vec<[f64; 4]> = ycxcz.iter().map(|[y, x, z]| [*y, *x, *z, *z]).collect();
    let rows = convolve(width, height, &split, Axis::X, &weights);
    let both = convolve(width, height, &rows, Axis::Y, &weights);
    both.par_iter()
        .map(|[y, x, z1, z2]| {
            let rgb = rgb_from_ycxcz([*y, *x, z1 + z2]);
            hunt_lab_from_rgb(rgb.map(|v| v.clamp(0.0, 1.0)))
        })
        .collect()
}

/// Strength of edges and of points in Y, a pixel.
fn features(width: usize, height: usize, ycxcz: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let sigma = 0.5 * FEATURE_WIDTH_DEG * PIXELS_PER_DEGREE;
    let radius = (3.0 * sigma).ceil() as usize;
    let kernel = |i: usize| {
        let x = i as f64 - radius as f64;
        let g = (-x * x / (2.0 * sigma * sigma)).exp();
        [g, -x * g, (x * x / (sigma * sigma) - 1.0) * g]
    };
    let mut weights: Vec<[f64; 3]> = (0..=2 * radius).map(kernel).collect();
    // The positive and the negative weights of each filter sum to 1 and −1.
    let sums = [0, 1, 2].map(|c| {
        let part = |sign: f64| weights.iter().map(|w| (sign * w[c]).max(0.0)).sum::<f64>();
        [part(1.0), part(-1.0)]
    });
    for weight in &mut weights {
        for (w, [positive, negative]) in weight.iter_mut().zip(sums) {
            *w /= if *w > 0.0 { positive } else { negative };
        }
    }
    let pick = |c: [usize; 4]| -> Vec<[f64; 4]> { weights.iter().map(|w| c.map(|c| w[c])).collect() };
    let grey: Vec<[f64; 4]> = ycxcz.iter().map(|p| [(p[0] + 16.0) / 116.0; 4]).collect();
    // First and second derivative along x, then along y; smoothed along the other axis.
    let rows = convolve(width, height, &grey, Axis::X, &pick([1, 2, 0, 0]));
    let both = convolve(width, height, &rows, Axis::Y, &pick([0, 0, 1, 2]));
    let strength = |d: &[f64; 4]| [d[0].hypot(d[2]), d[1].hypot(d[3])];
    both.par_iter().map(strength).collect()
}

#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
}

/// Each of four planes with its own weights along one axis; the border repeats its pixel.
fn convolve(
    width: usize,
    height: usize,
    values: &[[f64; 4]],
    axis: Axis,
    weights: &[[f64; 4]],
) -> Vec<[f64; 4]> {
    let radius = weights.len() / 2;
    let tap = |at: usize, i: usize, size: usize| (at + i).saturating_sub(radius).min(size - 1);
    (0..width * height)
        .into_par_iter()
        .map(|p| {
            let (x, y) = (p % width, p / width);
            let mut sum = [0.0; 4];
            for (i, weight) in weights.iter().enumerate() {
                let value = match axis {
                    Axis::X => values[y * width + tap(x, i, width)],
                    Axis::Y => values[tap(y, i, height) * width + x],
                };
                for c in 0..4 {
                    sum[c] += weight[c] * value[c];
                }
            }
            sum
        })
        .collect()
}

fn multiply(rows: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// X, Y and Z relative to white.
fn xyz_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = multiply(&XYZ_FROM_RGB, rgb);
    [0, 1, 2].map(|c| xyz[c] / WHITE[c])
}

fn opponent([x, y, z]: [f64; 3]) -> [f64; 3] {
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn ycxcz_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    opponent(xyz_from_rgb(rgb))
}

fn rgb_from_ycxcz([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let xyz = [y + cx / 500.0, y, y - cz / 200.0];
    multiply(&RGB_FROM_XYZ, [0, 1, 2].map(|c| xyz[c] * WHITE[c]))
}

/// L*a*b* with a* and b* scaled by lightness: dark colors look less colorful (Hunt).
fn hunt_lab_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |v: f64| {
        if v > DELTA * DELTA * DELTA { v.cbrt() } else { v / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [l, a, b] = opponent(xyz_from_rgb(rgb).map(root));
    [l, 0.01 * l * a, 0.01 * l * b]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub const WIDTH: usize = 40;
    pub const HEIGHT: usize = 30;

    /// Two pictures that the published programs were run on.
    pub fn pattern() -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let pixel = |p: usize| {
            let (x, y) = (p % WIDTH, p / WIDTH);
            [0, 1, 2].map(|c| {
                let a = ((x * 7 + y * 13 + c * 29 + (x * y) % 17 * 5) % 256) as f64 / 255.0;
                let shift = ((x * 3 + y * 5 + c) % 11) as f64 / 110.0;
                (a, (a * 0.9 + shift).clamp(0.0, 1.0))
            })
        };
        let pixels = (0..WIDTH * HEIGHT).map(pixel);
        pixels.map(|p| (p.map(|v| v.0), p.map(|v| v.1))).unzip()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    // The authors' program works in f32. Its derivative filters leave some 1e-7 on flat pictures,
    // whose root is 3e-4, times color·ln(1/color) of at most 0.37: 1e-4 (2.4e-5 was seen).
    #[test]
    fn agrees_with_the_authors_program_on_flat_pictures() {
        let cases = [
            ([0.0; 3], [1.0; 3], 0.967_386_186),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1.0),
            ([0.5; 3], [0.51; 3], 0.040_721_897),
            ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.986_663_997),
        ];
        for (a, b, expected) in cases {
            let value = mean(&flip(20, 20, &vec![a; 400], &vec![b; 400]));
            assert!((value - expected).abs() < 1e-4, "{a:?} {b:?} {value}");
        }
    }

    // Where there are features, f32 moves them by 1e-7 of their size only: 2e-5 is four digits.
    #[test]
    fn agrees_with_the_authors_program_on_a_pattern() {
        let (a, b) = pattern();
        let map = flip(WIDTH, HEIGHT, &a, &b);
        let near = |v: f64, expected: f64| assert!((v - expected).abs() < 2e-5, "{v} {expected}");
        near(mean(&map), 0.122_075_155);
        near(map[0], 0.150_839_16);
        near(map[15 * WIDTH + 20], 0.104_049_48);
        near(map[WIDTH * HEIGHT - 1], 0.131_305_98);
    }

    #[test]
    fn equal_pictures_are_0_and_single_pixels_work() {
        let (a, _) = pattern();
        assert!(flip(WIDTH, HEIGHT, &a, &a).iter().all(|v| *v == 0.0));
        let one = flip(1, 1, &[[0.0; 3]], &[[1.0; 3]]);
        assert!((one[0] - 0.967_386).abs() < 1e-5, "{one:?}");
    }
}
