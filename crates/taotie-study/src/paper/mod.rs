//! Tables 2 and 3 of Guo and Wang 2025, recomputed.
//!
//! Only the printed numbers are known ([`ROWS`]). From them follow the law of N2 and N3 with the g of each row
//! ([`Fit`]), the angles ([`Angle`]), the misprints ([`Misprint`]) and the conclusions ([`Conclusion`]).
//!
//! ```
//! let study = taotie_study::paper::Study::new();
//! assert_eq!(study.misprints.len(), 5);
//! assert!(study.text().contains("Table 2, row 1, N2.y: printed -0.3608, should be -0.6080"));
//! ```

mod angles;
mod document;
mod law;
mod misprints;
mod page;
mod printed;
mod range;
mod study;
mod text;
mod words;

pub use angles::Angle;
pub use law::{Fit, Number};
pub use misprints::Misprint;
pub use printed::{Normal, Printed, ROWS};
pub use study::{Agreeing, Conclusion, Distance, Row, Study};
