//! One parameter of the nodes that are edited together: what it is now, and the ways to change it.
//!
//! Every change goes through [`Slot::set`], which asks the graph's own check first: what it refuses does not reach the
//! document, which keeps the last valid value. Of a parameter with keys the value is the one of the frame that is
//! looked at, and a change is a change of that frame's key.

use std::path::Path;

use serde_json::{Map, Value as Json, json};

use crate::editor::Project;
use crate::graph::{Document, Moment, Node, ParamKind, ParamSpec, ParamValue, check_value, spec};

/// A parameter of the active node, and of the others of its kind.
pub struct Slot<'a> {
    project: &'a mut Project,
    /// Nodes that are edited together, the active one first.
    nodes: &'a [String],
    /// The records that it is in, then its own name.
    path: Vec<&'static str>,
    /// What may be written.
    pub spec: &'static ParamSpec,
    /// The frame that is looked at, where there are several.
    looked_at: Option<i64>,
}

impl<'a> Slot<'a> {
    /// A parameter that is in no record.
    pub fn new(
        project: &'a mut Project,
        nodes: &'a [String],
        spec: &'static ParamSpec,
        looked_at: Option<i64>,
    ) -> Self {
        Self { project, nodes, path: vec![spec.name], spec, looked_at }
    }

    /// A member of this record.
    pub fn member(&mut self, spec: &'static ParamSpec) -> Slot<'_> {
        let path = self.path.iter().copied().chain([spec.name]).collect();
        Slot { project: self.project, nodes: self.nodes, path, spec, looked_at: self.looked_at }
    }

    /// `medium.emission.flame`, by which tests and screen readers know its control.
    pub fn name(&self) -> String {
        format!("{}.{}", self.nodes[0], self.path.join("."))
    }

    /// Of its control.
    pub fn id(&self) -> egui::Id {
        egui::Id::new(("inspector", self.name()))
    }

    /// The graph.
    pub fn document(&self) -> &Document {
        self.project.document()
    }

    /// The active node.
    pub fn node(&self) -> &str {
        &self.nodes[0]
    }

    /// The frame that is looked at; where none is, that of the first key, whose value then holds.
    pub fn frame(&self) -> i64 {
        let first = || Some(self.keys()?.first()?[0].as_f64()? as i64);
        self.looked_at.or_else(first).unwrap_or(0)
    }

    /// What keys and sequences are at.
    pub fn moment(&self) -> Moment {
        Moment { frame: self.looked_at, is_aside: false }
    }

    /// What the file says.
    pub fn given(&self) -> Option<&Json> {
        self.given_to(&self.nodes[0])
    }

    /// Whether the file says anything, so that it can be reset.
    pub fn is_set(&self) -> bool {
        self.given().is_some()
    }

    fn given_to(&self, name: &str) -> Option<&Json> {
        given(self.document().node(name)?, &self.path)
    }

    /// Whether the other nodes that are edited with it have another value. A default that is written down is
    /// the default.
    pub fn is_mixed(&self) -> bool {
        let value = |name: &String| self.json_of(self.given_to(name));
        self.nodes[1..]
            .iter()
            .any(|name| self.given_to(name) != self.given() && !is_same(&value(name), &value(&self.nodes[0])))
    }

    /// What holds now: the given value, of keys the one of the frame, or the default.
    pub fn json(&self) -> Json {
        self.json_of(self.given())
    }

    fn json_of(&self, given: Option<&Json>) -> Json {
        let default = || self.spec.default_json().unwrap_or_default();
        let json = given.cloned().unwrap_or_else(default);
        if !self.spec.kind.takes_keys() || !json.is_object() {
            return json;
        }
        match check_value(self.spec.name, self.spec, &json, Path::new(""), self.moment()) {
            Ok(ParamValue::Float(x)) => number(x),
            Ok(ParamValue::Floats(values)) => numbers(&values),
            _ => default(),
        }
    }

    /// The numbers that it is made of, in the order of its components.
    pub fn numbers(&self) -> Vec<f64> {
        let count = match self.spec.kind {
            ParamKind::Vector(count) => count,
            ParamKind::Rgb | ParamKind::Direction => 3,
            _ => 1,
        };
        match self.json() {
            Json::Array(items) => {
                (0..count).map(|n| items.get(n).and_then(Json::as_f64).unwrap_or(0.0)).collect()
            }
            other => vec![other.as_f64().unwrap_or(0.0); count],
        }
    }

    /// What is wrong with what the file says.
    pub fn problem(&self) -> Option<String> {
        match self.given() {
            Some(json) => self.check(json).err(),
            None if self.spec.default == spec::Default::Required => {
                Some(format!("{} is missing; write {}", self.spec.name, self.spec.form()))
            }
            None => None,
        }
    }

    fn check(&self, json: &Json) -> Result<(), String> {
        let field = self.path.join(".");
        match check_value(&field, self.spec, json, &self.document().base, self.moment()) {
            Ok(_) => Ok(()),
            Err(found) => {
                let messages: Vec<String> = found.into_iter().map(|problem| problem.message).collect();
                Err(messages.join("; also "))
            }
        }
    }

    /// Gives it a value, of all nodes that are edited together. All that is set within one gesture is one step of undo.
    ///
    /// # Errors
    /// What is wrong with the value; the document is then as it was.
    pub fn set(&mut self, value: Json, gesture: Option<egui::Id>) -> Result<(), String> {
        self.check(&value)?;
        let whole = match self.keys() {
            Some(mut keys) => {
                put_key(&mut keys, self.frame(), value);
                json!({ "keys": keys })
            }
            None => value,
        };
        self.check(&whole)?;
        self.write(Some(whole), gesture);
        Ok(())
    }

    /// Sets one of its numbers.
    ///
    /// # Errors
    /// As [`Slot::set`].
    pub fn set_number(&mut self, part: usize, x: f64, gesture: Option<egui::Id>) -> Result<(), String> {
        let mut values = self.numbers();
        values[part] = x;
        self.set_numbers(&values, gesture)
    }

    /// Sets all of its numbers.
    ///
    /// # Errors
    /// As [`Slot::set`].
    pub fn set_numbers(&mut self, values: &[f64], gesture: Option<egui::Id>) -> Result<(), String> {
        let value = match self.spec.kind {
            ParamKind::Float | ParamKind::Int | ParamKind::IntChoice(_) => number(values[0]),
            _ => numbers(values),
        };
        self.set(value, gesture)
    }

    /// Back to the default.
    pub fn reset(&mut self) {
        self.write(None, None);
    }

    /// The keys that it has.
    pub fn keys(&self) -> Option<Vec<Json>> {
        let json = self.given().filter(|_| self.spec.kind.takes_keys())?;
        json.get("keys").and_then(Json::as_array).cloned()
    }

    /// Adds a key at the frame with the value that holds there, or takes the one that is there away; without
    /// its last key it is a plain value again.
    pub fn toggle_key(&mut self) {
        let value = self.json();
        let frame = self.frame();
        let mut keys = self.keys().unwrap_or_default();
        let before = keys.len();
        keys.retain(|key| key[0].as_f64() != Some(frame as f64));
        if keys.len() == before {
            put_key(&mut keys, frame, value.clone());
        }
        let whole = if keys.is_empty() { value } else { json!({ "keys": keys }) };
        self.write(Some(whole), None);
    }

    fn write(&mut self, value: Option<Json>, gesture: Option<egui::Id>) {
        let label = format!("{} {}", if value.is_some() { "Set" } else { "Reset" }, self.path.join("."));
        let (nodes, path) = (self.nodes, &self.path);
        let change = |document: &mut Document| {
            for name in nodes {
                if let Some(node) = document.node_mut(name) {
                    place(&mut node.params, path, value.clone());
                }
            }
        };
        match gesture {
            Some(gesture) => self.project.edit_during(gesture, &label, change),
            None => self.project.edit(&label, change),
        }
    }

    /// Ends the gesture that goes on.
    pub fn end_gesture(&mut self) {
        self.project.end_gesture();
    }
}

/// Whether two values are one: 1 and 1.0 are.
fn is_same(a: &Json, b: &Json) -> bool {
    match (a, b) {
        (Json::Number(a), Json::Number(b)) => a.as_f64() == b.as_f64(),
        (Json::Array(a), Json::Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(a, b)),
        _ => a == b,
    }
}

fn given<'a>(node: &'a Node, path: &[&str]) -> Option<&'a Json> {
    let mut found = node.params.get(path[0])?;
    for name in &path[1..] {
        found = found.get(name)?;
    }
    Some(found)
}

/// Writes or removes a member; records on the way come to be where they were null.
fn place(mut object: &mut Map<String, Json>, path: &[&str], value: Option<Json>) {
    let (last, records) = path.split_last().expect("a parameter has a name");
    for record in records {
        let entry = object.entry(*record).or_insert(Json::Null);
        if !entry.is_object() {
            *entry = Json::Object(Map::new());
        }
        object = entry.as_object_mut().expect("made an object above");
    }
    match value {
        Some(value) => drop(object.insert((*last).to_owned(), value)),
        // The order of what stays is the file's.
        None => drop(object.shift_remove(*last)),
    }
}

/// Puts a key where it belongs, in place of one at its frame.
pub fn put_key(keys: &mut Vec<Json>, frame: i64, value: Json) {
    let at = |key: &Json| key[0].as_f64().unwrap_or(f64::NEG_INFINITY);
    keys.retain(|key| at(key) != frame as f64);
    let place = keys.partition_point(|key| at(key) < frame as f64);
    keys.insert(place, json!([frame, value]));
}

/// A finite number as it is written; what is not finite is null, which the check refuses.
pub fn number(x: f64) -> Json {
    if x.is_finite() { Json::Number(spec::json_number(x)) } else { Json::Null }
}

/// The same for several.
pub fn numbers(values: &[f64]) -> Json {
    values.iter().copied().map(number).collect()
}
