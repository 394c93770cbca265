//! What the nodes that look at data look at: a grid of a volume, or the extinction of a medium.
//!
//! Values sit at voxel centers, trilinear between them; what stands outside of the voxels takes part, as it does in a
//! medium made of them.

use std::sync::Arc;

use glam::{DMat4, DVec3, IVec3};

use super::Run;
use crate::graph::{NodeError, ParamSpec, PortSpec, PortType};
use crate::volume::{Dense, Volume};
use crate::wire::Medium;

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

/// Two inputs, of which one is wired.
pub(super) const INPUTS: &[PortSpec] = &[
    PortSpec::new("volume", PortType::Volume, "the grids").optional("the medium is looked at"),
    PortSpec::new("medium", PortType::Medium, "its extinction sigma_t [1/m] on the solver's cells")
        .optional("the volume is looked at"),
];

/// Which grid of the volume.
pub(super) const GRID: ParamSpec =
    ParamSpec::grid("grid", "density").doc("Name of the grid of the volume; of a medium it says nothing.");

impl Scalar {
    /// Of the one input that is wired.
    ///
    /// # Errors
    /// Where none or both are; what the volume or the device reports.
    pub fn read(run: &Run) -> Result<Self, NodeError> {
        match (run.inputs.maybe::<Volume>("volume"), run.inputs.maybe::<Medium>("medium")) {
            (Some(volume), None) => Self::of_grid(volume, run.params.text("grid")),
            (None, Some(medium)) => {
                let values = run.gpu.read_texture(&medium.sigma_t)?;
                let lattice = &medium.lattice;
                let dense = Dense { dims: lattice.dims, values, world_from_index: lattice.world_from_index };
                Ok(Self::new(Arc::new(dense), 0.0, IVec3::ZERO))
            }
            (None, None) => Err(NodeError::new("volume and medium are empty: wire one of them")),
            (Some(_), Some(_)) => Err(NodeError::new("volume and medium are both wired: keep one of them")),
        }
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
