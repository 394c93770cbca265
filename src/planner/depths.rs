//! How optical depths to parallel lights are found.

use super::rules::number;
use crate::graph::Decision;

/// The way to the light.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Depths {
    /// From every corner to its end.
    Walk,
    /// From slab to slab; whether so for each beam, the others are walked.
    Scan(Vec<bool>),
}

/// What the rule looks at.
#[derive(Debug, Clone, Copy)]
pub struct DepthFacts<'a> {
    /// The parameter `scheme`.
    pub asked: &'a str,
    /// Whether the medium is a shape in closed form.
    pub is_closed: bool,
    /// Of each beam, the samples of a walk from a corner, and the mean cosine around its direction of the light that it
    /// stands for.
    pub beams: &'a [(f64, f64)],
    /// Whether the device holds what a scan keeps.
    pub fits: bool,
    /// Whether the device is a software driver.
    pub is_cpu: bool,
}

/// A scan costs as much as a walk of so many samples a corner, by a software driver and by a GPU, which has a slab done
/// before it has begun the next (measured on 128 x 80 x 112 cells; the GPU was an H200: 0.225 ms a scan, 5.9 ms 64 walks of
/// 55 samples).
const SAMPLES_OF_A_SCAN: [f64; 2] = [19.0, 135.0];

/// Below this spread the light of a beam comes from so wide a region that it has no shadow finer than a cell where a
/// scan is a slab behind what casts it: a disk of 5 degrees around its direction, eight cells away 0.7 cells.
const WIDE: f64 = 0.998;

/// How far scans of wide light may change a picture, relative, as measured (`tests/planner.rs`) where cells know nothing
/// of each other and are up to 0.4 optical depths thick; it goes with that thickness. What a grid resolves, clouds of 1.2
/// a cell and a sharp checkerboard among them, changes by less than a fiftieth of it.
pub const SCAN_ERROR: f64 = 0.015;

/// The cheaper way, or the one that was asked for.
pub fn depths(facts: DepthFacts, prune: bool) -> (Depths, Decision) {
    const RULE: &str = "depths";
    let n = facts.beams.len();
    let of_a_scan = SAMPLES_OF_A_SCAN[usize::from(!facts.is_cpu)];
    let is_scanned: Vec<bool> =
        facts.beams.iter().map(|(samples, spread)| *spread < WIDE && *samples > of_a_scan).collect();
    let n_wide = facts.beams.iter().filter(|(_, spread)| *spread < WIDE).count();
    let samples = facts.beams.iter().map(|(samples, _)| samples).sum::<f64>() / n.max(1) as f64;
    let data = format!(
        "a walk takes {} samples, a scan costs as much as {of_a_scan}; {n_wide} of {n} beams wide",
        number(samples),
    );
    let walk =
        |reason: &str| (Depths::Walk, Decision::kept(RULE, "walks to the light", reason, data.clone()));
    let scan = |which, reason: &str| {
        (
            Depths::Scan(which),
            Decision::left_out(RULE, "walks all the way to the light", reason, data.clone()),
        )
    };
    match facts.asked {
        _ if facts.is_closed => walk("a shape in closed form needs no samples"),
        "scan" => scan(vec![true; n], "scans were asked for"),
        "walk" => walk("they were asked for"),
        _ if !prune => walk("everything is modeled"),
        _ if n_wide == 0 => walk("light from one direction has sharp shadows"),
        _ if !is_scanned.contains(&true) => walk("they are cheaper"),
        _ if !facts.fits => walk("the device does not hold the depths of a scan"),
        _ => scan(is_scanned, "wide light is scanned from slab to slab"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_light_is_scanned_where_that_is_cheaper() {
        let found = |asked, is_closed, beams: &[(f64, f64)], fits, prune| {
            depths(DepthFacts { asked, is_closed, beams, fits, is_cpu: true }, prune).0
        };
        let mixed = [(50.0, 0.9), (50.0, 1.0), (10.0, 0.9)];
        assert_eq!(found("auto", false, &mixed, true, true), Depths::Scan(vec![true, false, false]));
        for walked in [
            found("auto", false, &mixed, true, false),
            found("auto", false, &mixed[1..2], true, true),
            found("auto", false, &mixed[2..], true, true),
            found("auto", false, &mixed, false, true),
            found("auto", true, &mixed, true, true),
            found("walk", false, &mixed, true, true),
            found("scan", true, &mixed, true, true),
        ] {
            assert_eq!(walked, Depths::Walk);
        }
        assert_eq!(found("scan", false, &mixed[1..], true, false), Depths::Scan(vec![true; 2]));
        let facts =
            DepthFacts { asked: "auto", is_closed: false, beams: &mixed[..2], fits: true, is_cpu: true };
        let data = depths(facts, true).1.data;
        assert_eq!(data, "a walk takes 50 samples, a scan costs as much as 19; 1 of 2 beams wide");
        let on_a_gpu = DepthFacts { is_cpu: false, ..facts };
        assert_eq!(depths(on_a_gpu, true).0, Depths::Walk);
        assert_eq!(
            depths(DepthFacts { beams: &[(140.0, 0.9)], ..on_a_gpu }, true).0,
            Depths::Scan(vec![true])
        );
    }
}
