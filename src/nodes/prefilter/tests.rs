use std::f64::consts::PI;
use std::sync::Arc;

use glam::DVec3;
use serde_json::json;

use crate::graph::{PortType, Value};
use crate::light::environment::{Environment, Map, STACK_X, Stack};
use crate::light::{Ordinate, Ordinates, Window};
use crate::nodes::testing::{Filling, Random, Scene, gpu, run};
use crate::optics::phase::hg;

const WINDOW: Window = Window { inner_deg: 60.0, outer_deg: 120.0, share: 0.7 };

fn map(width: usize, height: usize) -> Map {
    let mut random = Random(11);
    let texels =
        (0..width * height).map(|_| [0.0; 3].map(|_: f32| random.unit().powi(3) as f32 + 0.2)).collect();
    Map { width, height, texels: Arc::new(texels), scale: 1.5, rotate_y: 0.7, stack: None }
}

/// The stack's definition, texel by texel: DESIGN 6.5 as it is written.
fn reference(map: &Map, towards: DVec3, g: f64, x: f64) -> [f64; 3] {
    let minimum = Environment::Map(map.clone()).minimum();
    let [inner, outer] = WINDOW.cosines();
    let kernel = |mu: f64| {
        let t = ((mu - outer) / (inner - outer)).clamp(0.0, 1.0);
        if t == 0.0 {
            return 0.0;
        }
        let mut weight = (-x).exp();
        let peaks = (1..100).map(|j| {
            weight *= x / f64::from(j);
            let (f, g) = (g.powi(2 * j), g.powi(j));
            let folded = if f < 1e-10 {
                5.0 * (1.5 * mu * mu - 0.5) / (4.0 * PI)
            } else {
                (hg(mu, g) - (1.0 + 3.0 * g * mu) / (4.0 * PI)) / f
            };
            weight * (folded + (1.0 + 3.0 * mu) / (4.0 * PI))
        });
        WINDOW.share * t * t * (3.0 - 2.0 * t) * peaks.sum::<f64>()
    };
    let mut sum = [0.0; 3];
    for (idx, texel) in map.texels.iter().enumerate() {
        let (row, column) = (idx / map.width, idx % map.width);
        let from =
            map.direction((column as f64 + 0.5) / map.width as f64, (row as f64 + 0.5) / map.height as f64);
        let weight = kernel(towards.dot(from)) * map.solid_angle(row);
        (0..3).for_each(|c| sum[c] += weight * (f64::from(texel[c]) * map.scale - minimum[c]));
    }
    sum
}

fn stack_of(map: &Map, g: f64) -> Stack {
    super::stack(map, Environment::Map(map.clone()).minimum(), g, WINDOW)
}

#[test]
fn levels_are_sums_over_texels() {
    // No more rows than four for each of the stack's: texels are points, as in the sum.
    let mut sky = map(256, 128);
    let mut texels = sky.texels.to_vec();
    // As bright as may be, short of a sun: a fiftieth of all light.
    texels[50 * 256 + 18] = [200.0, 150.0, 50.0];
    sky.texels = Arc::new(texels);
    for (g, rows) in [(0.4, 64), (0.85, 128)] {
        let stack = stack_of(&sky, g);
        assert_eq!((stack.width, stack.height, stack.texels.len()), (2 * rows, rows, 16 * 2 * rows * rows));
        assert!(stack.texels[..2 * rows * rows].iter().all(|texel| *texel == [0.0; 3]), "x = 0");
        // As bright as it gets: next to that texel.
        let peak = |level: usize| {
            let level = &stack.texels[level * 2 * rows * rows..][..2 * rows * rows];
            f64::from(level.iter().map(|texel| texel[0]).fold(0.0, f32::max))
        };
        for (level, x) in [(1, STACK_X[1]), (4, 1.0), (7, 3.0), (15, 48.0)] {
            for (column, row) in [(18, 50), (0, 0), (22, 54), (30, 60)] {
                let (column, row) = (column * rows / 128, row * rows / 128);
                let [u, v] = [(column as f64 + 0.5) / (2 * rows) as f64, (row as f64 + 0.5) / rows as f64];
                let expected = reference(&sky, sky.direction(u, v), g, x);
                let found = stack.texels[(level * rows + row) * 2 * rows + column];
                for (found, expected) in found.into_iter().zip(expected) {
                    // Degrees end at e^-10 of the peak, some e^-10 · 10 of it at the spot, and the grid's
                    // texels are the map's or twice as wide.
                    let tolerance = 2e-3 * expected.abs() + 5e-4 * peak(level) + 1e-4;
                    assert!(
                        (f64::from(found) - expected).abs() < tolerance,
                        "g {g} x {x} ({column}, {row}): {found} against {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn bright_spots_do_not_ring() {
    // A texel of 1e4, a fortieth of the light of a sky of 1, which is ambient: nothing is darker for it by more than
    // the kernel takes itself.
    for g in [0.3, 0.9, 0.99, 0.999] {
        let mut sky = map(1024, 512);
        let mut texels = vec![[1.0; 3]; 1024 * 512];
        texels[200 * 1024 + 700] = [1e4; 3];
        sky.texels = Arc::new(texels);
        let fluence = 1.5e4 * sky.solid_angle(200);
        let stack = stack_of(&sky, g);
        let least = stack.texels.iter().map(|texel| f64::from(texel[0])).fold(0.0, f64::min);
        let most = stack.texels.iter().map(|texel| f64::from(texel[0])).fold(0.0, f64::max);
        // Of many scatterings it is w (1 + 3mu + 5P₂)/4π, which is -0.061 w(0) at 87 degrees.
        assert!(
            least > -0.063 * WINDOW.share * fluence && most > 0.05 * fluence,
            "g {g}: {least} to {most} of {fluence}"
        );
        // Beyond the window there is nothing but what rings.
        let towards = sky.direction(700.5 / 1024.0, 200.5 / 512.0);
        let n = stack.height;
        let far = stack.texels.iter().enumerate().filter(|(idx, _)| {
            let (u, v) = ((idx % (2 * n)) as f64 + 0.5, (idx / (2 * n) % n) as f64 + 0.5);
            let angle = sky.direction(u / (2 * n) as f64, v / n as f64).dot(towards).acos();
            angle.to_degrees() > 122.0
        });
        let worst = far.map(|(_, texel)| f64::from(texel[0].abs())).fold(0.0, f64::max);
        assert!(worst < 2e-3 * fluence, "g {g}: {worst} of {fluence}");
    }
}

/// So many regions, of which one is lit, and a sun.
fn ordinates(n_regions: usize) -> Ordinates {
    let ordinate =
        Ordinate { direction: DVec3::X, irradiance: [1.0; 3], a0: 1.0, region: Some(0.6), window: None };
    let sun = Ordinate { a0: 0.9, region: None, ..ordinate };
    Ordinates { ordinates: vec![ordinate, sun], ambient: [0.1; 3], n_regions }
}

#[test]
fn the_stack_takes_more_the_farther_ordinates_are_apart() {
    let same = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    // Where both err alike each takes half; ordinates three times as far apart leave a tenth.
    let alike = |n: usize| 1.0 - super::EVEN * (4.0 * PI / n as f64).sqrt();
    same(super::share(36, alike(36)), 0.5);
    same(super::share(4, alike(36)), 0.9);
    same(super::share(324, alike(36)), 0.1);
}

#[test]
fn regions_get_their_spread_and_window() {
    let Some(gpu) = gpu() else { return };
    let sky = Value::new(PortType::Environment, 0, Environment::Map(map(16, 8)));
    let constant = Value::new(PortType::Environment, 0, Environment::Constant([1.0; 3]));
    let [few, many] = [8, 128];
    let window = |g: f64| Some(Window { share: super::share(few, g), ..WINDOW });
    for (environment, g, n_regions, window) in [
        (&sky, 0.8, few, window(0.8)),
        (&sky, 0.3, few, window(0.3)),
        // A scattering blurs more than ordinates are apart.
        (&sky, 0.3, many, None),
        (&sky, 0.0, few, None),
        (&sky, -0.5, few, None),
        (&constant, 0.8, few, None),
    ] {
        let light = Value::new(PortType::Ordinates, 0, ordinates(n_regions));
        let medium = Scene { g, ..Scene::new([4, 4, 4], Filling::Homogeneous, 1.0) }.medium(gpu);
        let inputs = [("environment", environment), ("ordinates", &light), ("medium", &medium)];
        let found = run(gpu, "prefilter", json!({}), &inputs).unwrap();
        let mut expected = ordinates(n_regions);
        expected.ordinates[0] = Ordinate { a0: 0.6, window, ..expected.ordinates[0] };
        assert_eq!(*found[0].get::<Ordinates>(), expected);
        match found[1].get::<Environment>() {
            Environment::Map(map) if window.is_some() => {
                let stack = map.stack.as_ref().unwrap();
                assert_eq!(stack.texels.len(), STACK_X.len() * stack.width * stack.height);
                assert!(stack.texels.iter().flatten().all(|l| l.is_finite()));
            }
            _ => assert!(found[1].shares_data_with(environment)),
        }
        let inverted = run(gpu, "prefilter", json!({ "window_deg": [70, 30] }), &inputs).unwrap_err();
        assert!(inverted.to_string().contains("the smaller one"), "{inverted}");
    }
}

#[test]
fn a_sun_is_not_in_the_stack() {
    let lit = |radiance: f32| {
        let mut texels = vec![[1.0; 3]; 64 * 32];
        texels[9 * 64 + 20] = [radiance; 3];
        Map { width: 64, height: 32, texels: Arc::new(texels), scale: 1.0, rotate_y: 0.0, stack: None }
    };
    let bright = |radiance: f32| {
        let stack = stack_of(&lit(radiance), 0.85);
        stack.texels.iter().map(|texel| f64::from(texel[0].abs())).fold(0.0, f64::max)
    };
    // All else is ambient.
    assert_eq!(bright(1e5), 0.0);
    assert!(bright(50.0) > 0.1);
}
