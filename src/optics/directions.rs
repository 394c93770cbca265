//! Line directions: sets of lattice vectors with weights that integrate over the sphere.
//!
//! In a grid of cubic cells the line through a cell's center along an integer vector e goes through
//! the centers of other cells, so transport along e needs no interpolation. The weights are those
//! of Lebedev's rules on the axes, edges, corners and (3,1,1) points of the cube (Lebedev 1976; the
//! sets of 6, 14, 26 and 50 points), times 4π; 8 corners alone are exact to degree 3. Sums over the
//! set: Σw = 4π, Σ w ω = 0, Σ w ω ω = 4π/3, exact. Directions come in pairs: the entry 2m + 1 is
//! the reverse of 2m. Tested by those sums and, for each set, by its degree.

use glam::{DVec3, IVec3};
use std::f64::consts::PI;

/// One direction of a set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineDirection {
    /// Step from a cell to the next along the line, in cells.
    pub e: IVec3,
    /// Weight, sr.
    pub weight: f64,
}

impl LineDirection {
    /// The direction as a unit vector.
    pub fn unit(&self) -> DVec3 {
        self.e.as_dvec3().normalize()
    }

    /// |e|: length of a step, in cell edges.
    pub fn step_length(&self) -> f64 {
        self.e.as_dvec3().length()
    }
}

/// The sets on offer, by their number of directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineSet {
    /// Corners of the cube: exact to degree 3.
    Lines8,
    /// Axes and corners: degree 5.
    Lines14,
    /// Axes, edges and corners: degree 7.
    Lines26,
    /// Axes, edges, corners and (3,1,1): degree 11.
    Lines50,
}

impl LineSet {
    /// All sets, fewest first.
    pub const ALL: [Self; 4] = [Self::Lines8, Self::Lines14, Self::Lines26, Self::Lines50];

    /// Directions of the largest set.
    pub const MOST: usize = Self::Lines50.count();

    /// Number of directions.
    pub const fn count(self) -> usize {
        match self {
            Self::Lines8 => 8,
            Self::Lines14 => 14,
            Self::Lines26 => 26,
            Self::Lines50 => 50,
        }
    }

    /// The set of `count` directions, if there is one.
    pub fn from_count(count: usize) -> Option<Self> {
        Self::ALL.into_iter().find(|set| set.count() == count)
    }

    /// The directions: corners, then axes, edges, (3,1,1), each followed by its reverse.
    pub fn directions(self) -> Vec<LineDirection> {
        // Share of 4π of one direction: corners, axes, edges, (3,1,1).
        let [corner, axis, edge, knight] = match self {
            Self::Lines8 => [1.0 / 8.0, 0.0, 0.0, 0.0],
            Self::Lines14 => [3.0 / 40.0, 1.0 / 15.0, 0.0, 0.0],
            Self::Lines26 => [9.0 / 280.0, 1.0 / 21.0, 4.0 / 105.0, 0.0],
            Self::Lines50 => [27.0 / 1280.0, 4.0 / 315.0, 64.0 / 2835.0, 14641.0 / 725_760.0],
        };
        let families: [(&[[i32; 3]], f64); 4] = [
            (&[[1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1]], corner),
            (&[[1, 0, 0], [0, 1, 0], [0, 0, 1]], axis),
            (&[[1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]], edge),
            (
                &[
                    [3, 1, 1],
                    [3, 1, -1],
                    [3, -1, 1],
                    [3, -1, -1],
                    [1, 3, 1],
                    [1, 3, -1],
                    [-1, 3, 1],
                    [-1, 3, -1],
                    [1, 1, 3],
                    [1, -1, 3],
                    [-1, 1, 3],
                    [-1, -1, 3],
                ],
                knight,
            ),
        ];
        families
            .into_iter()
            .filter(|(_, share)| *share > 0.0)
            .flat_map(|(vectors, share)| vectors.iter().map(move |e| (IVec3::from(*e), share)))
            .flat_map(|(e, share)| [e, -e].map(|e| LineDirection { e, weight: 4.0 * PI * share }))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrate_one_omega_and_omega_omega() {
        // Sums of at most 50 terms up to 4π: 50 roundings of 12.6.
        let tolerance = 50.0 * 4.0 * PI * f64::EPSILON;
        for set in LineSet::ALL {
            let directions = set.directions();
            assert_eq!(directions.len(), set.count());
            assert_eq!(LineSet::from_count(set.count()), Some(set));
            let total: f64 = directions.iter().map(|line| line.weight).sum();
            assert!((total - 4.0 * PI).abs() < tolerance, "{set:?}: {total}");
            for i in 0..3 {
                let first: f64 = directions.iter().map(|line| line.weight * line.unit()[i]).sum();
                assert!(first.abs() < tolerance, "{set:?}: {first}");
                for j in 0..3 {
                    let second: f64 =
                        directions.iter().map(|line| line.weight * line.unit()[i] * line.unit()[j]).sum();
                    let expected = if i == j { 4.0 * PI / 3.0 } else { 0.0 };
                    assert!((second - expected).abs() < tolerance, "{set:?} {i} {j}: {second}");
                }
            }
        }
        assert_eq!(LineSet::from_count(32), None);
    }

    #[test]
    fn reach_the_degree_of_their_rules() {
        // Mean of (ω·n)^p over the sphere is 1/(p+1) for even p, whatever n: p is the highest even
        // power below the degree.
        let n = DVec3::new(0.3, -0.5, 0.8).normalize();
        for (set, power) in
            [(LineSet::Lines8, 2), (LineSet::Lines14, 4), (LineSet::Lines26, 6), (LineSet::Lines50, 10)]
        {
            let mean: f64 = set
                .directions()
                .iter()
                .map(|line| line.weight / (4.0 * PI) * line.unit().dot(n).powi(power))
                .sum();
            assert!((mean * f64::from(power + 1) - 1.0).abs() < 1e-13, "{set:?}: {mean}");
            let next: f64 = set
                .directions()
                .iter()
                .map(|line| line.weight / (4.0 * PI) * line.unit().dot(n).powi(power + 2))
                .sum();
            assert!((next * f64::from(power + 3) - 1.0).abs() > 1e-6, "{set:?} is better than thought");
        }
    }

    #[test]
    fn come_in_pairs() {
        for set in LineSet::ALL {
            for pair in set.directions().chunks(2) {
                assert_eq!(pair[0].e, -pair[1].e);
                assert_eq!(pair[0].weight, pair[1].weight);
            }
        }
    }
}
