//! JSON as people like to read and diff it: two spaces, one entry a line, but a vector and a key on one.
//!
//! serde_json's own pretty printer sets every component of a vector on a line of its own. Tested in the
//! tests of the document.

use serde_json::Value as Json;

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
            let entries =
                fields.iter().map(|(name, value)| (format!("{}: ", Json::from(name.as_str())), value));
            write_lines(['{', '}'], entries, depth, text);
        }
        other => *text += &other.to_string(),
    }
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
