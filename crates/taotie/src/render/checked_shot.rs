//! A shot prepared for any renderer.

use super::settings::{RenderSettings, Shot};
use super::view::{Eye, View};
use crate::error::Result;
use crate::image::Image;
use crate::math::Mat4;
use crate::raster::SamplePattern;

/// A shot that has been validated, with the settings effective for its model and the camera's transform.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CheckedShot {
    /// The settings; models as printed in the paper use no corrections.
    pub settings: RenderSettings,
    /// The sample positions in a pixel.
    pub pattern: SamplePattern,
    /// The transform to reversed-z clip space: 1 at the near plane, 0 at the far plane or at infinity.
    pub clip_from_world: Mat4,
    /// The viewpoint of the scene.
    pub eye: Eye,
}

impl CheckedShot {
    /// Validates a shot like [`super::Pass::new`].
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] or [`crate::Error::Limit`] for a size, sample count, light or camera that cannot be
    /// rendered.
    pub fn new(shot: &Shot<'_>) -> Result<Self> {
        shot.check()?;
        let settings = shot.settings.as_taken();
        Image::check_size(settings.width, settings.height)?;
        let pattern = SamplePattern::new(settings.samples)?;
        let View { clip_from_world, eye, .. } = View::new(shot.camera, settings.width, settings.height)?;
        Ok(Self { settings, pattern, clip_from_world, eye })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Lighting;
    use crate::scene::Orbit;
    use crate::shade::Shading;

    #[test]
    fn models_as_printed_take_no_corrections_and_nonsense_is_refused() {
        let orbit =
            Orbit { azimuth: 0.0, elevation: 0.0, distance: 3.0, target: Default::default(), fov_y: 0.7 };
        let (camera, lighting) = (orbit.camera(1.0), Lighting::default());
        let printed = RenderSettings { shading: Shading::GgxPrinted, ..RenderSettings::default() };
        let check = |settings: &RenderSettings| {
            CheckedShot::new(&Shot { camera: &camera, lighting: &lighting, settings })
        };
        assert!(printed.specular_aa && !check(&printed).unwrap().settings.specular_aa);
        assert!(check(&RenderSettings { samples: 3, ..RenderSettings::default() }).is_err());
        assert!(check(&RenderSettings { width: 0, ..RenderSettings::default() }).is_err());
    }
}
