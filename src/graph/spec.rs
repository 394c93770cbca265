//! What a node is, as data: the only source of the menu, the inspector, the command line's help, the
//! saved form, the cache key and the generic tests.
//!
//! Everything is `const`: a node's spec reads like a table and is checked by the compiler.
//!
//! ```
//! use tyndall::graph::{Category, NodeSpec, ParamSpec, PortSpec, PortType};
//!
//! static MEDIUM: NodeSpec = NodeSpec {
//!     id: "medium",
//!     version: 1,
//!     category: Category::Volume,
//!     purpose: "gives a volume its optical properties",
//!     doc: "sigma_t = density_scale times the grid's value.",
//!     inputs: &[PortSpec::new("volume", PortType::Volume, "the grids")],
//!     outputs: &[PortSpec::new("medium", PortType::Medium, "the medium")],
//!     params: &[
//!         ParamSpec::rgb("albedo", [1.0; 3]).between(0.0, 1.0).doc("sigma_s / sigma_t"),
//!         ParamSpec::float("g", 0.0).between(-1.0, 1.0).open().soft(-0.9, 0.9).doc("mean cosine"),
//!         ParamSpec::record("emission", &[ParamSpec::text("flame", "flame").doc("a grid")])
//!             .doc("what glows; null for nothing"),
//!     ],
//! };
//! assert_eq!(MEDIUM.param("g").unwrap().hard.to_string(), "-1 < value < 1");
//! ```
//!
//! Tested by the look-ups here and, through the messages, in `params` and `check`.

use std::fmt;

mod param;

pub use param::*;

/// One kind of node.
#[derive(Debug)]
pub struct NodeSpec {
    /// Name in the file, for instance `load_vdb`.
    pub id: &'static str,
    /// Counted up when the same parameters and inputs give another result; part of the cache key.
    pub version: u32,
    /// Where the menu shows it.
    pub category: Category,
    /// One line.
    pub purpose: &'static str,
    /// What its user reads in the editor and in `tyndall nodes`.
    pub doc: &'static str,
    /// Inputs, in the order in which they are shown and hashed.
    pub inputs: &'static [PortSpec],
    /// Outputs; a node without any is run for its effect and never cached.
    pub outputs: &'static [PortSpec],
    /// Parameters, in the order in which they are shown and hashed.
    pub params: &'static [ParamSpec],
}

/// A group of the menu.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Category {
    /// Volumes and media.
    Volume,
    /// Sources of light.
    Light,
    /// Surfaces.
    Geometry,
    /// Cameras.
    Camera,
    /// Solvers.
    Transport,
    /// Pictures and tables.
    Image,
}

/// One input or output.
#[derive(Debug, Clone, Copy)]
pub struct PortSpec {
    /// Name in a wire.
    pub name: &'static str,
    /// What may be wired to it.
    pub kind: PortType,
    /// An input that takes many wires.
    pub many: bool,
    /// Of an input that may stay empty, what that means.
    pub absent: Option<&'static str>,
    /// An input that fades: the parameter of its node that says how many frames apart its values are.
    pub faded_by: Option<&'static str>,
    /// What it is.
    pub doc: &'static str,
}

/// What travels along a wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PortType {
    /// Grids of a file or shape.
    Volume,
    /// A volume with optical properties.
    Medium,
    /// Light from infinity in all directions.
    Environment,
    /// A sun, a point light or many.
    Light,
    /// Triangles with an albedo.
    Surface,
    /// A camera.
    Camera,
    /// Decomposed directions of light.
    Ordinates,
    /// Where light matters to the picture.
    Importance,
    /// Uncollided light in the medium.
    Beams,
    /// Scattered light in the medium.
    Residual,
    /// A picture with layers.
    Image,
    /// Rows of figures.
    Table,
}

impl NodeSpec {
    /// The input of this name.
    pub fn input(&self, name: &str) -> Option<&'static PortSpec> {
        self.inputs.iter().find(|port| port.name == name)
    }

    /// The output of this name and its place.
    pub fn output(&self, name: &str) -> Option<(usize, &'static PortSpec)> {
        let mut outputs = self.outputs.iter().enumerate();
        outputs.find(|(_, port)| port.name == name)
    }

    /// The parameter of this name.
    pub fn param(&self, name: &str) -> Option<&'static ParamSpec> {
        self.params.iter().find(|param| param.name == name)
    }
}

impl PortSpec {
    /// An input that takes exactly one wire, or an output.
    pub const fn new(name: &'static str, kind: PortType, doc: &'static str) -> Self {
        Self { name, kind, many: false, absent: None, faded_by: None, doc }
    }

    /// Takes many wires; at least one, unless it is optional too.
    pub const fn many(mut self) -> Self {
        self.many = true;
        self
    }

    /// May stay empty, which means `absent`: "there are only suns".
    pub const fn optional(mut self, absent: &'static str) -> Self {
        self.absent = Some(absent);
        self
    }

    /// Comes from the two frames around the one that is looked at whose numbers are multiples of this
    /// parameter, a whole number of the node's own, each with its share. With 0 or 1, and where nothing
    /// changes with the frame, it is one value as any other.
    pub const fn faded_by(mut self, param: &'static str) -> Self {
        self.faded_by = Some(param);
        self
    }
}

impl fmt::Display for PortType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            PortType::Volume => "volume",
            PortType::Medium => "medium",
            PortType::Environment => "environment",
            PortType::Light => "light",
            PortType::Surface => "surface",
            PortType::Camera => "camera",
            PortType::Ordinates => "ordinates",
            PortType::Importance => "importance",
            PortType::Beams => "beams",
            PortType::Residual => "residual",
            PortType::Image => "image",
            PortType::Table => "table",
        })
    }
}

impl fmt::Display for Category {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Category::Volume => "volume",
            Category::Light => "light",
            Category::Geometry => "geometry",
            Category::Camera => "camera",
            Category::Transport => "transport",
            Category::Image => "image",
        })
    }
}

/// Every kind of node that there is, in the menu's order.
#[derive(Debug, Clone, Copy)]
pub struct Catalog(pub &'static [&'static NodeSpec]);

impl Catalog {
    /// The kind of this id.
    pub fn find(&self, id: &str) -> Option<&'static NodeSpec> {
        self.0.iter().copied().find(|spec| spec.id == id)
    }

    /// The outputs that give `kind`, as `load_vdb.volume`.
    pub fn givers_of(&self, kind: PortType) -> Vec<String> {
        let outputs = self.0.iter().flat_map(|spec| spec.outputs.iter().map(move |port| (spec, port)));
        let giving = outputs.filter(|(_, port)| port.kind == kind);
        giving.map(|(spec, port)| format!("{}.{}", spec.id, port.name)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn catalog_finds_kinds_and_givers() {
        const OUT: &[PortSpec] = &[PortSpec::new("volume", PortType::Volume, "grids")];
        static SHAPE: NodeSpec = NodeSpec {
            id: "shape",
            version: 1,
            category: Category::Volume,
            purpose: "a shape",
            doc: "",
            inputs: &[PortSpec::new("mask", PortType::Image, "").many().optional("")],
            outputs: OUT,
            params: &[],
        };
        static KINDS: &[&NodeSpec] = &[&SHAPE];
        let catalog = Catalog(KINDS);
        assert_eq!(catalog.find("shape").unwrap().id, "shape");
        assert!(catalog.find("sphere").is_none());
        assert_eq!(catalog.givers_of(PortType::Volume), ["shape.volume"]);
        assert!(catalog.givers_of(PortType::Image).is_empty());
        assert_eq!(SHAPE.output("volume").unwrap().0, 0);
        assert!(SHAPE.output("mask").is_none() && SHAPE.input("mask").is_some());
    }
}
