//! Optics: what a phase function, a medium and a spectrum are, as pure functions in f64, without
//! I/O and without GPU.
//!
//! These are the only places where the formulas of light transport stand in Rust; the shaders under
//! `shaders/lib` are their twins in f32 and are compared with them. Sources and equations stand in
//! the modules.

pub mod backward;
pub mod blackbody;
pub mod delta;
pub mod directions;
pub mod lobe;
pub mod octahedral;
pub mod peak;
pub mod phase;
pub mod spectrum;
pub mod transmittance;
