//! Spheres against Monte Carlo.

use glam::{DVec3, DVec4};

use crate::nodes::isotropic_residual::oracle::{Level, Quality, Sources, solve};
use crate::nodes::oracle_scene::corners::corner_field;
use crate::nodes::oracle_scene::{BeamLight, OracleBeam, OracleMedium};
use crate::nodes::principal_propagation::oracle::mean_irradiance;
use crate::nodes::raymarch::oracle::{MarchScene, Ray, march_through};
use crate::optics::backward::{self, Streams};
use crate::optics::peak::peak_table;
use crate::volume::field::Field;

/// Cells along an edge of the cube around the sphere.
const N: usize = 32;
/// Radius of the sphere, in cells.
const RADIUS: f64 = N as f64 / 2.0;
/// Center of the sphere, in index coordinates.
const CENTER: DVec3 = DVec3::splat(RADIUS - 0.5);

/// Where a line is inside the sphere, from `origin` on, in cells.
fn inside_sphere(origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
    let from_center = origin - CENTER;
    let b = from_center.dot(direction);
    let under_root = b * b - from_center.length_squared() + RADIUS * RADIUS;
    let half = (under_root > 0.0).then(|| under_root.sqrt())?;
    let (start, end) = ((-b - half).max(0.0), -b + half);
    (end > start).then_some([start, end])
}

/// A sphere of diameter 1 m and sigma_t = tau, lit along +z with 1 W/m²: its medium with edge
/// cells filled in part, its beam and its residual.
fn solved(g: f64, albedo: f64, tau: f64) -> (OracleMedium, Vec<OracleBeam>, Field<DVec4>) {
    let h = 1.0 / N as f64;
    let sigma_t = Field::from_fn([N; 3], |cell| {
        let center = DVec3::from_array(cell.map(|i| i as f64));
        let points = Field::from_fn([4; 3], |sub| {
            let offset = DVec3::from_array(sub.map(|i| (i as f64 + 0.5) / 4.0 - 0.5));
            f64::from((center + offset - CENTER).length() < RADIUS)
        });
        tau * points.data.iter().sum::<f64>() / 64.0
    });
    let medium = OracleMedium { sigma_t, h, albedo, g };
    let light = BeamLight::Parallel { direction: DVec3::Z, irradiance: 1.0, spread: 1.0 };
    let tau_corners = corner_field(&medium.sigma_t, |corner| tau_to_light(tau, corner));
    let mut sources = Sources::new([N; 3], 0.0);
    let mut ahead_corners = None;
    if g < 0.0 {
        let ahead = corner_field(&medium.sigma_t, |corner| depth_ahead(tau, corner));
        let mean = mean_irradiance(&tau_corners, Streams::new(albedo, g, 0.0, 0.0).kappa, DVec3::Z);
        let center = |cell: [usize; 3]| DVec3::from_array(cell.map(|i| i as f64));
        let depths = [
            Field::from_fn([N; 3], |cell| tau_to_light(tau, center(cell))),
            Field::from_fn([N; 3], |cell| depth_ahead(tau, center(cell))),
        ];
        sources.add_returning_beam(&medium, &light, &mean, depths.each_ref());
        ahead_corners = Some(ahead);
    } else {
        let mean = mean_irradiance(&tau_corners, medium.scaled().k, DVec3::Z);
        sources.add_beam(&medium, &light, &mean);
    }
    let residual = solve(Level::new(&medium, sources), Quality::Default.options()).state;
    (medium, vec![OracleBeam { light, tau_corners, ahead_corners, window: None }], residual)
}

fn tau_to_light(tau: f64, p: DVec3) -> f64 {
    let length = inside_sphere(p, DVec3::NEG_Z).map_or(0.0, |[start, end]| end - start);
    tau * length / N as f64
}

fn depth_ahead(tau: f64, p: DVec3) -> f64 {
    let length = inside_sphere(p, DVec3::Z).map_or(0.0, |[start, end]| end - start);
    tau * length / N as f64
}

/// Mean radiance over 20 × 20 parallel rays across the cube.
fn mean_radiance(
    tau: f64,
    (medium, beams, residual): &(OracleMedium, Vec<OracleBeam>, Field<DVec4>),
    view: DVec3,
) -> f64 {
    let peak_table = peak_table(medium.g);
    let backward_table = backward::table(medium.g);
    let scene = MarchScene {
        medium,
        beams,
        residual,
        emission: None,
        ambient: 0.0,
        peak_table: &peak_table,
        backward_table: &backward_table,
        step: 0.5,
        least_k: medium.scaled().k,
    };
    let across = DVec3::Y.cross(view).normalize();
    let up = view.cross(across);
    let mut sum = 0.0;
    for row in 0..20 {
        for column in 0..20 {
            let offset = |i: i32| (f64::from(i) + 0.5 - 10.0) / 20.0 * N as f64;
            let origin = CENTER + offset(row) * up + offset(column) * across - 3.0 * N as f64 * view;
            let ray = Ray { origin, direction: view };
            let seen = march_through(
                &scene,
                &ray,
                inside_sphere(origin, view),
                |_| tau,
                |_, p| tau_to_light(tau, p),
            );
            sum += seen.radiance();
        }
    }
    sum / 400.0
}

#[test]
fn shine_as_monte_carlo_says() {
    // g, albedo, tau, mean radiance seen along the light, obliquely, across and against it; the
    // references' standard errors are below 0.7 %.
    let references = [
        (0.0, 0.95, 0.5, [0.016609, 0.016547, 0.016407, 0.016249]),
        (0.0, 0.95, 2.0, [0.045417, 0.043722, 0.040070, 0.035134]),
        (0.5, 0.95, 0.5, [0.004421, 0.005323, 0.009692, 0.087929]),
        (0.5, 1.0, 2.0, [0.018947, 0.021555, 0.032555, 0.163821]),
        (0.5, 1.0, 10.0, [0.070093, 0.066856, 0.061344, 0.052501]),
        (0.5, 0.5, 10.0, [0.007421, 0.007331, 0.007924, 0.010309]),
        (0.9, 0.95, 2.0, [0.002164, 0.002747, 0.006000, 4.447957]),
        (0.9, 1.0, 10.0, [0.014538, 0.017397, 0.031386, 1.101970]),
        (-0.3, 0.95, 2.0, [0.086911, 0.058919, 0.034311, 0.023512]),
        (-0.5, 0.95, 2.0, [0.173426, 0.061922, 0.026798, 0.023958]),
        (-0.5, 0.95, 10.0, [0.223908, 0.084179, 0.032993, 0.006527]),
        (-0.8, 0.95, 2.0, [1.216885, 0.037434, 0.011682, 0.083419]),
    ];
    let oblique = DVec3::new(1.0, 0.0, 1.0).normalize();
    for (g, albedo, tau, means) in references {
        let sphere = solved(g, albedo, tau);
        // The figures that the solver must keep at 32 cells: views from the lit side and across,
        // |g| ≤ 0.5 and above; the dark side, thin and thick, which 32 cells keep the less the more light turns back.
        let lit = if g.abs() > 0.5 { 0.06 } else { 0.015 };
        let dark = match tau > 2.0 {
            true if g < 0.0 => 0.12,
            true => 0.09,
            false if g < -0.5 => 0.06,
            false => 0.015,
        };
        let views = [(DVec3::Z, lit), (oblique, lit), (DVec3::X, lit), (DVec3::NEG_Z, dark)];
        for ((view, tolerance), expected) in views.into_iter().zip(means) {
            let found = mean_radiance(tau, &sphere, view);
            let what = format!("g {g} albedo {albedo} tau {tau} view {view}");
            assert!((found / expected - 1.0).abs() < tolerance, "{what}: {found} ({expected})");
        }
    }
}
