//! The oracles as a chain.

mod slabs;
mod spheres;
