use glam::DVec3;

use super::*;
use crate::optics::phase::hg;

/// Unit vector to (u, v); the space is the map's own.
fn direction(u: f64, v: f64) -> DVec3 {
    let (latitude, longitude) = (PI * (0.5 - v), 2.0 * PI * u);
    DVec3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin())
}

fn center(column: usize, row: usize, width: usize, height: usize) -> DVec3 {
    direction((column as f64 + 0.5) / width as f64, (row as f64 + 0.5) / height as f64)
}

/// Levels that fold with HG of these mean cosines.
fn folds(n: usize, g: [f64; N_LEVELS]) -> Vec<[f64; N_LEVELS]> {
    (0..n).map(|l| g.map(|g| g.powi(l as i32))).collect()
}

/// Calls with level, direction and value of each texel.
fn each(stack: &[[f32; 3]], n: usize, mut with: impl FnMut(usize, DVec3, [f32; 3])) {
    assert_eq!(stack.len(), N_LEVELS * 2 * n * n);
    for (idx, texel) in stack.iter().enumerate() {
        with(idx / (2 * n * n), center(idx % (2 * n), idx / (2 * n) % n, 2 * n, n), *texel);
    }
}

#[test]
fn a_texel_gives_the_kernel() {
    // On the grid's own size a texel is a point: 64 degrees, 256 x 256 texels. HG(0.7)^64 is 1e-10.
    let (n, size) = (64, 256);
    let g = std::array::from_fn(|level| 0.7 * level as f64 / 15.0);
    let at = [(17, 100), (200, 0)];
    let power = |row: usize| {
        let edge = |row: usize| (PI * (0.5 - row as f64 / size as f64)).sin();
        2.0 * PI / size as f64 * (edge(row) - edge(row + 1))
    };
    // A lamp in red, another at the pole in blue, both in green.
    let lit = |row: usize, column: usize| {
        let [first, second] = at.map(|place| f64::from(place == (column, row)) / power(row));
        [first, first + second, second]
    };
    let stack = convolve(&Picture { width: size, height: size, texels: &lit }, &folds(n, g));
    each(&stack, n, |level, towards, found| {
        let [first, second] =
            at.map(|(column, row)| hg(towards.dot(center(column, row, size, size)), g[level]));
        for (found, expected) in found.into_iter().zip([first, first + second, second]) {
            // f32, and what of HG(0.7) is beyond degree 63: 2 · 64/4π · 1e-10/0.3.
            let tolerance = 2e-7 * expected + 1e-8;
            assert!(
                (f64::from(found) - expected).abs() < tolerance,
                "level {level} {towards}: {found} {expected}"
            );
        }
    });
}

#[test]
fn lobes_fold_to_lobes() {
    // HG(0.6) sampled on maps of any size, folded with HG(g): HG(0.6 g).
    let n = 64;
    let g = std::array::from_fn(|level| level as f64 / 20.0);
    let axis = DVec3::new(0.6, 0.48, -0.64);
    for (width, height) in [(512, 256), (300, 150), (2000, 1000), (129, 65)] {
        let lobe =
            |row: usize, column: usize| [hg(center(column, row, width, height).dot(axis), 0.6), 0.0, 1.0];
        let stack = convolve(&Picture { width, height, texels: &lobe }, &folds(n, g));
        // Cells of the grid have the lobe's value at their center for all of their area: dθ²/24 times its curvature,
        // up to 3/(1-g)² of the value, and as much again for cells that take parts of two texels.
        let cell = PI / height.min(4 * n) as f64;
        let tolerance = 2.0 * cell * cell / 24.0 * 3.0 / 0.16 * hg(1.0, 0.6);
        each(&stack, n, |level, towards, [found, black, one]| {
            let expected = hg(towards.dot(axis), 0.6 * g[level]);
            assert!(
                (f64::from(found) - expected).abs() < tolerance + 1e-6,
                "{width} x {height} level {level} {towards}: {found} against {expected}"
            );
            // Red and green share a transform: 1e-16 of each goes over.
            assert!(black.abs() < 1e-14);
            // The grid's rows are light along circles; it shows at the poles.
            assert!(
                f64::from((one - 1.0).abs()) < 2.0 * cell * cell,
                "{width} x {height} level {level}: {one}"
            );
        });
    }
}

#[test]
fn the_smallest_maps_are_spread_evenly() {
    // Two texels, one of them lit: half of the sphere, whose mean is that of its first degree's factor.
    let half = |_: usize, column: usize| if column == 0 { [1.0; 3] } else { [0.0; 3] };
    let stack = convolve(&Picture { width: 2, height: 1, texels: &half }, &folds(64, [0.0; N_LEVELS]));
    each(&stack, 64, |_, _, [found, ..]| assert!((found - 0.5).abs() < 1e-6, "{found}"));
    for (n_from, n) in [(1, 4), (3, 8), (8, 3), (1000, 1024), (7, 7)] {
        let parts = overlaps(n_from, n);
        let lengths: f64 = parts.iter().flatten().map(|(_, low, high)| high - low).sum();
        assert!((lengths - 1.0).abs() < 1e-12 && parts.iter().flatten().all(|(_, low, high)| low < high));
        assert!(parts.iter().flatten().all(|(from, low, high)| {
            let place = 0.5 * (low + high) * n_from as f64;
            *from as f64 <= place && place <= (*from + 1) as f64
        }));
    }
}
