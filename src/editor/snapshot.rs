//! Pictures of parts of the window, compared with those in `tests/snapshots`.
//!
//! Small, of things that do not change by themselves. After a change that is meant, `UPDATE_SNAPSHOTS=1 cargo test
//! looks` writes them anew: look at them.

use eframe::egui_wgpu::WgpuSetup;
use egui::{Theme, Ui, Vec2};
use egui_kittest::{Harness, SnapshotOptions, wgpu as drawing};

use crate::gpu::testing::{gpu, window_backends};

/// Two steps of rounding to 8 bits in the luma of a pixel, which drivers may differ by where edges are blended:
/// the distance of colors is 0.5053 dY² + 0.299 dI² + 0.1957 dQ². A letter elsewhere is a hundred times that.
const THRESHOLD: f32 = 2.1;

/// Compares what `draw` draws in a window of this size with the picture of this name. Skipped, said aloud, where there
/// is no adapter and none is required (`TYNDALL_GPU=require|auto|off`).
pub fn assert_looks<State>(
    name: &str,
    size: Vec2,
    theme: Theme,
    state: State,
    draw: impl FnMut(&mut Ui, &mut State),
) {
    if gpu().is_none() {
        return;
    }
    let mut setup = drawing::default_wgpu_setup();
    if let WgpuSetup::CreateNew(new) = &mut setup {
        new.instance_descriptor.backends = window_backends();
    }
    let builder = Harness::builder().with_size(size).renderer(drawing::WgpuTestRenderer::from_setup(setup));
    let mut harness = builder.build_ui_state(draw, state);
    crate::editor::theme::apply(&harness.ctx, theme.into());
    harness.run_steps(4);
    let options = SnapshotOptions::new().threshold(THRESHOLD).output_path("tests/snapshots");
    harness.try_snapshot_options(name, &options).unwrap_or_else(|error| panic!("{error}"));
}
