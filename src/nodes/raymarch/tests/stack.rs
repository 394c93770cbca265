use std::sync::Arc;

use super::*;
use crate::light::environment::{Environment, Map, STACK_X, Stack};
use crate::nodes::oracle_scene::constant_light;
use crate::nodes::oracle_scene::corners::tau_along;
use crate::nodes::raymarch::oracle::bend::{bend, turns_at};
use crate::wire::Medium;

#[test]
fn the_stack_shines_through_by_its_level() {
    // A stack that is 1 + x everywhere is e^{x − T} (1 + x) of a ray of optical depth T, x = albedo f T, in
    // each channel: linear between levels, so interpolation is exact. It is the same from everywhere: however the
    // ways bend, nothing changes. Where there is no medium nothing shines through it.
    let Some(gpu) = gpu() else { return };
    let albedo = [1.0, 0.5, 0.9];
    let scene = scene(0.85, albedo);
    let medium = scene.medium(gpu);
    let texels = STACK_X.iter().flat_map(|x| vec![[1.0 + *x as f32; 3]; 8]).collect();
    let turns = [[0.1, 0.4, 0.9]; STACK_X.len()];
    let stack = Some(Arc::new(Stack { width: 4, height: 2, texels, turns }));
    let dark = Arc::new(vec![[0.0; 3]; 8]);
    let map = Map { width: 4, height: 2, texels: dark, scale: 1.0, rotate_y: 0.3, stack };
    let map = Value::new(PortType::Environment, 0, Environment::Map(map));
    let camera = camera(&scene, DVec3::new(-14.0, 9.0, -11.0));
    let image = march(gpu, &[("medium", &medium), ("environment", &map)], camera);
    let tau: Vec<f64> = channel(&image, ALPHA, 0).iter().map(|alpha| -(1.0 - alpha).ln()).collect();
    assert!(largest(&tau) > 1.0, "{tau:?}");
    for (c, albedo) in albedo.into_iter().enumerate() {
        let x = |tau: f64| albedo * 0.85 * 0.85 * tau;
        let shines = |tau: &f64| if *tau > 0.0 { (x(*tau) - tau).exp() * (1.0 + x(*tau)) } else { 0.0 };
        let expected: Vec<f64> = tau.iter().map(shines).collect();
        // tau by way of an alpha of 24 bits; the level by sixteen clamped sums, of which an ulp is 1e-6.
        assert_close("forward", &channel(&image, "forward", c), &expected, filtered(gpu, 2e-5), 0.0);
        assert_close("beauty", &channel(&image, BEAUTY, c), &expected, filtered(gpu, 2e-5), 0.0);
    }
}

const G: f64 = 0.85;
const ALBEDO: [f64; 3] = [1.0, 0.5, 0.9];
/// The optical depth of a ray that meets nothing but a 512th of some cells.
const GRAZING: f64 = 0.02;

/// What the stack of [`sky`] holds towards a direction of the world.
fn radiance(towards: DVec3, x: f64) -> f64 {
    (1.0 + x) * (1.0 + 0.9 * towards.dot(DVec3::new(0.36, 0.8, -0.48)))
}

/// A black map with that stack.
fn sky() -> Map {
    let (width, height) = (512, 256);
    let dark = Arc::new(vec![[0.0; 3]; 8]);
    let map = Map { width: 4, height: 2, texels: dark, scale: 1.0, rotate_y: 0.3, stack: None };
    let texel = |x: f64, idx: usize| {
        let (u, v) = ((idx % width) as f64 + 0.5, (idx / width) as f64 + 0.5);
        [radiance(map.direction(u / width as f64, v / height as f64), x) as f32; 3]
    };
    let texels = STACK_X.iter().flat_map(|x| (0..width * height).map(move |idx| texel(*x, idx))).collect();
    let turns = std::array::from_fn(|level| [0.1, 0.3, 0.5].map(|turn: f32| turn + 0.05 * level as f32));
    Map { stack: Some(Arc::new(Stack { width, height, texels, turns })), ..map }
}

/// Fails unless the light of [`sky`] through a medium is that of the oracle, given optical depth and elbow of
/// each ray, and the depth from a point outwards; says by how much ways that bend change it.
fn assert_bent(
    gpu: &Gpu,
    medium: &Value,
    camera: Camera,
    seen: impl Fn(&Ray) -> [f64; 2],
    depth_outwards: impl Fn(DVec3, DVec3) -> f64,
) -> f64 {
    let sky = sky();
    let stack = sky.stack.clone().unwrap();
    let sky = Value::new(PortType::Environment, 0, Environment::Map(sky));
    let image = march(gpu, &[("medium", medium), ("environment", &sky)], camera);
    let lattice = &medium.get::<Medium>().lattice;
    let mut largest_factor: f64 = 1.0;
    for (c, albedo) in ALBEDO.into_iter().enumerate() {
        let see = |ray: &Ray| {
            let [tau, elbow] = seen(ray);
            if tau == 0.0 {
                return [0.0, 1.0];
            }
            let world = |d: DVec3| lattice.world_from_index.transform_vector3(d).normalize();
            let x = albedo * G * G * tau;
            let elbow = ray.origin + elbow * ray.direction;
            // The turns are those of the channel that is scattered most.
            let turns = turns_at(&stack, G * G * tau);
            let half = |way: DVec3| radiance(world(way), 0.5 * x);
            let factor =
                bend(ray.direction, turns, 1.0 - albedo * G * G, |way| depth_outwards(elbow, way), half);
            let straight = (x - tau).exp() * radiance(world(ray.direction), x);
            [straight * factor, factor]
        };
        let rays = rays(lattice, &camera);
        let (mut light, factors): (Vec<f64>, Vec<f64>) = rays.iter().map(|ray| see(ray).into()).unzip();
        let found = channel(&image, "forward", c);
        // A filter of 8 bits knows no weight under 1/512: a ray that grazes the medium may see nothing of it.
        let mut n_unseen = 0;
        for ((light, found), ray) in light.iter_mut().zip(&found).zip(&rays) {
            if !gpu.is_cpu() && *found == 0.0 && *light > 0.0 && seen(ray)[0] < GRAZING {
                *light = 0.0;
                n_unseen += 1;
            }
        }
        assert!(n_unseen <= rays.len() / 50, "{n_unseen} rays see nothing");
        largest_factor = factors.iter().map(|factor| factor.max(1.0 / factor)).fold(largest_factor, f64::max);
        // Between texels of a 256th of pi light is (pi/256)²/8 of 0.9 off, 2e-5, three times in a product; ways are
        // a hundred roundings of f32, 1e-5; what misses the closed shape by rounding is a part of its rim.
        let tolerance = filtered(gpu, 2e-4);
        assert_close("forward", &found, &light, tolerance, tolerance * largest(&light));
    }
    largest_factor
}

#[test]
fn light_of_the_stack_bends_as_the_oracle_bends_it() {
    let Some(gpu) = gpu() else { return };
    let scene = scene(G, ALBEDO);
    let oracle = scene.oracle(0);
    let high = DVec3::from_array(scene.sigma_t.dims.map(|n| (n - 1) as f64));
    let table = peak_table(G);
    let dark = constant_light(scene.sigma_t.dims, 0.0);
    let march = MarchScene {
        medium: &oracle,
        beams: &[],
        residual: &dark,
        emission: None,
        ambient: 0.0,
        peak_table: &table,
        backward_table: &[],
        step: 0.5,
        least_k: oracle.scaled().k,
    };
    let seen = |ray: &Ray| {
        let interval = box_interval(ray, DVec3::ZERO, high);
        let seen = march_through(&march, ray, interval, |p| oracle.sigma_t.trilinear_zero(p), |_, _| 0.0);
        [seen.tau, seen.elbow]
    };
    let depth_outwards = |p: DVec3, way: DVec3| {
        let [_, end] = box_interval(&Ray { origin: p, direction: way }, DVec3::ZERO, high).unwrap();
        tau_along(&oracle.sigma_t, oracle.h, p, way, end)
    };
    let camera = camera(&scene, DVec3::new(-14.0, 9.0, -11.0));
    let changed = assert_bent(gpu, &scene.medium(gpu), camera, seen, depth_outwards);
    assert!(changed > 1.1, "{changed}: nothing bends");
}

#[test]
fn ways_out_of_a_closed_shape_bend_too() {
    // A ball beside the view's middle: its chords are known.
    let Some(gpu) = gpu() else { return };
    let volume =
        output(gpu, "shape", json!({ "kind": "sphere", "size": [3.0, 3.0, 3.0], "resolution": 16 }), &[]);
    let optics = json!({ "density_scale": 2.0, "albedo": ALBEDO, "g": G });
    let medium = output(gpu, "medium", optics, &[("volume", &volume)]);
    let (shape, cell_m) = {
        let medium: &Medium = medium.get();
        (medium.shape(), medium.lattice.cell_m)
    };
    let (center, radius) = (DVec3::from_array(shape.center.map(f64::from)), f64::from(shape.half_extent[0]));
    let chord = |origin: DVec3, direction: DVec3| {
        let along = (center - origin).dot(direction);
        let half2 = radius * radius - (center - origin).length_squared() + along * along;
        if half2 > 0.0 { [(along - half2.sqrt()).max(0.0), along + half2.sqrt()] } else { [0.0; 2] }
    };
    let depth = |[start, end]: [f64; 2]| f64::from(shape.sigma_t) * cell_m * (end - start);
    let camera = Camera {
        position: DVec3::new(2.0, 1.5, 4.0),
        look_at: DVec3::new(0.4, 0.2, 0.0),
        up: DVec3::Y,
        fov_y_deg: 40.0,
        width: SIZE[0],
        height: SIZE[1],
    };
    let seen = |ray: &Ray| {
        // Midpoints of n steps, with the weights (1 - (i + 1/2)/n)²: the first moment over the zeroth.
        let [start, end] = chord(ray.origin, ray.direction);
        let n = 2.0 * (end - start).ceil().max(1.0);
        let at = |i: i32| (f64::from(i) + 0.5) / n;
        let sum = |power: i32| (0..n as i32).map(|i| at(i).powi(power) * (1.0 - at(i)).powi(2)).sum::<f64>();
        [depth([start, end]), start + (end - start) * sum(1) / sum(0)]
    };
    let changed = assert_bent(gpu, &medium, camera, seen, |p, way| depth(chord(p, way)));
    assert!(changed > 1.1, "{changed}: nothing bends");
}
