//! Arithmetic in number fields: `2*pi`, `sqrt(2)/3`, `deg(30)`.
//!
//! Numbers (`1e-3`), `+ - * / ^` with the usual precedence (`^` binds tightest and to the right, `-2^2` is −4),
//! parentheses, the constants pi, tau, e, and the functions of [`FUNCTIONS`], in f64. Ours, because the crates that do
//! this are either abandoned (meval, fasteval) or of a license that does not fit (evalexpr). Limit: what is no finite
//! number is refused. Tested by values and by the text of every error.

/// Functions of one number; trigonometry in radians, `deg(30)` is 30 degrees in radians.
type Function = (&'static str, fn(f64) -> f64);

const FUNCTIONS: &[Function] = &[
    ("sqrt", f64::sqrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("abs", f64::abs),
    ("round", f64::round),
    ("deg", f64::to_radians),
];
const CONSTANTS: &[(&str, f64)] =
    &[("pi", std::f64::consts::PI), ("tau", std::f64::consts::TAU), ("e", std::f64::consts::E)];
/// Deeper than anybody writes, and far from the end of the stack.
const MOST_NESTED: usize = 64;

/// The value of a text.
///
/// # Errors
/// What was found and what is allowed.
pub fn evaluate(text: &str) -> Result<f64, String> {
    let mut parser = Parser { text, at: 0, depth: 0 };
    let value = parser.sum()?;
    if parser.peek().is_some() {
        return Err(parser.unexpected("an operator or the end"));
    }
    match value.is_finite() {
        true => Ok(value),
        false => Err(format!("'{}' is {value}; write what gives a finite number", text.trim())),
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn sum(&mut self) -> Result<f64, String> {
        let mut value = self.product()?;
        loop {
            value = match self.take(&['+', '-', '−']) {
                Some('+') => value + self.product()?,
                Some(_) => value - self.product()?,
                None => return Ok(value),
            };
        }
    }

    fn product(&mut self) -> Result<f64, String> {
        let mut value = self.signed()?;
        loop {
            value = match self.take(&['*', '/', '·']) {
                Some('/') => value / self.signed()?,
                Some(_) => value * self.signed()?,
                None => return Ok(value),
            };
        }
    }

    fn signed(&mut self) -> Result<f64, String> {
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(format!("more than {MOST_NESTED} levels deep; write it simpler"));
        }
        let value = match self.take(&['+', '-', '−']) {
            Some('+') => self.signed()?,
            Some(_) => -self.signed()?,
            None => {
                let base = self.atom()?;
                match self.take(&['^']) {
                    Some(_) => base.powf(self.signed()?),
                    None => base,
                }
            }
        };
        self.depth -= 1;
        Ok(value)
    }

    fn atom(&mut self) -> Result<f64, String> {
        if self.take(&['(']).is_some() {
            return self.closed();
        }
        let start = self.at;
        match self.peek() {
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(start),
            Some(c) if c.is_alphabetic() => {
                let name = self.word();
                if let Some((_, value)) = CONSTANTS.iter().find(|(known, _)| *known == name) {
                    return Ok(*value);
                }
                let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
                    let known: Vec<&str> =
                        CONSTANTS.iter().map(|c| c.0).chain(FUNCTIONS.iter().map(|f| f.0)).collect();
                    return Err(format!("'{name}' is not known; known are {}", known.join(", ")));
                };
                match self.take(&['(']) {
                    Some(_) => Ok(function(self.closed()?)),
                    None => Err(format!("'{name}' takes a number in parentheses: {name}(2)")),
                }
            }
            _ => Err(self.unexpected("a number")),
        }
    }

    /// What is left of a pair of parentheses.
    fn closed(&mut self) -> Result<f64, String> {
        let value = self.sum()?;
        match self.take(&[')']) {
            Some(_) => Ok(value),
            None => Err(self.unexpected("')'")),
        }
    }

    fn number(&mut self, start: usize) -> Result<f64, String> {
        let bytes = self.text.as_bytes();
        let digits = |at: &mut usize| {
            while bytes.get(*at).is_some_and(|b| b.is_ascii_digit() || *b == b'.') {
                *at += 1;
            }
        };
        digits(&mut self.at);
        // An exponent, unless it is the constant e that stands here.
        if matches!(bytes.get(self.at), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(self.at + 1), Some(b'+' | b'-')));
            if bytes.get(self.at + 1 + sign).is_some_and(u8::is_ascii_digit) {
                self.at += 1 + sign;
                digits(&mut self.at);
            }
        }
        let text = &self.text[start..self.at];
        text.parse().map_err(|_| format!("'{text}' is no number; write it as 1234.5 or 1e-3"))
    }

    fn word(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// The next character that is no space, which is stepped over if it is one of these.
    fn take(&mut self, wanted: &[char]) -> Option<char> {
        let next = self.peek().filter(|c| wanted.contains(c))?;
        self.at += next.len_utf8();
        Some(next)
    }

    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn unexpected(&mut self, wanted: &str) -> String {
        match self.peek() {
            Some(_) => format!("'{}' stands where {wanted} should", &self.text[self.at..]),
            None => format!("'{}' ends where {wanted} should stand", self.text.trim()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values() {
        use std::f64::consts::{E, PI};
        let cases = [
            ("2*pi", 2.0 * PI),
            ("sqrt(2)/3", 2f64.sqrt() / 3.0),
            ("deg(30)", 30f64.to_radians()),
            (" 1 + 2 * 3 - 4 / 8 ", 6.5),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("2^3^2", 512.0),
            ("(1 + 2) * 3", 9.0),
            ("1e-3", 0.001),
            ("1E+3", 1000.0),
            ("2*e", 2.0 * E),
            (".5", 0.5),
            ("8/4/2", 1.0),
            ("1 − 3", -2.0),
            ("--1", 1.0),
            ("abs(-3) + round(2.6)", 6.0),
            ("log10(1000) * ln(exp(2))", 6.0),
        ];
        for (text, value) in cases {
            let found = evaluate(text).unwrap();
            // A few roundings of values up to 512.
            assert!((found - value).abs() < 4.0 * f64::EPSILON * value.abs(), "{text}: {found}");
        }
    }

    #[test]
    fn mistakes() {
        let cases = [
            ("", "'' ends where a number should stand"),
            ("1 +", "'1 +' ends where a number should stand"),
            ("2 pi", "'pi' stands where an operator or the end should"),
            ("(1", "'(1' ends where ')' should stand"),
            ("1,5", "',5' stands where an operator or the end should"),
            ("1.2.3", "'1.2.3' is no number; write it as 1234.5 or 1e-3"),
            ("sqrt 2", "'sqrt' takes a number in parentheses: sqrt(2)"),
            ("1/0", "'1/0' is inf; write what gives a finite number"),
            ("sqrt(-1)", "'sqrt(-1)' is NaN; write what gives a finite number"),
        ];
        for (text, message) in cases {
            assert_eq!(evaluate(text).unwrap_err(), message, "{text}");
        }
        assert!(
            evaluate("sinh(1)").unwrap_err().starts_with("'sinh' is not known; known are pi, tau, e, sqrt")
        );
        assert!(evaluate(&"(".repeat(100_000)).unwrap_err().contains("levels deep"));
        assert!(evaluate(&"-".repeat(100_000)).unwrap_err().contains("levels deep"));
    }
}
