use glam::DVec3;
use serde_json::json;

use super::ShadowParams;
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::light::{Ordinate, Ordinates};
use crate::nodes::oracle_scene::corners::HIDDEN;
use crate::nodes::testing::{Filling, Random, Scene, assert_layout, gpu, output, point, taus};
use crate::volume::field::Field;
use crate::wire::Beams;

/// Suns of these directions of index space behind surfaces, by one of the schemes.
fn suns(gpu: &Gpu, scene: &Scene, scheme: &str, directions: &[DVec3], surfaces: &[&Value]) -> Value {
    let world_from_index = scene.lattice().world_from_index;
    let ordinate = |direction: &DVec3| Ordinate {
        direction: world_from_index.transform_vector3(*direction).normalize(),
        irradiance: [3.0; 3],
        a0: 1.0,
        region: None,
        window: None,
    };
    let ordinates =
        Ordinates { ordinates: directions.iter().map(ordinate).collect(), ..Ordinates::default() };
    let (medium, ordinates) = (scene.medium(gpu), Value::new(PortType::Ordinates, 0, ordinates));
    let mut inputs = vec![("medium", &medium), ("ordinates", &ordinates)];
    inputs.extend(surfaces.iter().map(|surface| ("surfaces", *surface)));
    output(gpu, "principal_propagation", json!({ "scheme": scheme }), &inputs)
}

/// Fails where a corner is not hidden as `depth_in` says, how far in the shadow it lies [cells], or where
/// a lit one's depth is not what it is without surfaces. Corners by the edge may be either.
fn assert_shadow(what: &str, found: &Field<f64>, bare: &Field<f64>, depth_in: impl Fn(DVec3) -> f64) {
    let (mut n_hidden, mut n_lit) = (0, 0);
    for (idx, (&tau, &bare)) in found.data.iter().zip(&bare.data).enumerate() {
        let corner = DVec3::from_array(found.index_of(idx).map(|i| i as f64)) - 0.5;
        let depth = depth_in(corner);
        // Coordinates of some ten cells went through the world: 1e-5 cells.
        if depth.abs() < 1e-4 {
            continue;
        }
        let expected = if depth > 0.0 { HIDDEN } else { bare };
        assert_eq!(tau, expected, "{what}: corner {corner}, {depth} in the shadow");
        n_hidden += usize::from(depth > 0.0);
        n_lit += usize::from(depth < 0.0);
    }
    assert!(n_hidden > 100 && n_lit > 100, "{what}: {n_hidden} hidden, {n_lit} lit");
}

/// How far a point's view of the light passes inside of a plate's rectangle at height z.
fn inside(seen_at: DVec3, low: [f64; 2], high: [f64; 2]) -> f64 {
    let from_low = (seen_at.x - low[0]).min(seen_at.y - low[1]);
    from_low.min(high[0] - seen_at.x).min(high[1] - seen_at.y)
}

#[test]
fn a_plate_hides_what_its_edges_say() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([16, 12, 14], Filling::Random, 2.0);
    let (low, high, z) = ([-30.0, -30.0], [6.3, 40.0], 17.2);
    let plate = scene.plate(low, high, z);
    let down = [(0.3, 0.1), (-0.4, 0.2), (0.0, 0.0), (0.13, -0.7), (0.2, 0.2)];
    for n_beams in [1, 5] {
        let directions: Vec<DVec3> =
            down[..n_beams].iter().map(|&(x, y)| DVec3::new(x, y, -1.0).normalize()).collect();
        for scheme in ["walk", "scan"] {
            let found = suns(gpu, &scene, scheme, &directions, &[&plate]);
            let bare = suns(gpu, &scene, scheme, &directions, &[]);
            assert!(found.get::<Beams>().has_shadows && !bare.get::<Beams>().has_shadows);
            let fields = taus(gpu, found.get()).into_iter().zip(taus(gpu, bare.get()));
            for (n, ((found, bare), d)) in fields.zip(&directions).enumerate() {
                let seen_at = |corner: DVec3| corner + (z - corner.z) / d.z * *d;
                let what = format!("{scheme}, beam {n} of {n_beams}");
                assert_shadow(&what, &found, &bare, |corner| inside(seen_at(corner), low, high));
            }
        }
    }
}

#[test]
fn a_plate_inside_hides_what_is_beyond_it_from_a_lamp() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([16, 12, 14], Filling::Random, 2.0);
    let (low, high, z) = ([3.3, 2.1], [12.2, 9.7], 6.13);
    let plate = scene.plate(low, high, z);
    // Above it, far above, inside the medium, below it, and on it.
    let positions = [(8.0, 6.0, 20.0), (-50.0, 30.0, 90.0), (7.2, 5.1, 9.3), (5.0, 5.0, -12.0)]
        .map(|(x, y, z)| DVec3::new(x, y, z));
    for n_lamps in [1, 4] {
        let lamps = positions[..n_lamps].iter().map(|position| point(*position, 1.0)).collect::<Vec<_>>();
        let medium = scene.medium(gpu);
        let found = scene.propagate_behind(gpu, &medium, &lamps, [0.0; 3], &[&plate]);
        let bare = scene.propagate(gpu, &medium, &lamps, [0.0; 3]);
        let fields = taus(gpu, found.get()).into_iter().zip(taus(gpu, bare.get()));
        for ((found, bare), lamp) in fields.zip(positions) {
            assert_shadow(&format!("lamp {lamp} of {n_lamps}"), &found, &bare, |corner| {
                let share = (z - lamp.z) / (corner.z - lamp.z);
                let beyond = (corner.z - z).abs();
                if (corner.z - z) * (lamp.z - z) > 0.0 {
                    return -beyond;
                }
                inside(lamp.lerp(corner, share), low, high).min(beyond)
            });
        }
    }
}

#[test]
fn surfaces_that_hide_nothing_change_nothing() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([9, 8, 7], Filling::Random, 2.0);
    // Below the medium, and the light comes from above.
    let floor = scene.plate([-50.0, -50.0], [50.0, 50.0], -3.0);
    let mut random = Random(9);
    for n_beams in [1, 7] {
        let down = (0..n_beams).map(|_| random.direction() * DVec3::new(1.0, 1.0, 0.0) - DVec3::Z);
        let directions: Vec<DVec3> = down.map(DVec3::normalize).collect();
        for scheme in ["walk", "scan"] {
            let [with, without] = [vec![&floor], vec![]].map(|surfaces| {
                let beams = suns(gpu, &scene, scheme, &directions, &surfaces);
                taus(gpu, beams.get())
            });
            assert_eq!(with.len(), n_beams);
            assert!(with.iter().zip(&without).all(|(a, b)| a.data == b.data));
        }
    }
}

#[test]
fn layouts_are_those_of_the_shader() {
    const PACKED: [(&str, &str); 2] = [("pack", "4"), ("format", "rgba16float")];
    assert_layout::<ShadowParams>("shadow.wgsl", "ShadowParams", &PACKED);
}
