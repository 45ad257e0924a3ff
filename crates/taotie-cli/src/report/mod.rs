//! A report as one HTML page: pictures to be wiped and zoomed in step, tables and histograms.
//!
//! The page knows nothing of its subject. It opens from disk, needs nothing but itself, and its content security
//! policy forbids the browser to fetch anything: the style sheet and the script run because their SHA-256 is named,
//! and nothing that stands in the data can.

mod data;
mod document;

pub use data::{Cell, Column, Fact, Legend, Page, Picture, Section, Series, Tone, View};
pub use document::html;
