//! One image of a prepared scene, tile by tile.

use super::backdrop::Backdrop;
use super::frame::Frame;
use super::geometry::Projected;
use super::ground::Ground;
use super::prepare::{Prepared, Ready};
use super::rays::CameraRays;
use super::settings::Shot;
use super::stages::{Desk, Stages};
use super::tiles::tiles_of;
use crate::error::{Error, Result};
use crate::film::{Developer, Development};
use crate::progress::Progress;
use crate::raster::Tile;
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Tiles between two reports of progress.
const TILES_AT_ONCE: usize = 256;

/// One image: a prepared scene, seen from a camera under lights.
pub struct Pass<'p> {
    stages: Stages<'p>,
    desks: Mutex<Vec<Desk>>,
    ground: Option<Ground>,
    backdrop: Option<Backdrop>,
}

/// Room that one image leaves to the next.
#[derive(Default)]
pub(super) struct Kept {
    projected: Projected,
    desks: Vec<Desk>,
}

impl<'p> Pass<'p> {
    /// Projects, clips and bins the triangles.
    ///
    /// # Errors
    /// [`Error::Invalid`] or [`Error::Limit`] for a size, sample count or camera that cannot be drawn,
    /// [`Error::Unsupported`] for a SIMD level that the processor lacks.
    pub fn new(prepared: &'p Prepared, shot: &Shot<'_>) -> Result<Self> {
        Self::with(Kept::default(), prepared.ready(), shot)
    }

    /// Does what [`Self::new`] does, in the memory of an earlier image.
    pub(super) fn with(kept: Kept, ready: Ready<'p>, shot: &Shot<'_>) -> Result<Self> {
        let Shot { camera, lighting, settings } = shot;
        let stages = Stages::new(ready, shot, kept.projected)?;
        let rays = CameraRays::new(camera, [settings.width, settings.height]);
        let bounds = ready.bounds().filter(|_| settings.ground);
        Ok(Self {
            desks: Mutex::new(kept.desks),
            ground: bounds.map(|bounds| Ground::new(stages.casters(), bounds, lighting, rays)),
            backdrop: Backdrop::new(lighting.environment.as_ref(), rays),
            stages,
        })
    }

    /// Draws all tiles.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; where the image cannot be allocated as asked.
    pub fn render(&self, progress: Progress<'_>) -> Result<Frame> {
        let mut frame = Frame::new(self.stages.settings())?;
        self.draw(frame.tiles(), progress, |desk, tile| tile.write(&desk.resolve))?;
        Ok(frame)
    }

    /// Draws all tiles and develops each at once, so that the image in linear light never is in memory as a whole.
    /// `codes` takes the image as [`crate::film::develop8`] would give it.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Invalid`] where `codes` has not as many pixels as the image; as
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
            let what = format!("room for {} pixels", codes.len());
            return Err(Error::invalid(what, format!("the picture has {width}×{height}")));
        }
        let developer = Developer::new(development)?;
        self.draw(tiles_of(codes, width), progress, |desk, tile| {
            developer.codes8(&desk.resolve.color, &mut desk.codes);
            tile.write(&desk.codes);
        })
    }

    /// The stages, to be measured one by one.
    #[doc(hidden)]
    pub fn stages(&self) -> &Stages<'p> {
        &self.stages
    }

    /// Draws each tile and hands it over with its output.
    fn draw<O: Send>(
        &self,
        mut outputs: Vec<O>,
        progress: Progress<'_>,
        finish: impl Fn(&mut Desk, &mut O) + Sync,
    ) -> Result<()> {
        if self.stages.settings().shadows {
            self.stages.casters();
        }
        let total = outputs.len();
        for (group, outputs) in outputs.chunks_mut(TILES_AT_ONCE).enumerate() {
            let first = group * TILES_AT_ONCE;
            let done = first + outputs.len();
            outputs.par_iter_mut().with_max_len(1).enumerate().try_for_each(|(i, output)| -> Result<()> {
                let mut desk = self.desk();
                self.tile(first + i, &mut desk)?;
                finish(&mut desk, output);
                self.desks().push(desk);
                Ok(())
            })?;
            progress.at(done as f64 / total as f64)?;
        }
        Ok(())
    }

    fn tile(&self, index: usize, desk: &mut Desk) -> Result<()> {
        let tile = Tile::new(self.stages.viewport(), index);
        self.stages.tile(&tile, desk)?;
        if let Some(ground) = &self.ground {
            ground.fill(&tile, &mut desk.resolve.color);
        }
        if let Some(backdrop) = &self.backdrop {
            backdrop.fill(&tile, &mut desk.resolve.color);
        }
        Ok(())
    }

    /// Returns the memory that the next image can use again.
    pub(super) fn into_kept(self) -> Kept {
        let desks = self.desks.into_inner().unwrap_or_else(PoisonError::into_inner);
        Kept { projected: self.stages.into_projected(), desks }
    }

    /// Returns a desk that is free, or a new one.
    fn desk(&self) -> Desk {
        let free = self.desks().pop();
        free.unwrap_or_else(|| self.stages.desk())
    }

    fn desks(&self) -> MutexGuard<'_, Vec<Desk>> {
        self.desks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
