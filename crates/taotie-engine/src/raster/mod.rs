//! Rasterisation, from clip space to visibility: clipping, binning to tiles, coverage and depth. Finds triangles,
//! never colours.
//!
//! Clip space has x right, y up, z reversed: z/w is 1 on the near plane and 0 on the far plane (or at infinity).
//! Screen space has its origin top left, y down. Vertices are snapped to 1/256 pixel, so edge functions are exact
//! integers and every sample on a shared edge belongs to exactly one triangle (the top-left rule).

mod barycentric;
mod bin;
mod rasterize;
mod screen;
mod small;
mod tile;

pub use barycentric::{Barycentric, PerspectiveTriangle};
pub(crate) use barycentric::{CornerNumbers, PlaneSetup, TRIANGLES};
pub use bin::{Bins, Geometry, bin};
pub use rasterize::{rasterize_layers, rasterize_opaque};
pub use tile::{Faces, Layer, SamplePattern, TILE_PIXELS, Tile, TilePlane, TileSample, Viewport};
pub(crate) use tile::{NO_TRIANGLE, TILE_SIZE};

/// Subpixel positions per pixel, along each axis.
const SUBPIXELS: i32 = 256;
