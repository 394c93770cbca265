use std::sync::Arc;

use super::*;

fn image(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [f32; 3]) -> Image {
    let pixels = (0..width * height).flat_map(|p| pixel(p % width, p / width));
    Image::new(width, height, pixels.collect())
}

// Sums of a few small binary fractions in f64: exact to some 1e-16, 1e-12 is generous.
fn near(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-12 * (1.0 + b.abs()), "{a} is not {b}");
}

// R: four pixels, (1,2,4) each. X: the first two are (2,2,4), the third (0,2,4).
// Σ|X−R| = 3, ΣR = 28, ΣX = 29. One partial block of 2x2: means X (1.25,2,4): 0.25/7.
// mean(R) = 7/3; rel_mse = 3/(1 + 0.01·49/9)/12.
#[test]
fn hand_computed() {
    let reference = image(2, 2, |_, _| [1.0, 2.0, 4.0]);
    let picture = image(2, 2, |x, y| [[2.0, 2.0, 0.0, 1.0][y * 2 + x], 2.0, 4.0]);
    let m = compare(&picture, &reference, None).unwrap();
    near(m.mean_relative, 3.0 / 28.0);
    near(m.block_relative, 0.25 / 7.0);
    near(m.rel_mse, 3.0 / (1.0 + 0.01 * 49.0 / 9.0) / 12.0);
    near(m.bias, 29.0 / 28.0 - 1.0);
    assert_eq!(m.non_finite, 0);
    near(m.per_channel[0].mean_relative, 0.75);
    near(m.per_channel[0].block_relative, 0.25);
    near(m.per_channel[0].bias, 0.25);
    assert_eq!(m.per_channel[1].mean_relative, 0.0);
    assert!(m.flip > 0.0 && m.ssim < 1.0);
}

// 5x4: a full block of 16 pixels at 1, a partial block of 4 at 2 (X: 3). Weighted by pixels:
// 4·1/(16·1 + 4·2) = 1/6 for each channel.
#[test]
fn partial_blocks_weigh_their_pixels() {
    let reference = image(5, 4, |x, _| [if x < 4 { 1.0 } else { 2.0 }; 3]);
    let picture = image(5, 4, |x, _| [if x < 4 { 1.0 } else { 3.0 }; 3]);
    let m = compare(&picture, &reference, None).unwrap();
    near(m.block_relative, 1.0 / 6.0);
    near(m.mean_relative, 1.0 / 6.0);
}

// The right half of an 8x4 picture is wrong by 10 %; its mask says 0.02, the left's 0.009.
#[test]
fn the_mask_selects_blocks_for_block_relative_alone() {
    let reference = image(8, 4, |_, _| [1.0; 3]);
    let picture = image(8, 4, |x, _| [if x < 4 { 1.0 } else { 1.5 }; 3]);
    let mask = image(8, 4, |x, _| [if x < 4 { 0.009 } else { 0.02 }; 3]);
    let m = compare(&picture, &reference, Some(&mask)).unwrap();
    near(m.block_relative, 0.5);
    near(m.mean_relative, 0.25);
    let nothing = image(8, 4, |_, _| [0.0; 3]);
    let error = compare(&picture, &reference, Some(&nothing)).unwrap_err();
    assert_eq!(error, CompareError::EmptyMask);
}

#[test]
fn every_metric_sees_one_percent() {
    let ramp = |x: usize, y: usize| 0.05 + (x * y % 13) as f32 * 0.1;
    let reference = image(32, 24, |x, y| [ramp(x, y), 0.5, ramp(y, x)]);
    let picture = image(32, 24, |x, y| [ramp(x, y), 0.5, ramp(y, x)].map(|v| v * 1.01));
    let m = compare(&picture, &reference, None).unwrap();
    // The pictures are f32: a value off by 6e-8 moves 1 % by 6e-6 of it.
    for value in [m.mean_relative, m.block_relative, m.bias, m.per_channel[2].bias] {
        assert!((value - 0.01).abs() < 1e-6, "{value}");
    }
    // At most 1e-4, where R² is far above the floor.
    assert!(m.rel_mse > 5e-5 && m.rel_mse < 1e-4, "{}", m.rel_mse);
    // No closed form: far above what equal pictures give, see below.
    assert!(m.flip > 1e-3 && m.ssim < 1.0 - 1e-6, "{} {}", m.flip, m.ssim);
    let same = compare(&reference, &reference, None).unwrap();
    assert_eq!([same.mean_relative, same.rel_mse, same.bias, same.flip], [0.0; 4]);
    assert!((same.ssim - 1.0).abs() < 1e-12);
}

#[test]
fn non_finite_pixels_are_counted_and_left_out() {
    let mut reference = image(8, 8, |_, _| [1.0; 3]);
    let mut picture = image(8, 8, |_, _| [1.1; 3]);
    let clean = compare(&picture, &reference, None).unwrap();
    Arc::make_mut(&mut picture.layers["beauty"]).data[5] = f32::NAN;
    Arc::make_mut(&mut picture.layers["beauty"]).data[100] = f32::INFINITY;
    Arc::make_mut(&mut reference.layers["beauty"]).data[7] = f32::NEG_INFINITY;
    let m = compare(&picture, &reference, None).unwrap();
    assert_eq!(m.non_finite, 3);
    near(m.mean_relative, clean.mean_relative);
    near(m.block_relative, clean.block_relative);
    near(m.rel_mse, clean.rel_mse);
    assert!(m.flip.is_finite() && m.ssim.is_finite());
    let map = error_map(&picture, &reference).unwrap();
    assert_eq!(map.pixels()[1], [0.0, 1.0, 0.0]);
    let nan = image(8, 8, |_, _| [f32::NAN; 3]);
    let error = compare(&nan, &reference, None).unwrap_err();
    assert_eq!(error, CompareError::NothingFinite);
}

#[test]
fn zero_references_stay_finite_in_json() {
    let black = image(4, 4, |_, _| [0.0; 3]);
    let m = compare(&black, &black, None).unwrap();
    assert_eq!([m.mean_relative, m.block_relative, m.rel_mse, m.bias], [0.0; 4]);
    let huge = image(4, 4, |_, _| [f32::MAX; 3]);
    for picture in [image(4, 4, |_, _| [1.0; 3]), huge] {
        let m = compare(&picture, &black, None).unwrap();
        assert_eq!([m.mean_relative, m.block_relative, m.bias], [f64::MAX; 3]);
        let json = serde_json::to_string(&m).unwrap();
        assert!(!json.contains("null"), "{json}");
        let back: serde_json::Value = serde_json::from_str(&json).unwrap();
        let fields: Vec<&str> = back.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(fields.len(), 8);
        let names = [
            "mean_relative",
            "block_relative",
            "rel_mse",
            "bias",
            "flip",
            "ssim",
            "non_finite",
            "per_channel",
        ];
        assert!(names.iter().all(|name| fields.contains(name)), "{fields:?}");
    }
}

#[test]
fn unequal_sizes_are_refused_with_both_sizes() {
    let (a, b) = (image(3, 2, |_, _| [1.0; 3]), image(2, 3, |_, _| [1.0; 3]));
    let errors = [
        compare(&a, &b, None).unwrap_err(),
        error_map(&a, &b).unwrap_err(),
        compare(&b, &b, Some(&a)).unwrap_err(),
    ];
    for error in errors {
        let text = error.to_string();
        assert!(text.contains("3x2") && text.contains("2x3"), "{text}");
    }
}

// Against the table of inferno (matplotlib) at 0, 1/2 and 1; the polynomial is within 2 %.
#[test]
fn the_error_map_runs_from_black_to_yellow() {
    let table = [(0.0, [0.001, 0.000, 0.014]), (0.5, [0.735, 0.216, 0.330]), (1.0, [0.988, 0.998, 0.645])];
    for (t, expected) in table {
        let color = inferno(t);
        let far = (0..3).map(|c| (color[c] - expected[c]).abs()).fold(0.0, f64::max);
        assert!(far < 0.02, "{t} {color:?}");
    }
    let reference = image(4, 1, |_, _| [1.0; 3]);
    let picture = image(4, 1, |x, _| [[1.0, 1.001, 1.05, 3.0][x]; 3]);
    let map = error_map(&picture, &reference).unwrap();
    let green: Vec<f32> = map.pixels().iter().map(|p| p[1]).collect();
    assert!(green[0] <= green[1] && green[1] < green[2] && green[2] < green[3], "{green:?}");
    // The end of the scale, decoded: the polynomial's green is 1 within 2 %, times 2.3.
    assert!(green[3] > 0.95);
}

// 4x4 pixels of variance 0.16 and mean 2: 0.8 · √(0.16/16) / 2 = 0.04.
#[test]
fn noise_by_hand() {
    let reference = image(4, 4, |_, _| [2.0; 3]);
    let variance = image(4, 4, |_, _| [0.16; 3]);
    // 0.16 in f32 is off by 4e-8 of it, its root by half of that.
    let noise = block_noise(&reference, &variance, None).unwrap();
    assert!((noise - 0.04).abs() < 1e-8, "{noise}");
}

// The table gives two digits behind the point in percent: half of the last one, and rounding.
// It is over the masked blocks for every scene, the one with a mesh too (over all of its blocks
// the noise is 0.325 %, not the stated 0.55 %).
#[test]
fn noise_of_the_reference_pictures() {
    let Some(folder) = crate::shared_dir().map(|d| d.join("truth")) else {
        eprintln!("skipped: no shared files");
        return;
    };
    let text = std::fs::read_to_string(folder.join("README.md")).unwrap();
    let mut n_scenes = 0;
    for line in text.lines().filter(|l| l.starts_with("| s")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let (name, stated) = (cells[1], cells[6].trim_end_matches(" %"));
        if name == "scene" {
            continue;
        }
        let read = |end: &str| super::super::exr::read(&folder.join(format!("{name}{end}.exr"))).unwrap();
        let (truth, variance, tau) = (read(""), read("_var"), read("_tau"));
        let noise = 100.0 * block_noise(&truth, &variance, Some(&tau)).unwrap();
        let stated: f64 = stated.parse().unwrap();
        assert!((noise - stated).abs() < 0.0051, "{name}: {noise} % is not {stated} %");
        n_scenes += 1;
    }
    assert!(n_scenes > 0);
}
