//! Devices for the tests of this crate.

use std::sync::OnceLock;

use super::{AdapterChoice, Gpu};

/// The device that tests share; `None`, said aloud, where there is none and none is required
/// (`TYNDALL_GPU=require|auto|off`).
pub fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(fresh).as_ref()
}

/// A device of one's own, for a test that harms it or counts its memory.
pub fn fresh() -> Option<Gpu> {
    let mode = std::env::var("TYNDALL_GPU").unwrap_or_default();
    if mode == "off" {
        eprintln!("skipped: TYNDALL_GPU=off");
        return None;
    }
    match Gpu::open(&AdapterChoice::Auto) {
        Ok(gpu) => Some(gpu),
        Err(error) if mode == "require" => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// The backends that pictures of the window may be drawn by: those that Tyndall computes on. Crates that tests alone
/// use bring others in.
pub fn window_backends() -> wgpu::Backends {
    wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12
}
