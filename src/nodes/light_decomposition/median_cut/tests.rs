use std::f64::consts::PI;
use std::sync::Arc;

use super::*;
use crate::light::environment::Environment;
use crate::nodes::testing::Random;

/// Of what an environment has beyond its minimum.
fn split(
    environment: &Environment,
    count: usize,
    importance: Option<&Importance>,
) -> (Vec<Ordinate>, [f64; 3]) {
    let Environment::Map(map) = environment else { panic!("a constant is not split") };
    super::split(&Excess::new(map, environment.minimum()), count, importance)
}

fn map(width: usize, height: usize, texel: impl Fn(usize, usize) -> [f32; 3]) -> Environment {
    let texels = (0..width * height).map(|n| texel(n % width, n / width)).collect();
    Environment::Map(Map { width, height, texels: Arc::new(texels), scale: 1.5, rotate_y: 0.4, stack: None })
}

/// Fluence of each channel, and the luminance's irradiance vector towards the light, texel by texel; what
/// comes from everywhere has none, which texels of a quarter of the sky would not say.
fn exact(environment: &Environment) -> ([f64; 3], DVec3) {
    let Environment::Map(map) = environment else { unreachable!() };
    let minimum = luminance(environment.minimum());
    let (mut fluence, mut vector) = ([0.0; 3], DVec3::ZERO);
    for (idx, texel) in map.texels.iter().enumerate() {
        let (x, y) = (idx % map.width, idx / map.width);
        let e = texel.map(|l| f64::from(l) * map.scale * map.solid_angle(y));
        (0..3).for_each(|c| fluence[c] += e[c]);
        let [u, v] = [(x as f64 + 0.5) / map.width as f64, (y as f64 + 0.5) / map.height as f64];
        vector += (luminance(e) - minimum * map.solid_angle(y)) * map.direction(u, v);
    }
    (fluence, vector)
}

/// Fails unless the ordinates and what is left keep the map's light; gives the ordinates.
fn assert_kept(
    what: &str,
    environment: &Environment,
    count: usize,
    importance: Option<&Importance>,
) -> Vec<Ordinate> {
    let (ordinates, rest) = split(environment, count, importance);
    assert!(ordinates.len() <= count, "{what}: {} ordinates of {count}", ordinates.len());
    let (fluence, vector) = exact(environment);
    for c in 0..3 {
        let beams: f64 = ordinates.iter().map(|ordinate| ordinate.irradiance[c]).sum();
        let kept = beams + 4.0 * PI * (environment.minimum()[c] + rest[c]);
        // Sums of up to 3e7 terms in f64, 1e-16 times their number at worst; 1e-4 is asked for.
        assert!((kept - fluence[c]).abs() <= 1e-8 * fluence[c], "{what}, {count}: {kept} of {}", fluence[c]);
    }
    let mut kept = DVec3::ZERO;
    for ordinate in &ordinates {
        let region = ordinate.region.unwrap();
        assert!(ordinate.a0 == 1.0 && ordinate.window.is_none() && region > 0.0 && region <= 1.0);
        assert!((ordinate.direction.length() - 1.0).abs() < 1e-12);
        kept -= luminance(ordinate.irradiance) * region * ordinate.direction;
    }
    assert!((kept - vector).length() <= 1e-8 * luminance(fluence), "{what}, {count}: {kept} of {vector}");
    ordinates
}

fn noisy(width: usize, height: usize) -> Environment {
    let mut random = Random(3);
    let mut noise: Vec<[f32; 3]> =
        (0..width * height).map(|_| [0.0; 3].map(|_: f32| random.unit().powi(4) as f32 + 0.1)).collect();
    // A colored blob, so that there is something to find.
    noise[width * height / 3] = [80.0, 40.0, 5.0];
    map(width, height, |x, y| noise[y * width + x])
}

fn towards(axis: DVec3) -> Importance {
    Importance { axis, g: 0.8, strength: 0.75 }
}

#[test]
fn light_is_kept_for_any_count() {
    for (width, height) in [(1, 1), (1, 5), (4, 2), (7, 3), (128, 64)] {
        let environment = noisy(width, height);
        for count in [1, 2, 3, 7, 16, 32, 1000, 1024] {
            assert_kept("plain", &environment, count, None);
            assert_kept("important", &environment, count, Some(&towards(DVec3::X)));
        }
    }
    // As many as are asked for, where there are as many texels.
    assert_eq!(split(&noisy(128, 64), 1024, None).0.len(), 1024);
    // Every texel but the one that is the minimum of all channels at once, if any.
    assert!(split(&noisy(4, 2), 1024, None).0.len() >= 7);
}

#[test]
fn a_sun_does_not_stop_the_cut() {
    // 1e5 in one texel: 1.8 times the light of all other.
    let sun = (37, 20);
    let environment =
        map(128, 64, |x, y| if (x, y) == sun { [1e5; 3] } else { [0.4 + 0.01 * ((x + y) % 50) as f32; 3] });
    for count in [1, 2, 5, 6, 16, 32] {
        let ordinates = assert_kept("sun", &environment, count, None);
        assert_eq!(ordinates.len(), count);
    }
    let Environment::Map(pixels) = &environment else { unreachable!() };
    let towards_sun = pixels.direction(37.5 / 128.0, 20.5 / 64.0);
    let ordinates = split(&environment, 32, None).0;
    let suns: Vec<_> = ordinates.iter().filter(|ordinate| ordinate.irradiance[0] > 10.0).collect();
    // One texel alone has spread 1.
    assert_eq!(suns.len(), 1);
    assert!((suns[0].direction + towards_sun).length() < 1e-12 && suns[0].region > Some(1.0 - 1e-12));
    let rest = ordinates.iter().filter_map(|ordinate| ordinate.region).fold(1.0, f64::min);
    assert!(rest > 0.7, "the widest region has spread {rest}");
}

#[test]
fn black_takes_no_ordinates() {
    assert_eq!(split(&map(64, 32, |_, _| [0.0; 3]), 32, None), (vec![], [0.0; 3]));
    assert_eq!(split(&map(64, 32, |_, _| [0.7; 3]), 32, None), (vec![], [0.0; 3]));
    let hot = map(64, 32, |x, y| [0.0, if (x, y) == (10, 20) { 1e5 } else { 0.0 }, 0.0]);
    for count in [1, 2, 32] {
        let ordinates = assert_kept("hot", &hot, count, None);
        assert_eq!(ordinates.len(), 1, "count {count}");
    }
    // Two lamps in the dark are two ordinates, and so is a lamp beside one that is 1e14 times as bright.
    for dim in [1.0, 1e-14] {
        let lamps = map(64, 32, |x, y| match (x, y) {
            (10, 20) => [1e5; 3],
            (50, 7) => [1e5 * dim; 3],
            _ => [0.0; 3],
        });
        assert_eq!(assert_kept("lamps", &lamps, 2, None).len(), 2);
    }
}

#[test]
fn light_without_a_direction_joins_the_ambient() {
    let belt = map(64, 32, |_, y| [if (8..24).contains(&y) { 1.0 } else { 0.0 }; 3]);
    assert_eq!(assert_kept("belt", &belt, 1, None), []);
    assert_eq!(assert_kept("belt", &belt, 4, None).len(), 4);
}

#[test]
fn rectangles_weigh_alike_and_gather_where_it_matters() {
    // 16 of an even sky with a black half of noise: the heaviest is within 2.1 of the mean, since the last
    // halvings reach some and not others, and texels are whole.
    let environment =
        map(256, 128, |x, y| [if y < 64 { 1.0 + 0.3 * (x as f32 / 9.0).sin() } else { 0.0 }; 3]);
    let weights = |ordinates: &[Ordinate]| ordinates.iter().map(|o| o.irradiance[1]).collect::<Vec<_>>();
    let plain = weights(&split(&environment, 16, None).0);
    let mean = plain.iter().sum::<f64>() / 16.0;
    assert!(plain.iter().all(|w| *w < 2.1 * mean && *w > 0.45 * mean), "{plain:?}");
    let near = |importance| {
        let ordinates = split(&environment, 16, importance).0;
        ordinates.iter().filter(|ordinate| -ordinate.direction.dot(DVec3::X) > 0.7).count()
    };
    let (without, with) = (near(None), near(Some(&towards(DVec3::X))));
    assert!(without >= 1 && with >= 2 * without, "{without} and {with} rectangles near the axis");
}

#[test]
fn the_largest_maps_work() {
    let environment = map(8192, 4096, |x, y| [1.0, 0.5 + (x % 17) as f32, (y % 5) as f32]);
    let ordinates = assert_kept("large", &environment, 64, Some(&towards(DVec3::Z)));
    assert_eq!(ordinates.len(), 64);
}
