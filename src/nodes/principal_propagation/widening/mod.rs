//! `peak: widening`: the forward peak spreads as it goes (DESIGN 6.5).
//!
//! What delta scaling counts as not scattered is the light of the peak, which in truth turns by a little each
//! time. Its place and angle across the beam are a Gaussian whose covariances obey Fermi and Eyges (Eyges
//! 1948, *Multiple scattering with energy loss*): on a grid that is aligned with the beam, slice by slice, a
//! column holds E0, the peak's power Ep, and Ep times the covariance C of place and angle and the variance V
//! of angle, along one axis. With T = sigma_t albedo f (1 − g)/6 [1/m], E* = E0 + Ep, Em the mean of E* over
//! the slice: E*' = E* e^{−k tau}, E0' = E0 e^{−tau}, V' = V e^{−k tau} + T h Em,
//! C' = (C + h V) e^{−k tau} + T h² Em/2; then (Ep, C, V) diffuse across by backward Euler with the number
//! C/(Ep h), rows first, then columns.
//!
//! In: extinction, parallel beams, the depths of straight beams, surfaces, which end a column of light where
//! they cut it. Out: an atlas of depths tau\*, by which E* = E_n e^{−k tau\*} holds at the corners: the straight
//! beam's depth, without shadows, less ln(E* widened / E* straight)/k, both from this grid, so that its own
//! errors cancel. tau\* may be negative: it is brighter beside a cloud that spreads light.
//!
//! Limits: one albedo, the mean of the channels', spreads all of them; the grid has the medium's resolution
//! across the beam, so that no peak is narrower than a cell. Seven times the cost of a scan; for narrow beams,
//! windows and the edges of shadows: wide light changes by less than a percent. Tested against the f64
//! oracle, and that one by the radii of pencils of light.

use super::super::Run;
use super::aligned::{Aligned, AlignedTexel};
use crate::gpu::{Bind, Buffer, Format, Sampler, Texture};
use crate::graph::NodeError;
use crate::mirror;
use crate::optics::delta::DeltaScaled;
use crate::wire::{Beam, Medium, Place, Surfaces, TauAtlas};

#[cfg(test)]
pub mod oracle;

mirror! {
    /// `WidenParams` of `shaders/principal_propagation/widen_pass.wgsl`.
    struct WidenParams {
        grid: AlignedTexel,
        k: f32,
        peak: f32,
        spread: f32,
        face: u32,
    }
}

mirror! {
    /// `DiffuseParams` of `shaders/principal_propagation/widen_diffuse.wgsl`.
    struct DiffuseParams {
        n_rows: u32,
        n_columns: u32,
        row_stride: u32,
        column_stride: u32,
    }
}

mirror! {
    /// `WidenGatherParams` of `shaders/principal_propagation/widen_gather.wgsl`.
    struct WidenGatherParams {
        grids: [AlignedTexel; 4],
        origin: [u32; 3],
        n_beams: u32,
        corners: [u32; 3],
        k: f32,
    }
}

/// Of E* that must be the peak's for it to widen.
const LEAST_SHARE: f64 = 1e-5;
/// Of a peak at all, of 1 W/m² that entered: quotients by less overflow.
const LEAST_POWER: f64 = 1e-30;
/// Bytes of a column in `widen_column.wgsl`.
const COLUMN_BYTES: u64 = 32;
/// Slices of one submission, between which a cancel is heard.
const SLICES_AT_ONCE: usize = 16;
const REMEDY: &str = "lower medium.max_resolution";

/// E* at the faces between a grid's slices.
struct Faces {
    grid: Aligned,
    star: Texture,
    straight: Texture,
}

/// Fills an atlas with the depths of widening beams, from those of straight ones without shadows.
///
/// # Errors
/// What the device reports.
pub(super) fn widen(
    run: &Run,
    medium: &Medium,
    beams: &[Beam],
    tau: &TauAtlas,
    surfaces: &Surfaces,
) -> Result<TauAtlas, NodeError> {
    let gpu = run.gpu;
    let albedo = medium.albedo.iter().sum::<f64>() / 3.0;
    let scaled = DeltaScaled::new(albedo, medium.g);
    let spread = albedo * scaled.f * (1.0 - medium.g) / 6.0;
    let atlas = TauAtlas::new(gpu, &medium.lattice, beams.len())?;
    let sampler = gpu.linear_sampler();
    let unused = gpu.texture3("no beam", [1; 3], Format::R32Float, "")?;
    for (pack, four) in beams.chunks(atlas.pack).enumerate() {
        let faces = four
            .iter()
            .map(|beam| {
                let Place::Parallel(direction) = beam.place else {
                    panic!("a point light's node has no widening");
                };
                let grid = Aligned::new(&medium.lattice, direction);
                march(run, medium, grid, [scaled.k, albedo * scaled.f, spread], surfaces, &sampler)
            })
            .collect::<Result<Vec<Faces>, NodeError>>()?;
        let params = WidenGatherParams {
            grids: std::array::from_fn(|n| faces[n.min(faces.len() - 1)].grid.texel()),
            origin: atlas.origin(pack),
            n_beams: four.len() as u32,
            corners: atlas.corners.map(|n| n as u32),
            k: scaled.k as f32,
        };
        let star = |n: usize| Bind::Texture(faces.get(n).map_or(&unused, |faces| &faces.star));
        let straight = |n: usize| Bind::Texture(faces.get(n).map_or(&unused, |faces| &faces.straight));
        let mut inputs = vec![Bind::Sampler(&sampler), Bind::Texture(&tau.texture)];
        inputs.extend((0..4).map(star).chain((0..4).map(straight)));
        let stage = gpu.stage("principal_propagation/widen_gather", &atlas.choices())?;
        let mut recorder = gpu.recorder("widening");
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Texture(&atlas.texture)]);
        recorder.dispatch(&bound, atlas.corners);
        run.finish(recorder)?;
    }
    Ok(atlas)
}

fn march(
    run: &Run,
    medium: &Medium,
    grid: Aligned,
    [k, peak, spread]: [f64; 3],
    surfaces: &Surfaces,
    sampler: &Sampler,
) -> Result<Faces, NodeError> {
    let gpu = run.gpu;
    let [n_u, n_v, n_slices] = grid.dims;
    let faces = || gpu.texture3("a widening beam", [n_u, n_v, n_slices + 1], Format::R32Float, REMEDY);
    let (star, straight) = (faces()?, faces()?);
    let columns: Buffer = gpu.buffer("columns of a beam", COLUMN_BYTES * (n_u * n_v) as u64, REMEDY)?;
    let [nodes, triangles] = surfaces.binds();
    let inputs = [Bind::Texture(&medium.sigma_t), Bind::Sampler(sampler), nodes, triangles];
    let outputs = [Bind::Buffer(&columns), Bind::Texture(&star), Bind::Texture(&straight)];
    let choices = [("least_share", format!("{LEAST_SHARE:?}")), ("least_power", format!("{LEAST_POWER:?}"))];
    let pass = gpu.stage("principal_propagation/widen_pass", &choices)?;
    let diffuse = gpu.stage("principal_propagation/widen_diffuse", &[])?;
    let rows = [[n_v, n_u, n_u, 1], [n_u, n_v, 1, n_u]].map(|of| {
        let [n_rows, n_columns, row_stride, column_stride] = of.map(|n| n as u32);
        let params = DiffuseParams { n_rows, n_columns, row_stride, column_stride };
        (diffuse.bind(gpu, &params, &[], &[Bind::Buffer(&columns)]), [of[0], 1, 1])
    });
    for first in (0..=n_slices).step_by(SLICES_AT_ONCE) {
        let mut recorder = gpu.recorder("widening");
        for face in first..(first + SLICES_AT_ONCE).min(n_slices + 1) {
            let params = WidenParams {
                grid: grid.texel(),
                k: k as f32,
                peak: peak as f32,
                spread: spread as f32,
                face: face as u32,
            };
            recorder.dispatch(&pass.bind(gpu, &params, &inputs, &outputs), [n_u, n_v, 1]);
            for (bound, threads) in &rows {
                recorder.dispatch(bound, *threads);
            }
        }
        run.finish(recorder)?;
    }
    Ok(Faces { grid, star, straight })
}

#[cfg(test)]
mod tests;
