//! The oracles as a chain.

mod pencils;
mod slabs;
mod spheres;
