//! One picture of a prepared scene, tile by tile and stage by stage.

use super::backdrop::Backdrop;
use super::batch::{BATCH, Batch, get3};
use super::fragments::{self, Key};
use super::frame::{Frame, TilePicture};
use super::geometry::Projected;
use super::ground::Ground;
use super::grouping::Grouping;
use super::interpolate::Interpolation;
use super::lighting::{Illumination, Source, light};
use super::point::complete;
use super::prepare::Prepared;
use super::rays::CameraRays;
use super::settings::{EnvironmentLight, Lighting, RenderSettings};
use super::shadows::trace_shadows;
use super::surround;
use super::view::View;
use crate::error::Result;
use crate::math::Vec3;
use crate::raster::{self, Bins, SamplePattern, TILE_PIXELS, Tile, TilePlane, Viewport};
use crate::scene::{AlphaMode, Camera};
use fearless_simd::Level;
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Tiles between two reports of progress.
const TILES_AT_ONCE: usize = 256;

/// How far shadow rays start above the surface, as a fraction of the scene's size.
pub(super) const SHADOW_LIFT: f64 = 1e-5;

/// One picture: a prepared scene, seen from a camera under lights.
pub struct Pass<'p, 'a> {
    pub(super) prepared: &'p Prepared<'a>,
    pub(super) view: View,
    pub(super) viewport: Viewport,
    /// Each draw's vertices in clip space.
    pub(super) clip: Vec<Vec<[f32; 4]>>,
    pub(super) shadow_lift: f32,
    opaque: Bins,
    layered: Bins,
    sources: Vec<Source>,
    ambient: Vec3,
    environment: Option<EnvironmentLight>,
    ground: Option<Ground>,
    backdrop: Option<Backdrop>,
    pub(super) settings: RenderSettings,
    pub(super) level: Level,
    desks: Mutex<Vec<Box<Desk>>>,
}

/// What drawing a tile needs, kept from tile to tile.
struct Desk {
    plane: TilePlane,
    grouping: Grouping,
    keys: Vec<Key>,
    batch: Box<Batch>,
}

/// What a tile collects over its samples.
struct Resolve {
    picture: TilePicture,
    weight: f32,
}

/// A fragment with its colour.
#[derive(Debug, Clone, Copy)]
struct Shaded {
    key: Key,
    /// Linear RGB, not premultiplied.
    radiance: Vec3,
    /// How much of what is behind is covered.
    coverage: f32,
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
        // Checks the size before anything is made of it.
        crate::image::Image::check_size(settings.width, settings.height)?;
        let viewport = Viewport {
            width: settings.width,
            height: settings.height,
            pattern: SamplePattern::new(settings.samples)?,
        };
        let view = View::new(camera, settings.width, settings.height)?;
        let mut projected = Projected::default();
        projected.rebuild(prepared, &view, &viewport, settings.simd)?;
        let Projected { clip, opaque, layered } = projected;
        let rays = CameraRays::new(camera, [settings.width, settings.height]);
        let size = prepared.bounds().map_or(1.0, |bounds| bounds.diagonal());
        Ok(Self {
            prepared,
            view,
            viewport,
            opaque,
            layered,
            clip,
            shadow_lift: (size * SHADOW_LIFT) as f32,
            sources: lighting.lights.iter().map(Source::new).collect(),
            ambient: lighting.ambient,
            environment: lighting.environment.clone(),
            ground: settings.ground.then(|| Ground::new(prepared, lighting, rays)).flatten(),
            backdrop: Backdrop::new(lighting.environment.as_ref(), rays),
            settings: settings.clone(),
            level: settings.simd.dispatch()?,
            desks: Mutex::default(),
        })
    }

    /// Draws all tiles. `progress` is called from one thread with the fraction done, now and then.
    ///
    /// # Errors
    /// Where the picture cannot be allocated as asked.
    pub fn render(&self, progress: &dyn Fn(f64)) -> Result<Frame> {
        let mut frame = Frame::new(&self.settings)?;
        if self.settings.shadows {
            self.prepared.casters();
        }
        let total = self.tile_count();
        for start in (0..total).step_by(TILES_AT_ONCE) {
            let tiles = start..(start + TILES_AT_ONCE).min(total);
            let pictures: Vec<(Tile, TilePicture)> =
                tiles.into_par_iter().map(|index| self.tile(index)).collect::<Result<_>>()?;
            frame.store(&pictures);
            progress((start + pictures.len()) as f64 / total as f64);
        }
        Ok(frame)
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

    fn tile(&self, index: usize) -> Result<(Tile, TilePicture)> {
        let tile = Tile::new(&self.viewport, index);
        let mut desk = self.desk();
        let mut resolve = Resolve::new(self.viewport.pattern, self.settings.aovs);
        for sample in 0..self.viewport.pattern.offsets().len() {
            self.find_visible(&tile, sample, &mut desk)?;
            self.shade(&tile, sample, &mut desk, &mut resolve);
        }
        self.desks.lock().unwrap_or_else(PoisonError::into_inner).push(desk);
        if let Some(ground) = &self.ground {
            ground.fill(&tile, &mut resolve.picture.color);
        }
        if let Some(backdrop) = &self.backdrop {
            backdrop.fill(&tile, &mut resolve.picture.color);
        }
        Ok((tile, resolve.picture))
    }

    /// One that is free, or a new one.
    fn desk(&self) -> Box<Desk> {
        let free = self.desks.lock().unwrap_or_else(PoisonError::into_inner).pop();
        free.unwrap_or_else(|| {
            Box::new(Desk {
                plane: TilePlane::default(),
                grouping: Grouping::default(),
                keys: Vec::new(),
                batch: self.batch(),
            })
        })
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
        raster::rasterize_opaque(&self.opaque, tile, offset, self.settings.simd, plane)?;
        let layers = raster::rasterize_layers(&self.layered, tile, offset, self.settings.simd, plane)?;
        grouping.append(plane, |triangle| self.prepared.draw_of(triangle), keys);
        // Layers come in the order of drawing, and no draw has both.
        keys.extend(layers.iter().map(|l| Key { pixel: l.pixel, triangle: l.id, depth: l.depth }));
        Ok(())
    }

    /// Stages 2 to 5 for all fragments of a sample.
    fn shade(&self, tile: &Tile, sample: usize, desk: &mut Desk, resolve: &mut Resolve) {
        let Desk { keys, batch, .. } = desk;
        let layered = |draw: usize| self.prepared.draws[draw].layered();
        let mut shaded = Vec::new();
        let lie_over_one_another = self.runs(keys).any(|(draw, _)| layered(draw));
        for (draw, keys) in self.runs(keys) {
            for keys in keys.chunks(BATCH) {
                self.gather(tile, sample, draw, keys, batch);
                self.light(draw, batch);
                if lie_over_one_another {
                    self.collect(draw, keys, batch, &mut shaded);
                } else {
                    resolve.add_opaque(keys, batch);
                }
                if sample == 0 {
                    resolve.note_aovs(keys, self.prepared.draws[draw].material.alpha, batch, &self.view);
                }
            }
        }
        if lie_over_one_another {
            resolve.add(shaded);
        }
    }

    /// The parts of `keys`, sorted by draw, that belong to one draw each, with the draw's number.
    pub fn runs<'k>(&self, keys: &'k [Key]) -> impl Iterator<Item = (usize, &'k [Key])> {
        let draw_of = |key: &Key| self.prepared.draw_of(key.triangle);
        keys.chunk_by(move |a, b| draw_of(a) == draw_of(b)).map(move |keys| (draw_of(&keys[0]), keys))
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

    fn collect(&self, draw: usize, keys: &[Key], batch: &Batch, shaded: &mut Vec<Shaded>) {
        let alpha = self.prepared.draws[draw].material.alpha;
        for (i, key) in keys.iter().enumerate() {
            let coverage = coverage(alpha, batch.alpha[i]);
            shaded.push(Shaded { key: *key, radiance: get3(&batch.radiance, i), coverage });
        }
    }
}

/// How much a fragment hides of what is behind it.
fn coverage(mode: AlphaMode, alpha: f32) -> f32 {
    match mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        AlphaMode::Blend => alpha.clamp(0.0, 1.0),
    }
}

impl Resolve {
    fn new(pattern: SamplePattern, aovs: bool) -> Self {
        let plane = || vec![[0.0; 4]; TILE_PIXELS];
        let aovs = std::array::from_fn(|_| if aovs { plane() } else { Vec::new() });
        Self { picture: TilePicture { color: plane(), aovs }, weight: 1.0 / pattern.offsets().len() as f32 }
    }

    /// Lays the fragments of a sample over one another, far ones first, and adds them up.
    fn add(&mut self, mut shaded: Vec<Shaded>) {
        // At equal depth what was drawn first lies on top, as in the depth test.
        shaded.sort_by(|a, b| {
            let order = |s: &Shaded| (s.key.pixel, s.key.depth.to_bits());
            order(a).cmp(&order(b)).then(b.key.triangle.cmp(&a.key.triangle))
        });
        for fragments in shaded.chunk_by(|a, b| a.key.pixel == b.key.pixel) {
            let mut color = [0.0f32; 4];
            for fragment in fragments {
                let [r, g, b] = fragment.radiance.to_array();
                let source = [r, g, b, 1.0];
                let behind = 1.0 - fragment.coverage;
                color = std::array::from_fn(|c| source[c] * fragment.coverage + color[c] * behind);
            }
            let sum = &mut self.picture.color[fragments[0].key.pixel as usize];
            for c in 0..4 {
                sum[c] += color[c] * self.weight;
            }
        }
    }

    /// Adds fragments of which each is all that is seen in its pixel.
    fn add_opaque(&mut self, keys: &[Key], batch: &Batch) {
        let weight = self.weight;
        for (i, key) in keys.iter().enumerate() {
            let sum = &mut self.picture.color[key.pixel as usize];
            let [r, g, b] = get3(&batch.radiance, i).to_array();
            *sum = [sum[0] + r * weight, sum[1] + g * weight, sum[2] + b * weight, sum[3] + weight];
        }
    }

    /// Keeps what is nearest so far and at least half there.
    fn note_aovs(&mut self, keys: &[Key], mode: AlphaMode, batch: &Batch, view: &View) {
        let [normals, depth, albedo, uv, triangle] = &mut self.picture.aovs;
        if normals.is_empty() {
            return;
        }
        for (i, key) in keys.iter().enumerate().filter(|(i, _)| coverage(mode, batch.alpha[*i]) >= 0.5) {
            let pixel = key.pixel as usize;
            let distance = view.depth(get3(&batch.position, i));
            if depth[pixel][3] != 0.0 && depth[pixel][0] <= distance {
                continue;
            }
            let with_one = |v: Vec3| [v.x, v.y, v.z, 1.0];
            normals[pixel] = with_one(get3(&batch.n, i));
            depth[pixel] = [distance, distance, distance, 1.0];
            albedo[pixel] = with_one(get3(&batch.albedo, i));
            let [u, v] = batch.first_uv(i);
            uv[pixel] = [u, v, 0.0, 1.0];
            let id = key.triangle as f32;
            triangle[pixel] = [id, id, id, 1.0];
        }
    }
}
