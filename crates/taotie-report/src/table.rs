//! Results as plain text: aligned columns, comma-separated values, and summaries of distributions.

use taotie_engine::compare::Summary;
use taotie_engine::length::{ShownLength, Unit, significant};
use taotie_engine::names::Named;
use taotie_engine::proof::MapError;

/// Rows of cells under titles, in aligned columns of text. Columns of numbers are right-aligned.
pub struct Table {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Creates a table with these titles; a leading `>` right-aligns the column.
    pub fn new(titles: &[&str]) -> Self {
        let plain_titles = titles.iter().map(|title| title.trim_start_matches('>').to_owned());
        Self { rows: vec![plain_titles.collect()], ..Self::untitled(titles) }
    }

    /// Creates a table without titles; `>` right-aligns a column.
    pub fn untitled(columns: &[&str]) -> Self {
        Self { right: columns.iter().map(|column| column.starts_with('>')).collect(), rows: Vec::new() }
    }

    /// Adds a row with one cell for each column.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.into());
    }

    /// Returns the lines, indented by `indent` spaces and without trailing spaces.
    pub fn lines(&self, indent: usize) -> String {
        let widths: Vec<usize> = (0..self.right.len()).map(|column| self.width(column)).collect();
        let mut lines = String::new();
        self.rows.iter().for_each(|row| self.add_line(&mut lines, row, (widths.as_slice(), indent)));
        lines
    }

    /// Like [`Table::lines`], but returns an empty string if there are only titles.
    pub fn filled_lines(&self, indent: usize) -> String {
        if self.rows.len() > 1 { self.lines(indent) } else { String::new() }
    }

    fn width(&self, column: usize) -> usize {
        let cells = self.rows.iter().map(|row| row[column].chars().count());
        cells.max().unwrap_or(0)
    }

    fn add_line(&self, lines: &mut String, row: &[String], (widths, indent): (&[usize], usize)) {
        lines.extend(std::iter::repeat_n(' ', indent));
        let start = lines.len();
        for (column, text) in row.iter().enumerate() {
            // Format widths are limited to 65,535.
            let gap = std::iter::repeat_n(' ', widths[column] - text.chars().count());
            if column > 0 {
                lines.push_str("  ");
            }
            if self.right[column] {
                lines.extend(gap);
                lines.push_str(text);
            } else {
                lines.push_str(text);
                lines.extend(gap);
            }
        }
        lines.truncate(start + lines[start..].trim_end().len());
        lines.push('\n');
    }
}

/// Comma-separated values (RFC 4180), for spreadsheets and scripts: rows of equal width under column names. Lines end
/// with CR LF.
///
/// ```
/// use taotie_report::table::{Csv, number};
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

/// Returns the mean, median, 95th percentile and maximum, in the order of table columns.
pub fn figures(summary: &Summary) -> [f64; 4] {
    [summary.mean, summary.median, summary.p95, summary.max]
}

/// Formats mean, quantiles and maximum with `digits` decimals, each with its unit.
///
/// ```
/// use taotie_engine::compare::Field;
/// use taotie_report::table::summary_text;
///
/// let angles = Field::new(2, 1, vec![1.0, 2.0])?.summary().expect("two numbers");
/// let text = summary_text(&angles, 1, "°");
/// assert_eq!(text, "mean 1.5°, median 1.5°, quartiles 1.2° and 1.8°, p95 1.9°, max 2.0°");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
pub fn summary_text(summary: &Summary, digits: usize, unit: &str) -> String {
    let number = |value: f64| format!("{value:.digits$}{unit}");
    let [mean, median, p95, max] = figures(summary).map(number);
    let [first, third] = summary.quartiles.map(number);
    format!("mean {mean}, median {median}, quartiles {first} and {third}, p95 {p95}, max {max}")
}

/// Returns sizes of maps in words, given the largest first: all of a few, or the largest and the smallest.
pub fn sizes_text(sizes: &[[u32; 2]]) -> String {
    const FEW: usize = 4;
    let all: Vec<String> = sizes.iter().map(|[width, height]| format!("{width}×{height}")).collect();
    match all.as_slice() {
        [only] => only.clone(),
        [first, .., last] if all.len() > FEW => format!("{first} to {last}"),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
        [] => String::new(),
    }
}

/// Returns the mean, p95 and maximum of a map's errors; lengths are in the unit of the figures.
pub fn map_error_texts(MapError { unit, summary, .. }: &MapError, of_figures: Option<Unit>) -> [String; 3] {
    let text = |value: f64| match unit.as_str() {
        "" => significant(value, 3),
        "°" => format!("{}°", significant(value, 3)),
        "share" => format!("{} %", significant(value * 100.0, 3)),
        length if length == NO_UNIT || Unit::from_name(length).is_ok() => {
            ShownLength::of(value, of_figures, 3).to_string()
        }
        other => format!("{} {other}", significant(value, 3)),
    };
    [summary.mean, summary.p95, summary.max].map(text)
}

/// The unit of lengths whose unit is unknown.
const NO_UNIT: &str = "model units";

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
    fn sizes_are_all_stated_or_their_ends() {
        let of = |sides: &[u32]| sizes_text(&sides.iter().map(|side| [*side, 64]).collect::<Vec<_>>());
        assert_eq!(of(&[]), "");
        assert_eq!(of(&[128]), "128×64");
        assert_eq!(of(&[128, 64]), "128×64 and 64×64");
        assert_eq!(of(&[128, 96, 64]), "128×64, 96×64 and 64×64");
        assert_eq!(of(&[128, 96, 64, 48, 32]), "128×64 to 32×64");
    }

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(&["name", ">count"]);
        table.row(["a".into(), "1,000,000".into()]);
        table.row(["düne".into(), "7".into()]);
        assert_eq!(Table::new(&["name"]).filled_lines(1), "");
        assert_eq!(table.filled_lines(1), " name      count\n a     1,000,000\n düne          7\n");
        table.row(["x".repeat(1 << 17), "1".into()]);
        let widest = table.lines(0).lines().map(|line| line.chars().count()).max();
        assert_eq!(widest, Some((1 << 17) + 2 + 9));
    }

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
