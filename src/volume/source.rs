//! What a volume wire carries: named grids, from a file or made.
//!
//! Grids of a file are decoded when they are first asked for, and then kept, so that a file of 24 grids
//! costs what the graph uses, and a new albedo reads nothing again.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use glam::{DMat4, DVec3, IVec3};

use super::Dense;
use super::vdb;

/// Named grids.
pub struct Volume {
    source: Source,
    decoded: Mutex<HashMap<String, Decoded>>,
    /// After the volume's own map.
    transform: DMat4,
}

/// A grid of a file as voxels.
#[derive(Clone)]
struct Decoded {
    dense: Arc<Dense>,
    /// What stands outside of the voxels.
    background: f32,
    /// The first voxel.
    min: IVec3,
}

enum Source {
    File(vdb::File),
    Shape { dense: Arc<Dense>, evenly: Option<Evenly> },
}

/// A shape that is filled evenly: its boundary is known better than voxels tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evenly {
    /// An ellipsoid; else a box.
    pub ellipsoid: bool,
    /// Half of its extents in meters, before the volume's transform; its center is the origin.
    pub half_extent: DVec3,
}

/// Why a grid cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum VolumeError {
    /// What the file's reader says; a wrong name lists those that exist.
    #[error(transparent)]
    File(#[from] vdb::VdbError),
    /// A shape has one grid.
    #[error("no grid '{0}': a shape has one grid, 'density'")]
    NoGrid(String),
    /// The active box is too large to be held as voxels.
    #[error("grid '{name}' spans {0} x {1} x {2} voxels, more than can be held densely: crop or prune it", .size[0], .size[1], .size[2])]
    TooLarge {
        /// The grid.
        name: String,
        /// Its extent.
        size: [u64; 3],
    },
    /// Fog cannot be negative or undefined.
    #[error(
        "grid '{name}' holds {value:?} at voxel {at:?}, but an extinction is finite and at least 0: convert level sets to fog, clean the grid"
    )]
    Value {
        /// The grid.
        name: String,
        /// What was found.
        value: f32,
        /// Where, in index coordinates.
        at: [i32; 3],
    },
    /// No temperature either.
    #[error("grid '{name}' holds {value:?}, but every value is finite: clean the grid")]
    NotFinite {
        /// The grid.
        name: String,
        /// What was found.
        value: f32,
    },
    /// Fog fills all of space.
    #[error("grid '{name}' has the background {background:?}: a medium needs 0 outside of its active voxels")]
    Background {
        /// The grid.
        name: String,
        /// Its background.
        background: f32,
    },
}

/// The most voxels that are held densely: 4 GiB of them.
const MAX_VOXELS: u64 = 1 << 30;

impl Volume {
    /// The grids of a file, moved by `transform` after the file's own map.
    pub fn from_file(file: vdb::File, transform: DMat4) -> Self {
        Self { source: Source::File(file), decoded: Mutex::default(), transform }
    }

    /// One grid, `density`.
    pub fn from_shape(dense: Dense, evenly: Option<Evenly>, transform: DMat4) -> Self {
        let dense = Dense { world_from_index: transform * dense.world_from_index, ..dense };
        Self {
            source: Source::Shape { dense: Arc::new(dense), evenly },
            decoded: Mutex::default(),
            transform,
        }
    }

    /// Set for shapes that are filled evenly.
    pub fn evenly(&self) -> Option<Evenly> {
        match &self.source {
            Source::Shape { evenly, .. } => *evenly,
            Source::File(_) => None,
        }
    }

    /// The map after the volume's own.
    pub fn transform(&self) -> DMat4 {
        self.transform
    }

    /// Memory that its voxels take now: of a file only the grids that were asked for, which are dense then.
    /// The heads of a file's grids, some KiB, are not counted.
    pub fn bytes(&self) -> u64 {
        let of = |dense: &Dense| size_of_val(dense.values.as_slice()) as u64;
        match &self.source {
            Source::Shape { dense, .. } => of(dense),
            Source::File(_) => self.decoded.lock().unwrap().values().map(|decoded| of(&decoded.dense)).sum(),
        }
    }

    /// The voxels of a grid in its active box; every value finite and at least 0, and 0 outside.
    ///
    /// # Errors
    /// [`VolumeError`] names the grid and what to do.
    pub fn grid(&self, name: &str) -> Result<Arc<Dense>, VolumeError> {
        let Decoded { dense, background, min } = self.decoded(name)?;
        if background != 0.0 {
            return Err(VolumeError::Background { name: name.to_owned(), background });
        }
        if let Some(idx) = dense.values.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            let [nx, ny, _] = dense.dims;
            let at = [idx % nx, idx / nx % ny, idx / (nx * ny)];
            let at = std::array::from_fn(|axis| min[axis] + at[axis] as i32);
            return Err(VolumeError::Value { name: name.to_owned(), value: dense.values[idx], at });
        }
        Ok(dense)
    }

    /// The voxels of a grid of any finite values in its active box, and the value outside.
    ///
    /// # Errors
    /// [`VolumeError`] names the grid and what to do.
    pub fn signed_grid(&self, name: &str) -> Result<(Arc<Dense>, f32), VolumeError> {
        let Decoded { dense, background, .. } = self.decoded(name)?;
        let odd = dense.values.iter().chain([&background]).copied().find(|value| !value.is_finite());
        match odd {
            Some(value) => Err(VolumeError::NotFinite { name: name.to_owned(), value }),
            None => Ok((dense, background)),
        }
    }

    /// The file's index coordinates of the first voxel that [`Volume::signed_grid`] gives.
    ///
    /// # Errors
    /// As [`Volume::grid`].
    pub fn first_voxel(&self, name: &str) -> Result<IVec3, VolumeError> {
        Ok(self.decoded(name)?.min)
    }

    fn decoded(&self, name: &str) -> Result<Decoded, VolumeError> {
        match &self.source {
            Source::Shape { dense, .. } if name == "density" => {
                Ok(Decoded { dense: Arc::clone(dense), background: 0.0, min: IVec3::ZERO })
            }
            Source::Shape { .. } => Err(VolumeError::NoGrid(name.to_owned())),
            Source::File(file) => {
                let mut known = self.decoded.lock().unwrap();
                if let Some(decoded) = known.get(name) {
                    return Ok(decoded.clone());
                }
                let decoded = self.decode(file, name)?;
                known.insert(name.to_owned(), decoded.clone());
                Ok(decoded)
            }
        }
    }

    fn decode(&self, file: &vdb::File, name: &str) -> Result<Decoded, VolumeError> {
        let grid = file.read(name)?;
        let background = grid.background;
        let world_from_index = self.transform * grid.world_from_index;
        let Some((min, max)) = grid.active_bbox() else {
            let dense = Arc::new(Dense { dims: [1; 3], values: vec![background], world_from_index });
            return Ok(Decoded { dense, background, min: IVec3::ZERO });
        };
        let size: [u64; 3] =
            std::array::from_fn(|axis| (i64::from(max[axis]) - i64::from(min[axis]) + 1) as u64);
        if size.iter().try_fold(1_u64, |n, &m| n.checked_mul(m)).is_none_or(|n| n > MAX_VOXELS) {
            return Err(VolumeError::TooLarge { name: name.to_owned(), size });
        }
        let dims = size.map(|n| n as usize);
        let values = grid.dense(min, dims);
        let world_from_index = world_from_index * DMat4::from_translation(min.as_dvec3());
        Ok(Decoded { dense: Arc::new(Dense { dims, values, world_from_index }), background, min })
    }
}
