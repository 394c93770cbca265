//! Few beams in place of many, for a glance at who hides what.
//!
//! Parallel beams are merged, the two of the closest directions first, until [`FEW`] are left: powers add up, so
//! that the irradiance of all together stays, and the direction is their mean by power. Tested by the sum, and by
//! beams that stay what they are.

use glam::DVec3;

use crate::optics::spectrum::luminance;
use crate::wire::{Beam, Place};

/// Parallel beams that are left.
const FEW: usize = 6;

/// The same light as few beams; lamps, which have a place, stay.
pub(super) fn few(beams: &[Beam]) -> Vec<Beam> {
    // Direction times luminance, and power.
    let mut merged: Vec<(DVec3, [f64; 3])> = Vec::new();
    let mut lamps = Vec::new();
    for beam in beams {
        match beam.place {
            Place::Parallel(direction) => merged.push((luminance(beam.power) * direction, beam.power)),
            Place::Point(_) => lamps.push(*beam),
        }
    }
    merged.retain(|(flow, _)| flow.length() > 0.0);
    while merged.len() > FEW {
        let pairs = (0..merged.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
        let closeness = |a: usize, b: usize| merged[a].0.normalize().dot(merged[b].0.normalize());
        let (a, b) = pairs
            .max_by(|p, q| closeness(p.0, p.1).total_cmp(&closeness(q.0, q.1)))
            .expect("there are more than a few");
        let (flow, power) = merged.swap_remove(b);
        merged[a].0 += flow;
        for (sum, power) in merged[a].1.iter_mut().zip(power) {
            *sum += power;
        }
    }
    let parallel = merged.into_iter().filter_map(|(flow, power)| {
        let direction = flow.try_normalize()?;
        Some(Beam { place: Place::Parallel(direction), power, a0: 1.0, window: None, facing: None })
    });
    parallel.chain(lamps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nodes::testing::{Random, point, sun};

    #[test]
    fn few_beams_have_the_power_of_many() {
        let mut random = Random(3);
        let mut many: Vec<Beam> = (0..40).map(|n| sun(random.direction(), f64::from(n))).collect();
        many.push(point(DVec3::X, 5.0));
        let few = few(&many);
        assert_eq!(few.len(), FEW + 1);
        assert_eq!(few[FEW], many[40]);
        let sum = |beams: &[Beam]| beams.iter().map(|beam| beam.power[1]).sum::<f64>();
        // 40 sums of whole numbers.
        assert_eq!(sum(&few), sum(&many));
    }

    #[test]
    fn what_is_few_stays_and_what_is_close_merges() {
        let suns = [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z].map(|direction| sun(direction, 2.0));
        assert_eq!(few(&suns).len(), 4);
        let mut more = suns.to_vec();
        more.extend([0.9, 1.0, 1.1].map(|y| sun(DVec3::new(-1.0, y, -1.0), 1.0)));
        let merged = few(&more);
        assert_eq!(merged.len(), FEW);
        assert!(suns.iter().all(|sun| merged.iter().any(|beam| beam.place == sun.place)), "{merged:?}");
    }
}
