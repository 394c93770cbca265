//! Changes of a document: one parameter set from text here, `--set node.parameter=value`, and in the modules
//! below nodes, wires, the clipboard, groups with their ports, and the folder. What is refused leaves the document as it was.
//!
//! The text is JSON; what is no JSON is a string where a string is taken (text, choice, path), else an
//! error. A member of a record is `medium.emission.flame`, and the record comes to be when it was null.
//! Paths on a command line start at the working directory, those of a file at the file, so a path is
//! made absolute here. The value is checked before the document changes. Tested by values of each form
//! and the exact text of every error.

mod clipboard;
mod group_ports;
mod groups;
mod nodes;
mod paths;
mod unknown;
mod wires;

use std::path::Path;

use serde_json::{Map, Value as Json};

use super::check::{unknown_node, unknown_type};
use super::document::{Document, parse_json};
use super::params::{Moment, Reading, describe, parse, unknown_param};
use super::spec::{Catalog, ParamKind, ParamSpec};

/// Why a parameter cannot be set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SetError {
    /// The name has no dot.
    #[error("'{0}' names no parameter; write node.parameter=value")]
    Name(String),
    /// The node, its kind or the parameter is not there, or the value is not allowed.
    #[error("cannot set '{name}': {message}")]
    Refused {
        /// What was to be set.
        name: String,
        /// What was found and what is allowed.
        message: String,
    },
}

/// Text for a node that is not there.
fn no_node(document: &Document, name: &str) -> String {
    format!("'{name}': {}", unknown_node(document, name))
}

impl Document {
    /// Sets `node.parameter`, `node.record.member` or `group/node.parameter` to the JSON or string `text`;
    /// `node.mute` and `node.bypass` too.
    ///
    /// # Errors
    /// Says what is allowed; the document is then as it was.
    pub fn set(&mut self, catalog: Catalog, name: &str, text: &str) -> Result<(), SetError> {
        let refused = |message: String| SetError::Refused { name: name.to_owned(), message };
        let (node_name, field) = name.split_once('.').ok_or_else(|| SetError::Name(name.to_owned()))?;
        let Some(node) = self.node(node_name) else {
            return Err(refused(unknown_node(self, node_name)));
        };
        if let "mute" | "bypass" = field {
            let is_set = text.trim().parse();
            let is_set = is_set.map_err(|_| refused(format!("{field} is {text}; write true or false")))?;
            let node = self.node_mut(node_name).expect("found above");
            *(if field == "mute" { &mut node.mute } else { &mut node.bypass }) = is_set;
            return Ok(());
        }
        if node.inside.is_some() {
            let message = format!("a group has no parameters; write {node_name}/node.parameter=value");
            return Err(refused(message));
        }
        let Some(kind) = catalog.find(&node.type_id) else {
            return Err(refused(unknown_type(&node.type_id, catalog)));
        };
        let spec = find_param(field, kind.params).map_err(refused)?;
        let value = read_value(field, spec, text, &self.base).map_err(refused)?;
        let mut segments = field.split('.');
        let mut object = &mut self.node_mut(node_name).expect("found above").params;
        let mut last = segments.next().expect("split gives at least one");
        for segment in segments {
            let record = object.entry(last).or_insert(Json::Null);
            if !record.is_object() {
                *record = Json::Object(Map::new());
            }
            object = record.as_object_mut().expect("made an object above");
            last = segment;
        }
        object.insert(last.to_owned(), value);
        Ok(())
    }
}

/// The spec of `field`, whose dots lead into records.
fn find_param(field: &str, mut specs: &'static [ParamSpec]) -> Result<&'static ParamSpec, String> {
    let mut segments = field.split('.').peekable();
    while let Some(name) = segments.next() {
        let found = specs.iter().find(|spec| spec.name == name);
        let spec = found.ok_or_else(|| unknown_param(field, name, specs))?;
        match (segments.peek(), spec.kind) {
            (None, _) => return Ok(spec),
            (Some(_), ParamKind::Record(members)) => specs = members,
            (Some(member), _) => {
                return Err(format!("'{name}' has no member '{member}'; it is {}", spec.form()));
            }
        }
    }
    unreachable!("split gives at least one segment");
}

fn read_value(field: &str, spec: &ParamSpec, text: &str, base: &Path) -> Result<Json, String> {
    let is_path = matches!(spec.kind, ParamKind::Path | ParamKind::OutPath);
    let takes_text = is_path || matches!(spec.kind, ParamKind::Text | ParamKind::Grid | ParamKind::Choice(_));
    let json = match parse_json(text) {
        Ok(json) => json,
        Err(_) if takes_text => text.into(),
        Err(_) => {
            let found = describe(&text.into());
            return Err(format!("{found} is not valid JSON; write {}", spec.form()));
        }
    };
    let reading = Reading { base, moment: Moment::default() };
    if let Err(problems) = parse(field, spec, &json, &reading) {
        let messages: Vec<String> = problems.into_iter().map(|problem| problem.message).collect();
        let quoted = match &json {
            Json::String(_) => String::new(),
            _ if takes_text => format!("; in quotes it is one: '{}'", Json::from(text)),
            _ => String::new(),
        };
        return Err(messages.join("; also ") + &quoted);
    }
    match &json {
        Json::String(path) if is_path => absolute(path),
        _ => Ok(json),
    }
}

fn absolute(path: &str) -> Result<Json, String> {
    let full = std::path::absolute(path)
        .map_err(|error| format!("the working directory cannot be read: {error}"))?;
    let text = full.to_str();
    let text = text.ok_or("the working directory is not UTF-8; write an absolute path")?;
    Ok(text.into())
}

#[cfg(test)]
mod tests;
