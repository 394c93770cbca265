//! The points of surfaces at which light is known: where the corners of triangles lie.
//!
//! Surfaces are divided until no edge is longer than the points may stand apart: two cells in the medium and
//! beside it, more with the distance from it, and more everywhere where there would be more than
//! [`POINTS`] of them. Corners within half of that distance whose surfaces face the same way share a point. Some of
//! them may lie inside of another thing, where it is dark: where one of [`CANDIDATES`] corners gets far more light
//! than the first, the point stands there. It stands a little towards the middle of its triangle: a corner often lies on another surface too, where
//! walls meet or a thing stands on the ground, and would be in its shadow or not by chance.

use std::collections::HashMap;

use glam::{IVec3, Vec3};

use crate::geometry::divide::divide;
use crate::gpu::{Buffer, Gpu};
use crate::graph::NodeError;
use crate::mirror;
use crate::wire::Surfaces;

mirror! {
    /// `SurfacePoint` of `surface_light.wgsl`.
    pub(in super::super) struct SurfacePoint {
        p: [f32; 3],
        triangle: u32,
    }
}

/// Points of all surfaces together, at most.
const POINTS: usize = 1 << 14;
/// Triangles that are added for them, at most: of a sheet there are two a point.
const PIECES: usize = 4 * POINTS;
/// How far points stand apart in the medium, at least [cells].
const LEAST_SPACING: f32 = 2.0;
/// How far corners move towards the middle of their triangle, as a share of the way. In a corner between walls
/// two cells high that is 0.02 cells, 20 times what rays do not see at their start.
const INWARD: f32 = 1.0 / 32.0;
/// Steps of a normal's component that count as facing the same way: about 20 degrees.
const FACING: f32 = 3.0;
/// Corners that a point may stand at.
const CANDIDATES: usize = 4;
/// What the first corner gets of the light of the brightest, if another is taken instead.
const HIDDEN: f32 = 0.25;
const REMEDY: &str = "use a mesh of fewer triangles";

/// Points on surfaces.
pub(super) struct Points {
    /// The triangles whose corners they are.
    pub(super) surfaces: Surfaces,
    /// Where light is to be known; at first that is at all candidates.
    pub(super) list: Buffer,
    pub(super) n_points: usize,
    /// For each triangle the points that its corners are lit as.
    pub(super) corners: Buffer,
    candidates: Vec<SurfacePoint>,
}

impl Points {
    /// For a medium of so many cells.
    pub(super) fn new(gpu: &Gpu, dims: [usize; 3], whole: &Surfaces) -> Result<Self, NodeError> {
        let mut spacing = Spacing::new(dims);
        let most = whole.corners.len() + PIECES;
        let pieces = loop {
            if let Some(pieces) = divide(&whole.corners, |p| spacing.at(p), most) {
                let triangles: Vec<_> = pieces.iter().map(|(corners, _)| *corners).collect();
                let n_points = shared(&triangles, &spacing).0.len();
                if n_points <= POINTS {
                    break pieces;
                }
                spacing.least *= 1.1 * (n_points as f32 / POINTS as f32).sqrt();
            } else {
                spacing.least *= 2.0;
            }
        };
        let surfaces = whole.divided(gpu, &pieces)?;
        let (candidates, corners) = shared(&surfaces.corners, &spacing);
        let candidates = candidates.concat();
        Ok(Self {
            n_points: candidates.len(),
            list: gpu.buffer_from("points of surfaces", &candidates, REMEDY)?,
            corners: gpu.buffer_from("corners of surfaces", &corners, REMEDY)?,
            surfaces,
            candidates,
        })
    }

    /// Each point at one of its candidates, by what arrives at them.
    pub(super) fn settled(self, gpu: &Gpu, irradiances: &Buffer) -> Result<Self, NodeError> {
        let found: Vec<[f32; 4]> = gpu.read_buffer(irradiances)?;
        // On both sides, in all channels.
        let light = |n: usize| found[2 * n..2 * n + 2].as_flattened().iter().sum::<f32>();
        let list: Vec<SurfacePoint> = (0..self.candidates.len())
            .step_by(CANDIDATES)
            .map(|first| {
                let brightest =
                    (first..first + CANDIDATES).fold(first, |a, b| if light(b) > light(a) { b } else { a });
                self.candidates[if light(first) < HIDDEN * light(brightest) { brightest } else { first }]
            })
            .collect();
        let n_points = list.len();
        Ok(Self { list: gpu.buffer_from("points of surfaces", &list, REMEDY)?, n_points, ..self })
    }

    /// An irradiance for each side of each point, none yet.
    pub(super) fn irradiances(&self, gpu: &Gpu) -> Result<Buffer, NodeError> {
        Ok(gpu.buffer("irradiances of surfaces", 32 * self.n_points as u64, REMEDY)?)
    }
}

/// How far points stand apart.
struct Spacing {
    /// In the medium [cells].
    least: f32,
    /// The medium's last cell.
    last: Vec3,
}

impl Spacing {
    fn new(dims: [usize; 3]) -> Self {
        Self { least: LEAST_SPACING, last: Vec3::from_array(dims.map(|n| n as f32 - 1.0)) }
    }

    /// By how many powers of two more than in the medium: one for each of its half diagonals of distance, and
    /// one each time that this doubles.
    fn doublings(&self, p: Vec3) -> i32 {
        let away = p.distance(p.clamp(Vec3::ZERO, self.last));
        (1.0 + away / (0.5 * self.last.length()).max(1.0)).log2().floor() as i32
    }

    fn at(&self, p: Vec3) -> f32 {
        self.least * (self.doublings(p) as f32).exp2()
    }
}

/// The points that the corners of triangles share, each with its candidates, and for each triangle those of its own.
fn shared(triangles: &[[Vec3; 3]], spacing: &Spacing) -> (Vec<[SurfacePoint; CANDIDATES]>, Vec<[u32; 4]>) {
    let mut list: Vec<[SurfacePoint; CANDIDATES]> = Vec::new();
    let mut n_members: Vec<usize> = Vec::new();
    let mut numbers: HashMap<(i32, IVec3, IVec3), u32> = HashMap::new();
    let mut corners_of = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        let [a, b, c] = *corners;
        let facing = (FACING * (b - a).cross(c - a).normalize_or_zero()).round().as_ivec3();
        let middle = (a + b + c) / 3.0;
        let [a, b, c] = corners.map(|p| {
            let point = SurfacePoint { p: (p + INWARD * (middle - p)).to_array(), triangle: triangle as u32 };
            let place = (p / (0.5 * spacing.at(p))).round().as_ivec3();
            let n = *numbers.entry((spacing.doublings(p), place, facing)).or_insert_with(|| {
                list.push([point; CANDIDATES]);
                n_members.push(0);
                list.len() as u32 - 1
            });
            // Candidates come from all members: later ones replace earlier ones, ever more rarely.
            let members = &mut n_members[n as usize];
            if members.is_power_of_two() {
                list[n as usize][1 + members.ilog2() as usize % (CANDIDATES - 1)] = point;
            }
            *members += 1;
            n
        });
        corners_of.push([a, b, c, 0]);
    }
    (list, corners_of)
}

#[cfg(test)]
pub(super) mod tests;
