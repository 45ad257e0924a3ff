//! Rasterisation, from clip space to visibility: clipping, binning to tiles, coverage and depth. Finds triangles, never
//! colours.
//!
//! Clip space has x right, y up, z reversed: z/w is 1 on the near plane and 0 on the far plane (or at infinity).
//! Screen space has its origin top left, y down. Vertices are snapped to 1/256 pixel, so edge functions are exact
//! integers and every sample on a shared edge belongs to exactly one triangle (the top-left rule).

mod barycentric;
mod bin;
mod clip;
mod cull;
mod few;
mod rasterize;
mod samples;
mod scan;
mod setup;
mod sink;
mod small;
mod tile;
mod triangle;
mod vertices;
mod viewport;

pub use barycentric::{Barycentric, CornerNumbers, PerspectiveTriangle, PlaneSetup, TRIANGLES};
pub use bin::{Bins, Geometry, bin};
pub use rasterize::{rasterize_layers, rasterize_opaque};
pub use samples::SamplePattern;
pub use tile::{Layer, NO_TRIANGLE, Tile, TilePlane, TileSample};
pub use viewport::{Faces, TILE_PIXELS, TILE_SIZE, Viewport};

/// Subpixel positions in a pixel, along each axis.
const SUBPIXELS: i32 = 256;
