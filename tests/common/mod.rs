//! What integration tests share: the device, and the optional real files.

use std::path::{Path, PathBuf};

use tyndall::gpu::AdapterChoice;
use tyndall::session::Session;

/// An open session; `None`, said aloud, where there is no adapter and none is required
/// (`TYNDALL_GPU=require|auto|off`).
pub fn session() -> Option<Session> {
    let mode = std::env::var("TYNDALL_GPU").unwrap_or_default();
    if mode == "off" {
        eprintln!("skipped: TYNDALL_GPU=off");
        return None;
    }
    match Session::open(&AdapterChoice::Auto) {
        Ok(session) => Some(session),
        Err(error) if mode == "require" => panic!("{error}"),
        Err(error) => {
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// The optional folder of real files; `None` where it is absent.
#[allow(dead_code, reason = "not every test that shares this module needs it")]
pub fn shared_dir() -> Option<PathBuf> {
    let path = std::env::var_os("TYNDALL_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), Into::into);
    path.is_dir().then_some(path)
}
