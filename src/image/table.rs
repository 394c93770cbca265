//! Rows of figures: what a table wire carries.
//!
//! Written as CSV (RFC 4180): a line of column names, then a line for each row, numbers as Rust prints an f64, which
//! reads back to the same bits. Every file is written by [`super::atomic::write`]: whole or not at all.
//! Limits: finite numbers and column names without commas, quotes and line ends, which nodes see to. Tested by the text.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::atomic::{self, WriteError};

/// Why a table is not written.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The ending says no format that is written.
    #[error("cannot write {}: tables are written as .csv; change the ending", .0.display())]
    Ending(PathBuf),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Named columns of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Names, with their unit where they have one: `x_m`.
    pub columns: Vec<&'static str>,
    /// Of each row a number for each column.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// A table of these rows.
    ///
    /// # Panics
    /// If a row has not a number for each column.
    pub fn new(columns: &[&'static str], rows: Vec<Vec<f64>>) -> Self {
        assert!(rows.iter().all(|row| row.len() == columns.len()), "{columns:?}");
        Self { columns: columns.to_vec(), rows }
    }

    /// Memory that the rows take.
    pub fn bytes(&self) -> u64 {
        (self.rows.len() * self.columns.len() * size_of::<f64>()) as u64
    }

    /// The numbers of a column, from the first row on.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let place = self.columns.iter().position(|column| *column == name)?;
        Some(self.rows.iter().map(|row| row[place]).collect())
    }

    /// The text of a CSV file.
    pub fn to_csv(&self) -> String {
        let mut text = self.columns.join(",") + "\n";
        for row in &self.rows {
            for (n, x) in row.iter().enumerate() {
                let comma = if n == 0 { "" } else { "," };
                // Writing to a string cannot fail.
                let _ = write!(text, "{comma}{x}");
            }
            text.push('\n');
        }
        text
    }
}

/// How the names of tables end.
pub const ENDINGS: &[&str] = &["csv"];

/// Refuses a name that does not end in `.csv`, case ignored.
///
/// # Errors
/// [`TableError::Ending`].
pub fn check_ending(path: &Path) -> Result<(), TableError> {
    match path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) {
        true => Ok(()),
        false => Err(TableError::Ending(path.to_owned())),
    }
}

/// Writes a table as CSV.
///
/// # Errors
/// For another ending, and where the file cannot be written.
pub fn write(path: &Path, table: &Table) -> Result<(), TableError> {
    check_ending(path)?;
    Ok(atomic::write(path, table.to_csv().as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_reads_back() {
        let rows = vec![vec![0.1, 3.0], vec![-1e-30, f64::MAX]];
        let table = Table::new(&["low", "count"], rows);
        let text = table.to_csv();
        assert!(text.starts_with("low,count\n0.1,3\n"), "{text}");
        let read = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
        assert_eq!(text.lines().skip(1).map(read).collect::<Vec<_>>(), table.rows);
        assert_eq!(table.column("count").unwrap(), [3.0, f64::MAX]);
        assert!(table.column("high").is_none());
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        write(&path, &table).unwrap();
        assert_eq!(std::fs::read_to_string(path).unwrap(), text);
        let refused = write(Path::new("t.exr"), &table).unwrap_err().to_string();
        assert_eq!(refused, "cannot write t.exr: tables are written as .csv; change the ending");
    }
}
