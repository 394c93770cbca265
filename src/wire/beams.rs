//! Uncollided light in a medium: a list of beams and the optical depth that each has come through.

use std::sync::Arc;

use glam::DVec3;

use crate::gpu::{Format, Gpu, GpuError, Texture};
use crate::mirror;
use crate::volume::Lattice;

/// Where a beam comes from, in index space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Unit direction of travel.
    Parallel(DVec3),
    /// Position of the light.
    Point(DVec3),
}

/// One light in the medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Direction or position.
    pub place: Place,
    /// Irradiance [W/m²] of a parallel beam, intensity [W/sr] of a point light.
    pub power: [f64; 3],
    /// Spread of the region it stands for, in (0, 1].
    pub a0: f64,
}

/// Beams with their optical depths.
#[derive(Clone)]
pub struct Beams {
    /// The lights, in the order of the atlas.
    pub beams: Vec<Beam>,
    /// tau at the corners of cells.
    pub tau: TauAtlas,
    /// Radiance from everywhere, which needs no beams [W/(m² sr)].
    pub ambient: [f64; 3],
}

/// Optical depths at the corners of cells, four beams a texel (half floats: an error of at most 5e-4
/// tau exp(-tau)), one pack of four beyond the other along z, then along y.
#[derive(Clone)]
pub struct TauAtlas {
    /// The texels.
    pub texture: Arc<Texture>,
    /// Corners of cells along x, y, z.
    pub corners: [usize; 3],
    /// Packs that stand along z.
    pub packs_per_column: usize,
}

mirror! {
    /// `Beam` of `shaders/lib/beam.wgsl`.
    pub struct BeamTexel {
        /// Direction of travel or position, and 0 or 1.
        place: [f32; 4],
        /// Power of three channels, and a0.
        power: [f32; 4],
    }
}

impl Beam {
    /// For the shaders, with the power of the channels that are solved.
    pub fn texel(&self, power: [f64; 3]) -> BeamTexel {
        let (place, point) = match self.place {
            Place::Parallel(direction) => (direction, 0.0),
            Place::Point(position) => (position, 1.0),
        };
        let power = power.map(|p| p as f32);
        BeamTexel {
            place: place.as_vec3().extend(point).to_array(),
            power: [power[0], power[1], power[2], self.a0 as f32],
        }
    }
}

impl TauAtlas {
    /// Room for `n_beams`.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn new(gpu: &Gpu, lattice: &Lattice, n_beams: usize) -> Result<Self, GpuError> {
        let corners = lattice.dims.map(|n| n + 1);
        let n_packs = n_beams.div_ceil(4).max(1);
        let packs_per_column = (gpu.max_texture_3d() as usize / corners[2]).clamp(1, n_packs);
        let columns = n_packs.div_ceil(packs_per_column);
        let texture = gpu.texture3(
            "optical depths of the beams",
            [corners[0], corners[1] * columns, corners[2] * packs_per_column],
            Format::Rgba16Float,
            "lower light_decomposition.count or medium.max_resolution",
        )?;
        Ok(Self { texture: Arc::new(texture), corners, packs_per_column })
    }

    /// First texel of a pack.
    pub fn origin(&self, pack: usize) -> [u32; 3] {
        let column = pack / self.packs_per_column;
        let row = pack % self.packs_per_column;
        [0, (column * self.corners[1]) as u32, (row * self.corners[2]) as u32]
    }
}

impl Beams {
    /// No light at all.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn none(gpu: &Gpu, lattice: &Lattice) -> Result<Self, GpuError> {
        Ok(Self {
            beams: Vec::new(),
            tau: TauAtlas::new(gpu, &Lattice { dims: [0; 3], ..lattice.clone() }, 0)?,
            ambient: [0.0; 3],
        })
    }

    /// All of `parts` as one; a single part is shared, not copied.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn merge(gpu: &Gpu, lattice: &Lattice, parts: &[&Beams]) -> Result<Self, GpuError> {
        let lit: Vec<&&Beams> = parts.iter().filter(|part| !part.beams.is_empty()).collect();
        let ambient = std::array::from_fn(|c| parts.iter().map(|part| part.ambient[c]).sum());
        match lit.as_slice() {
            [] => Ok(Self { ambient, ..Self::none(gpu, lattice)? }),
            [one] => Ok(Self { ambient, ..(**one).clone() }),
            _ => Self::concatenate(gpu, lattice, &lit, ambient),
        }
    }

    /// Packs are copied whole: a part whose number of beams is no multiple of 4 is filled up with
    /// beams without power.
    fn concatenate(
        gpu: &Gpu,
        lattice: &Lattice,
        parts: &[&&Beams],
        ambient: [f64; 3],
    ) -> Result<Self, GpuError> {
        let n_packs: usize = parts.iter().map(|part| part.beams.len().div_ceil(4)).sum();
        let tau = TauAtlas::new(gpu, lattice, 4 * n_packs)?;
        let mut recorder = gpu.recorder("merge beams");
        let mut beams = Vec::new();
        for part in parts {
            for pack in 0..part.beams.len().div_ceil(4) {
                let to = tau.origin(beams.len() / 4);
                recorder.copy_box(&part.tau.texture, part.tau.origin(pack), &tau.texture, to, tau.corners);
                let rest = &part.beams[4 * pack..];
                let dark = Beam { power: [0.0; 3], ..rest[0] };
                beams.extend((0..4).map(|n| rest.get(n).copied().unwrap_or(dark)));
            }
        }
        recorder.finish()?;
        Ok(Self { beams, tau, ambient })
    }
}
