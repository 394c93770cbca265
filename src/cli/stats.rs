//! `--stats FILE.json`: what a render cost.
//!
//! Of several frames the times of the top level are sums, sizes the largest, and `cached` says whether a
//! node was cached in all of them; `frames` has each on its own. Times in milliseconds; `wall_ms` is from
//! the checked graph to the written file, without the opening of the device.

use std::path::Path;

use serde::Serialize;
use tyndall::gpu::Gpu;
use tyndall::image::atomic;
use tyndall::session::{NodeCost, Solved};

/// The costs of a render.
#[derive(Debug, Default, Serialize)]
pub struct Stats {
    wall_ms: f64,
    /// Of the process where the adapter is a CPU, else on the GPU.
    peak_bytes: u64,
    adapter: String,
    nodes: Vec<NodeCost>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    frames: Vec<FrameStats>,
}

#[derive(Debug, Serialize)]
struct FrameStats {
    frame: i64,
    wall_ms: f64,
    nodes: Vec<NodeCost>,
}

impl Stats {
    /// Adds what was solved, for this frame if there are several.
    pub fn add(&mut self, solved: Solved, frame: Option<i64>) {
        self.wall_ms += solved.wall_ms;
        self.peak_bytes = self.peak_bytes.max(solved.peak_gpu_bytes);
        for cost in &solved.costs {
            match self.nodes.iter_mut().find(|sum| sum.name == cost.name) {
                Some(sum) => {
                    sum.cpu_ms += cost.cpu_ms;
                    sum.gpu_ms += cost.gpu_ms;
                    sum.bytes = sum.bytes.max(cost.bytes);
                    sum.cached &= cost.cached;
                }
                None => self.nodes.push(cost.clone()),
            }
        }
        let (wall_ms, nodes) = (solved.wall_ms, solved.costs);
        self.frames.extend(frame.map(|frame| FrameStats { frame, wall_ms, nodes }));
    }

    /// Writes the file, whole or not at all. Without a device nothing was rendered.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(mut self, path: &Path, gpu: Option<&Gpu>) -> anyhow::Result<()> {
        if let Some(gpu) = gpu {
            self.adapter = gpu.report().name.clone();
            if gpu.is_cpu() {
                self.peak_bytes = peak_resident_bytes().unwrap_or(self.peak_bytes);
            }
        }
        let json = serde_json::to_string_pretty(&self)? + "\n";
        Ok(atomic::write(path, json.as_bytes())?)
    }
}

/// The most memory that this process has held; `None` where the system does not say so (Linux does).
fn peak_resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn peak_memory_is_seen() {
        let before = peak_resident_bytes().unwrap();
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        assert!(peak_resident_bytes().unwrap() >= before.max(64 << 20), "{}", block.len());
    }
}
