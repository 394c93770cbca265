//! Triangles of simple solids: turned, extruded, bent from pipe. And the GLB file that holds them.
//!
//! Edges are beveled, since an edge that is perfectly sharp never catches light. Faces are flat, so what is
//! round needs enough of them. Units: meters.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::Path;

use glam::{DMat4, DVec2, DVec3};

/// A part of an engine.
#[derive(Default)]
pub struct Solid {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl Solid {
    /// Number of its triangles.
    pub fn n_triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Takes the other one in, moved.
    pub fn add(&mut self, other: &Self, map: DMat4) {
        let first = self.positions.len() as u32;
        self.positions.extend(other.positions.iter().map(|&p| map.transform_point3(p)));
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|n| n + first)));
    }

    /// One more triangle.
    pub fn triangle(&mut self, corners: [DVec3; 3]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }

    /// A grid of points, closed along its rows where `closed`.
    fn sheet(rows: &[Vec<DVec3>], closed: bool) -> Self {
        let n = rows[0].len();
        let mut solid = Self { positions: rows.concat(), triangles: Vec::new() };
        for row in 0..rows.len() - 1 {
            for at in 0..if closed { n } else { n - 1 } {
                let next = (at + 1) % n;
                let [a, b, c, d] = [row * n + at, row * n + next, (row + 1) * n + at, (row + 1) * n + next]
                    .map(|n| n as u32);
                solid.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        solid
    }

    /// A fan over a closed outline.
    fn lid(outline: &[DVec3]) -> Self {
        let middle = outline.iter().sum::<DVec3>() / outline.len() as f64;
        let n = outline.len() as u32;
        let positions = outline.iter().copied().chain([middle]).collect();
        Self { positions, triangles: (0..n).map(|at| [at, (at + 1) % n, n]).collect() }
    }

    /// Turned around the x axis: (x, radius) from end to end, `n` faces around.
    pub fn turned(profile: &[[f64; 2]], n: usize) -> Self {
        let ring = |&[x, r]: &[f64; 2]| -> Vec<DVec3> {
            let at = |k: usize| TAU * (k as f64 + 0.5) / n as f64;
            (0..n).map(|k| DVec3::new(x, r * at(k).cos(), r * at(k).sin())).collect()
        };
        let rings: Vec<_> = profile.iter().map(ring).collect();
        Self::sheet(&rings, true)
    }

    /// A ring of round section around the x axis.
    pub fn ring(radius: f64, thickness: [f64; 2], n: usize) -> Self {
        let around = (0..=6).map(|k| TAU * f64::from(k) / 6.0);
        let profile: Vec<_> =
            around.map(|t| [0.5 * thickness[0] * t.cos(), radius + 0.5 * thickness[1] * t.sin()]).collect();
        Self::turned(&profile, n)
    }

    /// A plate in the xy plane: an outline that its middle sees all of, extruded to ±depth/2 with beveled edges.
    pub fn plate(outline: &[DVec2], depth: f64, bevel: f64) -> Self {
        let n = outline.len();
        let normal = |k: usize| (outline[(k + 1) % n] - outline[k]).perp().normalize();
        let area: f64 = (0..n).map(|k| outline[k].perp_dot(outline[(k + 1) % n])).sum();
        // Inwards by the bevel, where both edges of a corner are.
        let inner: Vec<DVec2> = (0..n)
            .map(|k| {
                let (a, b) = (normal((k + n - 1) % n), normal(k));
                outline[k] + bevel * area.signum() * (a + b) / (1.0 + a.dot(b)).max(0.3)
            })
            .collect();
        let at = |of: &[DVec2], z: f64| -> Vec<DVec3> { of.iter().map(|p| p.extend(z)).collect() };
        let h = 0.5 * depth;
        let rows = [at(&inner, -h), at(outline, bevel - h), at(outline, h - bevel), at(&inner, h)];
        let mut solid = Self::sheet(&rows, true);
        for end in [&rows[0], &rows[3]] {
            solid.add(&Self::lid(end), DMat4::IDENTITY);
        }
        solid
    }

    /// A box with beveled edges.
    pub fn block(low: [f64; 3], high: [f64; 3], bevel: f64) -> Self {
        let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
        let half = 0.5 * (high - low);
        let [x, y] = [half.x, half.y];
        let outline = [
            [bevel - x, -y],
            [x - bevel, -y],
            [x, bevel - y],
            [x, y - bevel],
            [x - bevel, y],
            [bevel - x, y],
            [-x, y - bevel],
            [-x, bevel - y],
        ];
        let mut solid = Self::default();
        let plate = Self::plate(&outline.map(DVec2::from_array), 2.0 * half.z, 0.8 * bevel);
        solid.add(&plate, DMat4::from_translation(0.5 * (low + high)));
        solid
    }

    /// A bar of this width and height between two points, its width across `side`.
    pub fn bar(from: DVec3, to: DVec3, side: DVec3, [width, height]: [f64; 2], bevel: f64) -> Self {
        let along = (to - from).normalize();
        let across = (side - along * side.dot(along)).normalize();
        let map = DMat4::from_cols(
            along.extend(0.0),
            across.extend(0.0),
            along.cross(across).extend(0.0),
            (0.5 * (from + to)).extend(1.0),
        );
        let half = 0.5 * DVec3::new((to - from).length(), width, height);
        let mut solid = Self::default();
        solid.add(&Self::block((-half).to_array(), half.to_array(), bevel), map);
        solid
    }

    /// A pipe through these points, closed at its ends.
    pub fn pipe(points: &[DVec3], radius: f64, n: usize) -> Self {
        let mut solid = Self::limb(points, &vec![radius; points.len()], n);
        let corners = solid.positions.clone();
        for end in [&corners[..n], &corners[corners.len() - n..]] {
            solid.add(&Self::lid(end), DMat4::IDENTITY);
        }
        solid
    }

    /// The same of changing radius, open at its ends.
    pub fn limb(points: &[DVec3], radii: &[f64], n: usize) -> Self {
        let last = points.len() - 1;
        let mut across = (points[1] - points[0]).any_orthonormal_vector();
        let mut rows = Vec::new();
        for (k, (&p, radius)) in points.iter().zip(radii).enumerate() {
            let along = (points[(k + 1).min(last)] - points[k.saturating_sub(1)]).normalize();
            across = (across - along * across.dot(along)).normalize();
            let other = along.cross(across);
            let ring = |t: f64| p + radius * (t.cos() * across + t.sin() * other);
            rows.push((0..n).map(|m| ring(TAU * m as f64 / n as f64)).collect::<Vec<_>>());
        }
        Self::sheet(&rows, true)
    }

    /// What lies between two outlines in the xy plane.
    pub fn between(inner: &[DVec2], outer: &[DVec2]) -> Self {
        let flat = |outline: &[DVec2]| -> Vec<DVec3> { outline.iter().map(|p| p.extend(0.0)).collect() };
        Self::sheet(&[flat(inner), flat(outer)], false)
    }

    /// The same section at several places, open at its ends.
    pub fn swept(section: &[DVec2], places: &[DMat4]) -> Self {
        let rows: Vec<Vec<DVec3>> = places
            .iter()
            .map(|place| section.iter().map(|p| place.transform_point3(p.extend(0.0))).collect())
            .collect();
        Self::sheet(&rows, false)
    }

    /// A height field over these coordinates.
    pub fn field(xs: &[f64], zs: &[f64], height: impl Fn(f64, f64) -> f64) -> Self {
        let rows: Vec<Vec<DVec3>> =
            xs.iter().map(|&x| zs.iter().map(|&z| DVec3::new(x, height(x, z), z)).collect()).collect();
        Self::sheet(&rows, false)
    }

    /// Writes a binary glTF with one mesh. Corners within 0.1 mm are one.
    ///
    /// # Panics
    /// Where there are more corners than 16 bits count.
    pub fn write_glb(&self, path: &Path) -> anyhow::Result<()> {
        let mut numbers = HashMap::new();
        let mut corners: Vec<[f32; 3]> = Vec::new();
        let mut number = |p: DVec3| {
            let place = (p * 1e4).round();
            *numbers.entry(place.to_array().map(|x| x as i64)).or_insert_with(|| {
                corners.push((place * 1e-4).as_vec3().to_array());
                corners.len() as u32 - 1
            })
        };
        let triangles: Vec<[u32; 3]> = self
            .triangles
            .iter()
            .map(|t| t.map(|n| number(self.positions[n as usize])))
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        let (low, high) = corners.iter().fold(([f32::MAX; 3], [f32::MIN; 3]), |(low, high), p| {
            let pick = |of: fn(f32, f32) -> f32, a: [f32; 3]| std::array::from_fn(|n| of(a[n], p[n]));
            (pick(f32::min, low), pick(f32::max, high))
        });
        let (corner_bytes, index_bytes) = (12 * corners.len(), 6 * triangles.len());
        let document = serde_json::json!({
            "asset": { "version": "2.0" },
            "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
            "buffers": [{ "byteLength": corner_bytes + index_bytes }],
            "bufferViews": [
                { "buffer": 0, "byteOffset": 0, "byteLength": corner_bytes },
                { "buffer": 0, "byteOffset": corner_bytes, "byteLength": index_bytes }
            ],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": corners.len(), "type": "VEC3", "min": low, "max": high },
                { "bufferView": 1, "componentType": 5123, "count": 3 * triangles.len(), "type": "SCALAR" }
            ]
        });
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut file = Vec::new();
        let n_bytes = 28 + text.len() + (corner_bytes + index_bytes).next_multiple_of(4);
        for word in [0x4654_6c67, 2, n_bytes as u32, text.len() as u32, 0x4e4f_534a] {
            file.extend(u32::to_le_bytes(word));
        }
        file.extend(text);
        for word in [(corner_bytes + index_bytes).next_multiple_of(4) as u32, 0x004e_4942] {
            file.extend(u32::to_le_bytes(word));
        }
        file.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        let short = |n: &u32| u16::try_from(*n).expect("few corners").to_le_bytes();
        file.extend(triangles.as_flattened().iter().flat_map(short));
        file.resize(file.len().next_multiple_of(4), 0);
        Ok(std::fs::write(path, file)?)
    }
}
