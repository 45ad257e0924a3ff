//! Images of a prepared scene, tile by tile: a single one, or one after the other in the same memory.

use super::background::{Backdrop, Ground};
use super::camera::CameraRays;
use super::frame::{Aovs, Frame, tiles_of};
use super::prepare::{Parts, Prepared, Ready};
use super::settings::{Lighting, RenderSettings, Shot, SurfaceSettings};
use super::stages::{Stages, TileScratch};
use super::visibility::Projected;
use crate::error::{Error, Result};
use crate::film::{Developer, Development};
use crate::progress::Progress;
use crate::raster::Tile;
use crate::scene::Scene;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Prepares `scene` and renders one image of it.
///
/// # Errors
/// As for [`Prepared::new`] and [`Pass::new`].
pub fn render(scene: &Scene, shot: &Shot<'_>) -> Result<Frame> {
    let parts = Parts::new(scene, &shot.settings.surface)?;
    Pass::with(FrameCache::default(), Ready { scene, parts: &parts }, shot)?.render(Progress::SILENT)
}

/// Returns the output variables of a shot, if it asks for them.
pub(super) fn variables(ready: Ready<'_>, shot: &Shot<'_>) -> Result<Option<Aovs>> {
    match shot.settings.aovs {
        true => Ok(Pass::of_variables(ready, shot)?.render(Progress::SILENT)?.aovs),
        false => Ok(None),
    }
}

/// Tiles between two reports of progress.
const TILES_AT_ONCE: usize = 256;

/// One image: a prepared scene, seen from a camera under lights.
pub struct Pass<'p> {
    stages: Stages<'p>,
    scratches: Mutex<Vec<TileScratch>>,
    ground: Option<Ground>,
    backdrop: Option<Backdrop>,
    /// The pass for output variables, which are at the centre of each pixel; `None` if there are none, or if this
    /// pass has its samples there.
    variables: Option<Box<Self>>,
}

/// Memory that one image passes on to the next.
#[derive(Default)]
struct FrameCache {
    projected: Projected,
    scratches: Vec<TileScratch>,
}

impl<'p> Pass<'p> {
    /// Projects, clips and bins the triangles.
    ///
    /// # Errors
    /// [`Error::Invalid`] or [`Error::Limit`] for a size, sample count or camera that cannot be rendered,
    /// [`Error::Unsupported`] for a SIMD level that the CPU lacks.
    pub fn new(prepared: &'p Prepared, shot: &Shot<'_>) -> Result<Self> {
        Self::with(FrameCache::default(), prepared.ready(), shot)
    }

    /// Like [`Self::new`], but reuses the memory of an earlier image.
    fn with(cache: FrameCache, ready: Ready<'p>, shot: &Shot<'_>) -> Result<Self> {
        let Shot { camera, lighting, settings } = shot;
        let is_apart = settings.aovs && settings.samples != 1;
        let variables = is_apart.then(|| Self::of_variables(ready, shot).map(Box::new)).transpose()?;
        let own = RenderSettings { aovs: settings.aovs && !is_apart, ..(*settings).clone() };
        let stages = Stages::new(ready, &Shot { settings: &own, ..*shot }, cache.projected)?;
        let rays = CameraRays::new(camera, [settings.width, settings.height]);
        Ok(Self {
            scratches: Mutex::new(cache.scratches),
            ground: Ground::of(ready, shot, rays),
            backdrop: Backdrop::new(lighting.environment.as_ref(), rays),
            stages,
            variables,
        })
    }

    /// Makes the pass for the output variables of a shot, which depend on no light.
    fn of_variables(ready: Ready<'p>, shot: &Shot<'_>) -> Result<Self> {
        let (samples, aovs) = (1, true);
        let settings =
            RenderSettings { samples, aovs, shadows: false, ground: false, ..shot.settings.clone() };
        let shot = Shot { camera: shot.camera, lighting: &Lighting::default(), settings: &settings };
        Self::with(FrameCache::default(), ready, &shot)
    }

    /// Draws all tiles.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; if the image cannot be allocated as requested.
    pub fn render(&self, progress: Progress<'_>) -> Result<Frame> {
        let mut frame = Frame::new(self.stages.settings())?;
        self.draw(frame.tiles(), progress, |scratch, tile| tile.write(&scratch.resolve))?;
        if let Some(variables) = &self.variables {
            frame.aovs = variables.render(Progress::SILENT)?.aovs;
        }
        Ok(frame)
    }

    /// Draws all tiles and develops each immediately, so that the image in linear light is never in memory as a
    /// whole. `codes` receives the image as from [`crate::film::develop8`].
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Invalid`] if `codes` does not have as many pixels as the image; as for
    /// [`Developer::new`].
    pub fn develop(
        &self,
        development: &Development,
        codes: &mut [[u8; 4]],
        progress: Progress<'_>,
    ) -> Result<()> {
        let viewport = self.stages.viewport();
        let (width, height) = (viewport.width as usize, viewport.height as usize);
        if codes.len() != width * height {
            let what = format!("a buffer of {} pixels", codes.len());
            return Err(Error::invalid(what, format!("the image has {width}×{height}")));
        }
        let developer = Developer::new(development)?;
        self.draw(tiles_of(codes, width), progress, |scratch, tile| {
            developer.codes8(&scratch.resolve.color, &mut scratch.codes);
            tile.write(&scratch.codes);
        })
    }

    /// The stages, for measuring them individually.
    #[doc(hidden)]
    pub fn stages(&self) -> &Stages<'p> {
        &self.stages
    }

    /// Draws each tile and passes it on with its output.
    fn draw<O: Send>(
        &self,
        mut outputs: Vec<O>,
        progress: Progress<'_>,
        finish: impl Fn(&mut TileScratch, &mut O) + Sync,
    ) -> Result<()> {
        if self.stages.settings().shadows {
            self.stages.casters();
        }
        let total = outputs.len();
        for (group, outputs) in outputs.chunks_mut(TILES_AT_ONCE).enumerate() {
            let first = group * TILES_AT_ONCE;
            let done = first + outputs.len();
            outputs.par_iter_mut().with_max_len(1).enumerate().try_for_each(|(i, output)| -> Result<()> {
                let mut scratch = self.scratch();
                self.tile(first + i, &mut scratch)?;
                finish(&mut scratch, output);
                self.scratches().push(scratch);
                Ok(())
            })?;
            progress.at(done as f64 / total as f64)?;
        }
        Ok(())
    }

    fn tile(&self, index: usize, scratch: &mut TileScratch) -> Result<()> {
        let tile = Tile::new(self.stages.viewport(), index);
        self.stages.tile(&tile, scratch)?;
        if let Some(ground) = &self.ground {
            ground.fill(&tile, &mut scratch.resolve.color);
        }
        if let Some(backdrop) = &self.backdrop {
            backdrop.fill(&tile, &mut scratch.resolve.color);
        }
        Ok(())
    }

    /// Returns the memory that the next image can reuse.
    fn into_cache(self) -> FrameCache {
        let scratches = self.scratches.into_inner().unwrap_or_else(PoisonError::into_inner);
        FrameCache { projected: self.stages.into_projected(), scratches }
    }

    /// Returns a scratch that is free, or a new one.
    fn scratch(&self) -> TileScratch {
        let free = self.scratches().pop();
        free.unwrap_or_else(|| self.stages.scratch())
    }

    fn scratches(&self) -> MutexGuard<'_, Vec<TileScratch>> {
        self.scratches.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

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
