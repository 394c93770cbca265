//! Shadows of surfaces on beams, shared by the propagations: corners of cells that a surface hides from a
//! light get a depth that says so (`shaders/lib/shadow.wgsl`).
//!
//! A pass of its own after the depths are known: from every corner a ray to every light, to infinity where
//! the light is parallel. A cell then gets the mean of its lit corners times their share of all corners:
//! the edge of a shadow is a cell wide, and right on average. Without surfaces nothing runs.
//! Tested by plates whose shadows are known, and by depths that stay as they are outside of them.

use super::Run;
use crate::geometry::Mesh;
use crate::gpu::Bind;
use crate::graph::{NodeError, PortSpec, PortType, StageWork};
use crate::mirror;
use crate::wire::{Beam, BeamTexel, Medium, Surfaces, TauAtlas};

/// The input of nodes whose light surfaces are in the way of.
pub(super) const SURFACES: PortSpec = PortSpec::new("surfaces", PortType::Surface, "what casts shadows")
    .many()
    .optional("nothing is in the way of the light");

mirror! {
    /// `ShadowParams` of `shaders/shadow.wgsl`.
    pub(super) struct ShadowParams {
        origin: [u32; 3],
        n_beams: u32,
        corners: [u32; 3],
        pad: u32,
        beams: [BeamTexel; 4],
    }
}

/// Whether the surfaces of the input hide anything.
pub(super) fn is_cast(run: &Run) -> bool {
    run.inputs.many::<Mesh>("surfaces").iter().any(|mesh| !mesh.triangles.is_empty())
}

/// What it moves, which nobody knows before rays have met surfaces.
pub(super) fn work(run: &Run, n_beams: usize) -> Option<StageWork> {
    is_cast(run).then_some(StageWork { stage: "shadow", runs: n_beams, moved_bytes: None })
}

/// Marks in an atlas what the surfaces of the input hide; whether there are any.
///
/// # Errors
/// What the device reports.
pub(super) fn cast(run: &Run, medium: &Medium, beams: &[Beam], atlas: &TauAtlas) -> Result<bool, NodeError> {
    let gpu = run.gpu;
    let surfaces = Surfaces::new(gpu, &medium.lattice, &run.inputs.many::<Mesh>("surfaces"))?;
    if surfaces.is_empty() {
        return Ok(false);
    }
    let stage = gpu.stage("shadow", &atlas.choices())?;
    // A pass cannot read what it writes.
    let remedy = "lower medium.max_resolution";
    let unshadowed = gpu.texture3("depths of a pack", atlas.corners, atlas.texture.format(), remedy)?;
    let [nodes, triangles] = surfaces.binds();
    for (pack, four) in beams.chunks(atlas.pack).enumerate() {
        let params = ShadowParams {
            origin: atlas.origin(pack),
            n_beams: four.len() as u32,
            corners: atlas.corners.map(|n| n as u32),
            pad: 0,
            beams: std::array::from_fn(|n| four[n.min(four.len() - 1)].texel([0.0; 3])),
        };
        let inputs = [Bind::Texture(&unshadowed), nodes, triangles];
        let mut recorder = gpu.recorder("shadow");
        recorder.copy_box(&atlas.texture, atlas.origin(pack), &unshadowed, [0; 3], atlas.corners);
        let bound = stage.bind(gpu, &params, &inputs, &[Bind::Texture(&atlas.texture)]);
        recorder.dispatch(&bound, atlas.corners);
        run.finish(recorder)?;
    }
    Ok(true)
}

#[cfg(test)]
mod tests;
