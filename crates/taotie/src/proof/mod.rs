//! The proof: how an asset differs from its scan in the eyes of a viewer, measured without the rays of a bake.
//!
//! A bake looks from the asset to the scan along its own rays and stores the result in its maps, so measuring along
//! the same rays would confirm any mistake. Here both surfaces are seen from the viewer's side: the same pixel, the
//! first surface drawn, its shading normal. [`overview`] looks at whole objects, [`CloseUp`] at points spread over
//! either surface, [`silhouettes`] at outlines, [`distance_bounds`] at shape.

mod close_up;
mod distance;
mod estimate;
mod exceedance;
mod footprint;
mod mismatch;
mod overview;
mod pair;
mod patch;
mod patch_view;
mod region;
mod relook;
mod shape;
mod silhouette;
mod window;

pub use close_up::{CloseUp, SurfaceSample};
pub use distance::{DistanceBounds, Source, distance_bounds};
pub use estimate::Estimate;
pub(crate) use estimate::share_interval;
pub use exceedance::{Exceedance, Share};
pub(crate) use footprint::{Footprint, edges};
pub(crate) use mismatch::Mismatch;
pub use overview::{Overview, Picture, overview};
pub(crate) use overview::{PixelDifferences, pixel_differences};
pub use pair::{Pair, Side};
pub use patch::Patch;
pub(crate) use patch::{most_missing, worst_patch};
pub use patch_view::PatchQuantity;
pub(crate) use patch_view::PatchView;
pub use region::{Region, WorstRegions};
pub(crate) use relook::{ImageLook, Relook, Shown};
pub use shape::hausdorff;
pub(crate) use shape::root_mean_square;
pub use silhouette::{SilhouetteFigures, silhouettes};
pub use window::Window;
