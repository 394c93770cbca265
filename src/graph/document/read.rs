//! From JSON fields to a document: what is understood, and a line for each thing that is not.

use std::path::Path;

use serde_json::{Map, Value as Json};

use super::{Document, End, Frame, GROUP, Node, Wire};
use crate::graph::params::describe;
use crate::graph::suggest::did_you_mean;

/// What a graph holds, and a group too.
const INSIDE: [&str; 8] = ["about", "nodes", "wires", "layout", "bends", "frames", "inputs", "outputs"];

/// The graph of a file, but for what is wrong with it.
pub(super) fn graph(mut root: Map<String, Json>, base: &Path) -> (Document, Vec<String>) {
    root.shift_remove("tyndall");
    let mut reader = Reader { place: String::new(), is_root: true, problems: Vec::new() };
    let mut document = reader.document(root);
    document.set_base(base);
    (document, reader.problems)
}

/// Whether a node may have this name: it must survive in a wire and on the command line.
pub fn is_node_name(name: &str) -> bool {
    !name.is_empty() && name.chars().all(is_in_names)
}

/// The text with `_` for all that no name has; `_` where there is no text.
pub fn node_name_from(text: &str) -> String {
    match text {
        "" => "_".to_owned(),
        _ => text.replace(|c| !is_in_names(c), "_"),
    }
}

fn is_in_names(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '-'
}

pub(super) fn form(what: &str, found: &Json, allowed: &str) -> String {
    format!("{what} is {}; write {allowed}", describe(found))
}

struct Reader {
    /// What stands before the names of fields: nothing, or `nodes.group.`.
    place: String,
    is_root: bool,
    problems: Vec<String>,
}

impl Reader {
    fn wrong(&mut self, what: &str, found: &Json, allowed: &str) {
        self.problems.push(form(&format!("{}{what}", self.place), found, allowed));
    }

    fn document(&mut self, fields: Map<String, Json>) -> Document {
        let mut document = Document::default();
        if !fields.contains_key("nodes") {
            let place = &self.place;
            self.problems.push(format!("the field \"{place}nodes\" is missing; write \"nodes\": {{}}"));
        }
        for (field, json) in fields {
            match (field.as_str(), json) {
                ("about", Json::String(about)) => document.about = about,
                ("about", other) => self.wrong("about", &other, "a string"),
                ("nodes", Json::Object(nodes)) => {
                    for (name, json) in nodes {
                        if let Some(node) = self.node(&name, json) {
                            document.nodes.insert(name, node);
                        }
                    }
                }
                ("nodes", other) => self.wrong("nodes", &other, "an object of nodes by name"),
                ("wires", Json::Array(wires)) => {
                    for (idx, json) in wires.into_iter().enumerate() {
                        match json.as_str().and_then(|text| text.parse().ok()) {
                            Some(wire) => document.wires.push(wire),
                            None => {
                                self.wrong(&format!("wires[{idx}]"), &json, "\"node.output -> node.input\"")
                            }
                        }
                    }
                }
                ("wires", other) => self.wrong("wires", &other, "a list of wires"),
                ("layout", Json::Object(places)) => {
                    for (name, json) in places {
                        match numbers(&json) {
                            Some(place) => drop(document.layout.insert(name, place)),
                            None => self.wrong(&format!("layout.{name}"), &json, "[x, y]"),
                        }
                    }
                }
                ("layout", other) => self.wrong("layout", &other, "an object of [x, y]"),
                ("bends", Json::Object(bends)) => {
                    for (text, json) in bends {
                        self.bend(&text, &json, &mut document);
                    }
                }
                ("bends", other) => self.wrong("bends", &other, "an object of lists of [x, y]"),
                ("frames", Json::Array(frames)) => {
                    for (idx, json) in frames.into_iter().enumerate() {
                        document.frames.extend(self.frame(idx, json));
                    }
                }
                ("frames", other) => self.wrong("frames", &other, "a list of frames"),
                ("inputs", Json::Object(inputs)) => {
                    for (name, json) in inputs {
                        if let Some(ends) = self.input(&name, &json) {
                            document.inputs.insert(name, ends);
                        }
                    }
                }
                ("inputs", other) => self.wrong("inputs", &other, "an object of \"node.input\""),
                ("outputs", Json::Object(outputs)) => {
                    for (name, json) in outputs {
                        match json.as_str().and_then(|text| text.parse().ok()) {
                            Some(end) if self.is_port(&name) => drop(document.outputs.insert(name, end)),
                            Some(_) => {}
                            None => self.wrong(&format!("outputs.{name}"), &json, "\"node.output\""),
                        }
                    }
                }
                ("outputs", other) => self.wrong("outputs", &other, "an object of \"node.output\""),
                (unknown, _) => self.unknown(unknown),
            }
        }
        self.remove_homeless(&mut document);
        document
    }

    fn unknown(&mut self, field: &str) {
        let (root, group): (&[&str], &[&str]) =
            if self.is_root { (&["tyndall"], &[]) } else { (&[], &["type", "mute", "bypass"]) };
        let allowed: Vec<&str> = [root, group, &INSIDE].concat();
        let near = did_you_mean(field, allowed.iter().copied());
        let message =
            format!("unknown field '{}{field}';{near} allowed are {}", self.place, allowed.join(", "));
        self.problems.push(message);
    }

    fn node(&mut self, name: &str, json: Json) -> Option<Node> {
        if !is_node_name(name) {
            let place = &self.place;
            let message = format!("'{place}{name}' is no name of a node; write letters, digits, '_' and '-'");
            self.problems.push(message);
            return None;
        }
        let Json::Object(mut params) = json else {
            self.wrong(&format!("nodes.{name}"), &json, "an object");
            return None;
        };
        // shift_remove keeps the order of what stays.
        let type_id = match params.shift_remove("type") {
            Some(Json::String(type_id)) => type_id,
            Some(other) => {
                self.wrong(&format!("nodes.{name}.type"), &other, "a string");
                return None;
            }
            None => {
                let place = &self.place;
                self.problems
                    .push(format!("{place}nodes.{name} has no \"type\"; 'tyndall nodes' lists them"));
                return None;
            }
        };
        let mut flag = |field: &str| match params.shift_remove(field) {
            None => false,
            Some(Json::Bool(is_set)) => is_set,
            Some(other) => {
                self.wrong(&format!("nodes.{name}.{field}"), &other, "true or false");
                false
            }
        };
        let mut node = Node { mute: flag("mute"), bypass: flag("bypass"), ..Node::new(&type_id) };
        if type_id == GROUP {
            let place = format!("{}nodes.{name}.", self.place);
            let mut reader = Reader { place, is_root: false, problems: Vec::new() };
            node.inside = Some(Box::new(reader.document(params)));
            self.problems.extend(reader.problems);
        } else {
            node.params = params;
        }
        Some(node)
    }

    fn bend(&mut self, text: &str, json: &Json, document: &mut Document) {
        let points = json.as_array().and_then(|points| points.iter().map(numbers).collect());
        match (text.parse::<Wire>(), points.filter(|points: &Vec<_>| !points.is_empty())) {
            (Ok(wire), Some(points)) => drop(document.bends.insert(wire, points)),
            (Ok(_), None) => {
                self.wrong(&format!("bends.\"{text}\""), json, "a list of [x, y], at least one");
            }
            (Err(()), _) => {
                self.wrong("bends", &text.into(), "a wire before the ':', \"node.output -> node.input\"");
            }
        }
    }

    fn frame(&mut self, idx: usize, json: Json) -> Option<Frame> {
        const FIELDS: [&str; 4] = ["title", "at", "size", "color"];
        let at = format!("frames[{idx}]");
        let Json::Object(fields) = json else {
            self.wrong(&at, &json, "{\"title\": \"..\", \"at\": [x, y], \"size\": [width, height]}");
            return None;
        };
        let n_problems = self.problems.len();
        for field in ["at", "size"].iter().filter(|field| !fields.contains_key(**field)) {
            self.problems.push(format!("{}{at} has no \"{field}\"; write \"{field}\": [x, y]", self.place));
        }
        let mut frame = Frame::default();
        for (field, json) in fields {
            let name = format!("{at}.{field}");
            match (field.as_str(), json) {
                ("title", Json::String(title)) => frame.title = title,
                ("title", other) => self.wrong(&name, &other, "a string"),
                ("at", json) => match numbers(&json) {
                    Some(at) => frame.at = at,
                    None => self.wrong(&name, &json, "[x, y]"),
                },
                ("size", json) => match numbers(&json).filter(|size| size.iter().all(|side| *side > 0.0)) {
                    Some(size) => frame.size = size,
                    None => self.wrong(&name, &json, "[width, height], both above 0"),
                },
                ("color", json) => {
                    let color = numbers(&json).filter(|rgb| rgb.iter().all(|x| (0.0..=1.0).contains(x)));
                    match color {
                        Some(color) => frame.color = Some(color),
                        None => self.wrong(&name, &json, "[red, green, blue], each 0..=1"),
                    }
                }
                (unknown, _) => {
                    let near = did_you_mean(unknown, FIELDS);
                    let allowed = FIELDS.join(", ");
                    let place = &self.place;
                    self.problems.push(format!("unknown field '{place}{name}';{near} allowed are {allowed}"));
                }
            }
        }
        // A frame without a place is left out; one with an odd color is not.
        let has_place = frame.size[0] > 0.0;
        (has_place || self.problems.len() == n_problems).then_some(frame)
    }

    fn input(&mut self, name: &str, json: &Json) -> Option<Vec<End>> {
        let one = std::slice::from_ref(json);
        let ends = json.as_array().map_or(one, Vec::as_slice).iter();
        let ends: Option<Vec<End>> = ends.map(|end| end.as_str()?.parse().ok()).collect();
        match ends.filter(|ends| !ends.is_empty()) {
            Some(ends) => self.is_port(name).then_some(ends),
            None => {
                let allowed = "\"node.input\", or a list of them";
                self.wrong(&format!("inputs.{name}"), json, allowed);
                None
            }
        }
    }

    fn is_port(&mut self, name: &str) -> bool {
        if !is_node_name(name) {
            let place = &self.place;
            let message = format!("'{place}{name}' is no name of a port; write letters, digits, '_' and '-'");
            self.problems.push(message);
        }
        is_node_name(name)
    }

    /// Takes out what belongs to a node or wire that is not there.
    fn remove_homeless(&mut self, document: &mut Document) {
        let Document { nodes, wires, layout, bends, inputs, outputs, .. } = document;
        let place = &self.place;
        let mut problems = Vec::new();
        let near = |name: &str| did_you_mean(name, nodes.keys().map(String::as_str));
        layout.retain(|name, _| {
            let is_home = nodes.contains_key(name);
            if !is_home {
                let near = near(name);
                problems.push(format!(
                    "{place}layout.{name} is the place of no node;{near} remove it or add the node"
                ));
            }
            is_home
        });
        bends.retain(|wire, _| {
            let is_home = wires.contains(wire);
            if !is_home {
                problems.push(format!(
                    "{place}bends.\"{wire}\" are the bends of no wire; remove them or add the wire"
                ));
            }
            is_home
        });
        let mut is_home = |what: &str, end: &End| {
            let is_home = nodes.contains_key(&end.node);
            if !is_home {
                let near = near(&end.node);
                problems.push(format!(
                    "{place}{what} stands for '{end}' of no node;{near} remove it or add the node"
                ));
            }
            is_home
        };
        inputs.retain(|name, ends| {
            ends.retain(|end| is_home(&format!("inputs.{name}"), end));
            !ends.is_empty()
        });
        outputs.retain(|name, end| is_home(&format!("outputs.{name}"), end));
        self.problems.extend(problems);
    }
}

/// `N` numbers in brackets.
fn numbers<const N: usize>(json: &Json) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = json.as_array()?.iter().map(Json::as_f64).collect();
    numbers?.try_into().ok()
}
