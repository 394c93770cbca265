//! The slice plane: any field of the graph, cut along an axis and colored, at its place in the picture or flat beside it.
//!
//! A tool of the viewport, not a part of the graph: no step of undo and nothing in the file. What it shows is computed
//! by the node `slice`, of a document that has one more node than the one that is edited ([`Slice::add_to`]): name
//! [`NAME`], which no node can have in a file. So it costs what the node costs, is cached as everything is, and the
//! command line can do the same with a node in the file.
//!
//! The plane is moved by its slider, by its handle in the picture ([`space`]), and flat by a drag or the wheel
//! ([`flat`]). Tested by the document that it asks for, and with the viewport's gestures by AccessKit names.

mod cut;
mod flat;
mod legend;
mod space;
mod strip;

use egui::{Align2, Rect, TextureHandle, TextureOptions, Ui, vec2};
use glam::DVec3;
use serde_json::{Value as Json, json};

use super::overlay::{self, short};
use super::place::Place;
use crate::graph::{Document, End, Node, PortType, Value, Wire};
use crate::image::{Table, colormap};
use crate::nodes::{self, catalog};

use cut::Cut;

pub use flat::show as flat;
pub use space::show as in_picture;
pub use strip::show as strip;

/// Of the node that cuts. Names in a file have no spaces.
pub const NAME: &str = "slice plane";

/// An output that can be cut.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    /// The output.
    pub output: End,
    /// What it gives.
    pub kind: PortType,
}

/// Which way the plane faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Axis {
    X,
    Y,
    /// As the node has it.
    #[default]
    Z,
}

impl Axis {
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
        }
    }

    pub fn normal(self) -> DVec3 {
        match self {
            Self::X => DVec3::X,
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}

/// What is cut, and how it is shown.
pub struct Slice {
    is_on: bool,
    /// Beside the picture's place, not in it.
    is_flat: bool,
    /// What was chosen; else the first medium.
    chosen: Option<End>,
    grid: String,
    beam: i64,
    axis: Axis,
    /// In meters; without one, the middle of the field.
    position: Option<f64>,
    colormap: &'static str,
    /// Values of the map's ends; without them, those of the data.
    range: Option<[f64; 2]>,
    /// Where the flat plane lies.
    place: Place,
    cut: Option<Cut>,
    /// Why there is none.
    problem: Option<String>,
    texture: Option<(Value, TextureHandle)>,
    /// The first request of the field that is chosen: what was asked before shows another.
    since: u64,
    is_new: bool,
    /// Where the handle was taken: the plane's place then, and how far along the normal.
    grip: Option<(f64, f64)>,
}

impl Default for Slice {
    fn default() -> Self {
        Self {
            is_on: false,
            is_flat: false,
            chosen: None,
            grid: "density".to_owned(),
            beam: 0,
            axis: Axis::default(),
            position: None,
            colormap: colormap::NAMES[0],
            range: None,
            place: Place::Fit,
            cut: None,
            problem: None,
            texture: None,
            since: 0,
            is_new: true,
            grip: None,
        }
    }
}

/// The outputs of a flat document that can be cut, media first.
pub(super) fn fields(document: &Document) -> Vec<Field> {
    let kinds = inputs();
    let mut found = Vec::new();
    for (name, node) in document.nodes.iter().filter(|(name, _)| *name != NAME) {
        let outputs = catalog().find(&node.type_id).map_or(&[][..], |spec| spec.outputs);
        let fields = outputs.iter().filter(|port| kinds.iter().any(|(kind, _)| *kind == port.kind));
        found.extend(fields.map(|port| Field { output: End::new(name, port.name), kind: port.kind }));
    }
    found.sort_by_key(|field| field.kind != PortType::Medium);
    found
}

/// What the node cuts: the types and names of its inputs.
fn inputs() -> Vec<(PortType, &'static str)> {
    let kind = nodes::kind("slice").expect("a node of the catalog");
    kind.spec.inputs.iter().map(|port| (port.kind, port.name)).collect()
}

impl Slice {
    /// Whether it is shown.
    pub fn is_on(&self) -> bool {
        self.is_on
    }

    /// Shows or hides it.
    pub fn toggle(&mut self) {
        self.is_on = !self.is_on;
        self.is_new = true;
    }

    /// As large as fits.
    pub fn fit(&mut self) {
        self.place = Place::Fit;
    }

    /// Whether the plane is all that is shown, where it can be shown at its place at all.
    pub fn is_flat(&self, has_place: bool) -> bool {
        self.is_on && (self.is_flat || !has_place)
    }

    /// Adds the node that cuts to a flat document; whether there is something to cut.
    pub fn add_to(&self, document: &mut Document) -> bool {
        let Some((node, wire)) = self.node(document).filter(|_| self.is_on) else { return false };
        document.nodes.insert(NAME.to_owned(), node);
        document.wires.push(wire);
        true
    }

    /// The node that cuts, as it is asked for; `None` where it is off or nothing can be cut.
    pub fn node(&self, document: &Document) -> Option<(Node, Wire)> {
        let field = self.field(document).filter(|_| self.is_on)?;
        let mut node = Node::new("slice");
        let mut set = |name: &str, value: Json| drop(node.params.insert(name.to_owned(), value));
        set("axis", self.axis.name().into());
        set("colormap", self.colormap.into());
        if let Some(position) = self.position {
            set("position", position.into());
        }
        if let Some(range) = self.range {
            set("range", json!(range));
        }
        match field.kind {
            PortType::Volume => set("grid", self.grid.as_str().into()),
            PortType::Beams => set("beam", self.beam.into()),
            _ => {}
        }
        let (_, port) = inputs().into_iter().find(|(kind, _)| *kind == field.kind)?;
        Some((node, Wire { from: field.output, to: End::new(NAME, port) }))
    }

    /// What is cut: what was chosen, else the first medium, else anything.
    fn field(&self, document: &Document) -> Option<Field> {
        let fields = fields(document);
        let chosen = fields.iter().find(|field| Some(&field.output) == self.chosen.as_ref());
        chosen.or(fields.first()).cloned()
    }

    /// The request of this number asks for the slice as it is now.
    pub fn asked(&mut self, number: u64) {
        if std::mem::take(&mut self.is_new) {
            self.since = number;
        }
    }

    /// Another field: what is shown says nothing of it.
    fn renew(&mut self) {
        (self.cut, self.problem, self.is_new) = (None, None, true);
    }

    /// What came of the request of this number.
    pub fn take(&mut self, number: u64, image: &Value, table: &Table) {
        if !self.is_new && number >= self.since {
            self.cut = Cut::new(image, table);
            self.problem = None;
        }
    }

    /// There is no slice, and why.
    pub fn fail(&mut self, message: String) {
        self.problem = Some(message);
    }

    /// Moves the plane, within the box of what it cuts.
    fn move_to(&mut self, position: f64) {
        if let Some(Cut { plane, .. }) = &self.cut {
            let [from, to] = plane.extent;
            self.position = Some(position.clamp(from.min(to), to.max(from)));
        }
    }

    /// Makes the texture, unless it is there.
    fn develop(&mut self, ui: &Ui) {
        let Some(cut) = &self.cut else { return };
        if self.texture.as_ref().is_some_and(|(value, _)| value.shares_data_with(&cut.image)) {
            return;
        }
        let pixels = cut.pixels();
        let texture = match self.texture.take() {
            Some((_, mut texture)) => {
                texture.set(pixels, TextureOptions::LINEAR);
                texture
            }
            None => ui.ctx().load_texture(NAME, pixels, TextureOptions::LINEAR),
        };
        self.texture = Some((cut.image.clone(), texture));
    }

    /// The legend, and value and place at this share of the plane, so far above the area's lower edge; where the value
    /// stands.
    fn tell(
        &self,
        ui: &mut Ui,
        area: Rect,
        document: &Document,
        cut: &Cut,
        share: Option<[f64; 2]>,
        above: f32,
    ) -> Option<Rect> {
        let value = share.and_then(|share| cut.value(share));
        let quantity = self.quantity(document);
        let told = share.zip(value).map(|(share, value)| {
            let text = readout(&quantity, value, cut.plane.at(share));
            let corner = area.right_bottom() + vec2(-10.0, -above);
            overlay::pill(ui, "slice value", corner, Align2::RIGHT_BOTTOM, &text)
        });
        let names = [quantity[0].as_str(), quantity[1].as_str()];
        legend::show(ui, area, self.colormap, names, cut.plane.range, value);
        told
    }

    /// What the numbers are, and their unit; empty where nobody knows.
    fn quantity(&self, document: &Document) -> [String; 2] {
        let (name, unit) = match self.field(document).map(|field| field.kind) {
            Some(PortType::Medium) => ("sigma_t", "1/m"),
            Some(PortType::Beams) => ("tau", ""),
            Some(PortType::Residual) => ("phi", "W/m²"),
            _ => (self.grid.as_str(), ""),
        };
        [name.to_owned(), unit.to_owned()]
    }
}

/// A value and its place.
fn readout([name, unit]: &[String; 2], value: f32, at: DVec3) -> String {
    let [x, y, z] = at.to_array().map(|x| short(x as f32));
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    format!("{name} {}{unit}   at {x} {y} {z} m", short(value))
}

#[cfg(test)]
pub mod tests {
    use std::path::Path;

    use super::*;
    use crate::graph::Target;

    impl Slice {
        /// Where the plane is, or is to be.
        pub fn position(&self) -> Option<f64> {
            self.position.or(self.cut.as_ref().map(|cut| cut.plane.position))
        }
    }

    /// A plane across x that is there since the request of this number.
    pub fn with_cut_of(number: u64) -> Slice {
        let mut slice = Slice { axis: Axis::X, ..Slice::default() };
        slice.toggle();
        slice.asked(number);
        slice.cut = Some(cut::tests::cut());
        slice
    }

    fn document() -> Document {
        let text = r#"{"tyndall": 1, "nodes": {
            "ball": {"type": "shape"}, "medium": {"type": "medium"}, "sun": {"type": "sun"},
            "split": {"type": "light_decomposition"}, "beams": {"type": "principal_propagation"},
            "residual": {"type": "isotropic_residual"}
        }, "wires": ["ball.volume -> medium.volume", "sun.light -> split.lights", "medium.medium -> beams.medium",
            "split.ordinates -> beams.ordinates", "beams.beams -> residual.beams", "medium.medium -> residual.medium"]}"#;
        Document::parse(text, Path::new("")).unwrap()
    }

    #[test]
    fn any_field_can_be_cut() {
        let names: Vec<String> = fields(&document()).iter().map(|field| field.output.to_string()).collect();
        assert_eq!(names, ["medium.medium", "ball.volume", "beams.beams", "residual.residual"]);
        let mut slice = Slice::default();
        let mut asked = document();
        assert!(!slice.add_to(&mut asked) && asked == document());
        slice.toggle();
        let wire_of = |slice: &Slice| {
            let mut asked = document();
            assert!(slice.add_to(&mut asked));
            // A document that a session takes: every parameter and wire fits.
            assert_eq!(crate::graph::check(&asked, catalog(), Target::Nodes(&[NAME])), []);
            (asked.wires.last().unwrap().to_string(), asked.nodes[NAME].params.clone())
        };
        assert_eq!(wire_of(&slice).0, "medium.medium -> slice plane.medium");
        slice.chosen = Some(End::new("beams", "beams"));
        (slice.axis, slice.position, slice.range, slice.beam) = (Axis::X, Some(0.5), Some([0.0, 2.0]), 3);
        let (wire, params) = wire_of(&slice);
        assert_eq!(wire, "beams.beams -> slice plane.beams");
        let expected =
            json!({"axis": "x", "colormap": "viridis", "position": 0.5, "range": [0.0, 2.0], "beam": 3});
        assert_eq!(Json::Object(params), expected);
        // What is no longer there is not cut.
        slice.chosen = Some(End::new("gone", "medium"));
        assert_eq!(wire_of(&slice).0, "medium.medium -> slice plane.medium");
        assert!(!slice.add_to(&mut Document::default()));
    }

    #[test]
    fn what_was_asked_of_another_field_is_not_shown() {
        let cut = cut::tests::cut();
        let columns = [0.0; 14];
        let mut slice = Slice::default();
        slice.toggle();
        slice.asked(4);
        let table = cut::tests::table(columns.to_vec());
        slice.take(4, &cut.image, &table);
        assert!(slice.cut.is_some());
        slice.renew();
        // Still on its way.
        slice.take(5, &cut.image, &table);
        assert!(slice.cut.is_none());
        slice.asked(6);
        slice.take(5, &cut.image, &table);
        assert!(slice.cut.is_none());
        slice.take(6, &cut.image, &table);
        assert!(slice.cut.is_some());
    }
}
