use std::f64::consts::PI;

use glam::DVec3;

use super::*;
use crate::nodes::isotropic_residual::oracle::Sources;
use crate::nodes::isotropic_residual::oracle::sweep::flux_of;
use crate::nodes::oracle_scene::{OracleMedium, constant_light};
use crate::optics::directions::LineSet;

const ALL: [Quality; 5] =
    [Quality::Draft, Quality::Fast, Quality::Default, Quality::Thick, Quality::Reference];

/// A lumpy medium, lit from −z through its bounding box, with a source that points to +z.
fn lumpy(dims: [usize; 3], tau: f64, albedo: f64, g: f64) -> Level {
    let h = 1.0 / dims[2] as f64;
    let lump = |[x, y, z]: [usize; 3]| {
        let p = DVec3::new(x as f64, y as f64, z as f64) * h;
        1.0 + 0.9 * (7.0 * p.x + 2.0).sin() * (5.0 * p.y).cos() * (9.0 * p.z + 1.0).sin()
    };
    let sigma_t = Field::from_fn(dims, |index| tau * lump(index));
    let medium = OracleMedium { sigma_t, h, albedo, g };
    let mut sources = Sources::new(dims, 0.0);
    let scaled = medium.scaled();
    sources.q0 = Field::from_fn(dims, |index| {
        let depth = tau * scaled.k * h * index[2] as f64;
        tau * lump(index) * scaled.sigma_s_ratio * (-depth).exp()
    });
    sources.q1 = sources.q0.map(|q| DVec3::Z * (scaled.g_star * q));
    Level::new(&medium, sources)
}

/// Σ|Δphi|/Σphi.
fn difference(a: &Field<DVec4>, b: &Field<DVec4>) -> f64 {
    change(a, b)
}

#[test]
fn power_out_is_power_in_at_every_quality() {
    // The factor makes it so; what is tested is that the balance is of the state returned: the
    // absorbed power is summed anew. Sums of 2048 positive terms.
    for quality in ALL {
        let mut level = lumpy([8, 16, 16], 6.0, 0.9, 0.6);
        level.sources.ambient = 0.1;
        let solution = solve(level.clone(), quality.options());
        let balance = solution.balance;
        assert!((balance.incoming() / balance.outgoing() - 1.0).abs() < 1e-12, "{quality:?}");
        let taken: f64 = (solution.state.data.iter().zip(&level.sigma_t.data))
            .map(|(light, t)| light.x * t * level.scaled.sigma_a_ratio * level.h.powi(3))
            .sum();
        assert!((taken / balance.absorbed - 1.0).abs() < 1e-12, "{quality:?}");
        assert!((balance.entering / (0.1 * PI * 4.0) - 1.0).abs() < 0.1);
        for light in &solution.state.data {
            assert!(light.x >= 0.0 && flux_of(*light).length() <= light.x * (1.0 + 1e-6));
        }
    }
}

#[test]
fn extremes_stay_finite_and_balanced() {
    // Two grids, a quarter of the cells 1e4 times thinner; sums of a thousand positive terms.
    for tau_per_cell in [1e-6, 1.0, 1e4] {
        for (albedo, g) in [(0.0, 0.0), (0.5, -0.99), (1.0, -0.99), (1.0, 0.999), (0.999, 0.85)] {
            let mut level = lumpy([10, 10, 10], 10.0 * tau_per_cell, albedo, g);
            for idx in (0..1000).step_by(4) {
                level.sigma_t.data[idx] *= 1e-4;
            }
            level.sources.ambient = 1e-3;
            for quality in [Quality::Draft, Quality::Default, Quality::Thick] {
                for scheme in [Scheme::Diamond, Scheme::LinearSource] {
                    let options = Options { scheme, ..quality.options() };
                    let solution = solve(level.clone(), options);
                    let what = format!("tau {tau_per_cell} albedo {albedo} g {g} {options:?}");
                    let balance = solution.balance;
                    let error = balance.incoming() / balance.outgoing() - 1.0;
                    assert!(error.abs() < 1e-12, "{what}: {error}");
                    for light in &solution.state.data {
                        let flux = flux_of(*light).length();
                        assert!(light.x.is_finite() && light.x >= 0.0, "{what}: {light}");
                        assert!(flux <= light.x * (1.0 + 1e-6), "{what}: {light}");
                    }
                }
            }
        }
    }
}

#[test]
fn constant_environment_is_seen_everywhere_at_albedo_one() {
    // What is left is the convergence of each quality, measured with g −0.5, the slowest: 0.110,
    // 0.031, 0.0013, 1e-10, 1e-11; each a third more here.
    let tolerances = [0.15, 0.04, 0.0018, 2e-10, 2e-11];
    for (quality, tolerance) in ALL.into_iter().zip(tolerances) {
        for g in [-0.5, 0.0, 0.85] {
            let mut level = lumpy([16, 16, 16], 5.0, 1.0, g);
            level.sources = Sources::new([16, 16, 16], 0.5);
            let solution = solve(level, quality.options());
            let error = difference(&solution.state, &constant_light([16, 16, 16], 0.5));
            assert!(error < tolerance, "{quality:?} g {g}: {error}");
        }
    }
}

#[test]
fn qualities_approach_the_reference() {
    // Measured: 0.098, 0.0058, 2.4e-5, 7e-7; thick: 0.68, 0.56, 0.39, 0.14. A third more here.
    for (tau, albedo, g, tolerances) in
        [(2.0, 0.9, 0.5, [0.13, 0.008, 3.5e-5, 1e-6]), (40.0, 1.0, 0.0, [0.9, 0.75, 0.52, 0.19])]
    {
        let level = lumpy([16, 16, 16], tau, albedo, g);
        let reference = solve(level.clone(), Quality::Reference.options());
        assert!(reference.change < 1e-5, "{}", reference.change);
        let last = reference.factors[reference.factors.len() - 1];
        assert!((last - 1.0).abs() < 1e-4, "{last}");
        for (quality, tolerance) in ALL.into_iter().zip(tolerances) {
            let error = difference(&solve(level.clone(), quality.options()).state, &reference.state);
            assert!(error < tolerance, "tau {tau} {quality:?}: {error}");
        }
    }
}

#[test]
fn reference_is_a_fixed_point_of_the_sweep() {
    let level = lumpy([16, 16, 16], 20.0, 0.999, 0.3);
    let options = Quality::Reference.options();
    let solution = solve(level.clone(), options);
    let swept = sweep(&level, &solution.state, &options.lines.directions(), options.scheme);
    // A plain sweep moves it by no more than a round's last change.
    assert!(difference(&solution.state, &swept.state) < 1e-5);
}

#[test]
fn one_sweep_is_enough_without_scattering() {
    let level = lumpy([16, 16, 8], 3.0, 0.0, 0.0);
    let mut level = level;
    level.sources = Sources::new([16, 16, 8], 1.0);
    level.sources.add_emission(&Field::filled([16, 16, 8], 2.0));
    let expected =
        sweep(&level, &constant_light([16, 16, 8], 0.0), &LineSet::Lines14.directions(), Scheme::Diamond);
    for quality in [Quality::Fast, Quality::Default, Quality::Thick, Quality::Reference] {
        let solution = solve(level.clone(), quality.options());
        // The factor is 1 to the rounding of the sums.
        assert!(difference(&solution.state, &expected.state) < 1e-13, "{quality:?}");
        assert!((solution.factors[0] - 1.0).abs() < 1e-12, "{quality:?}");
    }
}

#[test]
fn a_single_grid_gets_the_coarse_count() {
    let level = lumpy([5, 6, 7], 2.0, 0.95, 0.2);
    let options = Quality::Default.options();
    let mut state = constant_light([5, 6, 7], 0.0);
    for _ in 0..16 {
        state = sweep(&level, &state, &options.lines.directions(), options.scheme).rebalanced().0.state;
    }
    assert_eq!(solve(level, options).state, state);
}

#[test]
fn darkness_stays_dark() {
    let mut level = lumpy([16, 16, 16], 2.0, 0.9, 0.5);
    level.sources = Sources::new([16, 16, 16], 0.0);
    for quality in ALL {
        let solution = solve(level.clone(), quality.options());
        assert!(solution.state.data.iter().all(|light| *light == DVec4::ZERO), "{quality:?}");
        assert!(solution.factors.iter().all(|factor| *factor == 1.0), "{quality:?}");
    }
}

#[test]
fn is_linear_in_the_power() {
    // Powers of two only move exponents.
    let level = lumpy([16, 16, 16], 4.0, 0.9, 0.7);
    let mut brighter = level.clone();
    brighter.sources.q0.data.iter_mut().for_each(|q| *q *= 1024.0);
    brighter.sources.q1.data.iter_mut().for_each(|q| *q *= 1024.0);
    for quality in [Quality::Default, Quality::Thick] {
        let one = solve(level.clone(), quality.options()).state;
        let other = solve(brighter.clone(), quality.options()).state;
        for (a, b) in one.data.iter().zip(&other.data) {
            assert_eq!(*a * 1024.0, *b, "{quality:?}");
        }
    }
}

#[test]
fn is_the_same_turned_by_90_degrees() {
    // (x, y, z) → (−y, x, z) and → (z, x, y). Sums run in another order: 1e-12 of phi.
    let dims = [16, 8, 24];
    let level = lumpy(dims, 4.0, 0.9, 0.7);
    let options = Quality::Default.options();
    let options = Options { scheme: Scheme::LinearSource, ..options };
    let straight = solve(level.clone(), options).state;
    type Turn = (fn([usize; 3]) -> [usize; 3], fn(DVec3) -> DVec3, [usize; 3]);
    let turns: [Turn; 2] = [
        (|[x, y, z]| [y, 7 - x, z], |v| DVec3::new(-v.y, v.x, v.z), [8, 16, 24]),
        (|[x, y, z]| [y, z, x], |v| DVec3::new(v.z, v.x, v.y), [24, 16, 8]),
    ];
    for (source_of, turn, dims) in turns {
        let mut turned = level.clone();
        turned.sigma_t = Field::from_fn(dims, |index| level.sigma_t.at(source_of(index)));
        turned.sources.q0 = Field::from_fn(dims, |index| level.sources.q0.at(source_of(index)));
        turned.sources.q1 = Field::from_fn(dims, |index| turn(level.sources.q1.at(source_of(index))));
        let solution = solve(turned, options).state;
        for (idx, light) in solution.data.iter().enumerate() {
            let expected = straight.at(source_of(solution.index_of(idx)));
            assert!((light.x - expected.x).abs() < 1e-12 * expected.x);
            assert!((flux_of(*light) - turn(flux_of(expected))).length() < 1e-12 * expected.x);
        }
    }
}
