//! A fire for tests: three grids on voxels of their own, as the node `medium` reads them and as f64
//! numbers.

use glam::{DMat4, DVec3, IVec3};
use serde_json::{Value as Json, json};

use super::{Random, Scene, output};
use crate::gpu::Gpu;
use crate::graph::{PortType, Value};
use crate::nodes::oracle_scene::OracleEmission;
use crate::volume::field::Field;
use crate::volume::grid::Grid;
use crate::volume::vdb::{File, WriteOptions, to_bytes};
use crate::volume::{Dense, Volume};

/// A file's grids, each a name, its voxels, and what stands outside of them.
pub fn volume(grids: &[(&str, &Dense, f32)]) -> Value {
    let grid = |(name, dense, outside): &(&str, &Dense, f32)| {
        Grid::from_dense(*name, *outside, dense.world_from_index, IVec3::ZERO, dense.dims, &dense.values)
    };
    let grids: Vec<Grid> = grids.iter().map(grid).collect();
    let file = File::from_bytes("fire.vdb", to_bytes(&grids, WriteOptions::default())).expect("a file");
    Value::new(PortType::Volume, 0, Volume::from_file(file, DMat4::IDENTITY))
}

/// A medium that glows.
pub struct Fire {
    /// Its matter; void in the half of low x but for a voxel in the corner.
    pub scene: Scene,
    flame: Dense,
    /// In units of 1000 K above 300 K.
    temperature: Dense,
}

/// Of the temperature, outside of its voxels.
const OUTSIDE: f32 = 0.6;
const SCALE: f64 = 3.0;
const REFERENCE_KELVIN: f64 = 1800.0;

impl Fire {
    /// 16³ cells; the flame's voxels are smaller than cells and turned, the temperature's are larger.
    pub fn new(scene: Scene) -> Self {
        assert_eq!(scene.sigma_t.dims, [16; 3], "the medium node makes no other grid of it");
        let mut random = Random(5);
        let sigma_t = Field::from_fn([16; 3], |[x, y, z]| {
            let corner = [x, y, z] == [1; 3] || [x, y, z] == [14; 3];
            let sigma_t = scene.sigma_t.at([x, y, z]);
            if corner {
                f64::from(1.5_f32)
            } else if x > 8 {
                sigma_t
            } else {
                0.0
            }
        });
        let mut voxels = |dims, edge: f64, first: DVec3, low: f64, high: f64| {
            let values = Field::from_fn(dims, |_| (low + (high - low) * random.unit()) as f32).data;
            let map = DMat4::from_translation(first)
                * DMat4::from_rotation_z(0.2)
                * DMat4::from_scale(DVec3::splat(edge));
            Dense { dims, values, world_from_index: scene.lattice().world_from_index * map }
        };
        let flame = voxels([11, 9, 10], 0.7, DVec3::new(4.3, 3.2, 4.1), 0.0, 1.0);
        let temperature = voxels([8, 7, 6], 1.3, DVec3::new(3.9, 2.0, 3.0), 0.8, 2.2);
        Self { scene: Scene { sigma_t, ..scene }, flame, temperature }
    }

    /// Through the node.
    pub fn medium(&self, gpu: &Gpu) -> Value {
        let inside = Field::from_fn([14; 3], |cell| self.scene.sigma_t.at(cell.map(|n| n + 1)) as f32);
        let first = DMat4::from_translation(DVec3::ONE);
        let density = Dense {
            dims: inside.dims,
            values: inside.data,
            world_from_index: self.scene.lattice().world_from_index * first,
        };
        let volume = volume(&[
            ("density", &density, 0.0),
            ("flame", &self.flame, 0.0),
            ("heat", &self.temperature, OUTSIDE),
        ]);
        output(gpu, "medium", self.params(), &[("volume", &volume)])
    }

    fn params(&self) -> Json {
        json!({
            "albedo": self.scene.albedo, "g": self.scene.g, "max_resolution": 16,
            "emission": { "temperature": "heat" }, "kelvin_per_unit": 1000, "kelvin_offset": 300,
            "emission_scale": SCALE, "reference_kelvin": REFERENCE_KELVIN,
        })
    }

    /// A channel for the oracle.
    pub fn oracle(&self, channel: usize) -> OracleEmission {
        let world_from_index = self.scene.lattice().world_from_index;
        let field = |dense: &Dense, value: &dyn Fn(f64) -> f64| Field {
            dims: dense.dims,
            data: dense.values.iter().map(|units| value(f64::from(*units))).collect(),
        };
        let kelvin = |units: f64| 300.0 + 1000.0 * units;
        let outside = kelvin(f64::from(OUTSIDE));
        OracleEmission {
            flame: field(&self.flame, &|value| SCALE * value),
            flame_from_index: self.flame.world_from_index.inverse() * world_from_index,
            kelvin_above: field(&self.temperature, &|units| kelvin(units) - outside),
            kelvin_outside: outside,
            kelvin_from_index: self.temperature.world_from_index.inverse() * world_from_index,
            reference_kelvin: REFERENCE_KELVIN,
            channel,
        }
    }
}
