//! The difference of two images, or of the normals in two maps.
//!
//! Images are compared as a screen shows them: sRGB, composited over a background. Normals are compared by the angle
//! between them, without texels that have alpha 0 or no unit vector.
//!
//! ```
//! use taotie::Progress;
//! use taotie::comparison::diff::{DiffOptions, ImagePair, NamedBitmap};
//! use taotie::image::{Bitmap, Texels};
//!
//! # fn main() -> taotie::Result<()> {
//! let grey = |code: u8| Bitmap::new(16, 16, 1, Texels::U8(vec![[code, code, code, 255]; 256]));
//! let images = [("black", grey(0)?), ("white", grey(255)?)];
//! let [a, b] = images.each_ref().map(|(name, bitmap)| NamedBitmap { name, bitmap });
//! let options = DiffOptions::default();
//! let figures = ImagePair::new([a, b], &options)?.figures(&options, Progress::SILENT)?;
//! assert_eq!(figures.rmse, Some(1.0));
//! # Ok(())
//! # }
//! ```

mod figures;
mod heat;
mod options;
mod pair;

pub use figures::DiffFigures;
pub use heat::DifferenceMap;
pub use options::{DiffOptions, Encoding, Metric};
pub use pair::{ImageContent, ImagePair, NamedBitmap, guessed_encoding};
