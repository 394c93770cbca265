//! How fast the device copies: the floor that stages are compared with.

use super::{Bind, Format, Gpu, GpuError};

/// Texels along an axis of what is copied.
const EDGE: usize = 128;
/// Runs, of which the fastest counts: the first also compiles.
const RUNS: usize = 6;

impl Gpu {
    /// GB/s that a plain kernel reads and writes together, copying 128³ texels of 16 bytes.
    ///
    /// # Errors
    /// [`GpuError`] where the device has no room.
    pub fn copy_gb_per_s(&self) -> Result<f64, GpuError> {
        let dims = [EDGE; 3];
        let field = || self.texture3("copied", dims, Format::Rgba32Float, "use another --adapter");
        let (from, to) = (field()?, field()?);
        let params = [EDGE as u32, EDGE as u32, EDGE as u32, 0];
        let bound =
            self.stage("copy", &[])?.bind(self, &params, &[Bind::Texture(&from)], &[Bind::Texture(&to)]);
        let mut best_ms = f64::INFINITY;
        for _ in 0..RUNS {
            let mut recorder = self.recorder("copy");
            recorder.dispatch(&bound, dims);
            best_ms = best_ms.min(recorder.finish()?);
        }
        Ok((from.bytes() + to.bytes()) as f64 / best_ms * 1e-6)
    }
}
