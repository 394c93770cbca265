//! Parameters of one node, read from the file's JSON against its `ParamSpec`s: every value has its
//! declared form, is finite and inside the hard limits, and defaults are filled in.
//!
//! A node asks by name and gets a plain value; asking for a name or form that its spec does not declare
//! is our own mistake and panics. Nothing is clamped: what is outside is a problem that names the
//! allowed range. Relative paths are joined to the folder of the graph here, once. What changes with the
//! frame has its value of the [`Moment`] afterwards: a node sees plain values. Tested for every form: what
//! is taken, and the exact text of what is refused.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value as Json};

use super::spec::{Default, ParamKind, ParamSpec, Timing, list};
use super::suggest::did_you_mean;

mod keys;

/// When a node is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, std::default::Default)]
pub struct Moment {
    /// For the sake of another frame, which fades from this one or to it. There need not be one here.
    pub is_aside: bool,
    /// Frame of the scene; without one, parameters with keys have the value of their first.
    pub frame: Option<i64>,
}

/// Validated parameters, in the order of the spec.
#[derive(Debug, Clone, PartialEq)]
pub struct Params {
    entries: Vec<(&'static str, ParamValue)>,
}

/// One validated value.
#[derive(Debug, Clone, PartialEq)]
pub enum ParamValue {
    /// Not set.
    Null,
    /// A finite number.
    Float(f64),
    /// A whole number.
    Int(i64),
    /// true or false.
    Bool(bool),
    /// A string or a choice.
    Text(String),
    /// A path, already joined to the graph's folder.
    Path(PathBuf),
    /// A vector, color or direction.
    Floats(Vec<f64>),
    /// The control points of a curve, row by row.
    Rows(Vec<Vec<f64>>),
    /// A record.
    Record(Params),
}

/// What is wrong with one parameter.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParamProblem {
    /// The parameter, `emission.flame` inside a record.
    pub field: String,
    /// What was found, what is allowed, what to do; names the parameter.
    pub message: String,
}

impl Params {
    /// Reads `given` (the node's object without its `type`) as it is at a moment. Relative paths start at
    /// `base`.
    ///
    /// # Errors
    /// All problems at once, in the order of `given`, then what is missing.
    pub fn resolve(
        specs: &'static [ParamSpec],
        given: &Map<String, Json>,
        base: &Path,
        moment: Moment,
    ) -> Result<Self, Vec<ParamProblem>> {
        resolve_in("", specs, given, &Reading { base, moment })
    }

    /// The parameters of a node that says nothing but its type.
    ///
    /// # Errors
    /// Names the parameters that have no default.
    pub fn defaults(specs: &'static [ParamSpec]) -> Result<Self, Vec<ParamProblem>> {
        Self::resolve(specs, &Map::new(), Path::new(""), Moment::default())
    }

    /// Whether what is given can have another value in another frame.
    pub fn vary(specs: &[ParamSpec], given: &Map<String, Json>) -> bool {
        specs.iter().any(|spec| match (spec.timing, spec.kind, given.get(spec.name)) {
            (Timing::Frame, ..) => true,
            (_, ParamKind::Record(members), Some(Json::Object(given))) => Self::vary(members, given),
            (_, _, Some(json)) => keys::of(spec, json).is_some(),
            _ => false,
        })
    }

    /// All values in the order of the spec.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, &ParamValue)> {
        self.entries.iter().map(|(name, value)| (*name, value))
    }

    /// Whether a parameter that may be null has a value.
    pub fn is_set(&self, name: &str) -> bool {
        *self.get(name) != ParamValue::Null
    }

    /// A number; whole numbers too.
    pub fn f64(&self, name: &str) -> f64 {
        match self.get(name) {
            ParamValue::Float(x) => *x,
            other => mistake(name, "a number", other),
        }
    }

    /// A whole number.
    pub fn i64(&self, name: &str) -> i64 {
        match self.get(name) {
            ParamValue::Int(i) => *i,
            other => mistake(name, "a whole number", other),
        }
    }

    /// true or false.
    pub fn bool(&self, name: &str) -> bool {
        match self.get(name) {
            ParamValue::Bool(b) => *b,
            other => mistake(name, "a bool", other),
        }
    }

    /// A string or a choice.
    pub fn text(&self, name: &str) -> &str {
        match self.get(name) {
            ParamValue::Text(text) => text,
            other => mistake(name, "a string", other),
        }
    }

    /// A path; a relative one has been joined to the graph's folder.
    pub fn path(&self, name: &str) -> &Path {
        match self.get(name) {
            ParamValue::Path(path) => path,
            other => mistake(name, "a path", other),
        }
    }

    /// A color.
    pub fn rgb(&self, name: &str) -> [f64; 3] {
        self.vec(name)
    }

    /// `N` numbers: a vector, a color, or a direction as it was written.
    pub fn vec<const N: usize>(&self, name: &str) -> [f64; N] {
        match self.get(name) {
            ParamValue::Floats(values) if values.len() == N => std::array::from_fn(|axis| values[axis]),
            other => mistake(name, "numbers of that count", other),
        }
    }

    /// A direction, made unit length.
    pub fn unit(&self, name: &str) -> [f64; 3] {
        let v: [f64; 3] = self.vec(name);
        // Scaled by the largest component first, so that squares neither overflow nor vanish.
        let largest = v.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let scaled = v.map(|x| x / largest);
        let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        scaled.map(|x| x / length)
    }

    /// The control points of a curve, `None` when it is null.
    pub fn rows(&self, name: &str) -> Option<&[Vec<f64>]> {
        match self.get(name) {
            ParamValue::Rows(rows) => Some(rows),
            ParamValue::Null => None,
            other => mistake(name, "rows", other),
        }
    }

    /// A record, `None` when it is null.
    pub fn record(&self, name: &str) -> Option<&Params> {
        match self.get(name) {
            ParamValue::Record(params) => Some(params),
            ParamValue::Null => None,
            other => mistake(name, "a record", other),
        }
    }

    fn get(&self, name: &str) -> &ParamValue {
        let entry = self.entries.iter().find(|(known, _)| *known == name);
        let (_, value) = entry.unwrap_or_else(|| panic!("parameter '{name}' is not declared"));
        value
    }
}

/// One value as a file could give it, checked before it is written into a document; `field` is its name
/// in messages.
///
/// # Errors
/// What is wrong, each component and record member on its own.
pub fn check_value(
    field: &str,
    spec: &ParamSpec,
    json: &Json,
    base: &Path,
    moment: Moment,
) -> Result<ParamValue, Vec<ParamProblem>> {
    parse(field, spec, json, &Reading { base, moment })
}

fn mistake(name: &str, asked: &str, found: &ParamValue) -> ! {
    panic!("parameter '{name}' was asked for as {asked} but is {found:?}")
}

/// Where and when parameters are read.
pub(super) struct Reading<'a> {
    /// Relative paths start here.
    pub base: &'a Path,
    /// What changes with the frame has its value of this one.
    pub moment: Moment,
}

impl Reading<'_> {
    /// What the moment says about a parameter, whatever is given.
    fn timed(&self, spec: &ParamSpec) -> Option<ParamValue> {
        match spec.timing {
            Timing::Frame => self.moment.frame.map(ParamValue::Int),
            Timing::Aside => self.moment.is_aside.then_some(ParamValue::Bool(true)),
            Timing::Own => None,
        }
    }
}

fn resolve_in(
    prefix: &str,
    specs: &'static [ParamSpec],
    given: &Map<String, Json>,
    reading: &Reading,
) -> Result<Params, Vec<ParamProblem>> {
    let mut problems = Vec::new();
    for name in given.keys() {
        if !specs.iter().any(|spec| spec.name == name) {
            problems.push(ParamProblem {
                field: format!("{prefix}{name}"),
                message: unknown_param(&format!("{prefix}{name}"), name, specs),
            });
        }
    }
    let mut entries = Vec::with_capacity(specs.len());
    for spec in specs {
        let field = format!("{prefix}{}", spec.name);
        let default = spec.default_json();
        let result = match given.get(spec.name).or(default.as_ref()) {
            Some(json) => parse(&field, spec, json, reading),
            None => Err(vec![ParamProblem {
                message: format!("{field} is missing; write {}", spec.form()),
                field,
            }]),
        };
        match result {
            Ok(value) => entries.push((spec.name, reading.timed(spec).unwrap_or(value))),
            Err(found) => problems.extend(found),
        }
    }
    if problems.is_empty() { Ok(Params { entries }) } else { Err(problems) }
}

/// Text for a parameter `name`, shown as `field`, that is not among `specs`.
pub(super) fn unknown_param(field: &str, name: &str, specs: &[ParamSpec]) -> String {
    let names: Vec<&str> = specs.iter().map(|spec| spec.name).collect();
    let allowed = if names.is_empty() {
        "none are taken here".to_owned()
    } else {
        format!("allowed are {}", names.join(", "))
    };
    let near = did_you_mean(name, names.iter().copied());
    format!("unknown parameter '{field}';{near} {allowed}")
}

/// One value against its spec; `field` is its name in messages.
///
/// # Errors
/// What is wrong, each component and record member on its own.
pub(super) fn parse(
    field: &str,
    spec: &ParamSpec,
    json: &Json,
    reading: &Reading,
) -> Result<ParamValue, Vec<ParamProblem>> {
    if let Some(given) = keys::of(spec, json) {
        return keys::parse(field, spec, given, reading);
    }
    let refuse = |message: String| Err(vec![ParamProblem { field: field.to_owned(), message }]);
    let wrong_form = || refuse(format!("{field} is {}; write {}", describe(json), spec.form()));
    match (spec.kind, json) {
        (_, Json::Null) if spec.default == Default::Null => Ok(ParamValue::Null),
        (ParamKind::Float, Json::Number(_)) => Ok(ParamValue::Float(in_limits(field, spec, json)?[0])),
        (ParamKind::Int, Json::Number(number)) => {
            let Some(whole) = whole(number) else {
                return wrong_form();
            };
            in_limits(field, spec, json)?;
            Ok(ParamValue::Int(whole))
        }
        (ParamKind::IntChoice(choices), Json::Number(number)) => match whole(number) {
            Some(chosen) if choices.contains(&chosen) => Ok(ParamValue::Int(chosen)),
            _ => refuse(format!("{field} is {number}; allowed are {}", list(choices))),
        },
        (ParamKind::Bool, Json::Bool(b)) => Ok(ParamValue::Bool(*b)),
        (ParamKind::Text | ParamKind::Grid, Json::String(text)) => Ok(ParamValue::Text(text.clone())),
        (ParamKind::Choice(choices), Json::String(text)) => {
            if choices.contains(&text.as_str()) {
                return Ok(ParamValue::Text(text.clone()));
            }
            let near = did_you_mean(text, choices.iter().copied());
            refuse(format!("{field} is '{text}';{near} allowed are {}", choices.join(", ")))
        }
        (ParamKind::Path | ParamKind::OutPath, Json::String(text)) if text.is_empty() => {
            refuse(format!("{field} is empty; write {}", spec.form()))
        }
        (ParamKind::Path | ParamKind::OutPath, Json::String(text)) => {
            Ok(ParamValue::Path(reading.base.join(text)))
        }
        (ParamKind::Vector(count), Json::Array(items)) if all_numbers(items, count) => {
            Ok(ParamValue::Floats(in_limits(field, spec, json)?))
        }
        (ParamKind::Rgb, Json::Array(items)) if all_numbers(items, 3) => {
            Ok(ParamValue::Floats(in_limits(field, spec, json)?))
        }
        (ParamKind::Rgb, Json::Number(_)) => {
            let grey = in_limits(field, spec, json)?[0];
            Ok(ParamValue::Floats(vec![grey; 3]))
        }
        (ParamKind::Direction, Json::Array(items)) if all_numbers(items, 3) => {
            let values = in_limits(field, spec, json)?;
            if has_no_length(&values) {
                return refuse(format!("{field} has no length; write {}", spec.form()));
            }
            Ok(ParamValue::Floats(values))
        }
        (ParamKind::Curve(columns), Json::Array(rows)) if is_table(rows, columns.len()) => {
            curve(field, spec, columns, rows).map(ParamValue::Rows)
        }
        (ParamKind::Record(specs), Json::Object(given)) => {
            resolve_in(&format!("{field}."), specs, given, reading).map(ParamValue::Record)
        }
        _ => wrong_form(),
    }
}

fn has_no_length(direction: &[f64]) -> bool {
    direction.iter().all(|x| *x == 0.0)
}

fn all_numbers(items: &[Json], count: usize) -> bool {
    items.len() == count && items.iter().all(Json::is_number)
}

fn is_table(rows: &[Json], width: usize) -> bool {
    let is_row = |row: &Json| row.as_array().is_some_and(|items| all_numbers(items, width));
    !rows.is_empty() && rows.iter().all(is_row)
}

/// Rows whose first number rises; the others are inside the hard limits.
fn curve(
    field: &str,
    spec: &ParamSpec,
    columns: &[&str],
    rows: &[Json],
) -> Result<Vec<Vec<f64>>, Vec<ParamProblem>> {
    let mut values: Vec<Vec<f64>> = Vec::with_capacity(rows.len());
    let mut problems = Vec::new();
    let mut refuse = |message: String| problems.push(ParamProblem { field: field.to_owned(), message });
    for (idx, row) in rows.iter().enumerate() {
        let items = row.as_array().map_or(&[][..], Vec::as_slice);
        let row: Vec<f64> = items.iter().map(|item| item.as_f64().unwrap_or(f64::NAN)).collect();
        let name = columns[0];
        if !row[0].is_finite() {
            refuse(format!("{field}[{idx}].{name} = {} is no finite number", items[0]));
        } else if values.last().is_some_and(|before| before[0] >= row[0]) {
            let before = values[idx - 1][0];
            refuse(format!("{field}[{idx}].{name} = {} does not rise from {before}", items[0]));
        }
        for ((x, item), column) in row.iter().zip(items).zip(columns).skip(1) {
            if !spec.hard.contains(*x) {
                refuse(format!("{field}[{idx}].{column} = {item} is outside {}", spec.hard));
            }
        }
        values.push(row);
    }
    if problems.is_empty() { Ok(values) } else { Err(problems) }
}

/// `3` and `3.0` are whole; `3.5` and what an i64 cannot hold are not.
fn whole(number: &serde_json::Number) -> Option<i64> {
    number.as_i64().or_else(|| {
        let x = number.as_f64()?;
        // Beyond 2^53 a float no longer says which whole number was meant.
        (x.fract() == 0.0 && x.abs() <= 9_007_199_254_740_992.0).then_some(x as i64)
    })
}

/// The numbers of `json` (one or an array of them), each inside the hard limits.
fn in_limits(field: &str, spec: &ParamSpec, json: &Json) -> Result<Vec<f64>, Vec<ParamProblem>> {
    let one = std::slice::from_ref(json);
    let items = json.as_array().map_or(one, Vec::as_slice);
    let mut values = Vec::with_capacity(items.len());
    let mut problems = Vec::new();
    for (axis, item) in items.iter().enumerate() {
        let x = item.as_f64().unwrap_or(f64::NAN);
        values.push(x);
        if spec.hard.contains(x) {
            continue;
        }
        let component = match json {
            Json::Array(_) => format!("{field}[{axis}]"),
            _ => field.to_owned(),
        };
        let default = spec.default_json().unwrap_or_default();
        problems.push(ParamProblem {
            field: field.to_owned(),
            message: format!("{component} = {item} is outside {}; the default is {default}", spec.hard),
        });
    }
    if problems.is_empty() { Ok(values) } else { Err(problems) }
}

/// What was found, short enough for one line.
pub(super) fn describe(json: &Json) -> String {
    const LONGEST: usize = 40;
    let text = json.to_string();
    if text.chars().count() <= LONGEST {
        return text;
    }
    let head: String = text.chars().take(LONGEST).collect();
    format!("{head}…")
}

#[cfg(test)]
mod tests;
