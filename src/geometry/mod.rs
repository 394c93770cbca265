//! Surfaces: triangle meshes from files, and the tree of boxes that rays find them by.
//!
//! A [`Mesh`] holds triangles in the world, in meters, with one diffuse reflectance; both sides count.
//! Files are read by the kept crates `tobj` and `gltf`, each behind a file of its own that says where in the
//! input something is wrong. A file's own materials, normals and texture coordinates are not read.
//! Triangles without an area are left out and counted. Tested by small files of each kind, by damage, and
//! the tree against rays that try every triangle.

pub mod bvh;
pub mod divide;
mod gltf;
mod obj;
#[cfg(test)]
pub(crate) mod oracle;

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3};

/// Triangles with one reflectance.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Corners in the world in meters.
    pub positions: Vec<DVec3>,
    /// Three positions each; every one has an area.
    pub triangles: Vec<[u32; 3]>,
    /// Share of the light that comes back, evenly in all directions, linear Rec. 709, in 0..=1.
    pub reflectance: [f64; 3],
    /// Triangles of the file that had no area.
    pub n_degenerate: usize,
}

/// Triangles as a file has them, in its own space.
struct Parts {
    positions: Vec<DVec3>,
    /// Within `positions`.
    triangles: Vec<[u32; 3]>,
}

/// Why a mesh cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The system refused to read the file.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// What the file holds is right, but not read here.
    #[error("{}: {what}: {remedy}", path.display())]
    NotSupported {
        /// The file.
        path: PathBuf,
        /// What was found.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// The file is damaged, or another kind of file.
    #[error("{}: {place}: {what}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Line, or element of the document.
        place: String,
        /// What was found, and what is allowed.
        what: String,
    },
    /// There is nothing to see.
    #[error(
        "{}: no triangle with an area ({n_degenerate} without): export faces, not only points or lines", path.display()
    )]
    Empty {
        /// The file.
        path: PathBuf,
        /// Triangles without an area.
        n_degenerate: usize,
    },
}

impl MeshError {
    fn invalid(path: &Path, place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), place: place.into(), what: what.into() }
    }

    fn not_supported(path: &Path, what: impl Into<String>, remedy: &'static str) -> Self {
        Self::NotSupported { path: path.to_owned(), what: what.into(), remedy }
    }
}

/// How the names of meshes end, as [`read`] has it.
pub const ENDINGS: &[&str] = &["obj", "gltf", "glb"];

/// Reads a mesh by its file's ending: .obj, .gltf or .glb.
///
/// # Errors
/// [`MeshError`], with the place in the file.
pub fn read(path: &Path, world_from_mesh: DMat4, reflectance: [f64; 3]) -> Result<Mesh, MeshError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let parts = match ending.as_deref() {
        Some("obj") => obj::parse(path, &bytes(path)?)?,
        Some("gltf" | "glb") => gltf::parse(path, &bytes(path)?)?,
        _ => {
            return Err(MeshError::not_supported(path, "no mesh by its ending", "use .obj, .gltf or .glb"));
        }
    };
    Mesh::new(path, parts, world_from_mesh, reflectance)
}

/// The files that [`read`] would read: this one, and of a glTF those that hold its buffers.
pub fn files(path: &Path) -> Vec<PathBuf> {
    let is_gltf = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("gltf"));
    let beside =
        if is_gltf { bytes(path).map(|file| gltf::buffer_files(path, &file)) } else { Ok(Vec::new()) };
    // What cannot be read is refused by `read`, with its reason.
    [vec![path.to_owned()], beside.unwrap_or_default()].concat()
}

fn bytes(path: &Path) -> Result<Vec<u8>, MeshError> {
    std::fs::read(path).map_err(|source| MeshError::Io { path: path.to_owned(), source })
}

/// Corners further than this from the origin are a mistake of units in meters.
const FARTHEST_M: f64 = 1e9;

impl Mesh {
    fn new(
        path: &Path,
        parts: Parts,
        world_from_mesh: DMat4,
        reflectance: [f64; 3],
    ) -> Result<Self, MeshError> {
        let positions: Vec<DVec3> =
            parts.positions.iter().map(|p| world_from_mesh.transform_point3(*p)).collect();
        // Written so that no number that is none passes.
        if let Some(idx) = positions.iter().position(|p| !p.abs().cmple(DVec3::splat(FARTHEST_M)).all()) {
            let what = format!(
                "it lies at {} m in the world, allowed are finite numbers up to {FARTHEST_M:e}: scale the mesh down",
                positions[idx]
            );
            return Err(MeshError::invalid(path, format!("vertex {idx}"), what));
        }
        let n_all = parts.triangles.len();
        let mut triangles = parts.triangles;
        triangles.retain(|corners| {
            let [a, b, c] = corners.map(|n| positions[n as usize]);
            (b - a).cross(c - a).length_squared() > 0.0
        });
        let n_degenerate = n_all - triangles.len();
        if triangles.is_empty() {
            return Err(MeshError::Empty { path: path.to_owned(), n_degenerate });
        }
        Ok(Self { positions, triangles, reflectance, n_degenerate })
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.positions.as_slice()) + size_of_val(self.triangles.as_slice())) as u64
    }
}

#[cfg(test)]
mod tests;
