//! Surfaces inside of the medium.

use glam::DVec4;

use super::super::level;
use super::super::walls::APART;
use super::*;
use crate::geometry::Mesh;
use crate::graph::PortType;
use crate::nodes::testing::{Random, ball, mesh};
use crate::wire::Surfaces;

/// A black surface.
fn black(scene: &Scene, triangles: &[[DVec3; 3]]) -> Value {
    Value::new::<Mesh>(PortType::Surface, 0, mesh(&scene.lattice(), triangles, [0.0; 3]))
}

/// A rectangle across z.
fn plate(low: [f64; 2], high: [f64; 2], z: f64) -> [[DVec3; 3]; 2] {
    let [a, b, c, d] = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
        .map(|(x, y)| DVec3::new(x, y, z));
    [[a, b, c], [a, c, d]]
}

/// phi and F of sweeps past these surfaces, and the last factor; sources are those of beams that do not see them.
fn swept(
    gpu: &Gpu,
    scene: &Scene,
    triangles: &[[DVec3; 3]],
    (beams, ambient): (&Value, f64),
    (quality, lines): (&str, LineSet),
) -> (Vec<DVec4>, f64) {
    let medium = scene.medium(gpu);
    let inputs = [("medium", &medium), ("beams", beams)];
    with_run(gpu, "isotropic_residual", json!({ "quality": quality }), &inputs, |run| {
        let (medium, beams): (&Medium, &Beams) = (medium.get(), beams.get());
        let channels = Channels { count: 1, color: [1.0; 3] };
        let effort = super::super::Effort { lines, ..plan(run).unwrap().effort };
        let surfaces = mesh(&medium.lattice, triangles, [0.0; 3]);
        let surfaces = Surfaces::new(gpu, &medium.lattice, &[&surfaces]).unwrap();
        let problem = Problem::new(medium, &channels, [ambient; 3], lines, true)
            .behind(gpu, &surfaces, &solver::grids(medium.lattice.dims))
            .unwrap();
        let sources = sources::sources(run, medium, beams, &channels, &problem).unwrap();
        let bytes = level::BATCH_BYTES;
        let found = solver::solve(run, medium, &sources, &problem, effort, channels, bytes).unwrap();
        (layers(gpu, &found.moments, 1).remove(0).data, found.balance[0])
    })
}

#[test]
fn residuals_among_surfaces_are_the_oracles() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.4, albedo: [0.95; 3], ..Scene::new([16, 16, 16], Filling::Random, 4.0) };
    let medium = scene.medium(gpu);
    let mut random = Random(31);
    // A ball, a wall with an edge, and scattered pieces.
    let mut triangles: Vec<[DVec3; 3]> =
        ball(DVec3::ZERO, 2).iter().map(|t| t.map(|p| 0.38 * p + DVec3::new(5.2, 6.1, 4.7))).collect();
    triangles.extend(plate([-3.0, -4.0], [9.3, 40.0], 10.21));
    triangles.extend((0..6).map(|_| {
        let at = 14.0 * DVec3::new(random.unit(), random.unit(), random.unit());
        [(); 3].map(|()| at + 4.0 * random.direction())
    }));
    for (ambient, quality, lines) in [
        (0.0, Quality::Default, LineSet::Lines14),
        (0.3, Quality::Default, LineSet::Lines14),
        (0.3, Quality::Thick, LineSet::Lines14),
        (0.2, Quality::Fast, LineSet::Lines50),
    ] {
        let beams = scene.propagate(gpu, &medium, &suns(false), [ambient; 3]);
        let name = match quality {
            Quality::Thick => "thick",
            Quality::Fast => "fast",
            _ => "default",
        };
        let (found, _) = swept(gpu, &scene, &triangles, (&beams, ambient), (name, lines));
        let level = Level::new(&scene.oracle(0), oracle_sources(gpu, &scene, 0, beams.get()));
        let level = level.behind(triangles.iter().map(|corners| corners.map(|p| p + APART)).collect());
        let solved = solve(level, Options { quality, lines, scheme: Scheme::Diamond });
        assert!(solved.balance.into_surfaces > 0.05 * solved.balance.incoming(), "no wall says nothing");
        let expected = flat(&solved.state);
        let found: Vec<f64> = found.iter().flat_map(|light| light.to_array()).collect();
        // As without surfaces.
        assert_close(&format!("{name} {ambient}"), &found, &expected, 1e-5, 1e-5 * largest(&expected));
    }
}

#[test]
fn surfaces_take_what_they_stop() {
    // What has settled needs no factor: sweeps conserve power by themselves, with what goes into surfaces.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.3, albedo: [1.0; 3], ..Scene::new([16; 3], Filling::Random, 5.0) };
    let medium = scene.medium(gpu);
    let walls = plate([-3.0, -4.0], [9.3, 40.0], 7.3);
    for ambient in [0.0, 0.3] {
        let beams = scene.propagate(gpu, &medium, &suns(false), [ambient; 3]);
        let settled = |walls: &[[DVec3; 3]]| {
            swept(gpu, &scene, walls, (&beams, ambient), ("reference", LineSet::Lines14))
        };
        let ((open, _), (found, factor)) = (settled(&[]), settled(&walls));
        assert!((factor - 1.0).abs() < 1e-5, "{ambient}: {factor}");
        let sum = |state: &[DVec4]| state.iter().map(|light| light.x).sum::<f64>();
        assert!(sum(&found) < 0.95 * sum(&open), "{} of {}", sum(&found), sum(&open));
    }
}

#[test]
fn behind_a_wall_it_is_dark() {
    // A wall parts a white medium, lit from below, in two. Above it there is no light but around its edge, if it
    // has one inside; where it has none the sweeps end below 1e-4 of the light below, which is what `reference` has
    // not settled yet.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.0, albedo: [1.0; 3], ..Scene::new([16; 3], Filling::Homogeneous, 1.5) };
    let medium = scene.medium(gpu);
    let sums = |edge: f64, quality: &str| {
        let wall = black(&scene, &plate([-90.0, -90.0], [edge, 90.0], 7.3));
        let beams = scene.propagate_behind(gpu, &medium, &[sun(DVec3::Z, 3.0)], [0.0; 3], &[&wall]);
        let inputs = [("medium", &medium), ("beams", &beams), ("surfaces", &wall)];
        let found = output(gpu, "isotropic_residual", json!({ "quality": quality }), &inputs);
        let state = states(gpu, &found).remove(0);
        // Above the wall, of its first columns and of its last.
        let sum = |xs: std::ops::Range<usize>, zs: std::ops::Range<usize>| {
            let cells = zs.flat_map(|z| (1..15).map(move |y| (y, z)));
            cells
                .flat_map(|(y, z)| xs.clone().map(move |x| [x, y, z]))
                .map(|cell| state.at(cell).x)
                .sum::<f64>()
        };
        let lit = sum(1..15, 1..8);
        [sum(1..4, 8..15) / lit, sum(12..15, 8..15) / lit, sum(1..15, 8..15) / lit]
    };
    let [.., dark] = sums(90.0, "reference");
    assert!(dark < 1e-4, "{dark}");
    // The cascade starts from coarse grids between whose cells light is interpolated, wall or not: 4.5e-3.
    let [.., leaks] = sums(90.0, "default");
    assert!(leaks < 0.01, "{leaks}");
    // Around an edge light comes in, and less the further from it.
    let [far, near, _] = sums(9.6, "reference");
    assert!(near > 5.0 * far && far > 1e-4, "{far} {near}");
}
