//! Tables as comma-separated values (RFC 4180), for spreadsheets and scripts.

/// Rows of equal width under column names. Lines end with CR LF.
///
/// ```
/// use taotie_report::csv::{Csv, number};
///
/// let mut csv = Csv::new(["model", "mean_deg"]);
/// csv.row(["low, final.glb".into(), number(Some(1.5))]);
/// csv.row(["high.glb".into(), number(None)]);
/// assert_eq!(csv.text(), "model,mean_deg\r\n\"low, final.glb\",1.5\r\nhigh.glb,\r\n");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Csv<const N: usize> {
    text: String,
}

impl<const N: usize> Csv<N> {
    /// Creates a table without rows.
    pub fn new(columns: [&str; N]) -> Self {
        let mut csv = Self { text: String::new() };
        csv.row(columns.map(str::to_owned));
        csv
    }

    /// Adds a row.
    pub fn row(&mut self, cells: [String; N]) {
        self.text += &cells.map(quoted).join(",");
        self.text += "\r\n";
    }

    /// Returns the text of the file.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Returns the shortest text that reads back as the same number; an empty string for `None`.
pub fn number(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

/// Returns a cell, quoted if necessary.
fn quoted(cell: String) -> String {
    match cell.contains(['"', ',', '\r', '\n']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_quoted_where_they_would_not_read_back() {
        let written = ["a", "a,b", "say \"a\"", "two\nlines", ""].map(|cell| quoted(cell.into()));
        assert_eq!(written, ["a", "\"a,b\"", "\"say \"\"a\"\"\"", "\"two\nlines\"", ""]);
    }

    #[test]
    fn numbers_read_back_equal() {
        for value in [0.1, 1.0 / 3.0, 1e-7, -0.0, 12345.678] {
            assert_eq!(number(Some(value)).parse(), Ok(value));
        }
        assert_eq!(number(None), "");
    }
}
