//! Surfaces in the index space of a medium, as shaders walk them (`shaders/lib/bvh.wgsl`).

use glam::Vec3;

use crate::geometry::Mesh;
use crate::geometry::bvh::Bvh;
use crate::gpu::{Bind, Buffer, Gpu, GpuError};
use crate::mirror;
use crate::volume::Lattice;

mirror! {
    /// `SurfaceNode` of `shaders/lib/bvh.wgsl`.
    pub struct SurfaceNode {
        /// Least corner.
        low: [f32; 3],
        /// The first triangle of a leaf, or the node after all below this one.
        first_or_skip: u32,
        /// Greatest corner.
        high: [f32; 3],
        /// 0: no leaf.
        n_triangles: u32,
    }
}

mirror! {
    /// `SurfaceTriangle` of `shaders/lib/bvh.wgsl`.
    pub struct SurfaceTriangle {
        /// A corner, and the red reflectance.
        a: [f32; 4],
        /// A corner, and the green reflectance.
        b: [f32; 4],
        /// A corner, and the blue reflectance.
        c: [f32; 4],
    }
}

/// All triangles of many meshes under one tree. Where there are none, a tree that no ray enters.
pub struct Surfaces {
    nodes: Buffer,
    triangles: Buffer,
    /// Corners of the triangles in index space, in the order in which shaders number them.
    pub corners: Vec<[Vec3; 3]>,
    /// Their reflectances.
    reflectances: Vec<[f32; 3]>,
}

/// A box that no ray meets: what stands where there are no surfaces.
const NOWHERE: SurfaceNode = SurfaceNode { low: [1.0; 3], first_or_skip: 1, high: [-1.0; 3], n_triangles: 0 };
/// Corners further than this from the medium's first cell would overflow products of f32 [cells].
const FARTHEST: f32 = 1e9;
const REMEDY: &str = "use a mesh of fewer triangles";

impl Surfaces {
    /// The triangles of these meshes in the index space of a lattice.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room, or a corner is further than 1e9 cells from the medium.
    pub fn new(gpu: &Gpu, lattice: &Lattice, meshes: &[&Mesh]) -> Result<Self, GpuError> {
        let index_from_world = lattice.index_from_world();
        let mut corners: Vec<[Vec3; 3]> = Vec::new();
        let mut reflectances: Vec<[f32; 3]> = Vec::new();
        for mesh in meshes {
            let positions: Vec<Vec3> =
                mesh.positions.iter().map(|p| index_from_world.transform_point3(*p).as_vec3()).collect();
            let farthest = positions.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
            if farthest > FARTHEST {
                return Err(GpuError::TooLarge {
                    what: "a surface".to_owned(),
                    need: format!("{farthest:e} cells from the medium"),
                    limit: format!("{FARTHEST:e}"),
                    remedy: "move or scale the mesh towards the medium".to_owned(),
                });
            }
            corners.extend(mesh.triangles.iter().map(|t| t.map(|n| positions[n as usize])));
            reflectances.resize(corners.len(), mesh.reflectance.map(|share| share as f32));
        }
        Self::under_a_tree(gpu, &corners, &reflectances)
    }

    /// The same surfaces in pieces: triangles, and the number of the triangle that each is of.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn divided(&self, gpu: &Gpu, pieces: &[([Vec3; 3], u32)]) -> Result<Self, GpuError> {
        let corners: Vec<[Vec3; 3]> = pieces.iter().map(|(corners, _)| *corners).collect();
        let reflectances: Vec<[f32; 3]> =
            pieces.iter().map(|(_, whole)| self.reflectances[*whole as usize]).collect();
        Self::under_a_tree(gpu, &corners, &reflectances)
    }

    fn under_a_tree(gpu: &Gpu, corners: &[[Vec3; 3]], reflectances: &[[f32; 3]]) -> Result<Self, GpuError> {
        let bvh = Bvh::new(corners);
        let node = |node: &crate::geometry::bvh::Node| SurfaceNode {
            low: node.low.to_array(),
            first_or_skip: if node.n_triangles > 0 { node.first } else { node.skip },
            high: node.high.to_array(),
            n_triangles: node.n_triangles,
        };
        let corners: Vec<[Vec3; 3]> = bvh.order.iter().map(|n| corners[*n as usize]).collect();
        let reflectances: Vec<[f32; 3]> = bvh.order.iter().map(|n| reflectances[*n as usize]).collect();
        let triangle = |([a, b, c], [red, green, blue]): (&[Vec3; 3], &[f32; 3])| SurfaceTriangle {
            a: a.extend(*red).to_array(),
            b: b.extend(*green).to_array(),
            c: c.extend(*blue).to_array(),
        };
        let nodes: Vec<SurfaceNode> = bvh.nodes.iter().map(node).collect();
        let triangles: Vec<SurfaceTriangle> = corners.iter().zip(&reflectances).map(triangle).collect();
        // A shader's arrays have at least one element.
        let (nodes, triangles) = match triangles.len() {
            0 => (vec![NOWHERE], vec![bytemuck::Zeroable::zeroed()]),
            _ => (nodes, triangles),
        };
        Ok(Self {
            nodes: gpu.buffer_from("boxes of surfaces", &nodes, REMEDY)?,
            triangles: gpu.buffer_from("triangles of surfaces", &triangles, REMEDY)?,
            corners,
            reflectances,
        })
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// For a stage: `surface_nodes`, then `surface_triangles`.
    pub fn binds(&self) -> [Bind<'_>; 2] {
        [Bind::Buffer(&self.nodes), Bind::Buffer(&self.triangles)]
    }

    /// Share of the light that a triangle sends back.
    pub fn reflectance(&self, triangle: u32) -> [f32; 3] {
        self.reflectances[triangle as usize]
    }

    /// On the GPU.
    pub fn bytes(&self) -> u64 {
        self.nodes.bytes() + self.triangles.bytes()
    }
}
