//! Where the flame is, for rays that look for it.

use glam::{DVec3, Vec4};

use super::super::super::Run;
use crate::graph::NodeError;
use crate::optics::spectrum::luminance;
use crate::wire::Medium;

/// Cells of less of the brightest one's emission may lie outside.
const DIM: f64 = 0.01;

/// A ball around all cells that shine: its center in index space and its radius [cells]; 0 where none does.
pub(super) fn ball(run: &Run, medium: &Medium) -> Result<Vec4, NodeError> {
    let Some(emission) = &medium.emission else { return Ok(Vec4::ZERO) };
    let texels: Vec<[f32; 4]> = run.gpu.read_texture(&emission.cells)?;
    Ok(around(medium.lattice.dims, &texels))
}

fn around([nx, ny, _]: [usize; 3], texels: &[[f32; 4]]) -> Vec4 {
    let light = |[red, green, blue, _]: &[f32; 4]| luminance([*red, *green, *blue].map(f64::from));
    let brightest = texels.iter().map(light).fold(0.0, f64::max);
    if brightest <= 0.0 {
        return Vec4::ZERO;
    }
    let place = |idx: usize| DVec3::new((idx % nx) as f64, (idx / nx % ny) as f64, (idx / (nx * ny)) as f64);
    let bright = || (0..texels.len()).filter(|idx| light(&texels[*idx]) > DIM * brightest).map(place);
    let low = bright().fold(DVec3::INFINITY, DVec3::min);
    let high = bright().fold(DVec3::NEG_INFINITY, DVec3::max);
    let center = 0.5 * (low + high);
    // From the center of a cell to its corner there is half its diagonal.
    let radius = bright().map(|p| p.distance(center)).fold(0.0, f64::max) + 0.75_f64.sqrt();
    center.extend(radius).as_vec4()
}

#[test]
fn all_that_shines_is_inside() {
    let mut texels = vec![[0.0; 4]; 8 * 6 * 5];
    assert_eq!(around([8, 6, 5], &texels), Vec4::ZERO);
    for ([x, y, z], light) in [([1, 1, 1], 2.0), ([5, 1, 1], 1.0), ([7, 5, 4], 0.001)] {
        texels[x + 8 * (y + 6 * z)] = [light; 4];
    }
    assert_eq!(around([8, 6, 5], &texels), Vec4::new(3.0, 1.0, 1.0, 2.0 + 0.75_f32.sqrt()));
}
