//! What the nodes that look at data look at: a grid of a volume, the extinction of a medium, the optical depth of a
//! beam, or the fluence of a residual.
//!
//! Values sit at voxel centers (of a beam at the corners of cells), trilinear between them; what stands outside of the
//! voxels takes part, as it does in a medium made of them. Fields of the solver are read back whole: a texture of 64³
//! takes some milliseconds. Tested through `slice`, by fields that are known.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec3};
use half::f16;

use super::Run;
use crate::graph::{NodeError, ParamSpec, PortSpec, PortType};
use crate::optics::spectrum::luminance;
use crate::volume::{Dense, Lattice, Volume};
use crate::wire::{Beams, Medium, Residual};

/// A field of numbers.
pub(super) struct Scalar {
    /// Its voxels.
    pub dense: Arc<Dense>,
    /// What stands outside of them.
    pub outside: f64,
    /// Index coordinates of the first voxel in its file.
    pub first: IVec3,
    index_from_world: DMat4,
}

/// Inputs, of which one is wired.
pub(super) const INPUTS: &[PortSpec] = &[
    PortSpec::new("volume", PortType::Volume, "the grids").optional("another input is looked at"),
    PortSpec::new("medium", PortType::Medium, "its extinction sigma_t [1/m] on the solver's cells")
        .optional("another input is looked at"),
    PortSpec::new("beams", PortType::Beams, "the optical depth tau that one of them has come through")
        .optional("another input is looked at"),
    PortSpec::new("residual", PortType::Residual, "luminance of its fluence phi [W/m2]")
        .optional("another input is looked at"),
];

/// Which grid of the volume.
pub(super) const GRID: ParamSpec =
    ParamSpec::grid("grid", "density").doc("Name of the grid of a volume; of other inputs it says nothing.");

/// Which of the beams.
pub(super) const BEAM: ParamSpec = ParamSpec::int("beam", 0)
    .between(0.0, 1e6)
    .soft(0.0, 31.0)
    .doc("Which of the beams, from 0; of other inputs it says nothing. Where a surface hides the light, tau is the largest of elsewhere.");

/// Corners that a surface hides hold a depth that no walk gives (`shaders/lib/shadow.wgsl`).
const HIDDEN: f32 = f16::MAX.to_f32_const() - 32.0;

impl Scalar {
    /// Of the one input that is wired.
    ///
    /// # Errors
    /// Where none or both are; what the volume or the device reports.
    pub fn read(run: &Run) -> Result<Self, NodeError> {
        let wired: Vec<&str> =
            INPUTS.iter().map(|port| port.name).filter(|name| !run.inputs.values(name).is_empty()).collect();
        match *wired.as_slice() {
            ["volume"] => Self::of_grid(run.inputs.one("volume"), run.params.text("grid")),
            ["medium"] => {
                let medium: &Medium = run.inputs.one("medium");
                let values = run.gpu.read_texture(&medium.sigma_t)?;
                Ok(Self::of_cells(&medium.lattice, values))
            }
            ["beams"] => Self::of_beam(run, run.inputs.one("beams"), run.params.i64("beam") as usize),
            ["residual"] => Self::of_residual(run, run.inputs.one("residual")),
            [] => Err(NodeError::new("nothing is wired: wire a volume, medium, beams or residual")),
            [..] => Err(NodeError::new(format!("{} are all wired: keep one of them", wired.join(" and ")))),
        }
    }

    /// A number for each cell.
    fn of_cells(lattice: &Lattice, values: Vec<f32>) -> Self {
        let dense = Dense { dims: lattice.dims, values, world_from_index: lattice.world_from_index };
        Self::new(Arc::new(dense), 0.0, IVec3::ZERO)
    }

    fn of_beam(run: &Run, beams: &Beams, n: usize) -> Result<Self, NodeError> {
        let at_corners = beams.n_at_corners();
        let tau = beams.tau.as_ref().filter(|_| at_corners > 0).ok_or_else(|| {
            NodeError::new("the beams have no depths on the medium's grid: nothing scatters, or each light has a grid of its own")
        })?;
        if n >= at_corners {
            let last = at_corners - 1;
            return Err(NodeError::new(format!(
                "beam is {n}; there are 0..={last} with depths on the medium's grid"
            )));
        }
        let atlas = tau.texture.dims().map(|n| n as usize);
        let origin = tau.origin(n / tau.pack).map(|n| n as usize);
        let texels: Vec<f32> = match tau.pack {
            1 => run.gpu.read_texture(&tau.texture)?,
            _ => run.gpu.read_texture::<f16>(&tau.texture)?.into_iter().map(f32::from).collect(),
        };
        let [nx, ny, nz] = tau.corners;
        let corners = (0..nx * ny * nz).map(|idx| [idx % nx, idx / nx % ny, idx / (nx * ny)]);
        let texel = |[x, y, z]: [usize; 3]| {
            let [x, y, z] = [x + origin[0], y + origin[1], z + origin[2]];
            texels[tau.pack * (x + atlas[0] * (y + atlas[1] * z)) + n % tau.pack]
        };
        let mut values: Vec<f32> = corners.map(texel).collect();
        if beams.has_shadows {
            let largest = values.iter().copied().filter(|tau| *tau <= HIDDEN).fold(0.0, f32::max);
            values.iter_mut().filter(|tau| **tau > HIDDEN).for_each(|tau| *tau = largest);
        }
        // Corner (i, j, k) sits at (i - 1/2, j - 1/2, k - 1/2).
        let world_from_index = beams.lattice.world_from_index * DMat4::from_translation(DVec3::splat(-0.5));
        let dense = Dense { dims: tau.corners, values, world_from_index };
        Ok(Self::new(Arc::new(dense), 0.0, IVec3::ZERO))
    }

    fn of_residual(run: &Run, residual: &Residual) -> Result<Self, NodeError> {
        let n_cells: usize = residual.lattice.dims.iter().product();
        if residual.is_dark {
            return Ok(Self::of_cells(&residual.lattice, vec![0.0; n_cells]));
        }
        let texels: Vec<[f32; 4]> = run.gpu.read_texture(&residual.moments)?;
        let channels = &residual.channels;
        let n_texels = texels.len() / channels.count;
        let phi = |idx: usize| {
            let of_channel = |c: usize| f64::from(texels[idx + n_texels * (c % channels.count)][0]);
            luminance(std::array::from_fn(|c| channels.color[c] * of_channel(c))) as f32
        };
        // One cell for all, where they are the same everywhere.
        let values = match n_texels {
            1 => vec![phi(0); n_cells],
            _ => (0..n_texels).map(phi).collect(),
        };
        Ok(Self::of_cells(&residual.lattice, values))
    }

    /// A grid of a volume.
    ///
    /// # Errors
    /// What the volume reports: a name that is not there, a value that is not finite.
    pub fn of_grid(volume: &Volume, name: &str) -> Result<Self, NodeError> {
        let (dense, outside) = volume.signed_grid(name).map_err(NodeError::new)?;
        let first = volume.first_voxel(name).map_err(NodeError::new)?;
        Ok(Self::new(dense, f64::from(outside), first))
    }

    fn new(dense: Arc<Dense>, outside: f64, first: IVec3) -> Self {
        let index_from_world = dense.world_from_index.inverse();
        Self { dense, outside, first, index_from_world }
    }

    /// Index coordinates of a position in meters, 0 the first voxel.
    pub fn index_of(&self, position: DVec3) -> DVec3 {
        self.index_from_world.transform_point3(position)
    }

    /// The value at index coordinates.
    pub fn at(&self, index: DVec3) -> f64 {
        self.dense.trilinear(index, self.outside)
    }

    /// Whether index coordinates lie in a voxel.
    pub fn is_inside(&self, index: DVec3) -> bool {
        (0..3).all(|axis| index[axis] >= -0.5 && index[axis] <= self.dense.dims[axis] as f64 - 0.5)
    }

    /// The smallest and the largest value that it has anywhere.
    pub fn range(&self) -> [f64; 2] {
        let values = self.dense.values.iter().map(|value| f64::from(*value));
        values.fold([self.outside; 2], |[low, high], value| [low.min(value), high.max(value)])
    }

    /// Corners of the box of its voxels in meters.
    pub fn corners(&self) -> [DVec3; 8] {
        let last = DVec3::from_array(self.dense.dims.map(|n| n as f64 - 0.5));
        std::array::from_fn(|n| {
            let pick = |axis: usize| if n >> axis & 1 == 1 { last[axis] } else { -0.5 };
            self.dense.world_from_index.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        })
    }

    /// The middle of that box.
    pub fn center(&self) -> DVec3 {
        self.corners().into_iter().sum::<DVec3>() / 8.0
    }
}

/// The range that a parameter gives, or else the data's.
///
/// # Errors
/// Where it does not rise.
pub(super) fn range(run: &Run, of_data: [f64; 2]) -> Result<[f64; 2], NodeError> {
    if !run.params.is_set("range") {
        return Ok(of_data);
    }
    let [low, high]: [f64; 2] = run.params.vec("range");
    match low < high {
        true => Ok([low, high]),
        false => Err(NodeError::new(format!("range is [{low:?}, {high:?}]; write the smaller number first"))),
    }
}
