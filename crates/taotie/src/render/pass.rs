//! One picture of a prepared scene, tile by tile and stage by stage.

use super::backdrop::Backdrop;
use super::batch::{BATCH, Batch};
use super::fragments::{self, Key};
use super::frame::Frame;
use super::geometry::Projected;
use super::ground::Ground;
use super::grouping::Grouping;
use super::interpolate::Interpolation;
use super::lighting::{Illumination, Source, light};
use super::point::complete;
use super::prepare::Prepared;
use super::rays::CameraRays;
use super::resolve::Resolve;
use super::settings::{EnvironmentLight, Lighting, RenderSettings};
use super::shadows::trace_shadows;
use super::substance::takes_roughness;
use super::surround;
use super::tiles::tiles_of;
use super::view::View;
use crate::error::{Error, Result};
use crate::film::{Developer, Development};
use crate::math::Vec3;
use crate::progress::Progress;
use crate::raster::{self, SamplePattern, TILE_PIXELS, Tile, TilePlane, Viewport};
use crate::scene::Camera;
use fearless_simd::Level;
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Tiles between two reports of progress.
const TILES_AT_ONCE: usize = 256;

/// How far shadow rays start above the surface, as a fraction of the scene's size.
pub(super) const SHADOW_LIFT: f64 = 1e-5;

/// One picture: a prepared scene, seen from a camera under lights.
pub struct Pass<'p, 'a> {
    pub(super) prepared: &'p Prepared<'a>,
    pub(super) view: View,
    pub(super) viewport: Viewport,
    pub(super) shadow_lift: f32,
    pub(super) kept: Kept,
    sources: Vec<Source>,
    ambient: Vec3,
    environment: Option<EnvironmentLight>,
    ground: Option<Ground>,
    backdrop: Option<Backdrop>,
    pub(super) settings: RenderSettings,
    pub(super) level: Level,
}

/// Room that one picture leaves to the next.
#[derive(Default)]
pub(super) struct Kept {
    pub projected: Projected,
    desks: Mutex<Vec<Desk>>,
}

/// What drawing a tile needs.
struct Desk {
    plane: TilePlane,
    grouping: Grouping,
    keys: Vec<Key>,
    batch: Box<Batch>,
    resolve: Resolve,
    codes: Vec<[u8; 4]>,
}

impl<'p, 'a> Pass<'p, 'a> {
    /// Projects, clips and bins the triangles.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] or [`crate::Error::Limit`] for a size, sample count or camera that cannot be
    /// drawn, [`crate::Error::Unsupported`] for a SIMD level that the processor lacks.
    pub fn new(
        prepared: &'p Prepared<'a>,
        camera: &Camera,
        lighting: &Lighting,
        settings: &RenderSettings,
    ) -> Result<Self> {
        Self::with(Kept::default(), prepared, (camera, lighting), settings)
    }

    /// As [`Self::new`], in the memory of an earlier picture.
    pub(super) fn with(
        mut kept: Kept,
        prepared: &'p Prepared<'a>,
        (camera, lighting): (&Camera, &Lighting),
        settings: &RenderSettings,
    ) -> Result<Self> {
        // Checks the size before anything is made of it.
        crate::image::Image::check_size(settings.width, settings.height)?;
        let viewport = Viewport {
            width: settings.width,
            height: settings.height,
            pattern: SamplePattern::new(settings.samples)?,
        };
        let view = View::new(camera, settings.width, settings.height)?;
        kept.projected.rebuild(prepared, &view, &viewport, settings.simd)?;
        let rays = CameraRays::new(camera, [settings.width, settings.height]);
        let size = prepared.bounds().map_or(1.0, |bounds| bounds.diagonal());
        Ok(Self {
            prepared,
            view,
            viewport,
            shadow_lift: (size * SHADOW_LIFT) as f32,
            kept,
            sources: lighting.lights.iter().map(Source::new).collect(),
            ambient: lighting.ambient,
            environment: lighting.environment.clone(),
            ground: settings.ground.then(|| Ground::new(prepared, lighting, rays)).flatten(),
            backdrop: Backdrop::new(lighting.environment.as_ref(), rays),
            settings: settings.clone(),
            level: settings.simd.dispatch()?,
        })
    }

    /// Draws all tiles.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; where the picture cannot be allocated as asked.
    pub fn render(&self, progress: Progress<'_>) -> Result<Frame> {
        let mut frame = Frame::new(&self.settings)?;
        self.draw(frame.tiles(), progress, |desk, tile| tile.write(&desk.resolve))?;
        Ok(frame)
    }

    /// Draws all tiles and develops each at once, so that the picture in linear light never is in memory as a whole.
    /// `codes` takes the picture as [`crate::film::develop8`] would give it.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; [`Error::Invalid`] where `codes` has not as many pixels as the picture; as [`Developer::new`].
    pub fn develop(
        &self,
        development: &Development,
        codes: &mut [[u8; 4]],
        progress: Progress<'_>,
    ) -> Result<()> {
        let (width, height) = (self.viewport.width as usize, self.viewport.height as usize);
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

    /// Draws each tile and hands it over with its output.
    fn draw<O: Send>(
        &self,
        mut outputs: Vec<O>,
        progress: Progress<'_>,
        finish: impl Fn(&mut Desk, &mut O) + Sync,
    ) -> Result<()> {
        if self.settings.shadows {
            self.prepared.casters();
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

    /// What the next picture can use again.
    pub(super) fn into_kept(self) -> Kept {
        self.kept
    }

    /// How many tiles the picture has.
    pub fn tile_count(&self) -> usize {
        let (across, down) = self.viewport.tiles();
        (across * down) as usize
    }

    /// The picture's size and sampling pattern.
    pub fn viewport(&self) -> &Viewport {
        &self.viewport
    }

    /// An empty batch with room for the visibility of every light.
    pub fn batch(&self) -> Box<Batch> {
        Batch::new(self.sources.len())
    }

    fn tile(&self, index: usize, desk: &mut Desk) -> Result<()> {
        let tile = Tile::new(&self.viewport, index);
        let samples = self.viewport.pattern.offsets().len();
        desk.resolve.begin(samples, self.settings.aovs);
        for sample in 0..samples {
            self.find_visible(&tile, sample, desk)?;
            self.shade(&tile, sample, desk);
        }
        if let Some(ground) = &self.ground {
            ground.fill(&tile, &mut desk.resolve.color);
        }
        if let Some(backdrop) = &self.backdrop {
            backdrop.fill(&tile, &mut desk.resolve.color);
        }
        Ok(())
    }

    /// One that is free, or a new one.
    fn desk(&self) -> Desk {
        let free = self.desks().pop();
        let mut desk = free.unwrap_or_else(|| Desk {
            plane: TilePlane::default(),
            grouping: Grouping::default(),
            keys: Vec::new(),
            batch: self.batch(),
            resolve: Resolve::default(),
            codes: vec![[0; 4]; TILE_PIXELS],
        });
        desk.batch.begin(self.sources.len());
        desk
    }

    fn desks(&self) -> MutexGuard<'_, Vec<Desk>> {
        self.kept.desks.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stage 1: which triangles are seen at a sample of a tile, those of a draw and of a triangle together; `plane` is
    /// scratch.
    ///
    /// # Errors
    /// Where the SIMD level is not to be had.
    pub fn visible(&self, tile: &Tile, sample: usize, plane: &mut TilePlane) -> Result<Vec<Key>> {
        let mut keys = Vec::new();
        self.find(tile, sample, (plane, &mut Grouping::default()), &mut keys)?;
        Ok(keys)
    }

    fn find_visible(&self, tile: &Tile, sample: usize, desk: &mut Desk) -> Result<()> {
        desk.keys.clear();
        self.find(tile, sample, (&mut desk.plane, &mut desk.grouping), &mut desk.keys)
    }

    fn find(
        &self,
        tile: &Tile,
        sample: usize,
        (plane, grouping): (&mut TilePlane, &mut Grouping),
        keys: &mut Vec<Key>,
    ) -> Result<()> {
        let offset = self.viewport.pattern.offsets()[sample];
        raster::rasterize_opaque(&self.kept.projected.opaque, tile, offset, self.settings.simd, plane)?;
        let layers =
            raster::rasterize_layers(&self.kept.projected.layered, tile, offset, self.settings.simd, plane)?;
        grouping.append(plane, |triangle| self.prepared.draw_of(triangle), keys);
        // Layers come in the order of drawing, and no draw has both.
        keys.extend(layers.iter().map(|l| Key { pixel: l.pixel, triangle: l.id, depth: l.depth }));
        Ok(())
    }

    /// Stages 2 to 5 for all fragments of a sample.
    fn shade(&self, tile: &Tile, sample: usize, desk: &mut Desk) {
        let Desk { keys, batch, resolve, .. } = desk;
        let layered = self.runs(keys).any(|(draw, _)| self.prepared.draws[draw].layered());
        for (draw, keys) in self.runs(keys) {
            let alpha = self.prepared.draws[draw].material.alpha;
            for keys in keys.chunks(BATCH) {
                self.gather(tile, sample, draw, keys, batch);
                self.light(draw, batch);
                if layered {
                    resolve.keep(keys, alpha, batch);
                } else {
                    resolve.add_opaque(keys, batch);
                }
                if sample == 0 {
                    resolve.note_aovs(keys, alpha, batch, &self.view);
                }
            }
        }
        resolve.add_layers();
    }

    /// The parts of `keys`, in which those of a draw are together, with the draw's number.
    pub fn runs<'k>(&self, mut keys: &'k [Key]) -> impl Iterator<Item = (usize, &'k [Key])> {
        std::iter::from_fn(move || {
            let draw = self.prepared.draw_of(keys.first()?.triangle);
            let triangles = self.prepared.draws[draw].numbers();
            let same = keys.iter().take_while(|key| triangles.contains(&key.triangle)).count();
            let (run, rest) = keys.split_at(same.max(1));
            keys = rest;
            Some((draw, run))
        })
    }

    /// Stage 2: interpolates vertices and reads textures for at most [`BATCH`] keys of one draw.
    pub fn gather(&self, tile: &Tile, sample: usize, draw: usize, keys: &[Key], batch: &mut Batch) {
        fragments::gather(self, (tile, sample), draw, keys, batch);
    }

    /// Makes fragments of a draw.
    pub(super) fn interpolation(&self, draw: usize) -> Interpolation<'_, 'a> {
        Interpolation {
            level: self.level,
            scene: self.prepared.scene,
            draw: &self.prepared.draws[draw],
            specular_aa: self.settings.specular_aa && !self.settings.shading.is_printed(),
            takes_roughness: self.environment.is_some()
                || takes_roughness(self.settings.shading, self.prepared.draws[draw].material),
        }
    }

    /// Stages 3 to 5: shading normals, shadows, lighting.
    pub fn light(&self, draw: usize, batch: &mut Batch) {
        let settings = &self.settings;
        let interpolation = self.interpolation(draw);
        let draw = &self.prepared.draws[draw];
        complete(self.level, settings, draw, batch);
        if let Some(environment) = &self.environment {
            surround::look_up(self.level, environment, settings.shading, draw, batch);
        }
        if settings.shadows {
            let origins = interpolation.origins(self.shadow_lift, batch);
            trace_shadows(self.prepared, &self.sources, &origins, batch);
        }
        let illumination = Illumination {
            shading: self.settings.shading,
            sources: &self.sources,
            ambient: self.ambient,
            shadows: self.settings.shadows,
            surrounded: self.environment.is_some(),
        };
        light(self.level, &illumination, draw, batch);
    }
}
