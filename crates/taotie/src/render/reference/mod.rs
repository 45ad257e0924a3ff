//! The judge of every approximation: paths of light followed one by one, over the same scene, materials, normals and
//! lights as the rasteriser, and without bias.
//!
//! A path begins at a point of a pixel, chosen evenly, and meets surfaces as [`surfaces`] tells. At each it gathers
//! light directly: from every point, spot and directional light by a shadow ray, and from the environment in two ways
//! that are weighed against each other: towards where it is bright, and where the surface reflects much ([`respond`]).
//! Then it goes on in the second direction. Reflection is [`SurfacePoint::reflect`](super::point::SurfacePoint), so
//! that every named model works, physical or not. Textures are read at their finest level, since a pixel's many paths
//! average them.
//!
//! What is the same as in the rasteriser, so that direct light is equal: interpolation, normals, where shadow rays leave
//! from, and that light behind the shading normal counts as shadowed. What differs: blended surfaces let light through
//! in proportion to what they lack, where the rasteriser's cast no shadow.

mod groove;
mod patch;
mod respond;
mod scatter;
mod settings;
mod surfaces;
mod surround;
mod walk;

pub use settings::{EnvironmentSampling, NormalMapping, ReferenceSettings};
pub(super) use surfaces::Surfaces;

use super::frame::Frame;
use super::ground::Ground;
use super::lighting::Source;
use super::pass::SHADOW_LIFT;
use super::prepare::Prepared;
use super::rays::CameraRays;
use super::settings::{Lighting, RenderSettings};
use super::view::View;
use crate::error::Result;
use crate::math::Vec3;
use crate::progress::Progress;
use crate::scene::Camera;
use fearless_simd::Level;
use rayon::prelude::*;
use surfaces::Sight;
use surround::Surround;

/// What all paths of a picture need.
struct Tracer<'t, 'a> {
    prepared: &'t Prepared<'a>,
    sight: Sight<'t, 'a>,
    view: View,
    camera: CameraRays,
    sources: Vec<Source>,
    ambient: Vec3,
    ground: Option<Ground>,
    surround: Option<Surround<'t>>,
    settings: &'t RenderSettings,
    reference: ReferenceSettings,
    level: Level,
    /// How far above the surface rays leave, model units.
    lift: f32,
    /// Whether any surface shines by itself.
    emitters: bool,
}

/// Takes a picture by following paths of light. The same settings give the same bits with any number of threads.
///
/// Of `settings`, the number of samples and `specular_aa` are not read, since many paths average what is too fine for a
/// pixel. Without shadows lights shine through everything, as in the rasteriser; environment and surfaces always throw
/// shadows. [`Lighting::ambient`] is reflected at every surface. Cameras see single-sided surfaces from their front; light meets both sides of all. The
/// frame's output variables show the first path of each pixel.
///
/// # Errors
/// [`crate::Error::Cancelled`]; [`crate::Error::Invalid`] or [`crate::Error::Limit`] for a size, camera or number of paths that cannot be,
/// [`crate::Error::Unsupported`] for a SIMD level that the processor lacks.
pub fn reference(
    prepared: &Prepared<'_>,
    camera: &Camera,
    lighting: &Lighting,
    settings: &RenderSettings,
    reference: &ReferenceSettings,
    progress: Progress<'_>,
) -> Result<Frame> {
    reference.check()?;
    crate::image::Image::check_size(settings.width, settings.height)?;
    let size = prepared.bounds().map_or(1.0, |bounds| bounds.diagonal());
    let camera_rays = CameraRays::new(camera, [settings.width, settings.height]);
    let tracer = Tracer {
        prepared,
        sight: Sight::new(prepared),
        view: View::new(camera, settings.width, settings.height)?,
        camera: camera_rays,
        sources: lighting.lights.iter().map(Source::new).collect(),
        ambient: lighting.ambient,
        ground: settings.ground.then(|| Ground::new(prepared, lighting, camera_rays)).flatten(),
        surround: lighting.environment.as_ref().map(Surround::new),
        settings,
        reference: *reference,
        level: settings.simd.dispatch()?,
        lift: (size * SHADOW_LIFT) as f32,
        emitters: prepared.draws.iter().any(walk::shines),
    };
    tracer.picture(progress)
}

impl Tracer<'_, '_> {
    fn picture(&self, progress: Progress<'_>) -> Result<Frame> {
        let mut frame = Frame::new(self.settings)?;
        let patches = patch::patches(self.settings);
        // How many there are between two reports changes no pixel.
        let at_once = 8 * rayon::current_num_threads();
        let mut done = 0;
        for part in patches.chunks(at_once) {
            let pictures: Vec<_> = part.par_iter().map(|patch| self.patch(patch)).collect();
            for (patch, picture) in part.iter().zip(&pictures) {
                picture.store(patch, &mut frame);
            }
            done += part.len();
            progress.at(done as f64 / patches.len() as f64)?;
        }
        Ok(frame)
    }
}
