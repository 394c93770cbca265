//! How the optical depths to point lights are found: by walks from every corner of every cell, or on a grid of
//! distance and direction around each light.
//!
//! A walk is exact but for its samples, and costs time and memory for corners times lights. A grid costs for
//! directions times lights, whatever the cells, and blurs what is finer than its directions. So walks are taken
//! while both costs are small, and grids beyond; resolution is as the medium's cells, within a bound of memory.

use super::number;
use crate::graph::Decision;
use crate::wire::Fineness;

/// What a rule knows of the lights and the medium.
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// auto, walk or radial.
    pub scheme: &'a str,
    /// Directions along an edge that were asked for; 0: none.
    pub n_angular: usize,
    /// Nodes of a direction that were asked for; 0: none.
    pub n_radial: usize,
    /// How many lights there are.
    pub n_lights: usize,
    /// Corners of cells.
    pub n_corners: usize,
    /// Samples of a walk, the mean.
    pub samples: f64,
    /// Memory that depths at corners take.
    pub corner_bytes: u64,
    /// Cells along the longest axis of the matter.
    pub longest: usize,
    /// Distance of the farthest light in cells.
    pub farthest: f64,
    /// Whether the depths of the medium are known in closed form.
    pub is_closed: bool,
}

/// How depths are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spherical {
    /// From every corner to every light.
    Walk,
    /// On a grid around each light.
    Radial(Fineness),
}

/// Samples that all walks together may take: 3 s on two cores of a software driver.
const WALK_SAMPLES: f64 = (1u64 << 28) as f64;
/// What depths at corners may take, and what grids should.
const CORNER_BYTES: u64 = 256 << 20;
const GRID_BYTES: u64 = 128 << 20;
/// Resolutions that are chosen, the first that fits; with as many nodes along a direction.
const CHOSEN: [usize; 8] = [128, 96, 64, 48, 32, 24, 16, 8];
/// Below this resolution nothing is chosen for a small medium, but to save memory (DESIGN 6.7: 0.8 % of error).
const ENOUGH: usize = 32;
/// A light is no farther from a grid than this: distances of f32 are 1/128 of a cell apart there [cells].
pub const FARTHEST: f64 = 65_536.0;

/// The cheaper way of those that are good enough, or the one that was asked for.
///
/// # Errors
/// A grid was asked for that a light is too far away for.
pub fn spherical(points: Points, prune: bool) -> Result<(Spherical, Decision), String> {
    const RULE: &str = "spherical";
    let fineness = fineness(&points);
    let Fineness { n_angular, n_radial } = fineness;
    let n_lights = points.n_lights as f64;
    let walk_samples = n_lights * points.n_corners as f64 * points.samples;
    let way = points.longest.max(n_radial) as f64;
    let grid_samples = n_lights * ((n_angular + 2) * (n_angular + 2)) as f64 * way;
    let mib = |bytes: u64| number((bytes as f64 / f64::from(1 << 20)).ceil());
    let data = format!(
        "{} light{}; walks take {} samples and {} MiB, grids of {n_angular} x {n_angular} directions and {n_radial} distances \
         {} samples and {} MiB",
        points.n_lights,
        if points.n_lights == 1 { "" } else { "s" },
        number(walk_samples),
        mib(points.corner_bytes),
        number(grid_samples),
        mib(fineness.bytes() * points.n_lights as u64),
    );
    let walk = |reason: &str| {
        Ok((Spherical::Walk, Decision::kept(RULE, "walks to the lights", reason, data.clone())))
    };
    let radial = |reason: &str| {
        let decision = Decision::kept(RULE, "a grid around each light", reason, data.clone());
        Ok((Spherical::Radial(fineness), decision))
    };
    let asks_for_grid = points.scheme == "radial" || points.n_angular > 0 || points.n_radial > 0;
    match points.scheme {
        "walk" => walk("it was asked for"),
        _ if asks_for_grid && points.farthest > FARTHEST => Err(format!(
            "a light is {} cells away, and grids are for lights up to {FARTHEST} cells: use scheme walk, or a sun",
            number(points.farthest)
        )),
        _ if asks_for_grid => radial("it was asked for"),
        _ if !prune => walk("everything is modeled"),
        _ if points.farthest > FARTHEST => walk("a light is too far away for a grid"),
        _ if points.corner_bytes > CORNER_BYTES => radial("depths at all corners would take too much memory"),
        _ if points.is_closed => walk("a shape in closed form needs no samples"),
        _ if walk_samples <= grid_samples => walk("it is exact, and cheaper"),
        _ if walk_samples <= WALK_SAMPLES => walk("it is exact, and costs little"),
        _ => radial("walks would take too long"),
    }
}

/// What was asked for, or what fits.
fn fineness(points: &Points) -> Fineness {
    let chosen = CHOSEN.into_iter().find(|&n| {
        let one = Fineness { n_angular: n, n_radial: n };
        let is_useful = n <= points.longest.max(ENOUGH);
        is_useful && one.bytes() * points.n_lights.max(1) as u64 <= GRID_BYTES
    });
    let chosen = chosen.unwrap_or(CHOSEN[CHOSEN.len() - 1]);
    let or = |asked: usize| if asked == 0 { chosen } else { asked };
    Fineness { n_angular: or(points.n_angular), n_radial: or(points.n_radial) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: Points = Points {
        scheme: "auto",
        n_angular: 0,
        n_radial: 0,
        n_lights: 1,
        n_corners: 65 * 65 * 65,
        samples: 32.0,
        corner_bytes: 4 * 65 * 65 * 65,
        longest: 64,
        farthest: 100.0,
        is_closed: false,
    };

    fn found(points: Points) -> Spherical {
        spherical(points, true).unwrap().0
    }

    fn square(n: usize) -> Spherical {
        Spherical::Radial(Fineness { n_angular: n, n_radial: n })
    }

    #[test]
    fn few_lights_are_walked_to_and_many_have_grids() {
        assert_eq!(found(ONE), Spherical::Walk);
        let many = Points { n_lights: 256, corner_bytes: 2 * 256 * 65 * 65 * 65, ..ONE };
        assert_eq!(found(many), square(48));
        // Memory alone, though no sample is taken.
        assert_eq!(found(Points { is_closed: true, corner_bytes: 1 << 30, ..many }), square(48));
        assert_eq!(found(Points { is_closed: true, ..many }), Spherical::Walk);
        // Grids of 48³ of 256 lights take 117 MiB; of more lights each gets less.
        assert_eq!(found(Points { n_lights: 5000, corner_bytes: 1 << 30, ..many }), square(16));
        assert_eq!(spherical(many, false).unwrap().0, Spherical::Walk);
    }

    #[test]
    fn what_is_asked_for_is_done() {
        assert_eq!(found(Points { scheme: "radial", ..ONE }), square(64));
        let asked = Fineness { n_angular: 20, n_radial: 64 };
        assert_eq!(found(Points { n_angular: 20, ..ONE }), Spherical::Radial(asked));
        let many = Points { n_lights: 256, corner_bytes: 1 << 30, ..ONE };
        assert_eq!(found(Points { scheme: "walk", ..many }), Spherical::Walk);
        assert_eq!(found(Points { farthest: 1e6, ..many }), Spherical::Walk);
        let error = spherical(Points { scheme: "radial", farthest: 1e6, ..ONE }, true).unwrap_err();
        assert!(error.contains("1e6 cells away"), "{error}");
    }

    #[test]
    fn memory_is_bounded_however_many_lights() {
        for n_lights in [1, 10, 256, 1000, 20_000] {
            let fineness = fineness(&Points { n_lights, longest: 500, ..ONE });
            assert!(fineness.bytes() * n_lights as u64 <= GRID_BYTES, "{n_lights}: {fineness:?}");
        }
    }
}
