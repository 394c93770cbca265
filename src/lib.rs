//! Tyndall: light in smoke, fire, cloud and any other participating medium, as a graph of nodes.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod camera;
pub mod editor;
pub mod geometry;
pub mod gpu;
pub mod graph;
pub mod image;
pub mod light;
pub mod nodes;
pub mod optics;
pub mod planner;
pub mod session;
pub mod volume;
pub mod wire;

/// The optional folder of real files that some tests use; `None` where it is absent.
#[cfg(test)]
pub(crate) fn shared_dir() -> Option<std::path::PathBuf> {
    let path = std::env::var_os("TYNDALL_SHARED")
        .map_or_else(|| std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), Into::into);
    path.is_dir().then_some(path)
}
