//! Pictures of one scene, one after the other.

use super::pass::{Kept, Pass};
use super::prepare::Prepared;
use super::{Frame, Lighting, RenderSettings, SurfaceSettings};
use crate::error::Result;
use crate::film::Development;
use crate::progress::Progress;
use crate::scene::{Camera, Scene};

/// Takes pictures of one scene and keeps what does not change between them: vertices in world space, tangents, the tree
/// of shadow casters and the mip chains; and the memory of what does. A turntable costs its frames.
///
/// The same picture has the same bits whatever was taken before.
pub struct Renderer<'a> {
    prepared: Prepared<'a>,
    kept: Kept,
}

impl<'a> Renderer<'a> {
    /// Prepares `scene`.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn new(scene: &'a Scene, settings: &SurfaceSettings) -> Result<Self> {
        Ok(Self { prepared: Prepared::new(scene, settings)?, kept: Kept::default() })
    }

    /// The scene, prepared.
    pub fn prepared(&self) -> &Prepared<'a> {
        &self.prepared
    }

    /// Takes a picture in linear light.
    ///
    /// # Errors
    /// As [`Pass::new`] and [`Pass::render`].
    pub fn render(
        &mut self,
        camera: &Camera,
        lighting: &Lighting,
        settings: &RenderSettings,
        progress: Progress<'_>,
    ) -> Result<Frame> {
        self.with_pass((camera, lighting), settings, |pass| pass.render(progress))
    }

    /// Takes a picture and develops it to 8-bit sRGB with straight alpha, row by row from the top. `codes` is made as
    /// long as the picture; handed in again, nothing is allocated.
    ///
    /// # Errors
    /// As [`Pass::new`] and [`Pass::develop`].
    pub fn develop(
        &mut self,
        (camera, lighting): (&Camera, &Lighting),
        settings: &RenderSettings,
        development: &Development,
        codes: &mut Vec<[u8; 4]>,
        progress: Progress<'_>,
    ) -> Result<()> {
        self.with_pass((camera, lighting), settings, |pass| {
            codes.resize(settings.width as usize * settings.height as usize, [0; 4]);
            pass.develop(development, codes, progress)
        })
    }

    fn with_pass<T>(
        &mut self,
        seen: (&Camera, &Lighting),
        settings: &RenderSettings,
        take: impl FnOnce(&Pass<'_, 'a>) -> Result<T>,
    ) -> Result<T> {
        let pass = Pass::with(std::mem::take(&mut self.kept), &self.prepared, seen, settings)?;
        let taken = take(&pass);
        self.kept = pass.into_kept();
        taken
    }
}
