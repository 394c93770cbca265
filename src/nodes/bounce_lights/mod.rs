//! `bounce_lights`: instant radiosity (Keller 1997; DESIGN 6.7).
//!
//! What beams bring to surfaces, past surfaces and through the medium, is found at random points of them
//! (`points.rs`); a share of it, the reflectance, goes back as virtual lights (`lights.rs`). A virtual light sends
//! its power by the cosine from the side that was lit, as the surface does there: intensity power cos/π [W/sr],
//! nothing to the back. So it needs no clamp to keep to its side; near it its light is as bright as that of any
//! point, r⁻², and is never cut off. All lights together send reflectance times the arriving power, per channel.
//!
//! Inputs: a medium, beams, surfaces. Output: lights for `spherical_propagation`. Light that the medium has scattered
//! is not sent back, nor light of a second bounce (for that, another of these nodes takes the first one's beams).
//! Limits: what arrives is known at 32 points a light. Deterministic: points and lights follow from `seed`.
//! Tested by closed forms of the power that is sent and of what a plate sends, and against the f64 oracle of arrival.

use super::{NodeKind, Rules, Run, beams_through, check_media, no_files};
use crate::geometry::Mesh;
use crate::gpu::Bind;
use crate::graph::{Category, NodeError, NodeSpec, ParamSpec, PortSpec, PortType, Report, StageWork, Value};
use crate::light::Light;
use crate::mirror;
use crate::optics::delta::DeltaScaled;
use crate::planner;
use crate::wire::{Beam, Beams, Channels, Medium, ShapeTexel, Surfaces};

use lights::{Lit, distribute};
use points::{Point, sample};

mod lights;
mod points;

pub(super) const KIND: NodeKind =
    NodeKind { spec: &SPEC, files: no_files, run, rules: Rules::Foretold(foretell) };

static SPEC: NodeSpec = NodeSpec {
    id: "bounce_lights",
    version: 1,
    category: Category::Light,
    purpose: "Light that surfaces send back into the medium, as virtual point lights.",
    doc: "Instant radiosity: beams that meet surfaces are sent back by point lights on them, each by the cosine from the lit \
          side, all together just the reflectance times the power that arrives. Wire it to spherical_propagation.lights, and leave \
          isotropic_residual.surfaces empty: those send the same light back, by another method. For small bright spots; \
          few lights show as spots of their own near a surface, and nothing is clamped.",
    inputs: &[
        PortSpec::new("medium", PortType::Medium, "what the beams went through"),
        PortSpec::new("beams", PortType::Beams, "the light that arrives").many(),
        PortSpec::new("surfaces", PortType::Surface, "what sends it back, and casts shadows").many(),
    ],
    outputs: &[PortSpec::new("lights", PortType::Light, "virtual lights, for spherical_propagation.lights")],
    params: &[
        ParamSpec::int("count", 64).between(1.0, 16_384.0).soft(1.0, 256.0).doc("Virtual lights."),
        ParamSpec::int("seed", 1)
            .between(0.0, 4_294_967_295.0)
            .soft(0.0, 100.0)
            .doc("Of the random places; each has another noise of the same size."),
    ],
};

mirror! {
    /// `ArrivalParams` of `shaders/bounce_lights.wgsl`.
    pub(super) struct ArrivalParams {
        shape: ShapeTexel,
        k: [f32; 3],
        cell_m: f32,
        n_beams: u32,
        n_points: u32,
        pad_0: u32,
        pad_1: u32,
    }
}

/// Points at which it is known what arrives, for each light, and at least.
const POINTS_PER_LIGHT: usize = 32;
const LEAST_POINTS: usize = 1024;
/// Threads along x of one dispatch, as `bounce_lights.wgsl` has it.
const ROW: usize = 4_194_240;

/// The report, and whether anything is sent back.
fn plan(run: &Run) -> (bool, Report) {
    let parts = run.inputs.many::<Beams>("beams");
    let powers: Vec<[f64; 3]> =
        parts.iter().flat_map(|part| part.beams.iter().map(|beam| beam.power)).collect();
    let meshes = run.inputs.many::<Mesh>("surfaces");
    let reflectances: Vec<[f64; 3]> = meshes.iter().map(|mesh| mesh.reflectance).collect();
    let (is_sent, decision) = planner::bounce(&powers, &reflectances, count(run), run.prune);
    let work = StageWork { stage: "bounce_lights", runs: 1, moved_bytes: None };
    let report = Report {
        decisions: vec![decision],
        bytes: Some((count(run) * size_of::<Light>()) as u64),
        stages: if is_sent { vec![work] } else { Vec::new() },
        ..Report::default()
    };
    (is_sent, report)
}

fn count(run: &Run) -> usize {
    run.params.i64("count") as usize
}

fn output(lights: Vec<Light>) -> Vec<Value> {
    vec![Value::new(PortType::Light, (lights.len() * size_of::<Light>()) as u64, lights)]
}

/// The surfaces, and points on them.
fn surfaces_and_points(run: &Run, medium: &Medium) -> Result<(Surfaces, Vec<Point>), NodeError> {
    let surfaces = Surfaces::new(run.gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
    let n_points = (POINTS_PER_LIGHT * count(run)).max(LEAST_POINTS);
    let points = sample(&surfaces.corners, medium.lattice.occupied, n_points, run.params.i64("seed") as u64);
    Ok((surfaces, points))
}

fn run(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    let beams = beams_through(run, medium)?;
    let (is_sent, report) = plan(run);
    run.tell(report);
    if !is_sent {
        return Ok(output(Vec::new()));
    }
    let (surfaces, points) = surfaces_and_points(run, medium)?;
    let lit = lit(medium, &surfaces, &points, &irradiances(run, medium, &beams, &surfaces, &points)?);
    if let Some(bad) = lit.iter().find(|side| !side.power.iter().all(|watts| watts.is_finite())) {
        return Err(NodeError::new(format!(
            "light at {} is too bright for 32-bit numbers: lower the lights' irradiance or intensity, or move them from the surfaces",
            medium.lattice.world_from_index.transform_point3(bad.position)
        )));
    }
    let lights = distribute(lit, count(run), run.params.i64("seed") as u64);
    Ok(output(lights.into_iter().map(|side| in_world(medium, side)).collect()))
}

/// Both sides of all points, with the power that each sends back.
fn lit(medium: &Medium, surfaces: &Surfaces, points: &[Point], irradiances: &[[f32; 4]]) -> Vec<Lit> {
    let cell_m2 = medium.lattice.cell_m.powi(2);
    let sides = points.iter().zip(irradiances.chunks_exact(2)).flat_map(|(point, sides)| {
        let reflectance = surfaces.reflectance(point.triangle).map(f64::from);
        let area_m2 = point.area * cell_m2;
        [1.0, -1.0].into_iter().zip(sides).map(move |(sense, irradiance)| Lit {
            position: point.position.as_dvec3(),
            normal: sense * point.normal,
            power: std::array::from_fn(|c| reflectance[c] * f64::from(irradiance[c]) * area_m2),
        })
    });
    sides.collect()
}

fn in_world(medium: &Medium, side: Lit) -> Light {
    let world_from_index = medium.lattice.world_from_index;
    Light::Surface {
        position: world_from_index.transform_point3(side.position),
        normal: world_from_index.transform_vector3(side.normal).normalize(),
        power: side.power,
    }
}

/// On both sides of each point, in three channels.
fn irradiances(
    run: &Run,
    medium: &Medium,
    beams: &Beams,
    surfaces: &Surfaces,
    points: &[Point],
) -> Result<Vec<[f32; 4]>, NodeError> {
    let gpu = run.gpu;
    let k = medium.albedo.map(|albedo| DeltaScaled::new(albedo, medium.g).k as f32);
    let params = ArrivalParams {
        shape: medium.shape(),
        k,
        cell_m: medium.lattice.cell_m as f32,
        n_beams: beams.beams.len() as u32,
        n_points: points.len() as u32,
        pad_0: 0,
        pad_1: 0,
    };
    let remedy = "lower bounce_lights.count";
    let texels: Vec<_> = points.iter().map(Point::texel).collect();
    let points = gpu.buffer_from("points of surfaces", &texels, remedy)?;
    let n_sides = 2 * texels.len();
    let found = gpu.buffer("irradiances of surfaces", 16 * n_sides as u64, remedy)?;
    let (sampler, list) = (gpu.linear_sampler(), beams.list(gpu, &Channels::RGB)?);
    let [nodes, triangles] = surfaces.binds();
    let inputs = [
        Bind::Texture(&medium.sigma_t),
        Bind::Sampler(&sampler),
        nodes,
        triangles,
        Bind::Buffer(&points),
        Bind::Buffer(&list),
    ];
    let stage = gpu.stage("bounce_lights", &[("pack", beams.pack().to_string())])?;
    let mut recorder = gpu.recorder("light on surfaces");
    let bound = stage.bind(gpu, &params, &inputs, &[Bind::Buffer(&found)]);
    recorder.dispatch(&bound, [n_sides.min(ROW), n_sides.div_ceil(ROW), 1]);
    run.finish(recorder)?;
    Ok(gpu.read_buffer(&found)?)
}

/// As many lights as there will be, on the same surfaces and of the colors that may arrive; where they stand
/// among them, only the light decides.
fn foretell(run: &Run) -> Result<Vec<Value>, NodeError> {
    let medium: &Medium = run.inputs.one("medium");
    check_media(run, medium)?;
    let (is_sent, report) = plan(run);
    run.tell(report);
    if !is_sent {
        return Ok(output(Vec::new()));
    }
    let (surfaces, points) = surfaces_and_points(run, medium)?;
    let parts = run.inputs.many::<Beams>("beams");
    let beams: Vec<&Beam> = parts.iter().flat_map(|part| &part.beams).collect();
    let arriving: [f64; 3] = std::array::from_fn(|c| beams.iter().map(|beam| beam.power[c]).sum());
    let step = (points.len() / count(run)).max(1);
    let lights = points.iter().step_by(step).take(count(run)).map(|point| {
        let reflectance = surfaces.reflectance(point.triangle).map(f64::from);
        let power = std::array::from_fn(|c| reflectance[c] * arriving[c]);
        in_world(medium, Lit { position: point.position.as_dvec3(), normal: point.normal, power })
    });
    Ok(output(lights.collect()))
}

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
