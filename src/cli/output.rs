//! What is printed: results to stdout, complaints to stderr, colors on terminals alone (`NO_COLOR` and
//! `CLICOLOR` are heard). A reader that stops listening (`| head`) is no error.

use std::fmt;
use std::io::{ErrorKind, Write};
use std::path::Path;

use anstyle::{AnsiColor, Style};

/// Titles.
pub const TITLE: Style = Style::new().bold();
/// Names that can be typed.
pub const NAME: Style = AnsiColor::Cyan.on_default();
/// What went wrong.
pub const WRONG: Style = AnsiColor::Red.on_default().bold();
/// What went right.
pub const RIGHT: Style = AnsiColor::Green.on_default();

/// An error of several lines that are printed as they are, such as all problems of a graph.
#[derive(Debug, Default)]
pub struct Lines(pub Vec<String>);

impl fmt::Display for Lines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.join("\n"))
    }
}

impl std::error::Error for Lines {}

/// Prints a result, which ends with its own line end.
///
/// # Errors
/// When stdout cannot be written, as on a full disk.
pub fn print(text: &str) -> anyhow::Result<()> {
    let mut stdout = anstream::stdout();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(anyhow::anyhow!("cannot write to stdout: {error}"))
        }
        _ => Ok(()),
    }
}

/// Prints a value as JSON.
///
/// # Errors
/// As [`print`].
pub fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// Prints `error: ..`.
pub fn error(message: &str) {
    complain(&errors(&[message.to_owned()]));
}

/// Each message as a line `error: ..`.
pub fn errors(messages: &[String]) -> Lines {
    Lines(messages.iter().map(|message| format!("{WRONG}error:{WRONG:#} {message}")).collect())
}

/// Prints lines to stderr; where that is closed there is nobody to tell.
pub fn complain(lines: &Lines) {
    let mut stderr = anstream::stderr();
    for line in &lines.0 {
        let _ = writeln!(stderr, "{line}");
    }
}

/// Rows of cells in columns of equal width, two spaces apart and before; the last column is not padded.
pub fn columns(rows: &[Vec<String>]) -> String {
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..n_columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("  {cell:<width$}"));
        text += cells.collect::<String>().trim_end();
        text.push('\n');
    }
    text
}

/// A file as it is named from here: `out/a.png`, not `graphs/../out/a.png`.
pub fn near(path: &Path) -> String {
    let here = std::env::current_dir().and_then(std::fs::canonicalize);
    let full = std::fs::canonicalize(path);
    let near = here.ok().zip(full.ok()).filter(|_| path.is_relative());
    // What leads elsewhere, by a link or by `..`, stays as it was said.
    let near = near.and_then(|(here, full)| Some(full.strip_prefix(here).ok()?.to_owned()));
    near.unwrap_or_else(|| path.to_owned()).display().to_string()
}

/// Bytes as people read them.
pub fn size(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    if bytes < 1024 {
        return format!("{bytes} bytes");
    }
    let mut scaled = bytes as f64 / 1024.0;
    let mut unit = 0;
    while scaled >= 1024.0 && unit + 1 < UNITS.len() {
        scaled /= 1024.0;
        unit += 1;
    }
    format!("{scaled:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_and_columns() {
        assert_eq!(size(0), "0 bytes");
        assert_eq!(size(1023), "1023 bytes");
        assert_eq!(size(1536), "1.5 KiB");
        assert_eq!(size(5 << 40), "5.0 TiB");
        assert_eq!(size(5 << 50), "5120.0 TiB");
        let rows = [vec!["a".to_owned(), "b".to_owned()], vec!["long".to_owned()]];
        assert_eq!(columns(&rows), "  a     b\n  long\n");
    }
}
