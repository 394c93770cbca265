//! What the tests of nodes share: one device, a medium from plain numbers, the nodes' own code, and what
//! they leave on the GPU as plain fields again.
//!
//! A [`Scene`] lies crooked in the world, so that a node that mixes up index space and world is found out.
//! Its extinctions are f32 numbers, and oracles take the optical depths that the GPU stored, so that what
//! is compared differs by the rounding of the stage under test alone. Real Vulkan, Metal and DX12 devices
//! interpolate textures with weights of 8 bits: tolerances of tests that filter hold [`filtered`].

use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};
use serde_json::{Map, Value as Json};

use super::oracle_scene::{BeamLight, OracleMedium};
use super::{NodeError, Run, kind};
use crate::geometry::Mesh;
pub use crate::gpu::testing::gpu;
use crate::gpu::{Format, Gpu, Mirror, Shader, wgsl_members};
use crate::graph::{CancelToken, Inputs, Moment, Params, PortType, Value};
use crate::light::{Light, Ordinate, Ordinates};
use crate::volume::Lattice;
use crate::volume::field::Field;
use crate::wire::{Beam, Beams, Medium, Place, Residual, TauAtlas, occupancy};

mod fire;

pub use fire::{Fire, volume};

/// A tolerance for what was made with filtered textures: software drivers weigh in f32, others with
/// 8 bits, an error of half a step of 1/256 of the difference of two neighbors.
pub fn filtered(gpu: &Gpu, f32_tolerance: f64) -> f64 {
    filtered_times(gpu, f32_tolerance, 1.0)
}

/// The same where what was filtered enters so many times, or with such a power.
pub fn filtered_times(gpu: &Gpu, f32_tolerance: f64, times: f64) -> f64 {
    if gpu.is_cpu() { f32_tolerance } else { f32_tolerance.max(times / 256.0) }
}

/// Runs a node by its id.
pub fn run(gpu: &Gpu, id: &str, params: Json, inputs: &[(&str, &Value)]) -> Result<Vec<Value>, NodeError> {
    with_run(gpu, id, params, inputs, |run| (kind(id).expect(id).run)(run))
}

/// The first output of a node that must not fail and leaves nothing out.
pub fn full_output(gpu: &Gpu, id: &str, params: Json, inputs: &[(&str, &Value)]) -> Value {
    let full =
        |run: &Run| (kind(id).expect(id).run)(&Run { prune: false, report: RefCell::default(), ..*run });
    let values = with_run(gpu, id, params, inputs, full);
    values.unwrap_or_else(|error| panic!("{id}: {error}")).remove(0)
}

/// The first output of a node that must not fail.
pub fn output(gpu: &Gpu, id: &str, params: Json, inputs: &[(&str, &Value)]) -> Value {
    run(gpu, id, params, inputs).unwrap_or_else(|error| panic!("{id}: {error}")).remove(0)
}

/// Calls `body` with what a node of this kind would be given.
pub fn with_run<T>(
    gpu: &Gpu,
    id: &str,
    params: Json,
    inputs: &[(&str, &Value)],
    body: impl FnOnce(&Run) -> T,
) -> T {
    let shares: Vec<_> = inputs.iter().map(|(port, value)| (*port, *value, 1.0)).collect();
    with_shares(gpu, id, params, &shares, body)
}

/// The same where inputs that fade have values with their shares.
pub fn with_shares<T>(
    gpu: &Gpu,
    id: &str,
    params: Json,
    inputs: &[(&str, &Value, f64)],
    body: impl FnOnce(&Run) -> T,
) -> T {
    let spec = kind(id).expect(id).spec;
    let given: Map<String, Json> = params.as_object().expect("parameters are an object").clone();
    let params =
        Params::resolve(spec.params, &given, Path::new(""), Moment::default()).expect("valid parameters");
    let mut list = Inputs::new(spec);
    for (port, value, share) in inputs {
        list.push_share(port, (*value).clone(), *share);
    }
    let cancel = CancelToken::new();
    let report = RefCell::default();
    body(&Run { params: &params, inputs: &list, gpu, cancel: &cancel, prune: true, report })
}

/// Numbers in 0..1 from a seed (splitmix64).
pub struct Random(pub u64);

impl Random {
    /// The next number.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A unit vector.
    pub fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.unit() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z)
    }
}

/// What extinctions a medium has.
#[derive(Debug, Clone, Copy)]
pub enum Filling {
    /// The same everywhere.
    Homogeneous,
    /// Even between 0 and the given.
    Random,
    /// The given, or 1e-4 of it.
    Binary,
}

/// A medium as plain numbers.
#[derive(Clone)]
pub struct Scene {
    /// Extinction at the cells [1/m], each an f32.
    pub sigma_t: Field<f64>,
    /// Edge of a cell [m].
    pub cell_m: f64,
    /// Of three channels.
    pub albedo: [f64; 3],
    /// Mean cosine.
    pub g: f64,
}

impl Scene {
    /// Cells of extinctions up to `sigma_t`, with a border of void as the medium node leaves one.
    pub fn new(dims: [usize; 3], filling: Filling, sigma_t: f64) -> Self {
        let mut random = Random(7);
        let sigma_t = Field::from_fn(dims, |cell| {
            let x = random.unit();
            let share = match filling {
                Filling::Homogeneous => 1.0,
                Filling::Random => x,
                Filling::Binary => f64::from(x < 0.5) + 1e-4 * f64::from(x >= 0.5),
            };
            let is_border = (0..3).any(|axis| cell[axis] == 0 || cell[axis] + 1 == dims[axis]);
            if is_border { 0.0 } else { f64::from((sigma_t * share) as f32) }
        });
        Self { sigma_t, cell_m: 0.25, albedo: [0.9; 3], g: 0.5 }
    }

    /// The same with matter in the second block of 8³ cells alone, of which no sample reaches into another.
    pub fn in_one_block(mut self) -> Self {
        for idx in 0..self.sigma_t.data.len() {
            if self.sigma_t.index_of(idx).into_iter().any(|i| !(9..15).contains(&i)) {
                self.sigma_t.data[idx] = 0.0;
            }
        }
        self
    }

    /// Its grid in the world.
    pub fn lattice(&self) -> Lattice {
        let turn = DMat4::from_rotation_y(0.4) * DMat4::from_rotation_x(-0.3);
        Lattice {
            dims: self.sigma_t.dims,
            occupied: self.sigma_t.dims,
            cell_m: self.cell_m,
            world_from_index: DMat4::from_translation(DVec3::new(1.0, -0.5, 0.25))
                * turn
                * DMat4::from_scale(DVec3::splat(self.cell_m)),
        }
    }

    /// On the GPU.
    pub fn medium(&self, gpu: &Gpu) -> Value {
        let cells: Vec<f32> = self.sigma_t.data.iter().map(|value| *value as f32).collect();
        let sigma_t = gpu.texture3_from("extinction", self.sigma_t.dims, Format::R32Float, &cells, "");
        let sigma_t = sigma_t.expect("extinction");
        let blocks = occupancy(gpu, &sigma_t, None).expect("blocks");
        let medium = Medium {
            blocks: Arc::new(blocks),
            lattice: self.lattice(),
            sigma_t: Arc::new(sigma_t),
            sigma_t_max: self.sigma_t.data.iter().copied().fold(0.0, f64::max),
            tau_max: f64::INFINITY,
            albedo: self.albedo,
            g: self.g,
            emission: None,
            homogeneous: None,
        };
        Value::new(PortType::Medium, 0, medium)
    }

    /// A channel for the oracle.
    pub fn oracle(&self, channel: usize) -> OracleMedium {
        OracleMedium {
            sigma_t: self.sigma_t.clone(),
            h: self.cell_m,
            albedo: self.albedo[channel],
            g: self.g,
        }
    }

    /// What the propagation nodes make of these lights, all parallel or all points.
    pub fn propagate(&self, gpu: &Gpu, medium: &Value, lights: &[Beam], ambient: [f64; 3]) -> Value {
        self.propagate_behind(gpu, medium, lights, ambient, &[])
    }

    /// The same behind surfaces.
    pub fn propagate_behind(
        &self,
        gpu: &Gpu,
        medium: &Value,
        lights: &[Beam],
        ambient: [f64; 3],
        surfaces: &[&Value],
    ) -> Value {
        let world_from_index = self.lattice().world_from_index;
        let mut inputs = vec![("medium", medium)];
        inputs.extend(surfaces.iter().map(|surface| ("surfaces", *surface)));
        let point = |light: &Beam| match light.place {
            Place::Parallel(_) => None,
            Place::Point(position) => {
                let position = world_from_index.transform_point3(position);
                let light = Light::Point { position, intensity: light.power };
                Some(Value::new(PortType::Light, 0, vec![light]))
            }
        };
        let points: Vec<Value> = lights.iter().filter_map(point).collect();
        if !points.is_empty() {
            inputs.extend(points.iter().map(|point| ("lights", point)));
            return full_output(gpu, "spherical_propagation", Json::Object(Map::new()), &inputs);
        }
        let ordinates = lights.iter().filter_map(|light| match light.place {
            Place::Point(_) => None,
            Place::Parallel(direction) => Some(Ordinate {
                direction: world_from_index.transform_vector3(direction).normalize(),
                irradiance: light.power,
                a0: light.a0,
                region: None,
                window: light.window,
            }),
        });
        let ordinates = Ordinates { ordinates: ordinates.collect(), ambient, ..Ordinates::default() };
        let ordinates = Value::new(PortType::Ordinates, 0, ordinates);
        inputs.push(("ordinates", &ordinates));
        full_output(gpu, "principal_propagation", Json::Object(Map::new()), &inputs)
    }

    /// These triangles of index space as a surface of the world, grey of 0.5.
    pub fn surface(&self, triangles: &[[DVec3; 3]]) -> Value {
        Value::new::<Mesh>(PortType::Surface, 0, mesh(&self.lattice(), triangles, [0.5; 3]))
    }

    /// A rectangle of index space across z.
    pub fn plate(&self, low: [f64; 2], high: [f64; 2], z: f64) -> Value {
        let [a, b, c, d] = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
            .map(|(x, y)| DVec3::new(x, y, z));
        self.surface(&[[a, b, c], [a, c, d]])
    }
}

/// A mesh of these triangles of index space, apart from each other.
pub fn mesh(lattice: &Lattice, triangles: &[[DVec3; 3]], reflectance: [f64; 3]) -> Mesh {
    let positions = triangles.iter().flatten().map(|p| lattice.world_from_index.transform_point3(*p));
    let corners = (0..triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]);
    Mesh { positions: positions.collect(), triangles: corners.collect(), reflectance, n_degenerate: 0 }
}

/// A ball of radius 10 around `center`: an octahedron whose faces were cut in four, so many times.
pub fn ball(center: DVec3, n_cuts: usize) -> Vec<[DVec3; 3]> {
    let axes = [
        (DVec3::X, DVec3::Y),
        (DVec3::Y, DVec3::NEG_X),
        (DVec3::NEG_X, DVec3::NEG_Y),
        (DVec3::NEG_Y, DVec3::X),
    ];
    let faces = axes.iter().flat_map(|&(a, b)| [[a, b, DVec3::Z], [b, a, DVec3::NEG_Z]]);
    let mut triangles: Vec<[DVec3; 3]> = faces.collect();
    for _ in 0..n_cuts {
        let cut = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    triangles.iter().map(|t| t.map(|p| center + 10.0 * p)).collect()
}

/// White parallel light along a direction of index space.
pub fn sun(direction: DVec3, irradiance: f64) -> Beam {
    Beam {
        place: Place::Parallel(direction.normalize()),
        power: [irradiance; 3],
        a0: 1.0,
        window: None,
        facing: None,
    }
}

/// A white point light at a position of index space.
pub fn point(position: DVec3, intensity: f64) -> Beam {
    Beam { place: Place::Point(position), power: [intensity; 3], a0: 1.0, window: None, facing: None }
}

/// A channel of a beam for the oracle, in the f32 numbers that the shaders get.
pub fn oracle_light(beam: &Beam, channel: usize) -> BeamLight {
    match beam.place {
        Place::Parallel(direction) => BeamLight::Parallel {
            direction: direction.as_vec3().as_dvec3(),
            irradiance: beam.power[channel],
            spread: beam.a0,
        },
        Place::Point(position) => BeamLight::Point {
            position_in_index: position.as_vec3().as_dvec3(),
            intensity: beam.power[channel],
        },
    }
}

/// Optical depths at the corners, for each beam.
pub fn taus(gpu: &Gpu, beams: &Beams) -> Vec<Field<f64>> {
    depths(gpu, beams, beams.tau.as_ref())
}

/// Of each beam the depths that are ahead of it at the corners, where light comes back along it.
pub fn aheads(gpu: &Gpu, beams: &Beams) -> Vec<Option<Field<f64>>> {
    match &beams.ahead {
        Some(ahead) => depths(gpu, beams, Some(ahead)).into_iter().map(Some).collect(),
        None => vec![None; beams.beams.len()],
    }
}

fn depths(gpu: &Gpu, beams: &Beams, atlas: Option<&TauAtlas>) -> Vec<Field<f64>> {
    let Some(tau) = atlas else {
        assert!(beams.beams.is_empty(), "depths were left out");
        return Vec::new();
    };
    let pack = tau.pack;
    let texels: Vec<f64> = if pack == 1 {
        gpu.read_texture::<f32>(&tau.texture).expect("tau").into_iter().map(f64::from).collect()
    } else {
        gpu.read_texture::<half::f16>(&tau.texture).expect("tau").into_iter().map(f64::from).collect()
    };
    let atlas = tau.texture.dims().map(|n| n as usize);
    let of_beam = |n: usize| {
        let origin = tau.origin(n / pack).map(|n| n as usize);
        Field::from_fn(tau.corners, |[x, y, z]| {
            let (x, y, z) = (x + origin[0], y + origin[1], z + origin[2]);
            texels[pack * (x + atlas[0] * (y + atlas[1] * z)) + n % pack]
        })
    };
    (0..beams.beams.len()).map(of_beam).collect()
}

/// Texels of four numbers, a field for each channel that is stacked along z.
pub fn layers(gpu: &Gpu, texture: &crate::gpu::Texture, n_channels: usize) -> Vec<Field<DVec4>> {
    let texels: Vec<[f32; 4]> = gpu.read_texture(texture).expect("layers");
    let [nx, ny, nz] = texture.dims().map(|n| n as usize);
    let dims = [nx, ny, nz / n_channels];
    let wide = |texel: &[f32; 4]| DVec4::from_array(texel.map(f64::from));
    let fields = texels.chunks_exact(texels.len() / n_channels);
    fields.map(|field| Field { dims, data: field.iter().map(wide).collect() }).collect()
}

/// (phi, F) for each channel of a residual.
pub fn states(gpu: &Gpu, residual: &Value) -> Vec<Field<DVec4>> {
    let residual: &Residual = residual.get();
    layers(gpu, &residual.moments, residual.channels.count)
}

/// The components of states, one after the other.
pub fn flat(state: &Field<DVec4>) -> Vec<f64> {
    state.data.iter().flat_map(|value| value.to_array()).collect()
}

/// Fails where a number is further than `relative` of it and `absolute` from what is expected, is
/// missing, or is no number; names the worst.
pub fn assert_close(what: &str, found: &[f64], expected: &[f64], relative: f64, absolute: f64) {
    assert_eq!(found.len(), expected.len(), "{what}: number of values");
    assert!(found.iter().all(|value| value.is_finite()), "{what}: not finite");
    let excess = |(found, expected): (&f64, &f64)| {
        let apart = (found - expected).abs();
        // Of equal numbers nothing is to be divided, least of all 0 by 0.
        if apart == 0.0 { 0.0 } else { apart / (relative * expected.abs() + absolute) }
    };
    let worst = found.iter().zip(expected).map(excess).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((idx, excess)) = worst {
        let (found, expected) = (found[idx], expected[idx]);
        assert!(excess <= 1.0, "{what}[{idx}]: {found} against {expected}, {excess:.2} times the tolerance");
    }
}

/// The largest of the absolute values.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// Fails where a struct and its mirror in the shader differ by a member, an offset or the size.
pub fn assert_layout<P: Mirror>(shader: &str, name: &str, choices: &[(&str, &str)]) {
    let choices: Vec<_> = choices.iter().map(|(key, value)| (*key, (*value).to_owned())).collect();
    let shader = Shader::expand(shader, &choices).expect(shader);
    let (members, size) = wgsl_members(&shader, name).expect(name);
    let members: Vec<_> = members.iter().map(|(name, offset)| (name.as_str(), *offset)).collect();
    assert_eq!((P::members(), P::size()), (members, size), "{} and {name}", P::NAME);
}

mod tests {
    use super::*;

    #[test]
    fn equal_is_close() {
        assert_close("same", &[1.0, 0.0], &[1.0 + 1e-7, 1e-9], 1e-6, 1e-8);
        assert_close("exactly", &[0.0, 3.0], &[0.0, 3.0], 0.0, 0.0);
    }

    #[test]
    #[should_panic(expected = "x[1]: 2.02 against 2, ")]
    fn a_percent_is_not() {
        assert_close("x", &[1.0, 2.02], &[1.0, 2.0], 9e-3, 0.0);
    }

    #[test]
    #[should_panic(expected = "x: not finite")]
    fn nan_is_not() {
        assert_close("x", &[f64::NAN], &[f64::NAN], 1.0, 1.0);
    }

    #[test]
    #[should_panic(expected = "x: number of values")]
    fn too_few_are_not() {
        assert_close("x", &[], &[1.0], 1.0, 1.0);
    }

    crate::mirror! {
        /// `Beam` of `lib/beam.wgsl` with members that have changed places.
        struct Swapped {
            power: [f32; 4],
            place: [f32; 4],
        }
    }

    #[test]
    #[should_panic(expected = "Swapped and Beam")]
    fn other_layouts_are_found() {
        assert_layout::<Swapped>("lib/beam.wgsl", "Beam", &[("pack", "4")]);
    }

    #[test]
    fn random_numbers_are_spread() {
        let mut random = Random(1);
        let mean = (0..4000).map(|_| random.unit()).sum::<f64>() / 4000.0;
        // Standard error 0.0046.
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
        assert!((random.direction().length() - 1.0).abs() < 1e-12);
    }
}
