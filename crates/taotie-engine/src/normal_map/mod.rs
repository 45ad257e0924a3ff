//! Normal maps: made from heights, converted between spaces and stored in few bits, and the error this causes.
//!
//! [`tangent_from_height`], [`object_from_tangent`] and similar functions convert whole maps, [`store_normals`]
//! rounds them to 8 or 16 bits. [`convert_map`] combines them: it converts a stored map to another, with the angles
//! between both.
//!
//! ```
//! use taotie_engine::image::{Bitmap, Texels};
//! use taotie_engine::normal_map::{ConversionOptions, MapContent, MapSource, convert_map};
//! use taotie_engine::scene::GreenChannel;
//!
//! # fn main() -> taotie_engine::Result<()> {
//! let grey = |i: u16| [i * 256, i * 256, i * 256, u16::MAX];
//! let bitmap = Bitmap::new(16, 16, 1, Texels::U16((0..256).map(grey).collect()))?;
//! let heights = MapSource { bitmap, content: MapContent::Heights, green: GreenChannel::Up };
//! let options = ConversionOptions { height_scale: Some(4.0), bits: Some(8), ..ConversionOptions::default() };
//! let made = convert_map(&heights, &options, None)?;
//! let degrees = made.stored.summary().expect("every texel has an angle").mean;
//! assert!(degrees < 0.26, "{degrees}");
//! # Ok(())
//! # }
//! ```

mod conversion;
mod storage;
mod transforms;

pub use conversion::{
    Conversion, ConversionOptions, MapContent, MapSource, convert_map, guessed_content, lay_out, with_content,
};
pub use storage::{
    CoveredNormals, Storage, Stored, green_turned, requantised, store_codes, store_normals, store_rgba,
    store_unit_vectors, unsigned,
};
pub use transforms::{
    Heights, decoded_normals, object_from_tangent, tangent_from_height, tangent_from_height_on,
    tangent_from_object,
};
