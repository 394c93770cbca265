//! Volumes: OpenVDB files, numbered sequences, procedural shapes, and the lattice that solvers use.

pub mod dense;
#[cfg(test)]
pub mod field;
pub mod grid;
mod lattice;
pub mod sequence;
pub mod shapes;
mod source;
pub mod stats;
pub mod vdb;

pub use dense::Dense;
pub use lattice::{Fineness, Lattice, uniform_scale};
pub use source::{Evenly, Volume, VolumeError};
