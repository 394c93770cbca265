//! The nodes: one folder each, with its specification, its run, its CPU reference and its tests.
//!
//! [`KINDS`] lists them, a line each, in the menu's order; nothing else needs to change for a new one.
//! Nodes know the graph's node types, the GPU layer and the domain modules, never another node: what
//! they share travels on wires (`crate::wire`).

use std::cell::RefCell;
use std::path::PathBuf;

use crate::gpu::{Gpu, GpuError, Recorder};
use crate::graph::{Catalog, Inputs, NodeError, NodeSpec, Params, Report, Value};
use crate::wire::{Beams, Medium};

mod bands;
mod bounce_lights;
mod camera;
mod environment;
#[cfg(test)]
mod extremes;
mod histogram;
#[cfg(test)]
mod hits;
mod importance_propagation;
mod isotropic_residual;
mod light_decomposition;
mod load_vdb;
mod medium;
mod mesh;
#[cfg(test)]
mod oracle_scene;
mod point_light;
mod prefilter;
mod principal_propagation;
mod probe;
mod raymarch;
mod save_image;
mod save_table;
mod scalar;
mod shadow;
mod shape;
mod slice;
mod spherical_propagation;
mod sun;
#[cfg(test)]
mod testing;
mod tone_map;
mod transfer_function;
mod transform;
mod walk;

/// Every kind of node.
pub static KINDS: &[NodeKind] = &[
    load_vdb::KIND,
    shape::KIND,
    medium::KIND,
    sun::KIND,
    point_light::KIND,
    environment::KIND,
    mesh::KIND,
    camera::KIND,
    importance_propagation::KIND,
    light_decomposition::KIND,
    prefilter::KIND,
    principal_propagation::KIND,
    spherical_propagation::KIND,
    bounce_lights::KIND,
    isotropic_residual::KIND,
    raymarch::KIND,
    slice::KIND,
    transfer_function::KIND,
    histogram::KIND,
    probe::KIND,
    tone_map::KIND,
    save_image::KIND,
    save_table::KIND,
];

/// A node as the session runs it.
pub struct NodeKind {
    /// What it is.
    pub spec: &'static NodeSpec,
    /// Files that it reads, whose path, size and time its result depends on.
    pub files: fn(&Params) -> Result<Vec<PathBuf>, NodeError>,
    /// Makes its outputs, in the order of the specification.
    pub run: fn(&Run) -> Result<Vec<Value>, NodeError>,
    /// How the planner's rules bear on it.
    pub rules: Rules,
}

/// How the planner's rules bear on a node, and how `explain` learns of them.
pub enum Rules {
    /// Not at all.
    None,
    /// It follows some, and costs little: it is run.
    Cheap,
    /// It follows some, and costs much. This reports what `run` would, and makes outputs of which only what
    /// other nodes' decisions rest on is there, without any field.
    Foretold(fn(&Run) -> Result<Vec<Value>, NodeError>),
}

/// What a node has while it runs.
pub struct Run<'a> {
    /// Its parameters.
    pub params: &'a Params,
    /// Its inputs.
    pub inputs: &'a Inputs,
    /// The device.
    pub gpu: &'a Gpu,
    /// To be asked between stages.
    pub cancel: &'a crate::graph::CancelToken,
    /// Whether what the scene does not require is left out.
    pub prune: bool,
    /// What it says of itself.
    pub report: RefCell<Report>,
}

impl Run<'_> {
    /// Says what it does and does not.
    fn tell(&self, report: Report) {
        self.report.replace(report);
    }

    /// Runs what was recorded.
    ///
    /// # Errors
    /// What the device reports; [`NodeError::Cancelled`].
    pub fn finish(&self, recorder: Recorder) -> Result<(), NodeError> {
        recorder.finish()?;
        self.cancel.check()
    }
}

impl From<GpuError> for NodeError {
    fn from(error: GpuError) -> Self {
        Self::new(error)
    }
}

/// The kind of this id.
pub fn kind(id: &str) -> Option<&'static NodeKind> {
    KINDS.iter().find(|kind| kind.spec.id == id)
}

/// The specifications, for checks and help.
pub fn catalog() -> Catalog {
    static SPECS: std::sync::LazyLock<Vec<&'static NodeSpec>> =
        std::sync::LazyLock::new(|| KINDS.iter().map(|kind| kind.spec).collect());
    Catalog(&SPECS)
}

/// The beams of an input, which must have gone through this medium.
///
/// # Errors
/// Where they went through another one; what the device reports.
fn beams_through(run: &Run, medium: &Medium) -> Result<Beams, NodeError> {
    check_media(run, medium)?;
    Ok(Beams::merge(run.gpu, &medium.lattice, &run.inputs.many::<Beams>("beams"))?)
}

/// Fails unless the beams of an input went through this medium.
fn check_media(run: &Run, medium: &Medium) -> Result<(), NodeError> {
    let parts = run.inputs.many::<Beams>("beams");
    match parts.iter().all(|part| part.lattice == medium.lattice) {
        true => Ok(()),
        false => Err(NodeError::new(ELSEWHERE)),
    }
}

const ELSEWHERE: &str =
    "beams or residual belong to another medium: wire the one that they were made for to medium";

/// For a node that reads no files.
fn no_files(_: &Params) -> Result<Vec<PathBuf>, NodeError> {
    Ok(Vec::new())
}
