//! The skeleton of a cumulus: puffs on puffs, and a coarse grid that finds the near ones.
//!
//! A cloud tower grows by thermals that carry smaller ones, so each puff carries smaller ones on
//! its upper side, 0.3 to 0.64 of its size, four generations deep; one that would hide within
//! another is left out (after Neyret, "Qualitative simulation of convective cloud formation and
//! evolution", 1997, and Bouthors and Neyret, "Modeling clouds shape", 2004). The first generation
//! is laid out by hand with jitter: a tower that leans with the wind, a lower second one, and
//! shoulders around. Lengths are the skeleton's own (module `cloud`), y is up.
//!
//! Limits: puffs of later generations are balls, also where the first are flattened to the box.
//! Tested: depth of a ball, the coarse grid against all puffs, one generation on the next.

use super::noise::{Random, stream};
use glam::Vec3;
use rayon::prelude::*;

/// How often puffs carry smaller ones, and one.
const GENERATIONS: usize = 4;

/// Shoulders around the towers' feet.
const SHOULDERS: usize = 9;

/// Cells of the coarse grid along its longest axis.
const CELLS: f32 = 64.0;

/// A ball, or an ellipsoid along the axes.
#[derive(Clone, Copy, Debug)]
pub struct Puff {
    /// Where its center is.
    pub center: Vec3,
    /// Half axes.
    pub radii: Vec3,
}

impl Puff {
    /// Depth of `p` under the surface, negative outside; exact for a ball, within a few percent
    /// of the surface for an ellipsoid.
    pub fn depth(&self, p: Vec3) -> f32 {
        let q = (p - self.center) / self.radii;
        let k = q.length();
        let slope = (q / self.radii).length();
        if slope > 0.0 { k * (1.0 - k) / slope } else { self.radii.min_element() }
    }
}

/// All puffs of the cloud in a box of half extents `half`, large ones first; those that carry
/// others reach under the height `base`, to be cut there.
pub fn grow(half: Vec3, base: f32, seed: u32) -> Vec<Puff> {
    let mut random = Random::new(seed);
    let mut all = trunk(half, &mut random);
    let mut parents = 0..all.len();
    for generation in 1..GENERATIONS {
        let children: Vec<Puff> = parents
            .clone()
            .into_par_iter()
            .flat_map_iter(|i| offspring(&all[i], generation, &mut Random::new(stream(seed, i as u32))))
            .filter(|c| {
                let visible = |p: &Puff| p.depth(c.center) < 0.45 * c.radii.x;
                c.center.y > base && all.iter().all(visible)
            })
            .collect();
        parents = all.len()..all.len() + children.len();
        all.extend(children);
    }
    all
}

/// The largest puffs: a leaning tower, a second and lower one, shoulders around.
fn trunk(half: Vec3, random: &mut Random) -> Vec<Puff> {
    let wind = flat_direction(random);
    let mut puffs = Vec::new();
    let mut add = |at: Vec3, r: f32| puffs.push(Puff { center: at * half, radii: r * half });
    let foot = -0.15 * wind;
    let tower = [(-0.6, 0.52), (-0.25, 0.46), (0.1, 0.45), (0.4, 0.41)];
    for (y, r) in tower {
        let sway = 0.08 * random.direction();
        add(foot + wind * (0.16 * (y + 0.62)) + sway + Vec3::Y * y, r * random.within(0.92, 1.08));
    }
    let side = Vec3::new(-wind.z, 0.0, wind.x) * if random.unit() < 0.5 { 1.0 } else { -1.0 };
    let second = foot + (side + 0.6 * wind).normalize() * random.within(0.46, 0.56);
    for (y, r) in [(-0.6, 0.38), (-0.3, 0.33), (-0.04, 0.27)] {
        let sway = 0.06 * random.direction();
        add(second + wind * (0.1 * (y + 0.6)) + sway + Vec3::Y * y, r * random.within(0.9, 1.1));
    }
    let mut taken: Vec<Vec3> = Vec::new();
    while taken.len() < SHOULDERS {
        let out = flat_direction(random);
        let distance = random.within(0.42, 0.8);
        let at = out * distance;
        if taken.iter().any(|o| o.distance(at) < 0.26) {
            continue;
        }
        taken.push(at);
        let y = -0.5 - 0.25 * distance + random.within(-0.08, 0.1);
        add(foot * 0.5 + at + Vec3::Y * y, random.within(0.19, 0.32));
    }
    puffs
}

fn flat_direction(random: &mut Random) -> Vec3 {
    let d = random.direction();
    Vec3::new(d.x, 0.0, d.z).normalize()
}

/// Smaller puffs on the upper side of `parent`, no two at the same place.
fn offspring(parent: &Puff, generation: usize, random: &mut Random) -> Vec<Puff> {
    let harmonic_mean = 3.0 / parent.radii.recip().element_sum();
    let size = harmonic_mean.min(1.5 * parent.radii.min_element());
    let low = if generation == 1 { -0.45 } else { -0.3 };
    let mut taken: Vec<(Vec3, f32)> = Vec::new();
    for _ in 0..60 {
        let out = random.direction();
        let (least, most) = if random.unit() < 0.25 { (0.52, 0.64) } else { (0.3, 0.5) };
        let share = random.within(least, most);
        let reach = random.within(0.8, 0.97);
        if out.y > low && taken.iter().all(|(o, s)| o.distance(out) > 0.8 * (s + share)) {
            taken.push((out * reach, share));
        }
    }
    taken
        .into_iter()
        .map(|(out, share)| Puff {
            center: parent.center + out * parent.radii,
            radii: Vec3::splat(share * size),
        })
        .collect()
}

/// What a cell of the coarse grid holds.
#[derive(Clone, Debug)]
pub enum Cell {
    /// No puff within the band: empty. Else all puffs within it, large ones first.
    Near(Vec<Puff>),
    /// One puff covers the cell deeper than the band.
    Inside,
}

/// Which puffs come near each cell of a coarse grid.
pub struct Nearby {
    low: Vec3,
    cell: f32,
    dims: [usize; 3],
    cells: Vec<Cell>,
}

impl Nearby {
    /// A grid over `low`..`high`, right for positions up to `band` outside or inside of a surface.
    pub fn new(puffs: &[Puff], low: Vec3, high: Vec3, band: f32) -> Self {
        let cell = (high - low).max_element() / CELLS;
        let dims = ((high - low) / cell).ceil().max(Vec3::ONE).to_array().map(|n| n as usize);
        let [nx, ny, nz] = dims;
        let reach = band + 0.5 * cell * 3f32.sqrt();
        let mut cells = vec![Cell::Near(Vec::new()); nx * ny * nz];
        for puff in puffs {
            let from = ((puff.center - puff.radii - reach - low) / cell).max(Vec3::ZERO).as_usizevec3();
            let to = ((puff.center + puff.radii + reach - low) / cell).max(Vec3::ZERO).as_usizevec3();
            for k in from.z..(to.z + 1).min(nz) {
                for j in from.y..(to.y + 1).min(ny) {
                    for i in from.x..(to.x + 1).min(nx) {
                        let middle = low + cell * (Vec3::new(i as f32, j as f32, k as f32) + 0.5);
                        let depth = puff.depth(middle);
                        let held = &mut cells[i + nx * (j + ny * k)];
                        if depth > reach {
                            *held = Cell::Inside;
                        } else if depth > -reach
                            && let Cell::Near(near) = held
                        {
                            near.push(*puff);
                        }
                    }
                }
            }
        }
        Self { low, cell, dims, cells }
    }

    /// What holds around `p`, which is cut to the grid.
    pub fn at(&self, p: Vec3) -> &Cell {
        let [nx, ny, nz] = self.dims;
        let last = Vec3::new(nx as f32, ny as f32, nz as f32) - 1.0;
        let at = ((p - self.low) / self.cell).clamp(Vec3::ZERO, last).as_usizevec3();
        &self.cells[at.x + nx * (at.y + ny * at.z)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_of_a_ball_and_an_ellipsoid() {
        let center = Vec3::new(0.5, -1.0, 2.0);
        let ball = Puff { center, radii: Vec3::splat(2.0) };
        for (away, depth) in [(0.0, 2.0), (0.5, 1.5), (2.0, 0.0), (5.0, -3.0)] {
            let found = ball.depth(center + away * Vec3::new(0.6, 0.0, -0.8));
            // Ten roundings of numbers up to 6.
            assert!((found - depth).abs() < 60.0 * f32::EPSILON, "{away}: {found}");
        }
        let long = Puff { center, radii: Vec3::new(3.0, 1.0, 2.0) };
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let surface = center + axis * long.radii;
            assert!(long.depth(surface).abs() < 60.0 * f32::EPSILON);
            // Along an axis the estimate is k (1 - k) / (k / r) = r - distance.
            assert!((long.depth(surface + 0.5 * axis) + 0.5).abs() < 60.0 * f32::EPSILON);
        }
    }

    #[test]
    fn children_sit_on_their_parent() {
        let parent = Puff { center: Vec3::new(0.1, 0.2, 0.3), radii: Vec3::splat(0.4) };
        let children = offspring(&parent, 2, &mut Random::new(5));
        assert!(children.len() >= 5, "{}", children.len());
        for child in children {
            let out = (child.center - parent.center) / parent.radii;
            assert!((0.79..0.98).contains(&out.length()), "{out}");
            assert!(out.y > -0.3 && (0.29..0.65).contains(&(child.radii.x / 0.4)));
        }
    }

    #[test]
    fn coarse_grid_misses_no_puff() {
        let half = Vec3::new(1.2, 0.8, 1.0);
        let (base, band) = (-0.5, 0.1);
        let puffs = grow(half, base, 9);
        assert!(puffs.len() > 300, "{}", puffs.len());
        let nearby = Nearby::new(&puffs, -half, half, band);
        let mut random = Random::new(1);
        let mut near = 0;
        for _ in 0..2000 {
            let p = half
                * Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), random.within(-1.0, 1.0));
            let deepest = |of: &[Puff]| of.iter().map(|q| q.depth(p)).fold(-band, f32::max);
            let all = deepest(&puffs);
            match nearby.at(p) {
                Cell::Inside => assert!(all > band, "{p}: {all}"),
                Cell::Near(list) => {
                    near += usize::from(!list.is_empty());
                    assert_eq!(deepest(list), all, "{p}");
                }
            }
        }
        assert!(near > 150, "{near}");
    }
}
