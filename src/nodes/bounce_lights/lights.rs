//! Lit sides of points become virtual lights.
//!
//! Sides are put into an order in which neighbors are near and face alike, and their powers into a row, which is cut
//! into as many equal parts as there are lights. A light has all the power of its part, per channel, so that none is lost, and
//! stands at a side of it that is drawn by power. So lights stand where much is sent back, and none is much brighter
//! than others.

use glam::DVec3;

use super::points::Random;

/// A side of a point of a surface, in index space, with the power that it sends back [W].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lit {
    pub(super) position: DVec3,
    pub(super) normal: DVec3,
    pub(super) power: [f64; 3],
}

/// At most `count` lights that send all of what these sides do; none where nothing is sent.
pub(super) fn distribute(mut sides: Vec<Lit>, count: usize, seed: u64) -> Vec<Lit> {
    let weight = |side: &Lit| side.power.iter().sum::<f64>();
    sides.retain(|side| weight(side) > 0.0);
    let low = sides.iter().fold(DVec3::INFINITY, |low, side| low.min(side.position));
    let high = sides.iter().fold(DVec3::NEG_INFINITY, |high, side| high.max(side.position));
    let size = (high - low).max_element().max(1e-30);
    sides.sort_by_cached_key(|side| (facing(side.normal), morton((side.position - low) / size)));
    let all: f64 = sides.iter().map(weight).sum();
    let mut random = Random(seed ^ 0x5bd1_e995);
    let mut lights: Vec<Lit> = Vec::new();
    let mut left = sides.iter().copied().peekable();
    // What is left of the first side, as a share of it.
    let mut rest = 1.0;
    for n in 0..count {
        let part = all / count as f64;
        let drawn = part * random.unit();
        let mut filled = 0.0;
        let mut light: Option<Lit> = None;
        let mut power = [0.0; 3];
        while let Some(side) = left.peek().copied() {
            let here = rest * weight(&side);
            // The last light takes all, so that rounding loses nothing.
            let is_last = n + 1 == count;
            let taken = if is_last { here } else { here.min(part - filled) };
            let share = taken / weight(&side);
            power.iter_mut().zip(side.power).for_each(|(sum, p)| *sum += share * p);
            filled += taken;
            if light.is_none() && filled >= drawn {
                light = Some(side);
            }
            rest -= share;
            if taken < here {
                break;
            }
            left.next();
            rest = 1.0;
        }
        match light {
            Some(light) => lights.push(Lit { power, ..light }),
            // Rounding alone leaves a part without a side: what it has is the one before's.
            None => {
                if let Some(before) = lights.last_mut() {
                    before.power.iter_mut().zip(power).for_each(|(sum, p)| *sum += p);
                }
            }
        }
    }
    lights
}

/// Which eighth of all directions a normal is in.
fn facing(normal: DVec3) -> u32 {
    (0..3).map(|axis| u32::from(normal[axis] > 0.0) << axis).sum()
}

/// Place along a curve that keeps neighbors together, of a point in 0..=1.
fn morton(at: DVec3) -> u64 {
    let bits = at.to_array().map(|x| (x.clamp(0.0, 1.0) * 1023.0) as u64);
    (0..10)
        .flat_map(|bit| (0..3).map(move |axis| (bit, axis)))
        .fold(0, |key, (bit, axis)| key | (bits[axis] >> bit & 1) << (3 * bit + axis))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sides(n: usize) -> Vec<Lit> {
        let mut random = Random(3);
        (0..n)
            .map(|idx| Lit {
                position: DVec3::new(random.unit(), random.unit(), random.unit()) * 20.0,
                normal: if idx % 2 == 0 { DVec3::Z } else { DVec3::NEG_X },
                // A third is dark.
                power: [(); 3].map(|()| if idx % 3 == 0 { 0.0 } else { random.unit().powi(3) }),
            })
            .collect()
    }

    #[test]
    fn no_power_is_lost_or_made() {
        for (n, count) in [(1000, 64), (1000, 1), (5, 64), (2, 1), (1000, 1000)] {
            let sides = sides(n);
            let lights = distribute(sides.clone(), count, 9);
            assert!(lights.len() <= count && !lights.is_empty(), "{n} {count}: {}", lights.len());
            for c in 0..3 {
                let sum = |list: &[Lit]| list.iter().map(|side| side.power[c]).sum::<f64>();
                // A thousand sums of f64.
                assert!((sum(&lights) / sum(&sides) - 1.0).abs() < 1e-12, "{n} {count}");
            }
            for light in &lights {
                let side = sides.iter().find(|side| side.position == light.position).unwrap();
                assert_eq!(side.normal, light.normal);
                assert!(side.power != [0.0; 3], "a light in the dark");
            }
        }
    }

    #[test]
    fn darkness_has_no_lights() {
        assert!(distribute(Vec::new(), 8, 1).is_empty());
        assert!(distribute(vec![Lit { power: [0.0; 3], ..sides(1)[0] }], 8, 1).is_empty());
    }

    #[test]
    fn lights_are_alike_and_stay_in_their_part() {
        let lights = distribute(sides(3000), 32, 4);
        let sums: Vec<f64> = lights.iter().map(|light| light.power.iter().sum()).collect();
        assert!(sums.iter().all(|sum| (sum / sums[0] - 1.0).abs() < 1e-9), "{sums:?}");
        assert_eq!(lights.len(), 32);
    }
}
