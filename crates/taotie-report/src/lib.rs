//! Reports as a single offline HTML file, with images to compare by wipe and zoom, tables and histograms; and the
//! contact sheets, heat maps and text tables that accompany it.
//!
//! [`bake_page`] and [`comparison`] build the pages for `taotie::asset` and `taotie::comparison`.
//!
//! A [`Page`] is independent of its subject. [`html`] turns it into one document that opens from disk and fetches
//! nothing: its content security policy lists the style sheet and the script by their SHA-256, so nothing in the data
//! can run.
//!
//! ```
//! use taotie_report::{Cell, Column, Page, Section, html};
//!
//! let errors = Section::Table {
//!     title: "Errors".into(),
//!     note: String::new(),
//!     columns: vec![Column::words("method"), Column::numbers("mean", "°")],
//!     rows: vec![vec![Cell::text("tangent-normal"), Cell::number(1.84, 2)]],
//! };
//! let page = Page { title: "A jue".into(), sections: vec![errors], ..Page::default() };
//! assert!(html(&page).contains("<title>A jue</title>"));
//! ```

pub mod bake_page;
pub mod collection_page;
pub mod comparison;
mod data;
mod document;
pub mod heat_map;
mod picture;
pub mod sheet;
pub mod table;
pub mod viewer;

pub use data::{
    Axis, Cell, Column, Fact, Notice, Page, PlainTable, PlotPoint, PointSeries, Section, Series, Statement,
    Tone,
};
pub use document::html;
pub use picture::{Legend, Picture, View};
