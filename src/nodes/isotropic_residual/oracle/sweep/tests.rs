use std::f64::consts::PI;

use super::*;
use crate::nodes::isotropic_residual::oracle::Sources;
use crate::nodes::oracle_scene::{OracleMedium, constant_light};
use crate::optics::directions::LineSet;

/// Numbers in 0..1 from a seed (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A vector of the given length.
    fn vector(&mut self, length: f64) -> DVec3 {
        let v = DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5);
        v.normalize_or(DVec3::X) * length
    }
}

#[derive(Clone, Copy, Debug)]
enum Structure {
    Homogeneous,
    Random,
    /// 1 : 1e4.
    Binary,
    /// A third of the cells is void, and some of those emit.
    Holes,
}

fn level(structure: Structure, tau_per_cell: f64, albedo: f64, g: f64, random: &mut Random) -> Level {
    let dims = [5, 3, 4];
    let h = 0.3;
    let sigma_t = Field::from_fn(dims, |_| {
        let thickness = match structure {
            Structure::Homogeneous => 1.0,
            Structure::Random => random.next(),
            Structure::Binary => {
                if random.next() < 0.5 {
                    1e-4
                } else {
                    1.0
                }
            }
            Structure::Holes => {
                if random.next() < 0.33 {
                    0.0
                } else {
                    1.0
                }
            }
        };
        thickness * tau_per_cell / h
    });
    let mut sources = Sources::new(dims, random.next());
    sources.q0 = Field::from_fn(dims, |_| (random.next() - 0.3).max(0.0));
    sources.q1 = sources.q0.map(|q| {
        let cosine = 0.5 * random.next();
        random.vector(q * cosine)
    });
    Level::new(&OracleMedium { sigma_t, h, albedo, g }, sources)
}

fn random_state(dims: [usize; 3], random: &mut Random) -> Field<DVec4> {
    Field::from_fn(dims, |_| {
        let phi = 10.0 * random.next();
        let cosine = random.next();
        DVec4::from((phi, random.vector(phi * cosine)))
    })
}

/// Σ q + entering against Σ t c + leaving, over all of what a sweep carries, relative.
fn imbalance(level: &Level, state: &Field<DVec4>, swept: &Swept) -> f64 {
    let volume = level.h.powi(3);
    let (mut given, mut taken) = (swept.balance.entering, swept.balance.leaving.iter().sum::<f64>());
    taken += swept.balance.into_surfaces;
    for idx in 0..state.data.len() {
        let sigma_t = level.sigma_t.data[idx];
        given += volume * sigma_t * level.scaled.sigma_s_ratio * state.data[idx].x;
        given += volume * level.sources.q0.data[idx];
        taken += volume * sigma_t * level.scaled.k * swept.state.data[idx].x;
    }
    (given - taken).abs() / given
}

#[test]
fn conserves_power_at_the_extremes() {
    // Positive sums of 60 cells × 50 directions with some ten roundings a term, which average out:
    // 1e-12 is 4500 ulps.
    for seed in 0..3 {
        let mut random = Random(seed);
        for structure in [Structure::Homogeneous, Structure::Random, Structure::Binary, Structure::Holes] {
            for tau_per_cell in [1e-6, 1e-2, 0.7, 3.0, 100.0, 1e4] {
                for (albedo, g) in [(0.0, 0.3), (0.5, -0.99), (0.99, 0.85), (1.0, 0.0), (1.0, 0.999)] {
                    for scheme in [Scheme::Diamond, Scheme::LinearSource] {
                        let set = LineSet::ALL[(random.next() * 4.0) as usize];
                        let level = level(structure, tau_per_cell, albedo, g, &mut random);
                        let state = random_state(level.sigma_t.dims, &mut random);
                        let swept = sweep(&level, &state, &set.directions(), scheme);
                        let what = format!(
                            "seed {seed} {structure:?} tau {tau_per_cell} albedo {albedo} g {g} \
                             {scheme:?} {set:?}"
                        );
                        let error = imbalance(&level, &state, &swept);
                        assert!(error < 1e-12, "{what}: {error}");
                        for light in &swept.state.data {
                            let (phi, flux) = (light.x, flux_of(*light).length());
                            assert!(phi >= 0.0 && phi.is_finite(), "{what}: {light}");
                            assert!(flux <= phi * (1.0 + 1e-6), "{what}: {light}");
                        }
                        let (balanced, _) = swept.rebalanced();
                        let balance = balanced.balance;
                        let error = balance.incoming() / balance.outgoing() - 1.0;
                        assert!(error.abs() < 1e-12, "{what}: {error}");
                    }
                }
            }
        }
    }
}

#[test]
fn the_check_of_conservation_sees_an_error() {
    let mut random = Random(1);
    let level = level(Structure::Random, 1.0, 0.9, 0.5, &mut random);
    let state = random_state(level.sigma_t.dims, &mut random);
    let mut swept = sweep(&level, &state, &LineSet::Lines14.directions(), Scheme::Diamond);
    swept.state.data[7].x *= 1.0001;
    assert!(imbalance(&level, &state, &swept) > 1e-9);
}

#[test]
fn surfaces_take_what_they_stop() {
    // Through the whole grid, and a piece of one. As without surfaces, with as many more terms.
    let wall = |x: f64, z: f64| [DVec3::new(x, -9.0, z), DVec3::new(9.0, -9.0, z), DVec3::new(x, 30.0, z)];
    for scheme in [Scheme::Diamond, Scheme::LinearSource] {
        for structure in [Structure::Random, Structure::Holes] {
            let mut random = Random(3);
            let level = level(structure, 1.0, 0.9, 0.5, &mut random);
            let state = random_state(level.sigma_t.dims, &mut random);
            let level = level.behind(vec![wall(-90.0, 1.2), wall(2.1, 2.3)]);
            for set in LineSet::ALL {
                let swept = sweep(&level, &state, &set.directions(), scheme);
                assert!(swept.balance.into_surfaces > 0.0);
                let error = imbalance(&level, &state, &swept);
                assert!(error < 1e-12, "{scheme:?} {structure:?} {set:?}: {error}");
            }
        }
    }
}

#[test]
fn constant_light_stays_where_nothing_is_absorbed() {
    // I = L, S = L: every rule returns L to a few roundings a cell.
    for scheme in [Scheme::Diamond, Scheme::LinearSource] {
        let mut random = Random(5);
        let mut level = level(Structure::Holes, 2.0, 1.0, 0.7, &mut random);
        level.sources = Sources::new(level.sigma_t.dims, 0.25);
        let state = constant_light(level.sigma_t.dims, 0.25);
        for set in LineSet::ALL {
            for light in sweep(&level, &state, &set.directions(), scheme).state.data {
                assert!((light.x / PI - 1.0).abs() < 1e-13, "{scheme:?} {set:?} {light}");
                assert!(flux_of(light).length() < 1e-13, "{scheme:?} {set:?} {light}");
            }
        }
    }
}

#[test]
fn without_scattering_lines_carry_the_exponential() {
    // Linear source, darkness inside: along +x the light that leaves is the sum over the lines of
    // e^{−tau}; seven roundings a line.
    let mut random = Random(11);
    let mut level = level(Structure::Random, 1.5, 0.0, 0.0, &mut random);
    let dims = level.sigma_t.dims;
    level.sources = Sources::new(dims, 2.0);
    let x = LineDirection { e: IVec3::X, weight: 0.5 };
    let swept = sweep(&level, &constant_light(dims, 0.0), &[x], Scheme::LinearSource);
    let mut expected = 0.0;
    for y in 0..dims[1] {
        for z in 0..dims[2] {
            let tau: f64 = (0..dims[0]).map(|x| level.sigma_t.at([x, y, z]) * level.h).sum();
            expected += 0.5 * level.h * level.h * 2.0 * (-tau).exp();
        }
    }
    assert!((swept.balance.leaving[1] / expected - 1.0).abs() < 1e-14);
    assert_eq!(swept.balance.leaving.iter().filter(|power| **power > 0.0).count(), 1);
    // Along (3, 1, 1) every cell of the −x, −y and −z layers starts a line.
    let knight = LineDirection { e: IVec3::new(3, 1, 1), weight: 1.0 };
    let swept = sweep(&level, &constant_light(dims, 0.0), &[knight], Scheme::LinearSource);
    let n_starts = dims.iter().product::<usize>() - 2 * 2 * 3;
    let entering = 2.0 * level.h * level.h / 11f64.sqrt() * n_starts as f64;
    assert!((swept.balance.entering / entering - 1.0).abs() < 1e-14);
}

#[test]
fn order_two_meets_the_exponential_in_second_order() {
    // A column along z without scattering: ((1 − o/2)/(1 + o/2))^n against e^{−n o}: the error of
    // the exponent is n o³/12.
    for n in [8, 16] {
        let o: f64 = 4.0 / n as f64;
        let sigma_t = Field::filled([1, 1, n], o);
        let medium = OracleMedium { sigma_t, h: 1.0, albedo: 0.0, g: 0.0 };
        let level = Level::new(&medium, Sources::new([1, 1, n], 1.0));
        let z = LineDirection { e: IVec3::Z, weight: 1.0 };
        let swept = sweep(&level, &constant_light([1, 1, n], 0.0), &[z], Scheme::Diamond);
        let exponent = -swept.balance.leaving[5].ln() - 4.0;
        let expected = n as f64 * o.powi(3) / 12.0;
        // The next term is n o⁵/80.
        assert!((exponent / expected - 1.0).abs() < 0.2 * o * o, "{n}: {exponent}");
    }
}

#[test]
fn linear_source_is_exact_for_a_source_that_is_linear() {
    // q = t S with S = 1 + z at z, from z = −½ on with S(−½) coming in: I = S − (1 − e^{−t z})/t
    // beyond the first cells, where the slope is one-sided, too: it is the same.
    let (n, t) = (6, 0.8);
    let sigma_t = Field::filled([1, 1, n], t);
    let medium = OracleMedium { sigma_t, h: 1.0, albedo: 0.0, g: 0.0 };
    let mut sources = Sources::new([1, 1, n], 0.5);
    sources.q0 = Field::from_fn([1, 1, n], |[_, _, z]| 4.0 * PI * t * (1.0 + z as f64));
    let z = LineDirection { e: IVec3::Z, weight: 1.0 };
    let level = Level::new(&medium, sources);
    let dark = constant_light([1, 1, n], 0.0);
    let swept = sweep(&level, &dark, &[z], Scheme::LinearSource);
    let length = n as f64;
    let expected = 0.5 + length - (1.0 - (-t * length).exp()) / t;
    // Six cells of some ten roundings.
    assert!((swept.balance.leaving[5] / expected - 1.0).abs() < 1e-14);
}

#[test]
fn flame_without_smoke_adds_up() {
    let dims = [4, 1, 1];
    let medium = OracleMedium { sigma_t: Field::filled(dims, 0.0), h: 0.5, albedo: 0.0, g: 0.0 };
    let mut sources = Sources::new(dims, 0.0);
    sources.add_emission(&Field::filled(dims, 3.0));
    let x = LineDirection { e: IVec3::X, weight: 1.0 };
    let level = Level::new(&medium, sources);
    let swept = sweep(&level, &constant_light(dims, 0.0), &[x], Scheme::Diamond);
    // Mean over the cells 0.75, 2.25, …; 6 leaves.
    assert!((swept.state.at([1, 0, 0]).x - 2.25).abs() < 1e-14);
    assert!((swept.balance.leaving[1] / (6.0 * 0.25) - 1.0).abs() < 1e-14);
}

#[test]
fn realizable_states_stay_and_others_are_brought_back() {
    let inside = DVec4::new(2.0, 1.0, -1.0, 0.5);
    assert_eq!(realizable(inside), inside);
    assert_eq!(realizable(DVec4::new(5.0, 0.0, 6.0, 8.0)), DVec4::new(5.0, 0.0, 3.0, 4.0));
    assert_eq!(realizable(DVec4::new(-1.0, 0.0, 3.0, 4.0)), DVec4::ZERO);
}
