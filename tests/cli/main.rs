//! The program as its user meets it: exit codes, the lines that it prints, the files that it leaves.
//!
//! Everything is tried in a folder of its own, with a picture of 32x32 of a ball of 16³ voxels. What
//! needs an adapter is skipped, and says so, where there is none (`TYNDALL_GPU`, see `common`); what is
//! refused before a device is opened is tried everywhere, with the drivers hidden.

#[path = "../common/mod.rs"]
mod common;
mod desk;
mod explain;
mod look;
mod refused;
mod render;
