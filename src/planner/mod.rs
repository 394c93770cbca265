//! What a scene requires (DESIGN 7), and what it will cost.
//!
//! Each rule is one pure function of plain facts: it gives what is to be done and a [`Decision`] that says so
//! with the reason and the data. A node's run and what foretells it call the same function, so that what
//! `tyndall explain` says is what `tyndall render` does. With `prune` false every rule models everything:
//! what a rule saves and what it costs in accuracy can then be measured (`render --full`, `tests/planner.rs`).
//!
//! The error that a rule may make is zero or a rounding, but for these: a residual is left out where it is
//! proven to be under [`ERROR_TARGET`] of the light scattered once ([`scattering`]), 14 or 26 directions
//! stand for 50 ([`directions`]), beams may be gathered at corners within [`GATHERING_ERROR`] ([`gathering`]), wide
//! ones scanned within [`SCAN_ERROR`] ([`depths`]),
//! and a constant environment is inflow, not ordinates, which is the more accurate of both.
//!
//! [`Decision`]: crate::graph::Decision

pub mod cost;
mod depths;
mod gathering;
mod rules;
mod scattering;
mod spherical;

pub use depths::{DepthFacts, Depths, SCAN_ERROR, depths};
pub use gathering::{GATHERING_ERROR, Gathering, gathering};
pub use rules::{
    Colors, Split, backward_peak, beams, bounce, channels, closed_form, constant_light, directions,
    empty_space, forward_peak, lobes, number, one_depth, residual, split, stack, three_channels,
};
pub use scattering::{ERROR_TARGET, Lit, Scattering, scattering};
pub use spherical::{Points, Spherical, spherical};
