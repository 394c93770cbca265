//! Triangles cut until they are as small as is asked for where they lie.
//!
//! An edge that is too long is cut in its middle; which ones are depends on the edge alone, so that two triangles
//! agree on the edge that they share and nothing opens between them. A triangle with one cut edge becomes two,
//! with two three, with three four. Tested by areas, edges and neighbors of what comes out.

use glam::Vec3;

/// Pieces in the order of the triangles, each with the number of the triangle that it is of, no edge longer than
/// `longest` at its middle, which is above 0; `None` where they were more than `most`.
pub fn divide(
    triangles: &[[Vec3; 3]],
    longest: impl Fn(Vec3) -> f32,
    most: usize,
) -> Option<Vec<([Vec3; 3], u32)>> {
    let cut = |a: Vec3, b: Vec3| {
        let middle = 0.5 * (a + b);
        (a.distance(b) > longest(middle)).then_some(middle)
    };
    let mut pieces = Vec::new();
    let mut to_cut = Vec::new();
    for (triangle, corners) in triangles.iter().enumerate() {
        to_cut.push(*corners);
        while let Some([a, b, c]) = to_cut.pop() {
            match [cut(a, b), cut(b, c), cut(c, a)] {
                [None, None, None] => pieces.push(([a, b, c], triangle as u32)),
                [Some(ab), None, None] => to_cut.extend([[a, ab, c], [ab, b, c]]),
                [None, Some(bc), None] => to_cut.extend([[b, bc, a], [bc, c, a]]),
                [None, None, Some(ca)] => to_cut.extend([[c, ca, b], [ca, a, b]]),
                [Some(ab), Some(bc), None] => to_cut.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]),
                [None, Some(bc), Some(ca)] => to_cut.extend([[bc, c, ca], [b, bc, ca], [b, ca, a]]),
                [Some(ab), None, Some(ca)] => to_cut.extend([[ca, a, ab], [c, ca, ab], [c, ab, b]]),
                [Some(ab), Some(bc), Some(ca)] => {
                    to_cut.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
                }
            }
            if pieces.len() + to_cut.len() > most {
                return None;
            }
        }
    }
    Some(pieces)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
        0.5 * (b - a).cross(c - a)
    }

    /// A bent sheet of triangles of very different sizes.
    fn sheet() -> Vec<[Vec3; 3]> {
        let at = |i: i32, j: i32| Vec3::new((i * i) as f32, (3 * j) as f32, 0.3 * (i * j) as f32);
        let squares = (0..6).flat_map(|i| (0..5).map(move |j| (i, j)));
        squares
            .flat_map(|(i, j)| {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    fn longest(p: Vec3) -> f32 {
        0.7 + 0.2 * p.distance(Vec3::new(9.0, 5.0, 0.0))
    }

    #[test]
    fn pieces_are_small_and_cover_what_they_are_of() {
        let triangles = sheet();
        let pieces = divide(&triangles, longest, 100_000).unwrap();
        assert!(pieces.len() > 10 * triangles.len(), "{}", pieces.len());
        let mut sums = vec![Vec3::ZERO; triangles.len()];
        for ([a, b, c], triangle) in &pieces {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                assert!(p.distance(*q) <= longest(0.5 * (p + q)));
            }
            sums[*triangle as usize] += normal([*a, *b, *c]);
        }
        for (sum, triangle) in sums.iter().zip(&triangles) {
            // A thousand roundings of areas up to 16.
            assert!((sum - normal(*triangle)).length() < 2e-3, "{sum} {triangle:?}");
        }
    }

    #[test]
    fn nothing_opens_between_neighbors() {
        // In a sheet an edge has two triangles, which run along it in opposite senses, or is on the rim, which
        // is straight from corner to corner: there x or y is that of a rim.
        let pieces = divide(&sheet(), longest, 100_000).unwrap();
        let bits = |p: Vec3| p.to_array().map(f32::to_bits);
        let mut senses: HashMap<_, i32> = HashMap::new();
        for ([a, b, c], _) in pieces {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if bits(p) < bits(q) {
                    *senses.entry([bits(p), bits(q)]).or_default() += 1;
                } else {
                    *senses.entry([bits(q), bits(p)]).or_default() -= 1;
                }
            }
        }
        for ([p, q], sense) in senses {
            let on_rim = |axis: usize, end: f32| [p, q].iter().all(|at| f32::from_bits(at[axis]) == end);
            let rim = on_rim(0, 0.0) || on_rim(0, 36.0) || on_rim(1, 0.0) || on_rim(1, 15.0);
            assert_eq!(
                sense.abs(),
                i32::from(rim),
                "{:?} {:?}",
                p.map(f32::from_bits),
                q.map(f32::from_bits)
            );
        }
    }

    #[test]
    fn too_many_are_none() {
        let triangles = sheet();
        let n = divide(&triangles, longest, 100_000).unwrap().len();
        assert!(divide(&triangles, longest, n).is_some());
        assert!(divide(&triangles, longest, n / 2).is_none());
        // What is small enough stays as it is.
        let whole = divide(&triangles, |_| 100.0, triangles.len()).unwrap();
        assert!(whole.iter().enumerate().all(|(n, (piece, of))| *of as usize == n && *piece == triangles[n]));
    }
}
