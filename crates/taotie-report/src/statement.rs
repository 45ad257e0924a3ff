//! The statement that a page opens with, printed on a separate sheet.

use crate::{Cell, Column, Fact, Notice};
use serde::Serialize;

/// A statement of a result: its subject, the findings, and how to reproduce them. Fills one page when printed.
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
