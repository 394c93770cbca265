use glam::DVec3;
use serde_json::{Value as Json, json};

use super::level::{
    BalanceParams, BatchParams, ChannelTexel, DirectionTexel, LevelParams, LineSumParams, Problem,
    THREADS_OF_A_SUM, lines_per_sum,
};
use super::oracle::{Level, Options, Quality, Scheme, solve};
use super::plan::plan;
use super::sources::{COLUMNS_OF_A_SUM, SourceParams};
use super::{oracle, solver, sources};
use crate::gpu::{Format, Gpu, Shader, wgsl_constant};
use crate::graph::Value;
use crate::nodes::oracle_scene::corners::HIDDEN;
use crate::nodes::principal_propagation::oracle::mean_irradiance;
use crate::nodes::spherical_propagation::oracle::mean_irradiance_point;
use crate::nodes::testing::{
    Filling, Fire, Scene, aheads, assert_close, assert_layout, filtered_times, flat, full_output, gpu,
    largest, layers, oracle_light, output, point, run, states, sun, taus, with_run,
};
use crate::optics::backward::Streams;
use crate::optics::directions::LineSet;
use crate::volume::field::Field;
use crate::wire::{Beam, Beams, Channels, Medium, Place, Residual, TauAtlas};

/// Means of the corners of each cell.
fn mean_of_corners(corners: &Field<f64>) -> Field<f64> {
    Field::from_fn(corners.dims.map(|n| n - 1), |cell| {
        let corner = |n: usize| corners.at(std::array::from_fn(|axis| cell[axis] + (n >> axis & 1)));
        (0..8).map(corner).sum::<f64>() / 8.0
    })
}

/// The oracle's sources of one channel, from the optical depths that the GPU stored.
fn oracle_sources(gpu: &Gpu, scene: &Scene, channel: usize, beams: &Beams) -> oracle::Sources {
    let medium = scene.oracle(channel);
    let mut sources = oracle::Sources::new(scene.sigma_t.dims, beams.ambient[channel]);
    let k = medium.scaled().k;
    for ((beam, tau), ahead) in beams.beams.iter().zip(&taus(gpu, beams)).zip(&aheads(gpu, beams)) {
        if let (Some(ahead), Place::Parallel(direction)) = (ahead, beam.place) {
            let kappa = Streams::new(medium.albedo, medium.g, 0.0, 0.0).kappa;
            let mean = mean_irradiance(tau, kappa, direction);
            let at_cells = [tau, ahead].map(mean_of_corners);
            sources.add_returning_beam(&medium, &oracle_light(beam, channel), &mean, at_cells.each_ref());
            continue;
        }
        let mean = match beam.place {
            Place::Parallel(direction) => mean_irradiance(tau, k, direction),
            Place::Point(position) => mean_irradiance_point(tau, k, medium.h, position),
        };
        sources.add_beam(&medium, &oracle_light(beam, channel), &mean);
    }
    sources
}

/// Q0 and Q1 as the node makes them, a field a channel.
pub(super) fn gpu_sources(gpu: &Gpu, medium: &Value, beams: &Value) -> Vec<Field<glam::DVec4>> {
    let inputs = [("medium", medium), ("beams", beams)];
    with_run(gpu, "isotropic_residual", json!({}), &inputs, |run| {
        let (medium, beams): (&Medium, &Beams) = (medium.get(), beams.get());
        let channels = plan(run).unwrap().channels;
        let problem = Problem::new(medium, &channels, beams.ambient, LineSet::Lines14, true);
        let sources = sources::sources(run, medium, beams, &channels, &problem).unwrap();
        layers(gpu, &sources.field, channels.count)
    })
}

fn residual(gpu: &Gpu, params: Json, medium: &Value, beams: &Value) -> Value {
    // Where nothing scatters it is left out unless it is asked for.
    let make = if medium.get::<Medium>().albedo == [0.0; 3] { full_output } else { output };
    make(gpu, "isotropic_residual", params, &[("medium", medium), ("beams", beams)])
}

/// A bright, a dim and a colored sun, of different spreads.
fn suns(is_colored: bool) -> Vec<Beam> {
    let mut suns = vec![
        sun(DVec3::new(0.3, -0.2, 0.9), 3.0),
        sun(DVec3::new(-0.8, 0.5, 0.1), 0.5),
        Beam { a0: 0.8, ..sun(DVec3::new(0.1, 1.0, 0.3), 1.0) },
    ];
    if is_colored {
        suns[0].power = [3.0, 2.0, 1.0];
        suns[2].power = [0.2, 0.5, 1.5];
    }
    suns
}

#[test]
fn sources_of_suns_are_the_oracles() {
    let Some(gpu) = gpu() else { return };
    for (g, albedo) in [(-0.9, [0.3; 3]), (0.0, [1.0; 3]), (0.5, [0.9, 0.5, 0.99]), (0.95, [0.99; 3])] {
        for filling in [Filling::Random, Filling::Binary] {
            let scene = Scene { g, albedo, ..Scene::new([9, 6, 5], filling, 8.0) };
            let medium = scene.medium(gpu);
            let beams = scene.propagate(gpu, &medium, &suns(albedo[0] != albedo[1]), [0.0; 3]);
            for (channel, found) in gpu_sources(gpu, &medium, &beams).iter().enumerate() {
                let expected = oracle_sources(gpu, &scene, channel, beams.get());
                let q0: Vec<f64> = found.data.iter().map(|q| q.x).collect();
                let what = format!("g {g} {filling:?} channel {channel}");
                // e^-x is 3 + 2x ulps off, x under 20; the other steps are a dozen roundings; differences
                // of tau are divided by 0.1 at least: 1e-6.
                let top = largest(&expected.q0.data);
                assert_close(&what, &q0, &expected.q0.data, 1e-5, 1e-12 * top);
                let q1: Vec<f64> = found.data.iter().flat_map(|q| [q.y, q.z, q.w]).collect();
                let expected_q1: Vec<f64> = expected.q1.data.iter().flat_map(|q| q.to_array()).collect();
                // Components of several beams may cancel, so their error is that of the largest.
                assert_close(&what, &q1, &expected_q1, 1e-5, 1e-5 * largest(&expected_q1));
            }
        }
    }
}

#[test]
fn sources_of_point_lights_are_the_oracles() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([9, 8, 7], Filling::Random, 3.0);
    let medium = scene.medium(gpu);
    // Outside; inside beside a center, on a corner and anywhere. The mean of r^-2 over a cell nearer than its
    // edge is exact in the oracle and a sum of 8^3 points in the shader: 2 % off where the light is inside,
    // 4.4 % where it sits on the corner of eight sub-cells, whose means their middles do not see.
    for (position, near) in [
        (DVec3::new(-9.0, 4.0, 3.0), 1e-5),
        (DVec3::new(4.02, 3.03, 2.99), 0.02),
        (DVec3::new(4.5, 3.5, 2.5), 0.05),
        (DVec3::new(4.3, 3.1, 2.7), 0.02),
    ] {
        let beams = scene.propagate(gpu, &medium, &[point(position, 2.0)], [0.0; 3]);
        let expected = oracle_sources(gpu, &scene, 0, beams.get());
        let found = gpu_sources(gpu, &medium, &beams).remove(0);
        for (idx, (found, expected)) in found.data.iter().zip(&expected.q0.data).enumerate() {
            let cell = DVec3::from_array(scene.sigma_t.index_of(idx).map(|i| i as f64));
            let relative = if (cell - position).length() < 1.0 { near } else { 1e-5 };
            let what = format!("light {position}, cell {cell}");
            assert_close(&what, &[found.x], &[*expected], relative, 1e-12);
        }
    }
}

#[test]
fn sources_in_shadows_are_the_oracles() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.5, ..Scene::new([9, 8, 7], Filling::Random, 3.0) };
    let medium = scene.medium(gpu);
    let plate = scene.plate([2.2, 1.7], [6.1, 30.0], 4.3);
    for lights in [suns(false), vec![point(DVec3::new(4.2, 4.3, 20.0), 50.0)]] {
        let beams = scene.propagate_behind(gpu, &medium, &lights, [0.0; 3], &[&plate]);
        let taus = taus(gpu, beams.get());
        assert!(taus.iter().all(|tau| tau.data.contains(&HIDDEN)), "no shadow says nothing");
        let expected = oracle_sources(gpu, &scene, 0, beams.get()).q0.data;
        let found: Vec<f64> = gpu_sources(gpu, &medium, &beams)[0].data.iter().map(|q| q.x).collect();
        // As without shadows.
        assert_close("Q0", &found, &expected, 1e-5, 1e-12 * largest(&expected));
    }
}

#[test]
fn a_thin_medium_scatters_what_its_lit_part_gets() {
    // Of 14 cells along each axis those are lit that lie beyond the plane through the plate's edge along the
    // light. Cells that it cuts get the share of their lit corners: that is off by a part of a cell in each
    // column, and on average by none. Were they dark, 6 % of the light would be missing.
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.0, albedo: [1.0; 3], ..Scene::new([16, 16, 16], Filling::Homogeneous, 1e-3) };
    let direction = DVec3::new(0.37, 0.11, -1.0).normalize();
    let (edge, z) = (2.71, 18.0);
    let plate = scene.plate([-90.0, -90.0], [edge, 90.0], z);
    let medium = scene.medium(gpu);
    let beams = scene.propagate_behind(gpu, &medium, &[sun(direction, 3.0)], [0.0; 3], &[&plate]);
    let found = gpu_sources(gpu, &medium, &beams).remove(0);
    let n_lit = found.data.iter().map(|q| q.x).sum::<f64>() / (3.0 * 1e-3);
    let boundary = edge + (7.5 - z) * direction.x / direction.z;
    let expected = 14.0 * 14.0 * (14.5 - boundary);
    assert!((n_lit / expected - 1.0).abs() < 0.01, "{n_lit} of {expected} lit cells");
}

/// Compares every channel of a residual with the oracle's, in units of the largest phi.
fn assert_solved(
    gpu: &Gpu,
    what: &str,
    scene: &Scene,
    (lights, ambient): (&[Beam], [f64; 3]),
    (quality, lines): (Quality, LineSet),
) {
    let name = match quality {
        Quality::Draft => "draft",
        Quality::Fast => "fast",
        Quality::Thick => "thick",
        _ => "default",
    };
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, lights, ambient);
    let params = json!({ "quality": name, "directions": lines.count() });
    let found = residual(gpu, params, &medium, &beams);
    let channels = found.get::<Residual>().channels;
    for (channel, found) in states(gpu, &found).iter().enumerate() {
        let level = Level::new(&scene.oracle(channel), oracle_sources(gpu, scene, channel, beams.get()));
        let solved = solve(level, Options { quality, lines, scheme: Scheme::Diamond });
        let expected: Vec<f64> = flat(&solved.state).iter().map(|x| x / channels.color[channel]).collect();
        // Lobes are stored in steps of 1e-6 of phi; sources are 1e-5 off at worst, where they are weakest;
        // a line of up to 32 cells and 20 sweeps add 1e-7 a step, most of which the balance takes back.
        let what = format!("{what} {name} {lines:?} channel {channel}");
        assert_close(&what, &flat(found), &expected, 1e-5, 1e-5 * largest(&expected));
    }
}

#[test]
fn residuals_are_the_oracles_for_every_g_and_albedo() {
    let Some(gpu) = gpu() else { return };
    for g in [-0.9, 0.0, 0.5, 0.9] {
        for albedo in [0.0, 0.5, 0.99, 1.0] {
            let scene = Scene { g, albedo: [albedo; 3], ..Scene::new([10, 6, 8], Filling::Random, 6.0) };
            let what = format!("g {g} albedo {albedo}");
            let light = (&suns(false)[..], [0.2; 3]);
            assert_solved(gpu, &what, &scene, light, (Quality::Fast, LineSet::Lines14));
        }
    }
}

#[test]
fn residuals_are_the_oracles_for_every_set_of_lines() {
    let Some(gpu) = gpu() else { return };
    for lines in LineSet::ALL {
        for (quality, dims) in [
            (Quality::Draft, [16, 8, 32]),
            (Quality::Fast, [5, 3, 2]),
            (Quality::Default, [8, 16, 4]),
            (Quality::Default, [1, 1, 1]),
        ] {
            let mut scene = Scene::new(dims, Filling::Binary, 5.0);
            // Without a border of void: the sweeps need none.
            scene.sigma_t = Field::from_fn(dims, |[x, y, z]| ((3 * x + 5 * y + 7 * z) % 4) as f64);
            let light = (&suns(false)[..1], [0.4; 3]);
            assert_solved(gpu, &format!("{dims:?}"), &scene, light, (quality, lines));
        }
    }
}

#[test]
fn v_cycles_in_a_deep_white_medium_are_the_oracles() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { g: 0.3, albedo: [1.0; 3], ..Scene::new([16, 16, 32], Filling::Random, 40.0) };
    assert_solved(gpu, "deep", &scene, (&suns(false)[..1], [0.1; 3]), (Quality::Thick, LineSet::Lines14));
}

#[test]
fn residuals_of_three_channels_are_the_oracles() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [1.0, 0.5, 0.9], ..Scene::new([16, 8, 32], Filling::Random, 4.0) };
    let colored = suns(true);
    for (lights, ambient) in [(&colored[..], [0.1, 0.0, 0.3]), (&[], [0.2, 0.4, 0.1])] {
        for quality in [Quality::Draft, Quality::Default] {
            let lines = quality.options().lines;
            assert_solved(gpu, "three channels", &scene, (lights, ambient), (quality, lines));
        }
    }
    // A grey medium in light of one color is one channel.
    let grey = Scene { albedo: [0.9; 3], ..scene };
    let medium = grey.medium(gpu);
    let red = Beam { power: [2.0, 1.0, 0.5], ..colored[0] };
    let beams = grey.propagate(gpu, &medium, &[red], [0.0; 3]);
    let found = residual(gpu, json!({}), &medium, &beams);
    assert_eq!(found.get::<Residual>().channels, Channels { count: 1, color: [1.0, 0.5, 0.25] });
}

#[test]
fn point_lights_light_the_residual() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([8, 8, 16], Filling::Random, 3.0);
    let lights = [point(DVec3::new(20.0, 4.0, -3.0), 50.0), point(DVec3::new(3.0, -9.0, 8.0), 20.0)];
    let default = (Quality::Default, LineSet::Lines14);
    assert_solved(gpu, "points", &scene, (&lights, [0.0; 3]), default);
}

#[test]
fn a_fire_gives_each_cell_the_mean_of_its_points() {
    let Some(gpu) = gpu() else { return };
    let fire = Fire::new(Scene::new([16; 3], Filling::Random, 3.0));
    let medium = fire.medium(gpu);
    for lights in [vec![], suns(true)] {
        let beams = fire.scene.propagate(gpu, &medium, &lights, [0.0; 3]);
        let found = gpu_sources(gpu, &medium, &beams);
        assert_eq!(found.len(), 3);
        for (channel, found) in found.iter().enumerate() {
            let emission = fire.oracle(channel);
            let mut expected = oracle_sources(gpu, &fire.scene, channel, beams.get());
            expected.add_emission(&Field::from_fn([48; 3], |point| {
                emission.at(DVec3::from_array(point.map(|n| (n as f64 - 1.0) / 3.0)))
            }));
            let q0: Vec<f64> = found.data.iter().map(|q| q.x).collect();
            let top = largest(&expected.q0.data);
            // The table of black bodies is 1e-4 off; blue, which sets in at 1900 K, 1e-4 of red.
            let tolerance = if channel == 2 { 6e-4 } else { 1.5e-4 };
            // A filter of 8 bits is half a 256th of the difference of neighbors off, here as large as temperatures are,
            // and black bodies of 1500 K go with the 15th power of those; twice, for three axes.
            let tolerance = filtered_times(gpu, tolerance, 15.0);
            assert_close(
                &format!("channel {channel}"),
                &q0,
                &expected.q0.data,
                tolerance,
                1e-2 * tolerance * top,
            );
        }
    }
}

#[test]
fn flame_without_smoke_shines() {
    // Sources where nothing scatters, which beams never give: exact in void, c = I + q s/2, O = I + q s.
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([6, 8, 5], Filling::Binary, 3.0);
    let (dims, volume) = (scene.sigma_t.dims, scene.cell_m.powi(3));
    let q0 = Field::from_fn(dims, |[x, y, z]| ((x + 3 * y + 2 * z) % 5) as f64);
    let medium = scene.medium(gpu);
    let result = with_run(gpu, "isotropic_residual", json!({}), &[("medium", &medium)], |run| {
        let medium: &Medium = medium.get();
        let channels = Channels { count: 1, color: [1.0; 3] };
        let problem = Problem::new(medium, &channels, [0.0; 3], LineSet::Lines14, true);
        let texels: Vec<[f32; 4]> = q0.data.iter().map(|q| [*q as f32, 0.0, 0.0, 0.0]).collect();
        let field = gpu.texture3_from("sources", dims, Format::Rgba32Float, &texels, "").unwrap();
        let power = (q0.data.iter().sum::<f64>() * volume) as f32;
        let sums = gpu.buffer_from("powers of sources", &[power], "").unwrap();
        let (sources, effort) = (sources::Sources { field, sums, n_sums: 1 }, plan(run).unwrap().effort);
        solver::solve(run, medium, &sources, &problem, effort, channels, 1 << 30).unwrap()
    });
    let sources = oracle::Sources { q0, ..oracle::Sources::new(dims, 0.0) };
    let solved = solve(Level::new(&scene.oracle(0), sources), Quality::Default.options());
    let expected = flat(&solved.state);
    let found = flat(&layers(gpu, &result.moments, 1)[0]);
    assert_close("flame", &found, &expected, 1e-5, 1e-5 * largest(&expected));
}

#[test]
fn several_batches_give_what_one_gives() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene { albedo: [0.9, 0.5, 0.99], ..Scene::new([8, 6, 12], Filling::Random, 4.0) };
    let medium = scene.medium(gpu);
    let beams = scene.propagate(gpu, &medium, &suns(true), [0.1; 3]);
    let inputs = [("medium", &medium), ("beams", &beams)];
    let solved = |batch_bytes| {
        let result = with_run(gpu, "isotropic_residual", json!({}), &inputs, |run| {
            let (medium, beams): (&Medium, &Beams) = (medium.get(), beams.get());
            let channels = plan(run).unwrap().channels;
            let problem = Problem::new(medium, &channels, beams.ambient, LineSet::Lines14, true);
            let sources = sources::sources(run, medium, beams, &channels, &problem).unwrap();
            solver::solve(run, medium, &sources, &problem, plan(run).unwrap().effort, channels, batch_bytes)
        });
        let moments = result.unwrap().moments;
        layers(gpu, &moments, 3).iter().flat_map(flat).collect::<Vec<f64>>()
    };
    let cells_bytes = 4 * 8 * 6 * 12;
    let one = solved(1 << 30);
    // Batches of 1, 3, 5, 14 and 20 of the 42 pairs of channel and direction: the sums are the same, in
    // the same order; |F| <= phi is enforced on partial sums too, which changes nothing while it holds.
    for pairs in [1, 3, 5, 14, 20] {
        assert_close(
            &format!("{pairs} pairs"),
            &solved(pairs * cells_bytes),
            &one,
            1e-5,
            1e-5 * largest(&one),
        );
    }
}

#[test]
fn no_light_is_no_residual() {
    let Some(gpu) = gpu() else { return };
    let scene = Scene::new([6, 5, 4], Filling::Random, 4.0);
    let medium = scene.medium(gpu);
    let found = output(gpu, "isotropic_residual", json!({}), &[("medium", &medium)]);
    assert!(states(gpu, &found)[0].data.iter().all(|state| *state == glam::DVec4::ZERO));
    assert_eq!(found.get::<Residual>().balance, [1.0; 3]);
}

#[test]
fn packs_of_beams_beyond_a_column_are_found() {
    // An atlas has room for 2048 corners along z on every device: with 1300 of them one pack a column.
    let Some(gpu) = gpu() else { return };
    let n_z = gpu.max_texture_3d() as usize * 5 / 8;
    let scene = Scene::new([3, 3, n_z], Filling::Random, 2.0);
    let medium = scene.medium(gpu);
    let five: Vec<Beam> = suns(false).into_iter().chain(suns(false)).take(5).collect();
    let beams = scene.propagate(gpu, &medium, &five, [0.0; 3]);
    let atlas: &TauAtlas = beams.get::<Beams>().tau.as_ref().unwrap();
    assert_eq!(atlas.packs_per_column, 1);
    assert_eq!(atlas.origin(1), [0, 4, 0]);
    let taus = taus(gpu, beams.get());
    assert_eq!(taus[0], taus[3]);
    assert_eq!(taus[1], taus[4]);
    let expected = oracle_sources(gpu, &scene, 0, beams.get());
    let found: Vec<f64> = gpu_sources(gpu, &medium, &beams)[0].data.iter().map(|q| q.x).collect();
    assert_close("q0", &found, &expected.q0.data, 1e-5, 1e-12);
}

#[test]
fn no_grid_has_too_many_sums() {
    for n_lines in [1, 1024, 1025, 140_000, 67_107_840, 67_107_841, 400_000_000] {
        let per_sum = lines_per_sum(n_lines);
        assert!(per_sum >= 1024 && n_lines.div_ceil(per_sum) <= 65_535, "{n_lines}: {per_sum}");
    }
}

#[test]
fn v_cycles_take_no_number_of_sweeps() {
    let Some(gpu) = gpu() else { return };
    let medium = Scene::new([3, 3, 3], Filling::Random, 1.0).medium(gpu);
    for name in ["sweeps", "coarse_sweeps"] {
        let solve = |quality: &str| {
            run(gpu, "isotropic_residual", json!({ "quality": quality, name: 3 }), &[("medium", &medium)])
        };
        let error = solve("thick").unwrap_err().to_string();
        assert!(error.starts_with(&format!("{name} = 3: quality thick")), "{error}");
        assert!(solve("default").is_ok());
    }
}

#[test]
fn layouts_are_those_of_the_shaders() {
    let lobes = [("lobes", "true"), ("walls", "true")];
    assert_layout::<ChannelTexel>("isotropic_residual/sweep.wgsl", "Channel", &lobes);
    assert_layout::<LevelParams>("isotropic_residual/sweep.wgsl", "Level", &lobes);
    assert_layout::<DirectionTexel>("isotropic_residual/sweep.wgsl", "Direction", &lobes);
    assert_layout::<BatchParams>("isotropic_residual/sweep.wgsl", "Batch", &lobes);
    assert_layout::<LineSumParams>("isotropic_residual/line_sum.wgsl", "LineSumParams", &[]);
    let constant = |name: &str, constant: &str| {
        wgsl_constant(&Shader::expand(&format!("isotropic_residual/{name}.wgsl"), &[]).unwrap(), constant)
            .unwrap()
    };
    assert_eq!(constant("line_sum", "THREADS"), [THREADS_OF_A_SUM as f64]);
    assert_eq!(constant("source_sum", "EDGE"), [COLUMNS_OF_A_SUM as f64]);
    assert_layout::<BalanceParams>("isotropic_residual/balance.wgsl", "BalanceParams", &[]);
    assert_layout::<SourceParams>(
        "isotropic_residual/sources.wgsl",
        "SourceParams",
        &[("pack", "4"), ("emission", "true"), ("grey", "true"), ("returns", "true")],
    );
    let format = [("format", "r32float")];
    assert_layout::<solver::RestrictParams>("isotropic_residual/restrict.wgsl", "RestrictParams", &format);
}

mod power;
mod walls;
