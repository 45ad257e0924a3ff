//! Renders images of one scene, one after the other.

use super::frame::Frame;
use super::pass::{FrameCache, Pass};
use super::prepare::Prepared;
use super::settings::{Shot, SurfaceSettings};
use crate::error::Result;
use crate::film::Development;
use crate::progress::Progress;
use crate::scene::Scene;
use std::sync::Arc;

/// Renders images of one scene and keeps everything that is reused between them: vertices in world space, tangents,
/// the tree of triangles and the mip chains, as well as scratch memory. Each further frame of a turntable costs only
/// its rendering.
///
/// The same image has the same bits regardless of what was rendered before.
pub struct Renderer {
    prepared: Prepared,
    cache: FrameCache,
}

impl Renderer {
    /// Prepares `scene`. A scene that is already shared is not copied.
    ///
    /// # Errors
    /// As for [`Prepared::new`].
    pub fn new(scene: impl Into<Arc<Scene>>, settings: &SurfaceSettings) -> Result<Self> {
        Ok(Self { prepared: Prepared::new(scene, settings)?, cache: FrameCache::default() })
    }

    /// The prepared scene.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Renders an image in linear light.
    ///
    /// # Errors
    /// As for [`Pass::new`] and [`Pass::render`].
    pub fn render(&mut self, shot: &Shot<'_>, progress: Progress<'_>) -> Result<Frame> {
        self.with_pass(shot, |pass| pass.render(progress))
    }

    /// Renders an image and develops it to 8-bit sRGB with straight alpha, row by row from the top. `codes` is
    /// resized to the image; passing it in again avoids allocation.
    ///
    /// # Errors
    /// As for [`Pass::new`] and [`Pass::develop`].
    pub fn develop(
        &mut self,
        shot: &Shot<'_>,
        development: &Development,
        codes: &mut Vec<[u8; 4]>,
        progress: Progress<'_>,
    ) -> Result<()> {
        let pixels = shot.settings.width as usize * shot.settings.height as usize;
        self.with_pass(shot, |pass| {
            codes.resize(pixels, [0; 4]);
            pass.develop(development, codes, progress)
        })
    }

    fn with_pass<T>(&mut self, shot: &Shot<'_>, take: impl FnOnce(&Pass<'_>) -> Result<T>) -> Result<T> {
        let pass = Pass::with(std::mem::take(&mut self.cache), self.prepared.ready(), shot)?;
        let taken = take(&pass);
        self.cache = pass.into_cache();
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_can_be_kept_and_sent_anywhere() {
        fn assert_owned<T: Send + Sync + 'static>() {}
        assert_owned::<Renderer>();
    }
}
