//! `raymarch`: the picture (DESIGN 6.5).
//!
//! Along each view ray: exact single scattering of the beams, what their forward peak adds (the table K) or for
//! g < 0 what goes to and fro along them (`optics/backward.rs`),
//! the residual lobe, emission, and what stands behind the medium. Pixels are computed in bands of rows, so that a
//! picture of any size fits and a cancel is heard.

use glam::DMat3;

use self::backdrop::Backdrop;
use super::bands::Bands;
use super::{ELSEWHERE, NodeKind, Rules, Run, beams_through, check_media, no_files};
use crate::camera::Camera;
use crate::geometry::Mesh;
use crate::gpu::{Bind, Format, Gpu, GpuError, Texture};
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Value};
use crate::light::environment::STACK_X;
use crate::mirror;
use crate::optics::delta::DeltaScaled;
use crate::optics::{backward, peak};
use crate::wire::{
    Beams, Channels, Depths, Emission, Heat, Medium, Place, Residual, ShapeTexel, SurfaceLight, Surfaces,
};
use plan::Plan;

mod backdrop;
mod layers;
#[cfg(test)]
pub(super) mod oracle;
mod plan;
mod sums;

pub(super) const KIND: NodeKind =
    NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Foretold(foretell) };

static SPEC: NodeSpec = NodeSpec {
    id: "raymarch",
    version: 4,
    category: Category::Image,
    purpose: "Marches the camera's rays through the medium: the picture.",
    doc: "Layers: beauty, alpha (coverage), depth (mean distance of what is seen [m], 0 where nothing is), single (light scattered \
          once), forward (light of the forward peak; where g < 0 light that went to and fro along its beam), residual (light scattered into all directions), emission (of the medium \
          itself), surface (light of meshes).",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what is seen"),
        PortSpec::new("beams", PortType::Beams, "light from propagations")
            .many()
            .optional("only residual and emission are seen"),
        PortSpec::new("residual", PortType::Residual, "multiple scattering")
            .optional("light that was scattered more than once is not seen, but for the forward peak"),
        PortSpec::new("camera", PortType::Camera, "the view"),
        PortSpec::new("environment", PortType::Environment, "what stands behind the medium")
            .optional("it is black behind the medium"),
        PortSpec::new("surfaces", PortType::Surface, "meshes that are seen, lit by the beams")
            .many()
            .optional("only the medium is seen"),
    ],
    outputs: &[PortSpec::new("image", PortType::Image, "radiance [W/(m2 sr)], linear Rec. 709, with layers")],
    params: &[
        ParamSpec::float("step", 0.5).unit("cells").between(0.01, 4.0).soft(0.1, 2.0).doc(
            "Longest step along the ray. Extinction is sampled in every step, light in every second one.",
        ),
        ParamSpec::bool("background", true).doc("Whether the environment is seen behind the medium."),
        ParamSpec::int("samples", 1)
            .between(1.0, 256.0)
            .soft(1.0, 16.0)
            .doc("Rays a pixel, rounded up to a square number, on a grid in the pixel."),
    ],
};

mirror! {
    /// `MarchParams` of `shaders/raymarch.wgsl`.
    pub(super) struct MarchParams {
        shape: ShapeTexel,
        eye: [f32; 3],
        cell_m: f32,
        forward: [f32; 3],
        step: f32,
        right: [f32; 3],
        g: f32,
        up: [f32; 3],
        g_star: f32,
        k: [f32; 4],
        albedo: [f32; 4],
        scatter: [f32; 4],
        ambient: [f32; 4],
        color: [f32; 4],
        dims: [u32; 3],
        n_beams: u32,
        packs_per_column: u32,
        width: u32,
        height: u32,
        row: u32,
        n_rows: u32,
        n_sub: u32,
        backdrop: u32,
        rotate_y: f32,
        background: [f32; 4],
        residual_color: [f32; 4],
        world_from_index: [[f32; 4]; 3],
        residual_channels: u32,
        n_at_corners: u32,
        pad_1: u32,
        pad_2: u32,
        stack_x: [[f32; 4]; 4],
        stack_turns: [[f32; 4]; 16],
        heat: Heat,
    }
}

/// Rays that are marched at once at the most, about.
const BAND_RAYS: usize = 1 << 18;

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let gpu = run.gpu;
    let medium: &Medium = run.inputs.one("medium");
    let camera: &Camera = run.inputs.one("camera");
    let residual = run.inputs.maybe::<Residual>("residual");
    let beams = beams_through(run, medium)?;
    if residual.is_some_and(|residual| residual.lattice != medium.lattice) {
        return Err(NodeError::new(ELSEWHERE));
    }
    let surfaces = Surfaces::new(gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
    let gathered = residual.and_then(|residual| residual.surface_light.as_deref());
    if gathered.is_some_and(|light| !light.is_of(&surfaces)) {
        return Err(NodeError::new(
            "the residual knows other surfaces: wire the same to its surfaces, in the same order",
        ));
    }
    let backdrop = Backdrop::new(gpu, run.inputs.maybe("environment"), run.params.bool("background"))?;
    let plan = plan::plan(run)?;
    run.tell(plan.report.clone());
    let channels = plan.channels;
    let depths = beams.depths(gpu)?;
    let emission = Emission::or_none(medium.emission.as_ref(), gpu)?;
    let params = params(run, medium, camera, (&beams, &depths), residual, &backdrop, channels)?;
    let list = beams.list(gpu, &channels)?;
    let dark = gpu.texture3("no residual", [1; 3], Format::Rgba32Float, "")?;
    let moments = residual.map_or(&dark, |residual| &residual.moments);
    let table = peak_texture(gpu, medium.g)?;
    let phases = backward_texture(gpu, medium.g)?;
    let (clamp, around) = (gpu.linear_sampler(), gpu.latlong_sampler());
    let [flame, temperature, blackbodies] = emission.grids();
    let nothing = gpu.buffer_from("no light on surfaces", &[[0.0_f32; 4]; 2], "")?;
    let [light, corners] = gathered.map_or([Bind::Buffer(&nothing); 2], SurfaceLight::binds);
    let [nodes, triangles] = gathered.map_or(&surfaces, SurfaceLight::surfaces).binds();
    let (radial, radial_lights) = beams.radial_binds(gpu)?;
    let sums = match plan.has_sums {
        true => sums::gather(run, &plan, &beams, [&depths.tau.texture, &table], &list, &params)?,
        false => gpu.texture3("no sums of beams", [1; 3], Format::Rgba32Float, "")?,
    };
    let inputs = [
        Bind::Texture(&medium.sigma_t),
        Bind::Sampler(&clamp),
        Bind::Texture(&depths.tau.texture),
        Bind::Buffer(&list),
        Bind::Texture(moments),
        Bind::Texture(&table),
        Bind::Texture(&backdrop.map),
        Bind::Sampler(&around),
        Bind::Texture(&medium.blocks.texture),
        Bind::Texture(&backdrop.stack),
        nodes,
        triangles,
        flame,
        temperature,
        blackbodies,
        light,
        corners,
        Bind::Texture(&depths.star.texture),
        Bind::Texture(&radial),
        Bind::Buffer(&radial_lights),
        Bind::Texture(&sums),
        Bind::Texture(&depths.ahead.texture),
        Bind::Texture(&phases),
    ];

    let stage = gpu.stage("raymarch", &choices(&plan, medium, &beams, residual, &backdrop, &surfaces))?;
    let row_bytes = size_of::<layers::Pixel>() * camera.width;
    let row_rays = camera.width * (params.n_sub * params.n_sub) as usize;
    let band = (BAND_RAYS / row_rays).clamp(1, camera.height);
    let pixels = gpu.buffer("a band of pixels", (row_bytes * band) as u64, "lower camera.width")?;
    let mut picture = layers::Filling::new(camera.width, camera.height);
    for rows in Bands::new(camera.height, band) {
        let n_rows = rows.len();
        let params = MarchParams { row: rows.start as u32, n_rows: n_rows as u32, ..params };
        let mut recorder = gpu.recorder("raymarch");
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&pixels)]);
        recorder.dispatch(&bound, [camera.width, n_rows, 1]);
        run.finish(recorder)?;
        let add = |raw: &[u8]| picture.add(bytemuck::cast_slice(raw));
        gpu.read_prefix(&pixels, (row_bytes * n_rows) as u64, add)?.map_err(|(x, y)| {
            NodeError::new(format!(
                "pixel ({x}, {y}) is not finite: the light is too bright for 32-bit numbers, lower its irradiance, intensity, radiance or emission_scale"
            ))
        })?;
    }
    let image = picture.finish();
    Ok(vec![Value::new(PortType::Image, image.bytes(), image)])
}

/// What the shader is compiled for.
fn choices(
    plan: &Plan,
    medium: &Medium,
    beams: &Beams,
    residual: Option<&Residual>,
    backdrop: &Backdrop,
    surfaces: &Surfaces,
) -> [(&'static str, String); 21] {
    let points = beams.beams.iter().any(|beam| matches!(beam.place, Place::Point(_)));
    let gathered = residual.and_then(|residual| residual.surface_light.as_ref());
    let n_beams = match beams.beams.len() {
        n @ ..=4 => format!("{n}u"),
        _ => "params.n_beams".to_owned(),
    };
    [
        ("channels", plan.channels.count.to_string()),
        ("grey", medium.is_grey().to_string()),
        ("voxels", medium.homogeneous.is_none().to_string()),
        ("points", points.to_string()),
        ("peak", plan.has_peak.to_string()),
        ("window", has_window(beams).to_string()),
        ("residual", plan.has_residual.to_string()),
        ("stack", backdrop.has_stack.to_string()),
        ("surfaces", (!surfaces.is_empty()).to_string()),
        ("shadows", beams.has_shadows.to_string()),
        ("gathered", gathered.is_some().to_string()),
        ("radial", beams.radial.is_some().to_string()),
        ("widening", beams.peak.is_some().to_string()),
        ("returns", beams.ahead.is_some().to_string()),
        ("emission", medium.emission.is_some().to_string()),
        ("beams", plan.has_beams.to_string()),
        ("sums", plan.has_sums.to_string()),
        ("lobes", plan.has_lobes.to_string()),
        ("skips", plan.skips.to_string()),
        ("n_beams", n_beams),
        ("pack", beams.pack().to_string()),
    ]
}

/// Whether some of the beams leave light to the environment's stack.
fn has_window(beams: &Beams) -> bool {
    beams.beams.iter().any(|beam| beam.window.is_some())
}

/// The report of a run; of the picture only that there will be one.
fn foretell(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    check_media(run, medium)?;
    run.tell(plan::plan(run)?.report);
    Ok(vec![Value::unknown(PortType::Image)])
}

fn params(
    run: &Run,
    medium: &Medium,
    camera: &Camera,
    (beams, depths): (&Beams, &Depths),
    residual: Option<&Residual>,
    backdrop: &Backdrop,
    channels: Channels,
) -> Result<MarchParams, NodeError> {
    let lattice = &medium.lattice;
    let index_from_world = lattice.index_from_world();
    let [forward, right, up] =
        camera.frame().map_err(NodeError::new)?.map(|v| lattice.turned(v).as_vec3().to_array());
    let scaled = medium.albedo.map(|albedo| DeltaScaled::new(albedo, medium.g));
    let four = |v: [f64; 3]| [v[0] as f32, v[1] as f32, v[2] as f32, 0.0];
    let residual_color = residual.map_or([0.0; 3], |residual| match channels.count {
        1 => [1.0; 3],
        _ => residual.channels.color,
    });
    let rotation = DMat3::from_mat4(lattice.world_from_index) * (1.0 / lattice.cell_m);
    Ok(MarchParams {
        shape: medium.shape(),
        eye: index_from_world.transform_point3(camera.position).as_vec3().to_array(),
        cell_m: lattice.cell_m as f32,
        forward,
        step: run.params.f64("step") as f32,
        right,
        g: medium.g as f32,
        up,
        g_star: scaled[0].g_star as f32,
        k: four(scaled.map(|s| s.k)),
        albedo: four(medium.albedo),
        scatter: four(scaled.map(|s| s.sigma_s_ratio)),
        ambient: four(channels.project(beams.ambient)),
        color: four(channels.color),
        dims: lattice.dims.map(|n| n as u32),
        n_beams: beams.beams.len() as u32,
        packs_per_column: depths.tau.packs_per_column as u32,
        width: camera.width as u32,
        height: camera.height as u32,
        row: 0,
        n_rows: 0,
        n_sub: (run.params.i64("samples") as f64).sqrt().ceil() as u32,
        backdrop: backdrop.kind,
        rotate_y: backdrop.rotate_y as f32,
        background: four(backdrop.radiance),
        residual_color: four(residual_color),
        world_from_index: [rotation.x_axis, rotation.y_axis, rotation.z_axis]
            .map(|axis| axis.as_vec3().extend(0.0).to_array()),
        residual_channels: residual.map_or(0, |residual| residual.channels.count as u32),
        n_at_corners: beams.n_at_corners() as u32,
        pad_1: 0,
        pad_2: 0,
        stack_x: std::array::from_fn(|row| std::array::from_fn(|n| STACK_X[4 * row + n] as f32)),
        stack_turns: backdrop.turns,
        heat: medium.emission.as_ref().map_or(bytemuck::Zeroable::zeroed(), |emission| emission.heat),
    })
}

/// The table of K for this g.
fn peak_texture(gpu: &Gpu, g: f64) -> Result<Texture, GpuError> {
    let dims = [peak::COLUMNS, peak::ROWS];
    if g <= 0.0 {
        return gpu.texture2_from("no forward peak", [1; 2], Format::R32Float, &[0.0_f32], "");
    }
    gpu.texture2_from("forward peak", dims, Format::R32Float, &peak::peak_table(g), "")
}

/// The table of phases of light that goes to and fro.
fn backward_texture(gpu: &Gpu, g: f64) -> Result<Texture, GpuError> {
    if g >= 0.0 {
        return gpu.texture2_from("no way back", [1; 2], Format::R32Float, &[0.0_f32], "");
    }
    let dims = [backward::COLUMNS, 2];
    gpu.texture2_from("backward phases", dims, Format::R32Float, &backward::table(g), "")
}

#[cfg(test)]
mod tests;
