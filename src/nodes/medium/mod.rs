//! `medium`: a volume with optical properties, on the solver's grid (DESIGN 6.3).

use std::sync::Arc;

use glam::{DMat3, DMat4, DVec3};

use super::{NodeKind, Rules, Run, no_files};
use crate::gpu::{Bind, Format, Texture};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Report, Value};
use crate::mirror;
use crate::planner::{self, Split};
use crate::volume::{Dense, Fineness, Lattice, Volume, uniform_scale};
use crate::wire::{Emission, Homogeneous, Medium, occupancy};
use emission::Glow;

mod emission;

pub(super) const KIND: NodeKind = NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Cheap };

static SPEC: NodeSpec = NodeSpec {
    id: "medium",
    version: 2,
    category: Category::Volume,
    purpose: "Gives a volume its optical properties: extinction, albedo, phase function, emission.",
    doc: "sigma_t = density_scale times the grid's value. The phase function is Henyey-Greenstein's. Solvers work on cubic cells; \
          cells that would be thicker than 0.7 optical depths are split, as far as max_cells and the device allow. \
          With emission it glows as a black body does: emission_scale * flame * B(T) [W/(m3 sr)], \
          T = kelvin_offset + kelvin_per_unit * temperature, B of luminance 1 at reference_kelvin.",
    inputs: &[PortSpec::new("volume", PortType::Volume, "the grids")],
    outputs: &[PortSpec::new("medium", PortType::Medium, "the medium on its grid")],
    params: &[
        ParamSpec::grid("density", "density").doc("Name of the grid that holds the density."),
        ParamSpec::float("density_scale", 1.0)
            .unit("1/m per unit")
            .at_least(0.0)
            .soft(0.0, 100.0)
            .doc("Extinction of a density of 1."),
        ParamSpec::rgb("albedo", [1.0; 3])
            .between(0.0, 1.0)
            .doc("Share of the extinction that scatters, linear Rec. 709."),
        ParamSpec::float("g", 0.0)
            .between(-1.0, 1.0)
            .open()
            .soft(-0.9, 0.95)
            .doc("Mean cosine of scattering: above 0 forward, below 0 backward."),
        ParamSpec::int("max_resolution", 0)
            .between(0.0, 4096.0)
            .soft(0.0, 512.0)
            .doc("Cells along the longest axis, and no splitting; 0 is the volume's own."),
        ParamSpec::int("max_cells", 1 << 24)
            .at_least(1.0)
            .soft(1e5, 1e8)
            .doc("Thick cells are split only as long as there are no more than these."),
        ParamSpec::record("emission", EMISSION)
            .doc("Names of the grids that make it glow; null: it does not."),
        ParamSpec::float("kelvin_per_unit", 1.0)
            .unit("K per unit")
            .between(-1e30, 1e30)
            .soft(0.0, 3000.0)
            .doc("What a unit of the temperature's grid is."),
        ParamSpec::float("kelvin_offset", 0.0)
            .unit("K")
            .between(-1e30, 1e30)
            .soft(0.0, 1000.0)
            .doc("Temperature where its grid is 0."),
        ParamSpec::float("emission_scale", 1.0)
            .unit("W/(m3 sr)")
            .at_least(0.0)
            .soft(0.0, 100.0)
            .doc("Luminance that a flame of 1 emits a meter at reference_kelvin."),
        ParamSpec::float("reference_kelvin", 2000.0)
            .unit("K")
            .between(500.0, 1e6)
            .soft(1000.0, 6500.0)
            .doc("Where the black body has luminance 1; hotter is brighter."),
    ],
};

const EMISSION: &[ParamSpec] = &[
    ParamSpec::grid("temperature", "temperature").doc("Name of the grid of temperatures."),
    ParamSpec::grid("flame", "flame").doc("Name of the grid that says how much glows where."),
];

/// A cell takes one sample a voxel along each axis, up to this many: a thread then reads 2 million voxels,
/// and drivers stop what runs for seconds.
const MOST_SAMPLES: f64 = 64.0;
const REMEDY: &str = "lower medium.max_resolution";

mirror! {
    /// `MediumParams` of `shaders/medium.wgsl`.
    pub(super) struct MediumParams {
        voxel_from_cell: [[f32; 4]; 3],
        dims: [u32; 3],
        n_sub: u32,
        density_scale: f32,
        pad_0: u32,
        pad_1: u32,
        pad_2: u32,
    }
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let volume: &Volume = run.inputs.one("volume");
    let dense = volume.grid(run.params.text("density")).map_err(NodeError::new)?;
    let density_scale = run.params.f64("density_scale");
    let largest = dense.values.iter().copied().fold(0.0, f32::max);
    let sigma_t_max = density_scale * f64::from(largest);
    if !(sigma_t_max as f32).is_finite() {
        return Err(NodeError::new(format!(
            "density_scale {density_scale:?} times the largest density {largest:?} is no finite extinction: lower density_scale"
        )));
    }
    let glow = emission::read(run.params, volume)?;
    let (low, high) = occupied(&dense, glow.as_ref());
    let max_resolution = run.params.i64("max_resolution") as usize;
    let whole_m = Lattice::whole_cell_m(low, high, dense.world_from_index, max_resolution);
    let facts = Split { sigma_t_max, whole_m, is_bounded: max_resolution > 0 };
    let (wanted_cell_m, tell_split) = planner::split(facts, run.prune);
    let fineness = Fineness {
        max_resolution,
        wanted_cell_m,
        // The residual binds 16 bytes a cell at once.
        max_cells: (run.params.i64("max_cells") as usize).min(run.gpu.max_binding_bytes() as usize / 16),
        // The residual stacks three channels along z, and a beam's lines stand half a cell apart: of n cells
        // 3 n and 2 n + 3 texels, and n is at least 16.
        max_axis: run.gpu.max_texture_3d() as usize / 3,
    };
    let lattice = Lattice::fit(low, high, dense.world_from_index, fineness);
    let sigma_t = resample(run, &dense, density_scale, &lattice)?;
    let emission = glow.map(|glow| glow.on(run, &lattice)).transpose()?;
    let blocks = occupancy(run.gpu, &sigma_t, emission.as_ref())?;
    let bytes = sigma_t.bytes() + blocks.texture.bytes() + emission.as_ref().map_or(0, Emission::bytes);
    // A flame ends where its voxels do; its smoke must end there too.
    let shape = homogeneous(volume, &lattice).filter(|_| emission.is_none());
    let (is_closed, tell_closed) = planner::closed_form(shape.is_some(), run.prune);
    run.tell(Report {
        decisions: vec![tell_split(lattice.cell_m), tell_closed],
        cells: Some(lattice.dims),
        ..Report::default()
    });
    let medium = Medium {
        homogeneous: shape.filter(|_| is_closed),
        tau_max: density_scale * longest_way(&dense),
        emission,
        lattice,
        blocks: Arc::new(blocks),
        sigma_t: Arc::new(sigma_t),
        sigma_t_max,
        albedo: run.params.rgb("albedo"),
        g: run.params.f64("g"),
    };
    Ok(vec![Value::new(PortType::Medium, bytes, medium)])
}

/// What no straight way through the voxels exceeds: it crosses the slices of one axis, of each at most √3 of
/// its thickness, where nothing is larger than the slice's largest. A tenth more, because cells that are no
/// whole part of a voxel sample it up to so much too densely.
fn longest_way(dense: &Dense) -> f64 {
    match uniform_scale(DMat3::from_mat4(dense.world_from_index)) {
        Some(voxel_m) => 1.1 * 3f64.sqrt() * voxel_m * dense.slice_maxima().into_iter().fold(0.0, f64::max),
        None => {
            let largest = dense.values.iter().copied().fold(0.0, f32::max);
            let reach = DVec3::from_array(dense.dims.map(|n| n as f64 + 1.0));
            let linear = DMat3::from_mat4(dense.world_from_index);
            let diagonal = (linear.x_axis * reach.x).length()
                + (linear.y_axis * reach.y).length()
                + (linear.z_axis * reach.z).length();
            1.1 * diagonal * f64::from(largest)
        }
    }
}

/// First and last voxel that the medium reaches into, by matter or glow.
fn occupied(dense: &Dense, glow: Option<&Glow>) -> (DVec3, DVec3) {
    let at = |voxel: [usize; 3]| DVec3::from_array(voxel.map(|n| n as f64));
    let matter = dense.occupied().map(|(low, high)| (at(low), at(high)));
    match (matter, glow.map(|glow| glow.occupied_in(dense.world_from_index))) {
        (Some((low, high)), Some((from, to))) => (low.min(from), high.max(to)),
        (Some(reach), None) | (None, Some(reach)) => reach,
        (None, None) => (DVec3::ZERO, DVec3::ZERO),
    }
}

/// The closed form of an evenly filled shape, where its axes are those of the lattice.
fn homogeneous(volume: &Volume, lattice: &Lattice) -> Option<Homogeneous> {
    let evenly = volume.evenly()?;
    let scale = uniform_scale(DMat3::from_mat4(volume.transform()))?;
    let origin = volume.transform().transform_point3(DVec3::ZERO);
    Some(Homogeneous {
        ellipsoid: evenly.ellipsoid,
        center: lattice.index_from_world().transform_point3(origin),
        half_extent: evenly.half_extent * (scale / lattice.cell_m),
    })
}

/// sigma_t at the cells of a lattice.
fn resample(run: &Run, dense: &Dense, density_scale: f64, lattice: &Lattice) -> Result<Texture, NodeError> {
    let gpu = run.gpu;
    let n_sub = samples_along_cell(run.params.i64("max_resolution"), dense, lattice)?;
    let voxels =
        gpu.texture3_from("the grid's voxels", dense.dims, Format::R32Float, &dense.values, "crop the grid")?;
    let sigma_t = gpu.texture3("extinction", lattice.dims, Format::R32Float, REMEDY)?;
    let rows = voxel_from_cell(dense, lattice).transpose();
    let params = MediumParams {
        voxel_from_cell: [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec4().to_array()),
        dims: lattice.dims.map(|n| n as u32),
        n_sub,
        density_scale: density_scale as f32,
        pad_0: 0,
        pad_1: 0,
        pad_2: 0,
    };
    let mut recorder = gpu.recorder("medium");
    let stage = gpu.stage("medium", &[])?;
    let bound = stage.bind(gpu, &params, &[Bind::Texture(&voxels)], &[Bind::Texture(&sigma_t)]);
    recorder.dispatch(&bound, lattice.dims);
    run.finish(recorder)?;
    Ok(sigma_t)
}

fn voxel_from_cell(dense: &Dense, lattice: &Lattice) -> DMat4 {
    dense.world_from_index.inverse() * lattice.world_from_index
}

/// A cell larger than a voxel takes a sample in every voxel that it covers.
fn samples_along_cell(max_resolution: i64, dense: &Dense, lattice: &Lattice) -> Result<u32, NodeError> {
    let map = voxel_from_cell(dense, lattice);
    let reach = [map.x_axis, map.y_axis, map.z_axis]
        .map(|axis| axis.truncate().abs().max_element())
        .into_iter()
        .fold(0.0, f64::max);
    let samples = (reach - 1e-6).ceil().max(1.0);
    if samples <= MOST_SAMPLES {
        return Ok(samples as u32);
    }
    // Cells shrink as max_resolution grows; without it only a map that shears the voxels gets here.
    let remedy = match max_resolution {
        0 => "give the volume a map that shears its voxels less".to_owned(),
        n => format!(
            "raise max_resolution from {n} to {:.0} or more",
            (n as f64 * reach / MOST_SAMPLES).ceil()
        ),
    };
    Err(NodeError::new(format!(
        "a cell is {samples:?} voxels long, at most {MOST_SAMPLES} are sampled: {remedy}"
    )))
}

#[cfg(test)]
mod tests;
