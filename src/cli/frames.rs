//! `--frames 1-100x2` and the names of the files that they become.

use std::path::{Path, PathBuf};
use std::str::FromStr;

/// More is a slip of the finger.
const MOST: u64 = 1_000_000;

/// Frame numbers in the order in which they are rendered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frames(pub Vec<i64>);

impl FromStr for Frames {
    type Err = String;

    /// One frame `7`, a range `1-100`, or every second of it `1-100x2`.
    fn from_str(text: &str) -> Result<Self, String> {
        let number = |digits: &str| {
            let is_plain = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
            let number = is_plain.then(|| digits.parse::<i64>().ok()).flatten();
            number.ok_or("write 7, 1-100 or 1-100x2 (every second)")
        };
        let (range, step) = match text.split_once('x') {
            Some((range, step)) => (range, number(step)?),
            None => (text, 1),
        };
        let (first, last) = match range.split_once('-') {
            Some((first, last)) => (number(first)?, number(last)?),
            None => (number(range)?, number(range)?),
        };
        if first > last {
            return Err(format!("{first} comes after {last}; write {last}-{first}"));
        }
        if step == 0 {
            return Err("a step of 0 gets nowhere; write 1 or more".to_owned());
        }
        let count = (last - first) as u64 / step as u64 + 1;
        if count > MOST {
            return Err(format!("{count} frames; at most {MOST} are rendered at once"));
        }
        Ok(Self((first..=last).step_by(step as usize).collect()))
    }
}

/// Whether the name has a place for the frame's number.
pub fn is_pattern(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().contains('#'))
}

/// The file of a frame: `a_####.exr` becomes `a_0007.exr`, and `a.exr` does too.
pub fn file(path: &Path, frame: i64) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let numbered = match name.find('#') {
        Some(start) => {
            let rest = name[start..].trim_start_matches('#');
            let digits = name.len() - start - rest.len();
            format!("{}{frame:0digits$}{rest}", &name[..start])
        }
        None => match name.rsplit_once('.') {
            Some((stem, ending)) => format!("{stem}_{frame:04}.{ending}"),
            None => format!("{name}_{frame:04}"),
        },
    };
    path.with_file_name(numbered)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        let frames = |text: &str| text.parse::<Frames>().map(|frames| frames.0);
        assert_eq!(frames("7").unwrap(), [7]);
        assert_eq!(frames("1-3").unwrap(), [1, 2, 3]);
        assert_eq!(frames("1-6x2").unwrap(), [1, 3, 5]);
        assert_eq!(frames("0-0x5").unwrap(), [0]);
        for wrong in [
            "",
            "x",
            "-",
            "1-",
            "-1",
            "1-2-3",
            "1-3x",
            "1-3xx2",
            "a-b",
            "1.5",
            "+1",
            "1-99999999999999999999",
        ] {
            assert_eq!(frames(wrong).unwrap_err(), "write 7, 1-100 or 1-100x2 (every second)", "{wrong}");
        }
        assert_eq!(frames("5-2").unwrap_err(), "5 comes after 2; write 2-5");
        assert_eq!(frames("1-5x0").unwrap_err(), "a step of 0 gets nowhere; write 1 or more");
        assert!(frames("0-9223372036854775807").unwrap_err().contains("at most 1000000"));
    }

    #[test]
    fn names() {
        let name = |path: &str, frame| file(Path::new(path), frame).display().to_string();
        assert_eq!(name("a/b.exr", 7), "a/b_0007.exr");
        assert_eq!(name("a#/b_####.exr", 12345), "a#/b_12345.exr");
        assert_eq!(name("b.##.v2.png", 3), "b.03.v2.png");
        assert_eq!(name("b", 3), "b_0003");
        assert!(is_pattern(Path::new("a/b#.exr")) && !is_pattern(Path::new("a#/b.exr")));
    }
}
