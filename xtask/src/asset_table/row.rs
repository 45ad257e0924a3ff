//! The table, with one row per model.

use super::baked::Baked;
use serde_json::{Value, json};
use std::fmt::{self, Display, Formatter};

const HEAD: &str = "\
| model | triangles | of the asset | kB | of the asset | mean ° | p95 ° | ΔE00 | carried | reported as lost |
|---|--:|--:|--:|--:|--:|--:|--:|---|---|
";

/// The result for a model.
pub struct Row {
    /// The model's name.
    pub model: String,
    /// Its figures, or the error message of the command.
    pub outcome: Result<Baked, String>,
}

impl Row {
    /// Returns the row as JSON.
    pub fn json(&self) -> Value {
        match &self.outcome {
            Ok(baked) => json!({ "model": self.model, "baked": baked.json() }),
            Err(sentence) => json!({ "model": self.model, "refused": sentence }),
        }
    }
}

/// The progress line on the terminal.
impl Display for Row {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match &self.outcome {
            Ok(Baked { triangles: [_, triangles], angles, .. }) => {
                write!(f, "{}: {triangles} triangles, {}°", self.model, figure(angles.map(|[mean, _]| mean)))
            }
            Err(sentence) => write!(f, "{}: {sentence}", self.model),
        }
    }
}

/// Returns the table in Markdown.
pub fn table(rows: &[Row]) -> String {
    let lines = rows.iter().map(|row| format!("| {} |\n", cells(row).map(|cell| plain(&cell)).join(" | ")));
    HEAD.to_owned() + &lines.collect::<String>()
}

/// Returns a sentence with the counts of rows.
pub fn count(rows: &[Row]) -> String {
    let baked = rows.iter().filter_map(|row| row.outcome.as_ref().ok());
    let (baked, lossy) = (baked.clone().count(), baked.filter(|baked| !baked.lost.is_empty()).count());
    let refused = rows.len() - baked;
    format!("{} files: {baked} baked, {lossy} of them with a reported loss, {refused} refused.\n", rows.len())
}

fn cells(row: &Row) -> [String; 10] {
    let model = row.model.clone();
    match &row.outcome {
        Ok(Baked { triangles, bytes, angles, color, carried, lost }) => {
            let [triangles_in, triangles_out] = triangles.map(grouped);
            let [bytes_in, bytes_out] = bytes.map(kilobytes);
            let [mean, p95] = [0, 1].map(|i| figure(angles.map(|angles| angles[i])));
            let [carried, lost] = [carried.join(", "), lost.join("; ")];
            let color = figure(*color);
            [model, triangles_in, triangles_out, bytes_in, bytes_out, mean, p95, color, carried, lost]
        }
        Err(sentence) => {
            let [a, b, c, d, e, f, g, h] = [""; 8].map(str::to_owned);
            [model, a, b, c, d, e, f, g, h, format!("refused: {sentence}")]
        }
    }
}

/// Escapes text for a table cell.
fn plain(text: &str) -> String {
    text.replace('|', "\\|").replace(['\n', '\r'], " ")
}

/// Formats 1234567 as 1,234,567.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let comma = |i: usize| if i > 0 && (digits.len() - i).is_multiple_of(3) { "," } else { "" };
    digits.char_indices().map(|(i, digit)| format!("{}{digit}", comma(i))).collect()
}

fn kilobytes(bytes: u64) -> String {
    format!("{:.1}", bytes as f64 / 1000.0)
}

fn figure(number: Option<f64>) -> String {
    number.map_or_else(|| "–".into(), |number| format!("{number:.2}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> [Row; 2] {
        let baked = Baked {
            triangles: [1_234_567, 999],
            bytes: [1_500_000, 80_040],
            angles: Some([1.234, 5.0]),
            color: None,
            carried: vec!["base colour".into(), "alpha".into()],
            lost: vec![],
        };
        let refused = Err("a|b: no\ntriangles".into());
        [Row { model: "bottle".into(), outcome: Ok(baked) }, Row { model: "points".into(), outcome: refused }]
    }

    #[test]
    fn a_row_has_a_cell_for_each_column() {
        let expected = "\
| bottle | 1,234,567 | 999 | 1500.0 | 80.0 | 1.23 | 5.00 | – | base colour, alpha |  |
| points |  |  |  |  |  |  |  |  | refused: a\\|b: no triangles |
";
        assert_eq!(table(&rows()), format!("{HEAD}{expected}"));
        let columns = |line: &str| line.replace("\\|", "").matches('|').count();
        assert!(table(&rows()).lines().all(|line| columns(line) == 11));
    }

    #[test]
    fn rows_are_counted_and_written_as_json() {
        assert_eq!(count(&rows()), "2 files: 1 baked, 0 of them with a reported loss, 1 refused.\n");
        let [baked, refused] = rows().map(|row| row.json());
        assert_eq!((&baked["baked"]["bytes"][1], &refused["model"]), (&json!(80_040), &json!("points")));
        assert_eq!(rows()[0].to_string(), "bottle: 999 triangles, 1.23°");
    }
}
