//! What a parameter is, as data: name, form, unit, default, soft range, hard limits, doc.
//!
//! The builders are `const fn`, so that a node's table of parameters is checked by the compiler; each
//! reads as one line. A range is one interval, the same for every component of a vector. A parameter
//! has a default, is required (`Default::Required`), or may be null (`or_null`). Tested by the ends of
//! ranges and by the texts that messages and help are made of.

use std::fmt;

use serde_json::{Number, Value as Json};

/// One parameter.
#[derive(Debug, Clone, Copy)]
pub struct ParamSpec {
    /// Name in the file.
    pub name: &'static str,
    /// Its form.
    pub kind: ParamKind,
    /// Unit, empty for none: `1/m`, `m`, `deg`.
    pub unit: &'static str,
    /// What holds when the file says nothing.
    pub default: Default,
    /// What a slider spans.
    pub soft: Option<(f64, f64)>,
    /// What is allowed, for each component.
    pub hard: Limits,
    /// Of a file: how its name may end, lower case without the dot; empty for anything.
    pub endings: &'static [&'static str],
    /// What the frame does to it.
    pub timing: Timing,
    /// What its user reads.
    pub doc: &'static str,
}

/// Form of a parameter.
#[derive(Debug, Clone, Copy)]
pub enum ParamKind {
    /// A finite number.
    Float,
    /// A whole number.
    Int,
    /// One of these whole numbers.
    IntChoice(&'static [i64]),
    /// true or false.
    Bool,
    /// A string.
    Text,
    /// The name of a grid of the volume that the node reads.
    Grid,
    /// One of these strings.
    Choice(&'static [&'static str]),
    /// A file or folder that is read.
    Path,
    /// A file that is written.
    OutPath,
    /// So many numbers.
    Vector(usize),
    /// Three numbers, or one for grey.
    Rgb,
    /// Three numbers, not all zero; need not be of unit length.
    Direction,
    /// Control points: rows of numbers by these names, of which the first rises from row to row and is
    /// not bound by the limits.
    Curve(&'static [&'static str]),
    /// An object with these parameters, or null.
    Record(&'static [ParamSpec]),
}

impl ParamKind {
    /// Whether `{"keys": …}` may stand for it.
    pub fn takes_keys(self) -> bool {
        matches!(self, Self::Float | Self::Vector(_) | Self::Rgb | Self::Direction)
    }
}

/// What the frame that is looked at does to a parameter. One that the frame sets chooses files and nothing
/// else: cache keys hold the identity of the files instead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Timing {
    /// Nothing, unless it has keys.
    Own,
    /// It is the frame, whatever the file says.
    Frame,
    /// It is true where a node is looked at for the sake of another frame.
    Aside,
}

/// What holds when the file says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Default {
    /// Nothing: the file must say it.
    Required,
    /// null: the parameter is not set, and may be written as null.
    Null,
    /// A number.
    Float(f64),
    /// A whole number.
    Int(i64),
    /// true or false.
    Bool(bool),
    /// A string, a choice or a path.
    Text(&'static str),
    /// Three numbers of a color, position or direction.
    Three([f64; 3]),
    /// The numbers of a vector.
    Floats(&'static [f64]),
}

/// An interval; `None` is no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Lower end.
    pub min: Option<f64>,
    /// Upper end.
    pub max: Option<f64>,
    /// The ends themselves are not allowed.
    pub open_min: bool,
    /// The same for the upper end.
    pub open_max: bool,
}

impl ParamSpec {
    const fn new(name: &'static str, kind: ParamKind, default: Default) -> Self {
        let timing = Timing::Own;
        Self { name, kind, unit: "", default, soft: None, hard: Limits::NONE, endings: &[], timing, doc: "" }
    }

    /// A finite number.
    pub const fn float(name: &'static str, default: f64) -> Self {
        Self::new(name, ParamKind::Float, Default::Float(default))
    }

    /// A whole number.
    pub const fn int(name: &'static str, default: i64) -> Self {
        Self::new(name, ParamKind::Int, Default::Int(default))
    }

    /// One of these whole numbers, the first by default.
    pub const fn int_choice(name: &'static str, choices: &'static [i64]) -> Self {
        Self::new(name, ParamKind::IntChoice(choices), Default::Int(choices[0]))
    }

    /// true or false.
    pub const fn bool(name: &'static str, default: bool) -> Self {
        Self::new(name, ParamKind::Bool, Default::Bool(default))
    }

    /// A string.
    pub const fn text(name: &'static str, default: &'static str) -> Self {
        Self::new(name, ParamKind::Text, Default::Text(default))
    }

    /// The name of a grid.
    pub const fn grid(name: &'static str, default: &'static str) -> Self {
        Self::new(name, ParamKind::Grid, Default::Text(default))
    }

    /// Control points with these columns, null by default.
    pub const fn curve(name: &'static str, columns: &'static [&'static str]) -> Self {
        Self::new(name, ParamKind::Curve(columns), Default::Null)
    }

    /// One of `choices`, the first by default.
    pub const fn choice(name: &'static str, choices: &'static [&'static str]) -> Self {
        Self::new(name, ParamKind::Choice(choices), Default::Text(choices[0]))
    }

    /// A file or folder that is read; required unless `or_null` follows.
    pub const fn path(name: &'static str) -> Self {
        Self::new(name, ParamKind::Path, Default::Required)
    }

    /// A file that is written.
    pub const fn out_path(name: &'static str, default: &'static str) -> Self {
        Self::new(name, ParamKind::OutPath, Default::Text(default))
    }

    /// As many numbers as the default has.
    pub const fn vector(name: &'static str, default: &'static [f64]) -> Self {
        Self::new(name, ParamKind::Vector(default.len()), Default::Floats(default))
    }

    /// Three numbers, or one for grey.
    pub const fn rgb(name: &'static str, default: [f64; 3]) -> Self {
        Self::new(name, ParamKind::Rgb, Default::Three(default))
    }

    /// Three numbers, not all zero.
    pub const fn direction(name: &'static str, default: [f64; 3]) -> Self {
        Self::new(name, ParamKind::Direction, Default::Three(default))
    }

    /// An object or null, null by default.
    pub const fn record(name: &'static str, params: &'static [ParamSpec]) -> Self {
        Self::new(name, ParamKind::Record(params), Default::Null)
    }

    /// Not set by default, and may be null: for a parameter that has no value of its own for "none".
    pub const fn or_null(mut self) -> Self {
        self.default = Default::Null;
        self
    }

    /// Allowed from `min` to `max`, both included.
    pub const fn between(mut self, min: f64, max: f64) -> Self {
        self.hard.min = Some(min);
        self.hard.max = Some(max);
        self
    }

    /// Allowed from `min`, included.
    pub const fn at_least(mut self, min: f64) -> Self {
        self.hard.min = Some(min);
        self
    }

    /// Allowed above `min`, which is not.
    pub const fn above(mut self, min: f64) -> Self {
        self.hard.min = Some(min);
        self.hard.open_min = true;
        self
    }

    /// Allowed up to `max`, included.
    pub const fn at_most(mut self, max: f64) -> Self {
        self.hard.max = Some(max);
        self
    }

    /// Allowed below `max`, which is not.
    pub const fn below(mut self, max: f64) -> Self {
        self.hard.max = Some(max);
        self.hard.open_max = true;
        self
    }

    /// The ends of the range are not allowed.
    pub const fn open(mut self) -> Self {
        self.hard.open_min = true;
        self.hard.open_max = true;
        self
    }

    /// How the file's name may end, what is usual first.
    pub const fn endings(mut self, endings: &'static [&'static str]) -> Self {
        self.endings = endings;
        self
    }

    /// What the frame does to it.
    pub const fn timed(mut self, timing: Timing) -> Self {
        self.timing = timing;
        self
    }

    /// What a slider spans.
    pub const fn soft(mut self, min: f64, max: f64) -> Self {
        self.soft = Some((min, max));
        self
    }

    /// Its unit.
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// What its user reads.
    pub const fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// The default as it would stand in the file; `None` when the file must say it.
    pub fn default_json(&self) -> Option<Json> {
        self.default.to_json()
    }

    /// What may be written, for messages and help: `a number, 0..=1`.
    pub fn form(&self) -> String {
        let mut form = match self.kind {
            ParamKind::Float => "a number".to_owned(),
            ParamKind::Int => "a whole number".to_owned(),
            ParamKind::IntChoice(choices) => format!("one of {}", list(choices)),
            ParamKind::Bool => "true or false".to_owned(),
            ParamKind::Text => "a string".to_owned(),
            ParamKind::Grid => "a grid's name as a string".to_owned(),
            ParamKind::Choice(choices) => format!("one of {}", choices.join(", ")),
            ParamKind::Path | ParamKind::OutPath => "a path as a string".to_owned(),
            ParamKind::Vector(count) => format!("{count} numbers in brackets"),
            ParamKind::Rgb => "3 numbers in brackets or one for grey".to_owned(),
            ParamKind::Direction => "3 numbers in brackets, not all zero".to_owned(),
            ParamKind::Curve(columns) => {
                format!("1 or more rows [{}] with rising {}", columns.join(", "), columns[0])
            }
            ParamKind::Record(params) => {
                let names: Vec<&str> = params.iter().map(|param| param.name).collect();
                format!("an object with {}", names.join(", "))
            }
        };
        if self.hard != Limits::NONE {
            let of_which = if matches!(self.kind, ParamKind::Curve(_)) { "the others " } else { "" };
            form += &format!(", {of_which}{}", self.hard);
        }
        if self.default == Default::Null {
            form += ", or null";
        }
        form
    }
}

impl Default {
    fn to_json(self) -> Option<Json> {
        let number = |x: f64| Json::Number(json_number(x));
        let numbers = |values: &[f64]| Json::Array(values.iter().copied().map(number).collect());
        match self {
            Default::Required => None,
            Default::Null => Some(Json::Null),
            Default::Float(x) => Some(number(x)),
            Default::Int(i) => Some(i.into()),
            Default::Bool(b) => Some(b.into()),
            Default::Text(text) => Some(text.into()),
            Default::Three(values) => Some(numbers(&values)),
            Default::Floats(values) => Some(numbers(values)),
        }
    }
}

/// `0, 8, 14`.
pub(in crate::graph) fn list(numbers: &[i64]) -> String {
    numbers.iter().map(i64::to_string).collect::<Vec<_>>().join(", ")
}

/// A number as people write it: `1`, not `1.0`.
///
/// # Panics
/// When `x` is not finite: JSON has no such number, so it can only come from us.
pub fn json_number(x: f64) -> Number {
    // Below 2^53 every whole f64 is exact as i64; -0.0 keeps its sign only as a float.
    if x.fract() == 0.0 && x.abs() < 9_007_199_254_740_992.0 && !(x == 0.0 && x.is_sign_negative()) {
        return Number::from(x as i64);
    }
    Number::from_f64(x).expect("a parameter is finite")
}

impl Limits {
    /// No limits.
    pub const NONE: Self = Self { min: None, max: None, open_min: false, open_max: false };

    /// Whether `x` is inside; never for a number that is not finite.
    pub fn contains(&self, x: f64) -> bool {
        let above = self.min.is_none_or(|min| if self.open_min { x > min } else { x >= min });
        let below = self.max.is_none_or(|max| if self.open_max { x < max } else { x <= max });
        x.is_finite() && above && below
    }
}

impl fmt::Display for Limits {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // 1e28, not its 29 digits.
        let number = |x: f64| if x.abs() < 1e16 { format!("{x}") } else { format!("{x:e}") };
        let (min, max) = (self.min.map(number), self.max.map(number));
        let low = if self.open_min { "<" } else { "<=" };
        let high = if self.open_max { "<" } else { "<=" };
        match (min, max) {
            (Some(min), Some(max)) if !self.open_min && !self.open_max => {
                write!(f, "{min}..={max}")
            }
            (Some(min), Some(max)) => write!(f, "{min} {low} value {high} {max}"),
            (Some(min), None) if self.open_min => write!(f, "value > {min}"),
            (Some(min), None) => write!(f, "value >= {min}"),
            (None, Some(max)) if self.open_max => write!(f, "value < {max}"),
            (None, Some(max)) => write!(f, "value <= {max}"),
            (None, None) => write!(f, "any"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn open_and_closed_ends() {
        let closed = ParamSpec::float("x", 0.0).between(-1.0, 1.0);
        assert!(closed.hard.contains(1.0) && closed.hard.contains(-1.0));
        let open = closed.open();
        assert!(!open.hard.contains(1.0) && !open.hard.contains(-1.0));
        assert!(open.hard.contains(1.0_f64.next_down()));
        assert!(!closed.hard.contains(f64::NAN));
        assert!(!Limits::NONE.contains(f64::INFINITY));
    }

    #[test]
    fn forms_name_what_is_allowed() {
        const KINDS: &[&str] = &["sphere", "box"];
        const GLOW: ParamSpec = ParamSpec::record("x", &[ParamSpec::text("a", "")]);
        let form = |param: ParamSpec| param.form();
        assert_eq!(form(ParamSpec::float("x", 0.0)), "a number");
        assert_eq!(form(ParamSpec::int("x", 0).at_least(0.0)), "a whole number, value >= 0");
        assert_eq!(form(ParamSpec::float("x", 1.0).above(0.0)), "a number, value > 0");
        assert_eq!(form(ParamSpec::float("x", 1.0).at_most(2.5)), "a number, value <= 2.5");
        assert_eq!(form(ParamSpec::float("x", 1.0).below(2.0)), "a number, value < 2");
        assert_eq!(form(ParamSpec::float("x", 1.0).between(0.0, 1e28)), "a number, 0..=1e28");
        assert_eq!(form(ParamSpec::float("x", 1.0).above(0.0).at_most(1.0)), "a number, 0 < value <= 1");
        assert_eq!(form(ParamSpec::choice("x", KINDS)), "one of sphere, box");
        assert_eq!(form(ParamSpec::int_choice("x", &[0, 8, 14])), "one of 0, 8, 14");
        assert_eq!(form(ParamSpec::path("x").or_null()), "a path as a string, or null");
        assert_eq!(form(ParamSpec::vector("x", &[30.0, 70.0])), "2 numbers in brackets");
        let curve = ParamSpec::curve("x", &["value", "opacity"]).between(0.0, 1.0);
        let rows = "1 or more rows [value, opacity] with rising value, the others 0..=1, or null";
        assert_eq!(form(curve), rows);
        assert_eq!(form(ParamSpec::grid("x", "density")), "a grid's name as a string");
        assert_eq!(form(GLOW), "an object with a, or null");
    }

    #[test]
    fn defaults_stand_as_people_write_them() {
        let json = |param: ParamSpec| param.default_json().map(|json| json.to_string());
        assert_eq!(json(ParamSpec::float("x", 1.0)).unwrap(), "1");
        assert_eq!(json(ParamSpec::float("x", 0.25)).unwrap(), "0.25");
        assert_eq!(json(ParamSpec::float("x", -0.0)).unwrap(), "-0.0");
        assert_eq!(json(ParamSpec::rgb("x", [1.0, 0.5, 0.0])).unwrap(), "[1,0.5,0]");
        assert_eq!(json(ParamSpec::int("x", 3).or_null()).unwrap(), "null");
        assert_eq!(json(ParamSpec::path("x")), None);
    }
}
