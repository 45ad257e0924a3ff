//! The stages of an image: visibility, fragments, normals, shadows, lighting, and resolve into the tile.

use super::batch::{Batch, Points, Run};
use super::camera::View;
use super::draw::Draws;
use super::frame::Resolve;
use super::interpolate::{Interpolation, Screen};
use super::lighting::{EnvironmentQuery, Illumination, light, look_up_environment};
use super::prepare::Ready;
use super::settings::{EnvironmentLight, RenderSettings, Shot};
use super::surface_point::complete;
use super::tree::{Casters, trace_shadows};
use super::visibility::{Grouping, Projected, VisibleBatch, VisibleSpan, batches};
use crate::error::Result;
use crate::math::{MOST_LANES, Pack, Vec3, dispatch_pack};
use crate::pixel::{LightSource, takes_roughness};
use crate::raster::{self, SamplePattern, TILE_PIXELS, TILE_SIZE, Tile, TilePlane, TileSample, Viewport};
use fearless_simd::Level;

/// The stages that each tile of an image passes through, and their inputs.
pub struct Stages<'p> {
    ready: Ready<'p>,
    draws: Draws<'p>,
    projected: Projected,
    view: View,
    viewport: Viewport,
    sources: Vec<LightSource<f32>>,
    ambient: Vec3,
    environment: Option<EnvironmentLight>,
    /// The settings effective for the model.
    settings: RenderSettings,
    level: Level,
    ray_offset: f32,
}

/// The working memory for drawing a tile.
pub(super) struct TileScratch {
    pub resolve: Resolve,
    pub codes: Vec<[u8; 4]>,
    plane: TilePlane,
    grouping: Grouping,
    visible: Vec<VisibleSpan>,
    batch: Box<Batch>,
}

impl<'p> Stages<'p> {
    /// Projects, clips and bins the triangles, reusing the memory of `projected`.
    ///
    /// # Errors
    /// As for [`super::Pass::new`].
    pub(super) fn new(ready: Ready<'p>, shot: &Shot<'_>, mut projected: Projected) -> Result<Self> {
        shot.check()?;
        let settings = shot.settings.as_taken();
        let (width, height) = (settings.width, settings.height);
        // Checks the size before anything is allocated for it.
        crate::image::Image::check_size(width, height)?;
        let viewport = Viewport { width, height, pattern: SamplePattern::new(settings.samples)? };
        let view = View::new(shot.camera, width, height)?;
        let draws = ready.draws();
        projected.rebuild(&draws.all, &view, &viewport, settings.surface.simd)?;
        Ok(Self {
            ready,
            draws,
            projected,
            view,
            viewport,
            sources: shot.lighting.lights.iter().map(LightSource::new).collect(),
            ambient: shot.lighting.ambient,
            environment: shot.lighting.environment.clone(),
            level: settings.surface.simd.dispatch()?,
            settings,
            ray_offset: ready.ray_offset(),
        })
    }

    /// The memory of the triangles, for the next image.
    pub(super) fn into_projected(self) -> Projected {
        self.projected
    }

    /// The settings effective for the model.
    pub(super) fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The shadow casters; the tree is built on first use.
    pub(super) fn casters(&self) -> Casters<'_> {
        Casters { tree: self.ready.tree(0), draws: &self.draws }
    }

    /// The number of tiles of the image.
    pub fn tile_count(&self) -> usize {
        let (across, down) = self.viewport.tiles();
        (across * down) as usize
    }

    /// The image's size and sampling pattern.
    pub fn viewport(&self) -> &Viewport {
        &self.viewport
    }

    /// Creates a batch with the visibility of every light.
    pub fn batch(&self) -> Box<Batch> {
        Batch::new(self.sources.len())
    }

    /// Creates empty working memory for drawing a tile.
    pub(super) fn scratch(&self) -> TileScratch {
        TileScratch {
            resolve: Resolve::default(),
            codes: vec![[0; 4]; TILE_PIXELS],
            plane: TilePlane::default(),
            grouping: Grouping::default(),
            visible: Vec::new(),
            batch: self.batch(),
        }
    }

    /// Draws the surfaces in a tile.
    ///
    /// # Errors
    /// If the SIMD level is not available.
    pub(super) fn tile(&self, tile: &Tile, scratch: &mut TileScratch) -> Result<()> {
        let offsets = self.viewport.pattern.offsets();
        scratch.batch.begin(self.sources.len());
        scratch.resolve.begin(offsets.len(), self.settings.aovs);
        for offset in offsets {
            let at = TileSample { tile, offset: *offset };
            let TileScratch { plane, grouping, visible, .. } = scratch;
            visible.clear();
            self.find(at, plane, grouping, visible)?;
            self.shade(at, scratch);
        }
        Ok(())
    }

    /// Stage 1: finds the triangles visible at a sample of a tile, those of a draw and of a triangle together;
    /// `plane` is scratch.
    ///
    /// # Errors
    /// If the SIMD level is not available.
    pub fn visible(&self, at: TileSample<'_>, plane: &mut TilePlane) -> Result<Vec<VisibleSpan>> {
        let mut visible = Vec::new();
        self.find(at, plane, &mut Grouping::default(), &mut visible)?;
        Ok(visible)
    }

    fn find(
        &self,
        at: TileSample<'_>,
        plane: &mut TilePlane,
        grouping: &mut Grouping,
        visible: &mut Vec<VisibleSpan>,
    ) -> Result<()> {
        let simd = self.settings.surface.simd;
        raster::rasterize_opaque(&self.projected.opaque, at, simd, plane)?;
        let layers = raster::rasterize_layers(&self.projected.layered, at, simd, plane)?;
        grouping.append(self.level, plane, |triangle| self.draws.number_of(triangle), visible);
        // Layers are in drawing order, and no draw has both.
        visible.extend(layers.iter().map(|l| VisibleSpan {
            start: l.pixel,
            end: l.pixel + 1,
            triangle: l.id,
            depth: l.depth,
        }));
        Ok(())
    }

    /// Runs stages 2 to 5 for all fragments of a sample.
    fn shade(&self, at: TileSample<'_>, scratch: &mut TileScratch) {
        let TileScratch { visible, batch, resolve, .. } = scratch;
        let layered = visible.last().is_some_and(|last| self.draws.of(last.triangle).layered());
        for (draw, visible) in self.runs(visible) {
            let material = self.draws.all[draw].material;
            for visible in batches(visible) {
                self.gather(at, draw, visible, batch);
                self.light(draw, batch);
                if layered {
                    resolve.keep(visible, material, batch);
                } else {
                    resolve.add_opaque(visible, batch);
                }
                // Images with output variables have one sample per pixel.
                resolve.note_aovs(visible, material, batch, &self.view);
            }
        }
        resolve.add_layers();
    }

    /// The parts of `visible`, which contains the spans of each draw together, with the draw's index.
    pub fn runs<'k>(
        &self,
        mut visible: &'k [VisibleSpan],
    ) -> impl Iterator<Item = (usize, &'k [VisibleSpan])> {
        std::iter::from_fn(move || {
            let draw = self.draws.number_of(visible.first()?.triangle);
            let triangles = self.draws.all[draw].numbers();
            let same = visible.iter().take_while(|span| triangles.contains(&span.triangle)).count();
            let (run, rest) = visible.split_at(same.max(1));
            visible = rest;
            Some((draw, run))
        })
    }

    /// Stage 2: interpolates vertices and reads textures for visible pixels of one draw.
    pub fn gather(&self, at: TileSample<'_>, draw: usize, visible: VisibleBatch<'_>, batch: &mut Batch) {
        let offset = at.offset.map(|o| o as f32 / 256.0);
        dispatch_pack!(self.level, P, token => place::<P>(token, visible, offset, batch));
        let interpolation = self.interpolation(draw);
        let screen = Screen {
            viewport: &self.viewport,
            clip: &self.projected.clip[draw],
            origin: [f64::from(at.tile.x), f64::from(at.tile.y)],
        };
        interpolation.weigh(&screen, batch);
        interpolation.fill(Some(self.view.eye), batch);
    }

    /// Computes the fragments of a draw.
    fn interpolation(&self, draw: usize) -> Interpolation<'_> {
        let draw = &self.draws.all[draw];
        Interpolation {
            level: self.level,
            scene: self.draws.scene,
            draw,
            specular_aa: self.settings.specular_aa,
            takes_roughness: self.environment.is_some()
                || takes_roughness(self.settings.shading, draw.material),
        }
    }

    /// Runs stages 3 to 5: shading normals, shadows, lighting.
    pub fn light(&self, draw: usize, batch: &mut Batch) {
        let settings = &self.settings;
        let interpolation = self.interpolation(draw);
        let draw = &self.draws.all[draw];
        complete(self.level, settings, draw, batch);
        if let Some(light) = &self.environment {
            look_up_environment(
                self.level,
                EnvironmentQuery { light, shading: settings.shading },
                draw,
                batch,
            );
        }
        if settings.shadows {
            let origins = interpolation.origins(self.ray_offset, batch);
            trace_shadows(self.casters(), &self.sources, &origins, batch);
        }
        let illumination = Illumination {
            shading: settings.shading,
            sources: &self.sources,
            ambient: self.ambient,
            shadows: settings.shadows,
            has_environment: self.environment.is_some(),
        };
        light(self.level, &illumination, draw, batch);
    }
}

/// Clears `batch` and fills in the positions of the visible pixels at `offset` within the pixels.
#[inline(always)]
fn place<P: Pack>(token: P::Token, visible: VisibleBatch<'_>, offset: [f32; 2], batch: &mut Batch) {
    let Points { place: [x, y], runs, .. } = &mut batch.points;
    batch.len = visible.len();
    runs.clear();
    let (numbers, [right, down]) = (P::load(token, &NUMBERS), offset.map(|offset| P::splat(token, offset)));
    let mut start = 0;
    for span in visible.spans() {
        let end = start + span.len();
        let column = (span.start % TILE_SIZE) as f32;
        let row = P::splat(token, (span.start / TILE_SIZE) as f32) + down;
        // The end of a pack may overwrite the next span, which is written afterwards.
        for i in (start..end).step_by(P::LANES) {
            (numbers + P::splat(token, column + (i - start) as f32) + right).store(&mut x[i..]);
            row.store(&mut y[i..]);
        }
        match runs.last_mut() {
            Some(run) if run.triangle == span.triangle => run.end = end,
            _ => runs.push(Run { triangle: span.triangle, start, end }),
        }
        start = end;
    }
}

/// The lanes' numbers.
const NUMBERS: [f32; MOST_LANES] =
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];
