//! Emission of a medium: eps = emission_scale · flame · B(T), T = kelvin_offset + kelvin_per_unit ·
//! temperature (DESIGN 6.3).
//!
//! Grids go to the GPU at their own voxels, so that a march interpolates what the file holds and asks
//! Planck after that; cells get the mean over 3³ points or more, one a voxel at least. In: the names of
//! grids. Out: [`Emission`]. Limits: radiance up to 1e28 W/(m³ sr) and temperatures up to 1e30 K, so that
//! sums over all cells stay 32-bit numbers; more is an error. Tested against the grids in f64.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::super::Run;
use super::{REMEDY, samples_along_cell};
use crate::gpu::{Bind, Format, Texture};
use crate::graph::{NodeError, Params};
use crate::light::BRIGHTEST;
use crate::mirror;
use crate::optics::blackbody::{KNEE, TABLE_SIZE, blackbody_rgb, blackbody_table};
use crate::volume::{Dense, Lattice, Volume};
use crate::wire::{Emission, Heat};

/// The hottest that is not refused, and the coldest below 0 [K].
const HOTTEST: f64 = 1e30;
/// Points along each axis of a cell whose mean it holds (DESIGN 6.3).
const LEAST_SAMPLES: u32 = 3;

mirror! {
    /// `EmissionParams` of `shaders/emission.wgsl`.
    pub(super) struct EmissionParams {
        heat: Heat,
        dims: [u32; 3],
        n_sub: u32,
    }
}

/// The grids that glow.
pub(super) struct Glow {
    flame: Arc<Dense>,
    temperature: Arc<Dense>,
    /// Of the temperature, in its own units.
    background: f32,
    /// First and last voxel of the flame that is not 0.
    occupied: ([usize; 3], [usize; 3]),
}

/// What the parameters ask for; `None` where nothing glows.
pub(super) fn read(params: &Params, volume: &Volume) -> Result<Option<Glow>, NodeError> {
    let Some(names) = params.record("emission") else { return Ok(None) };
    let named = |name: &str, error| NodeError::new(format!("emission.{name}: {error}"));
    let flame = volume.grid(names.text("flame")).map_err(|error| named("flame", error))?;
    let temperature = volume.signed_grid(names.text("temperature"));
    let (temperature, background) = temperature.map_err(|error| named("temperature", error))?;
    let glow = flame.occupied().map(|occupied| Glow { flame, temperature, background, occupied });
    let Some(glow) = glow.filter(|_| params.f64("emission_scale") > 0.0) else { return Ok(None) };
    glow.check(params)?;
    Ok(Some(glow))
}

impl Glow {
    /// Whether all that follows from it are 32-bit numbers.
    fn check(&self, params: &Params) -> Result<(), NodeError> {
        let kelvin =
            |units: f32| params.f64("kelvin_offset") + params.f64("kelvin_per_unit") * f64::from(units);
        let all = self.temperature.values.iter().chain([&self.background]);
        let (cold, hot) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(cold, hot), &units| {
            (cold.min(kelvin(units)), hot.max(kelvin(units)))
        });
        if -cold > HOTTEST || hot > HOTTEST {
            return Err(NodeError::new(format!(
                "temperatures reach from {cold:?} K to {hot:?} K, at most {HOTTEST:?} K are computed: lower kelvin_per_unit"
            )));
        }
        let largest = self.flame.values.iter().copied().fold(0.0, f32::max);
        let color = blackbody_rgb(hot, params.f64("reference_kelvin"));
        let brightest =
            params.f64("emission_scale") * f64::from(largest) * color.into_iter().fold(0.0, f64::max);
        if brightest > BRIGHTEST {
            return Err(NodeError::new(format!(
                "the largest flame {largest:?} at {hot:?} K may emit {brightest:?} W/(m3 sr), at most {BRIGHTEST:?} is computed: lower emission_scale, or raise reference_kelvin"
            )));
        }
        Ok(())
    }

    /// The box of voxels of another grid that the flame reaches into: as if that grid's first and last
    /// voxel with a value stood there.
    pub(super) fn occupied_in(&self, world_from_voxel: DMat4) -> (DVec3, DVec3) {
        let map = world_from_voxel.inverse() * self.flame.world_from_index;
        let (low, high) = self.occupied;
        let corners = (0..8).map(|n| {
            let at = |axis: usize| {
                if n >> axis & 1 == 1 { high[axis] as f64 + 1.0 } else { low[axis] as f64 - 1.0 }
            };
            map.transform_point3(DVec3::new(at(0), at(1), at(2)))
        });
        let (low, high) =
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        (low + 1.0, high - 1.0)
    }

    /// On the GPU, for the cells of a lattice.
    pub(super) fn on(&self, run: &Run, lattice: &Lattice) -> Result<Emission, NodeError> {
        let gpu = run.gpu;
        let scale = run.params.f64("emission_scale");
        let flame = self.flame.padded(0.0, |value| (scale * f64::from(value)) as f32);
        let temperature = self.temperature.padded(self.background, |value| value);
        let upload = |what: &str, grid: &Dense| -> Result<Arc<Texture>, NodeError> {
            Ok(Arc::new(gpu.texture3_from(
                what,
                grid.dims,
                Format::R32Float,
                &grid.values,
                "crop the grid",
            )?))
        };
        let table = blackbody_table(run.params.f64("reference_kelvin"));
        let emission = Emission {
            cells: Arc::new(gpu.texture3("emission", lattice.dims, Format::Rgba32Float, REMEDY)?),
            flame: upload("the flame's voxels", &flame)?,
            temperature: upload("the temperature's voxels", &temperature)?,
            blackbodies: Arc::new(gpu.texture2_from(
                "black bodies",
                [TABLE_SIZE, 1],
                Format::Rgba32Float,
                &table,
                "",
            )?),
            heat: Heat {
                flame_from_index: texture_from_index(&flame, lattice),
                temperature_from_index: texture_from_index(&temperature, lattice),
                kelvin_offset: run.params.f64("kelvin_offset") as f32,
                kelvin_per_unit: run.params.f64("kelvin_per_unit") as f32,
                knee: KNEE as f32,
                pad: 0,
            },
        };
        let max_resolution = run.params.i64("max_resolution");
        let n_sub = samples_along_cell(max_resolution, &self.flame, lattice)?
            .max(samples_along_cell(max_resolution, &self.temperature, lattice)?)
            .max(LEAST_SAMPLES);
        let params = EmissionParams { heat: emission.heat, dims: lattice.dims.map(|n| n as u32), n_sub };
        let sampler = gpu.linear_sampler();
        let [flame, temperature, blackbodies] = emission.grids();
        let inputs = [flame, temperature, blackbodies, Bind::Sampler(&sampler)];
        let mut recorder = gpu.recorder("medium");
        let stage = gpu.stage("emission", &[])?;
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Texture(&emission.cells)]);
        recorder.dispatch(&bound, lattice.dims);
        run.finish(recorder)?;
        Ok(emission)
    }
}

/// Rows of the map from cells to texture coordinates of a grid.
fn texture_from_index(grid: &Dense, lattice: &Lattice) -> [[f32; 4]; 3] {
    let extent = DVec3::from_array(grid.dims.map(|n| n as f64));
    let map = DMat4::from_scale(1.0 / extent)
        * DMat4::from_translation(DVec3::splat(0.5))
        * grid.world_from_index.inverse()
        * lattice.world_from_index;
    let rows = map.transpose();
    [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec4().to_array())
}

#[cfg(test)]
mod tests;
