//! JSON as people like to read and diff it: two spaces, one entry a line, but a vector, a key, and what is as short as
//! most nodes are on one.
//!
//! serde_json's own pretty printer sets every component of a vector on a line of its own, and a node of ten parameters on
//! twelve. Tested in the tests of the document, and by the presets, which are as they would be saved.

use serde_json::{Map, Value as Json};

use super::{Document, Node};
use crate::graph::spec::json_number;

/// The fields of a document, in the order of the file; what is empty has none, but for nodes and wires.
pub fn fields(document: &Document) -> Map<String, Json> {
    let mut fields = Map::new();
    let mut push = |name: &str, json: Json| drop(fields.insert(name.to_owned(), json));
    let object = |entries: Vec<(String, Json)>| Json::Object(entries.into_iter().collect());
    if !document.about.is_empty() {
        push("about", document.about.clone().into());
    }
    let nodes = document.nodes.iter().map(|(name, node)| (name.clone(), Json::Object(node_fields(node))));
    push("nodes", object(nodes.collect()));
    let wires = document.wires.iter().map(|wire| wire.to_string().into());
    push("wires", Json::Array(wires.collect()));
    if !document.inputs.is_empty() {
        let inputs = document.inputs.iter().map(|(name, ends)| {
            let mut ends: Vec<Json> = ends.iter().map(|end| end.to_string().into()).collect();
            (name.clone(), if ends.len() == 1 { ends.remove(0) } else { Json::Array(ends) })
        });
        push("inputs", object(inputs.collect()));
    }
    if !document.outputs.is_empty() {
        let outputs = document.outputs.iter().map(|(name, end)| (name.clone(), end.to_string().into()));
        push("outputs", object(outputs.collect()));
    }
    if !document.layout.is_empty() {
        let places = document.layout.iter().map(|(name, place)| (name.clone(), vector(place)));
        push("layout", object(places.collect()));
    }
    if !document.bends.is_empty() {
        let bends = document.bends.iter().map(|(wire, points)| {
            (wire.to_string(), Json::Array(points.iter().map(|point| vector(point)).collect()))
        });
        push("bends", object(bends.collect()));
    }
    if !document.frames.is_empty() {
        let frames = document.frames.iter().map(|frame| {
            let mut fields = vec![
                ("title".to_owned(), frame.title.clone().into()),
                ("at".to_owned(), vector(&frame.at)),
                ("size".to_owned(), vector(&frame.size)),
            ];
            fields.extend(frame.color.map(|color| ("color".to_owned(), vector(&color))));
            object(fields)
        });
        push("frames", Json::Array(frames.collect()));
    }
    fields
}

fn node_fields(node: &Node) -> Map<String, Json> {
    let mut fields = Map::from_iter([("type".to_owned(), node.type_id.clone().into())]);
    for (name, is_set) in [("mute", node.mute), ("bypass", node.bypass)] {
        if is_set {
            fields.insert(name.to_owned(), true.into());
        }
    }
    fields.extend(node.params.clone());
    fields.extend(node.inside.iter().flat_map(|inside| self::fields(inside)));
    fields
}

fn vector(values: &[f64]) -> Json {
    Json::Array(values.iter().map(|x| Json::Number(json_number(*x))).collect())
}

/// Letters that a line has at most which holds several entries, but for the comma.
const WIDTH: usize = 120;

/// The text of `json` with a line end.
pub fn pretty(json: &Json) -> String {
    let mut text = String::new();
    write(json, 0, &mut text);
    text.push('\n');
    text
}

fn write(json: &Json, depth: usize, text: &mut String) {
    match json {
        Json::Array(items) if !is_short(items) => {
            let entries = items.iter().map(|item| (String::new(), item));
            write_lines(['[', ']'], entries, depth, text);
        }
        Json::Array(items) => {
            text.push('[');
            for (idx, item) in items.iter().enumerate() {
                *text += if idx == 0 { "" } else { ", " };
                write(item, depth, text);
            }
            text.push(']');
        }
        Json::Object(fields) if !fields.is_empty() => {
            let before = text.len() - text.rfind('\n').map_or(0, |end| end + 1);
            if let Some(line) = on_a_line(fields).filter(|line| before + line.len() <= WIDTH) {
                *text += &line;
                return;
            }
            let entries =
                fields.iter().map(|(name, value)| (format!("{}: ", Json::from(name.as_str())), value));
            write_lines(['{', '}'], entries, depth, text);
        }
        other => *text += &other.to_string(),
    }
}

/// `{ "type": "sun", "direction": [0, -1, 0] }`. `None` for what holds more than vectors, and for vectors alone: places
/// of nodes are read one below the other.
fn on_a_line(fields: &Map<String, Json>) -> Option<String> {
    let is_flat = |json: &Json| match json {
        Json::Array(items) => is_short(items),
        other => !other.is_object(),
    };
    let is_record = fields.values().all(is_flat) && !fields.values().all(Json::is_array);
    is_record.then(|| {
        let entries = fields.iter().map(|(name, value)| {
            let mut text = format!("{}: ", Json::from(name.as_str()));
            write(value, 0, &mut text);
            text
        });
        format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
    })
}

/// A vector, or a key of a frame and a number or a vector.
fn is_short(items: &[Json]) -> bool {
    let is_vector = |items: &[Json]| items.iter().all(Json::is_number);
    match items {
        [Json::Number(_), Json::Array(items)] => is_vector(items),
        items => is_vector(items),
    }
}

fn write_lines<'a>(
    [open, close]: [char; 2],
    entries: impl Iterator<Item = (String, &'a Json)>,
    depth: usize,
    text: &mut String,
) {
    text.push(open);
    for (idx, (label, value)) in entries.enumerate() {
        *text += if idx == 0 { "\n" } else { ",\n" };
        *text += &"  ".repeat(depth + 1);
        *text += &label;
        write(value, depth + 1, text);
    }
    text.push('\n');
    *text += &"  ".repeat(depth);
    text.push(close);
}
