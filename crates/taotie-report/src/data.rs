//! The data of a page, serialised in the form that `page/main.js` documents and reads; see `picture.rs` for pictures.

use crate::picture::View;
use serde::Serialize;

/// A page.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Page {
    /// The heading and window title.
    pub title: String,
    /// Below the heading; may be empty, like every text here.
    pub subtitle: String,
    /// Verdict and warnings, below the heading: the most important information.
    pub notices: Vec<Notice>,
    /// A compact list below that.
    pub facts: Vec<Fact>,
    /// The statement that follows, on a separate sheet when the page is printed.
    pub statement: Option<Statement>,
    /// Pictures side by side, ahead of all others.
    pub features: Vec<View>,
    /// Pictures, a tab for each view.
    pub views: Vec<View>,
    /// Above the model, if the page contains one; by default, that it is an asset as written.
    pub model_note: String,
    /// Text, tables and histograms below the pictures, in order.
    pub sections: Vec<Section>,
    /// At the end: the origin of the page.
    pub footer: String,
}

/// A line at the top of the page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Notice {
    /// The line.
    pub text: String,
    /// Its tone.
    pub tone: Tone,
}

impl Notice {
    /// Creates a notice.
    pub fn new(text: impl Into<String>, tone: Tone) -> Self {
        Self { text: text.into(), tone }
    }
}

/// A named value.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Fact {
    /// The quantity.
    pub name: String,
    /// Its value, with its unit.
    pub value: String,
}

impl Fact {
    /// Creates a fact.
    pub fn new(name: impl Into<String>, value: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}

/// The statement that a page opens with: its subject, the findings, and how to reproduce them. Printed on a separate
/// sheet, which it fills.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    /// Its heading.
    pub title: String,
    /// The outcome.
    pub verdict: Notice,
    /// Its subject and its author.
    pub facts: Vec<Fact>,
    /// Its tables.
    pub tables: Vec<PlainTable>,
    /// A line about the command below it.
    pub command_note: String,
    /// The command that reproduces it; may be empty.
    pub command: String,
}

/// A table that cannot be re-sorted.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PlainTable {
    /// Heading.
    pub title: String,
    /// Below the table; may be empty.
    pub note: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// One cell for each column.
    pub rows: Vec<Vec<Cell>>,
}

/// A part of the page below the pictures.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Section {
    /// Prose.
    Text {
        /// Heading.
        title: String,
        /// Plain text.
        paragraphs: Vec<String>,
    },
    /// Source text, shown with its line breaks.
    Code {
        /// Heading.
        title: String,
        /// Above the code.
        note: String,
        /// The code.
        code: String,
    },
    /// A table; clicking a column sorts it.
    Table {
        /// Heading.
        title: String,
        /// Above the table.
        note: String,
        /// The columns.
        columns: Vec<Column>,
        /// One cell for each column.
        rows: Vec<Vec<Cell>>,
    },
    /// Histograms, one panel for each series on common axes.
    Histogram {
        /// Heading.
        title: String,
        /// Above the panels.
        note: String,
        /// Unit of the values.
        unit: String,
        /// Bin i counts the values in [i · `bin_width`, (i + 1) · `bin_width`).
        bin_width: f64,
        /// True if the last bin also counts all larger values.
        last_is_open: bool,
        /// The counts, one panel each.
        series: Vec<Series>,
    },
    /// Points on two logarithmic axes.
    Plot {
        /// Heading.
        title: String,
        /// Above the plot.
        note: String,
        /// The horizontal axis.
        x: Axis,
        /// The vertical axis.
        y: Axis,
        /// The points by kind.
        series: Vec<PointSeries>,
        /// Corners of a step line, by ascending x.
        frontier: Vec<[f64; 2]>,
    },
    /// Notable lines.
    Notices {
        /// Heading.
        title: String,
        /// Above the lines.
        note: String,
        /// The lines.
        notices: Vec<Notice>,
    },
}

/// A column of a table.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Heading.
    pub name: String,
    /// Unit of the numbers below.
    pub unit: String,
    /// True for numbers, which are right-aligned.
    pub numeric: bool,
}

impl Column {
    /// Creates a column of words.
    pub fn words(name: impl Into<String>) -> Self {
        Self { name: name.into(), unit: String::new(), numeric: false }
    }

    /// Creates a column of numbers in this unit, which may be empty.
    pub fn numbers(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into(), numeric: true }
    }
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Cell {
    /// Words.
    Text(String),
    /// Machine-readable text, such as a hash.
    Code(String),
    /// A number.
    Number {
        /// `None` and values that are not finite are shown as missing.
        value: Option<f64>,
        /// Decimals shown.
        digits: usize,
    },
    /// A judgement.
    Mark {
        /// The text shown.
        text: String,
        /// Its tone.
        tone: Tone,
        /// The reason, shown as a numbered note below the table. May be empty.
        why: String,
    },
}

impl Cell {
    /// Creates a cell of words.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// Creates a number with `digits` decimals.
    pub fn number(value: f64, digits: usize) -> Self {
        // Adding zero turns -0, the sum of nothing, into 0.
        Self::Number { value: Some(value + 0.0), digits }
    }
}

/// The meaning of a [`Cell::Mark`] or a [`Notice`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    /// As expected.
    Good,
    /// Not as expected.
    Bad,
    /// Corrected, or worth a look.
    Changed,
}

/// A logarithmic axis of a plot; values are positive.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Axis {
    /// The quantity.
    pub name: String,
    /// Its unit.
    pub unit: String,
}

/// Points of one kind in a plot.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PointSeries {
    /// The kind.
    pub label: String,
    /// The points.
    pub points: Vec<PlotPoint>,
}

/// A point of a plot.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PlotPoint {
    /// Position on both axes.
    pub at: [f64; 2],
    /// Description, shown when a pointer is over it.
    pub text: String,
    /// `true` if it is highlighted.
    pub is_chosen: bool,
    /// `true` if it is drawn filled, `false` as a ring.
    pub is_filled: bool,
}

/// The counts of a histogram.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Series {
    /// The thing counted.
    pub label: String,
    /// The number of values in each bin.
    pub counts: Vec<u64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{json, to_value};

    #[test]
    fn cells_are_written_as_the_script_reads_them() {
        let mark = Cell::Mark { text: "1".into(), tone: Tone::Changed, why: String::new() };
        assert_eq!(to_value(Cell::text("a")).unwrap(), json!({ "text": "a" }));
        assert_eq!(
            to_value(Cell::number(f64::NAN, 2)).unwrap(),
            json!({ "number": { "value": null, "digits": 2 } })
        );
        assert_eq!(to_value(mark).unwrap(), json!({ "mark": { "text": "1", "tone": "changed", "why": "" } }));
    }
}
