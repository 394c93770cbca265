//! JSON as people like to read and diff it: two spaces, one entry a line, numbers of a list on one line.
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
        Json::Array(items) if !items.is_empty() && !items.iter().all(Json::is_number) => {
            let entries = items.iter().map(|item| (String::new(), item));
            write_lines(['[', ']'], entries, depth, text);
        }
        Json::Array(items) => {
            let items: Vec<String> = items.iter().map(Json::to_string).collect();
            *text += &format!("[{}]", items.join(", "));
        }
        Json::Object(fields) if !fields.is_empty() => {
            let entries =
                fields.iter().map(|(name, value)| (format!("{}: ", Json::from(name.as_str())), value));
            write_lines(['{', '}'], entries, depth, text);
        }
        other => *text += &other.to_string(),
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
