//! Pictures of parts of the window, compared with those in `tests/snapshots`.
//!
//! Small, of things that do not change by themselves, and without what other drivers may draw otherwise. After a
//! change that is meant, `UPDATE_SNAPSHOTS=1 cargo test snapshot` writes them anew: look at them.

use egui_kittest::{Harness, SnapshotOptions};

/// Two steps of rounding to 8 bits in the luma of a pixel, which drivers may differ by where edges are blended:
/// the distance of colors is 0.5053 dY² + 0.299 dI² + 0.1957 dQ². A letter elsewhere is a hundred times that.
const THRESHOLD: f32 = 2.1;

/// Compares what is drawn with the picture of this name. Skipped, said aloud, where there is no adapter and none
/// is required (`TYNDALL_GPU=require|auto|off`).
pub fn assert_looks<State>(harness: &mut Harness<State>, name: &str) {
    if crate::gpu::testing::gpu().is_some() {
        let options = SnapshotOptions::new().threshold(THRESHOLD).output_path("tests/snapshots");
        harness.try_snapshot_options(name, &options).unwrap_or_else(|error| panic!("{error}"));
    }
}
