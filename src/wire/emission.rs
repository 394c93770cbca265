//! Light that a medium emits by itself.

use std::sync::Arc;

use crate::gpu::{Bind, Format, Gpu, GpuError, Texture};
use crate::mirror;

/// Emitted radiance per meter, eps = emission_scale · flame · B(T): as the mean of each cell for what
/// is solved on the grid, and as what it is made of for what needs it at a point
/// (`shaders/lib/emission.wgsl`).
#[derive(Clone)]
pub struct Emission {
    /// Mean of eps [W/(m³ sr)] over each cell of the lattice; red, green and blue of an Rgba32Float texel.
    pub cells: Arc<Texture>,
    /// emission_scale · flame at its own voxels and a border of 0; R32Float.
    pub flame: Arc<Texture>,
    /// The temperature's grid at its own voxels and a border of its background; R32Float.
    pub temperature: Arc<Texture>,
    /// [`blackbody_table`](crate::optics::blackbody::blackbody_table), a texel an entry.
    pub blackbodies: Arc<Texture>,
    /// How to read them.
    pub heat: Heat,
}

mirror! {
    /// `Heat` of `shaders/lib/emission.wgsl`.
    pub struct Heat {
        /// Rows of the map from index space to texture coordinates of the flame.
        flame_from_index: [[f32; 4]; 3],
        /// The same of the temperature.
        temperature_from_index: [[f32; 4]; 3],
        /// Temperature of the value 0, in kelvin.
        kelvin_offset: f32,
        /// Kelvin a unit.
        kelvin_per_unit: f32,
        /// In the middle of the table of black bodies, in kelvin.
        knee: f32,
        /// Unused.
        pad: u32,
    }
}

impl Emission {
    /// Itself, or what stages are bound to where nothing glows; they never read that.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn or_none(emission: Option<&Self>, gpu: &Gpu) -> Result<Self, GpuError> {
        if let Some(emission) = emission {
            return Ok(emission.clone());
        }
        let field = |format| gpu.texture3("no emission", [1; 3], format, "").map(Arc::new);
        let table = gpu.texture2_from("no black bodies", [1; 2], Format::Rgba32Float, &[[0.0_f32; 4]], "")?;
        Ok(Self {
            cells: field(Format::Rgba32Float)?,
            flame: field(Format::R32Float)?,
            temperature: field(Format::R32Float)?,
            blackbodies: Arc::new(table),
            heat: bytemuck::Zeroable::zeroed(),
        })
    }

    /// Memory of its fields.
    pub fn bytes(&self) -> u64 {
        [&self.cells, &self.flame, &self.temperature, &self.blackbodies]
            .map(|texture| texture.bytes())
            .iter()
            .sum()
    }

    /// What [`Self::heat`] is read with, in the order of the shaders that look at a point: flame,
    /// temperature, black bodies.
    pub fn grids(&self) -> [Bind<'_>; 3] {
        [&self.flame, &self.temperature, &self.blackbodies].map(|texture| Bind::Texture(texture))
    }
}
