//! Beams that are gathered at corners: the shader against the oracle of that, and both against beams that are
//! looked up one by one.

use super::*;
use crate::nodes::Run;
use crate::nodes::testing::with_run;

const MANY: usize = 13;

/// More rays than the medium has corners, from so far away in cells that the phase function hardly turns.
fn telescope(scene: &Scene, distance: f64) -> Camera {
    let from = DVec3::new(-0.7, 0.45, -0.55).normalize() * distance;
    let view = camera(scene, from + DVec3::from_array(scene.sigma_t.dims.map(|n| (n - 1) as f64 / 2.0)));
    let fov_y_deg = 2.0 * (8.0 / distance).atan().to_degrees();
    Camera { width: 120, height: 100, fov_y_deg, ..view }
}

/// The picture of a march that must gather, and one that must not.
fn both(gpu: &Gpu, step: f64, inputs: &[(&str, &Value)]) -> [Image; 2] {
    let make = |prune: bool| {
        with_run(gpu, "raymarch", json!({ "step": step }), inputs, |run| {
            let run = Run { prune, report: Default::default(), ..*run };
            let image = (crate::nodes::kind("raymarch").unwrap().run)(&run).unwrap().remove(0);
            let report = run.report.borrow();
            let decision = report.decisions.iter().find(|decision| decision.rule == "gathering").unwrap();
            assert_eq!(decision.kept, !prune, "{decision:?}");
            image.get::<Image>().clone()
        })
    };
    [make(true), make(false)]
}

fn assert_gathered(gpu: &Gpu, what: &str, scene: &Scene, lights: &[Beam], distance: f64) {
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, lights, [0.0; 3]);
    let dark = crate::nodes::oracle_scene::constant_light(scene.sigma_t.dims, 0.0);
    let lit = Lit {
        beams: beams.get::<Beams>().clone(),
        taus: taus(gpu, beams.get()),
        aheads: aheads(gpu, beams.get()),
        residual: vec![dark; 3],
        fire: None,
    };
    let camera = telescope(scene, distance);
    let rays = rays(&scene.lattice(), &camera);
    let camera = Value::new(PortType::Camera, 0, camera);
    let [found, looked_up] = both(gpu, 0.5, &[("medium", &medium), ("beams", &beams), ("camera", &camera)]);
    for c in 0..3 {
        let seen: Vec<Marched> = with_march(scene, c, &lit, |march| {
            let sums = sums::gather(march, rays[0].origin);
            let sigma_t_at = |p: DVec3| march.medium.sigma_t.trilinear_zero(p);
            let see = |ray: &Ray| sums::march_gathered(march, ray, interval(march, ray), sigma_t_at, &sums);
            rays.iter().map(see).collect()
        });
        let compare = |layer: &str, of: &dyn Fn(&Marched) -> f64| {
            let expected: Vec<f64> = seen.iter().map(of).collect();
            assert!(largest(&expected) > 0.0, "{what}, {layer}: black");
            // As where beams are looked up, from an eye ten times as far away.
            let tolerance = filtered(gpu, 3e-4);
            let found = channel(&found, layer, c);
            assert_close(
                &format!("{what}, {layer}, {c}"),
                &found,
                &expected,
                tolerance,
                tolerance * largest(&expected),
            );
        };
        compare("single", &|seen| seen.single);
        if scene.g > 0.0 {
            compare("forward", &|seen| seen.forward);
        }
        let sum = |image: &Image| channel(image, BEAUTY, c).iter().sum::<f64>();
        let apart = sum(&found) / sum(&looked_up) - 1.0;
        // By the planner's rule: g 0.85 turns by 0.07 %, and cells have optical depths evenly up to 3 · 0.25, the mean
        // of whose squares is a third of the largest; a twelfth of that is 1.6 %, for light from everywhere. That of
        // thirteen suns is a little less even.
        let bound = 0.02;
        eprintln!("{what}: gathered {apart:+.2e}, bound {bound:.2e}");
        assert!(apart != 0.0 && apart.abs() < bound, "{what}, {c}: {apart}");
    }
}

/// Suns around the medium, one behind it.
fn suns(scene_g: f64) -> Vec<Beam> {
    let around = |n: usize| {
        let (sin, cos) = (n as f64 * 2.4).sin_cos();
        Beam { a0: 0.95, ..sun(DVec3::new(cos, 0.6 - 0.2 * n as f64, sin), 1.0 + 0.3 * n as f64) }
    };
    let behind = sun(DVec3::new(-0.7, 0.45, -0.55), 1.0 / (1.0 + scene_g.abs()));
    (1..MANY).map(around).chain([behind]).collect()
}

#[test]
fn gathered_light_is_seen_as_the_oracle_gathers_it() {
    let Some(gpu) = gpu() else { return };
    for (g, distance) in [(0.0, 30.0), (0.5, 60.0), (0.85, 200.0)] {
        assert_gathered(gpu, &format!("g {g}"), &scene(g, [0.9; 3]), &suns(g), distance);
    }
    let one_block = Scene::new([24; 3], Filling::Random, 3.0).in_one_block();
    assert_gathered(gpu, "one block", &one_block, &suns(0.5), 60.0);
    let colored =
        suns(0.5).iter().map(|sun| Beam { power: [sun.power[0], 1.0, 0.5], ..*sun }).collect::<Vec<_>>();
    assert_gathered(gpu, "colored light", &scene(0.5, [0.9; 3]), &colored, 60.0);
    assert_gathered(gpu, "colored matter", &scene(0.5, [1.0, 0.5, 0.9]), &colored, 60.0);
}

#[test]
fn gathered_light_leaves_its_forward_share_to_the_stack() {
    let Some(gpu) = gpu() else { return };
    let window = Some(Window { inner_deg: 40.0, outer_deg: 120.0, share: 0.7 });
    let lights: Vec<Beam> = suns(0.85).into_iter().map(|sun| Beam { window, ..sun }).collect();
    assert_gathered(gpu, "windows", &scene(0.85, [0.9; 3]), &lights, 200.0);
}

#[test]
fn long_steps_read_no_corner_that_was_not_gathered() {
    // Light of two steps is evaluated between their middles, which may be in an empty block between filled ones: a
    // corner that was passed over holds ln 1 there, much more than any other.
    let Some(gpu) = gpu() else { return };
    let mut scene = Scene::new([24; 3], Filling::Random, 3.0);
    for idx in 0..scene.sigma_t.data.len() {
        // Blocks like the cells of a chessboard, of which none reaches into another.
        let cell = scene.sigma_t.index_of(idx);
        let is_white = cell.into_iter().map(|i| i / 8).sum::<usize>() % 2 == 1;
        if is_white || cell.into_iter().any(|i| i % 8 == 0 || i % 8 == 7) {
            scene.sigma_t.data[idx] = 0.0;
        }
    }
    let medium = scene.medium(gpu);
    let weak: Vec<Beam> = suns(0.5).iter().map(|sun| Beam { power: [1e-3; 3], ..*sun }).collect();
    let beams = scene.propagate(gpu, &medium, &weak, [0.0; 3]);
    let camera = Value::new(PortType::Camera, 0, telescope(&scene, 60.0));
    let [found, looked_up] = both(gpu, 4.0, &[("medium", &medium), ("beams", &beams), ("camera", &camera)]);
    let [found, looked_up] = [found, looked_up].map(|image| channel(&image, BEAUTY, 0));
    let least = 0.01 * largest(&looked_up);
    assert!(least > 0.0);
    for (found, looked_up) in found.iter().zip(&looked_up) {
        // Depths of a cell that is half void change by a third from corner to corner.
        assert!(*found < 1.3 * looked_up + least, "{found} against {looked_up}");
    }
}
