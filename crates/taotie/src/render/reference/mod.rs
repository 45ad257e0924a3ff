//! A path tracer, the reference for every approximation. It follows paths of light individually, without bias, over
//! the same scene, materials, normals and lights as the rasteriser.
//!
//! A path starts at a uniformly sampled point of a pixel and meets surfaces (see [`surfaces`]). At each it gathers
//! direct light: from every point, spot and directional light by a shadow ray, and from the environment by two
//! techniques that are weighted against each other: sampling the environment's brightness, and sampling the surface's
//! reflection ([`evaluate`]). Then it continues in the second direction. Reflection is
//! [`SurfacePoint::reflect`](crate::pixel::SurfacePoint::reflect), so that every named model works, physical or not.
//! Textures are read at their finest level, since a pixel's many paths average them.
//!
//! Interpolation, normals, the origins of shadow rays, and the treatment of light behind the shading normal as
//! shadowed are the same as in the rasteriser, so that direct light is equal. One thing differs: blended surfaces
//! transmit light in proportion to their transparency, while the rasteriser's cast no shadow.

mod environment;
mod evaluate;
mod groove;
mod image_tile;
mod scatter;
mod settings;
mod surfaces;
mod tracer;
mod walk;

pub use settings::{EnvironmentSampling, NormalMapping, ReferenceSettings};

use super::frame::Frame;
use super::prepare::Prepared;
use super::settings::Shot;
use crate::error::Result;
use crate::parallel;
use crate::progress::Progress;
use tracer::Tracer;

/// Renders an image by following paths of light. The same settings give the same bits with any number of threads.
///
/// Of the shot's settings, the number of samples and `specular_aa` are ignored, since many paths average subpixel
/// detail. Without shadows, lights shine through everything, as in the rasteriser; environment and surfaces always
/// cast shadows. [`Lighting::ambient`](super::Lighting::ambient) is reflected at every surface. Cameras see
/// single-sided surfaces from their front; light hits both sides of all. The frame's output variables show the first
/// path of each pixel.
///
/// # Errors
/// [`crate::Error::Cancelled`]; [`crate::Error::Invalid`] or [`crate::Error::Limit`] for an invalid size, camera or
/// number of paths, [`crate::Error::Unsupported`] for a SIMD level that the CPU lacks.
pub fn reference(
    prepared: &Prepared,
    shot: &Shot<'_>,
    paths: &ReferenceSettings,
    progress: Progress<'_>,
) -> Result<Frame> {
    let ready = prepared.ready();
    let draws = ready.draws();
    let tracer = Tracer::new(ready, &draws, shot, paths)?;
    let mut frame = Frame::new(shot.settings)?;
    let tiles = image_tile::tiles(shot.settings);
    // The number of paths between two reports does not affect pixels.
    let at_once = 8 * rayon::current_num_threads();
    let mut done = 0;
    for part in tiles.chunks(at_once) {
        let before = done as f64 / tiles.len() as f64;
        let go_on = || progress.at(before);
        for (tile, pixels) in part.iter().zip(parallel::tasks(part.len(), &|i| tracer.tile(&part[i], &go_on)))
        {
            pixels?.store(tile, &mut frame);
        }
        done += part.len();
        progress.at(done as f64 / tiles.len() as f64)?;
    }
    Ok(frame)
}
