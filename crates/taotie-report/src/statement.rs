//! The statement that a page opens with, printed on a sheet of its own.

use crate::{Cell, Column, Fact, Notice};
use serde::Serialize;

/// A statement of what was found, of what, and how to find it again. Printed, it fills one page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    /// Its heading.
    pub title: String,
    /// The outcome.
    pub verdict: Notice,
    /// What it is about, and who made it.
    pub facts: Vec<Fact>,
    /// Its tables.
    pub tables: Vec<PlainTable>,
    /// A line on the command below.
    pub command_note: String,
    /// The command that repeats it; may be empty.
    pub command: String,
}

/// A table that stays in its order.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PlainTable {
    /// Heading.
    pub title: String,
    /// Below the table; may be empty.
    pub note: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// As many cells as there are columns.
    pub rows: Vec<Vec<Cell>>,
}
