//! One picture of a prepared scene, tile by tile and stage by stage.

use super::backdrop::Backdrop;
use super::batch::{BATCH, Batch, get3};
use super::fragments::{Gather, Key};
use super::frame::{Frame, TilePicture};
use super::geometry::Projected;
use super::ground::Ground;
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
use crate::raster::{
    self, Bins, NO_TRIANGLE, SamplePattern, TILE_PIXELS, TILE_SIZE, Tile, TilePlane, Viewport,
};
use crate::scene::{AlphaMode, Camera};
use fearless_simd::Level;
use rayon::prelude::*;

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
    level: Level,
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
            for (tile, picture) in &pictures {
                frame.store(tile, picture);
            }
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
        let mut plane = TilePlane::default();
        let mut batch = self.batch();
        let mut resolve = Resolve::new(self.viewport.pattern, self.settings.aovs);
        for sample in 0..self.viewport.pattern.offsets().len() {
            let keys = self.visible(&tile, sample, &mut plane)?;
            let shaded = self.shade(&tile, sample, &keys, &mut batch, &mut resolve);
            resolve.add(shaded);
        }
        if let Some(ground) = &self.ground {
            ground.fill(&tile, &mut resolve.picture.color);
        }
        if let Some(backdrop) = &self.backdrop {
            backdrop.fill(&tile, &mut resolve.picture.color);
        }
        Ok((tile, resolve.picture))
    }

    /// Stage 1: which triangles are seen at a sample of a tile, sorted by draw; `plane` is scratch.
    ///
    /// # Errors
    /// Where the SIMD level is not to be had.
    pub fn visible(&self, tile: &Tile, sample: usize, plane: &mut TilePlane) -> Result<Vec<Key>> {
        let offset = self.viewport.pattern.offsets()[sample];
        raster::rasterize_opaque(&self.opaque, tile, offset, self.settings.simd, plane)?;
        let layers = raster::rasterize_layers(&self.layered, tile, offset, self.settings.simd, plane)?;
        let opaque = plane.ids.iter().zip(&plane.depths).enumerate();
        let mut keys: Vec<Key> = opaque
            .filter(|(_, (id, _))| **id != NO_TRIANGLE)
            .map(|(pixel, (id, depth))| Key { pixel: pixel as u32, triangle: *id, depth: *depth })
            .collect();
        keys.extend(layers.iter().map(|l| Key { pixel: l.pixel, triangle: l.id, depth: l.depth }));
        if self.prepared.draws.len() > 1 {
            keys.sort_by_cached_key(|key| self.prepared.draw_of(key.triangle));
        }
        Ok(keys)
    }

    /// Stages 2 to 5 for all fragments of a sample.
    fn shade(
        &self,
        tile: &Tile,
        sample: usize,
        keys: &[Key],
        batch: &mut Batch,
        resolve: &mut Resolve,
    ) -> Vec<Shaded> {
        let mut shaded = Vec::with_capacity(keys.len());
        for (draw, keys) in self.runs(keys) {
            for keys in keys.chunks(BATCH) {
                let origins = self.gather(tile, sample, draw, keys, batch);
                self.light(draw, &origins, batch);
                self.collect(draw, keys, batch, &mut shaded);
                if sample == 0 {
                    resolve.note_aovs(&shaded[shaded.len() - keys.len()..], batch, &self.view);
                }
            }
        }
        shaded
    }

    /// The parts of `keys`, sorted by draw, that belong to one draw each, with the draw's number.
    pub fn runs<'k>(&self, keys: &'k [Key]) -> impl Iterator<Item = (usize, &'k [Key])> {
        let draw_of = |key: &Key| self.prepared.draw_of(key.triangle);
        keys.chunk_by(move |a, b| draw_of(a) == draw_of(b)).map(move |keys| (draw_of(&keys[0]), keys))
    }

    /// Stage 2: interpolates vertices and reads textures for at most [`BATCH`] keys of one draw. Returns where their
    /// shadow rays leave from.
    pub fn gather(
        &self,
        tile: &Tile,
        sample: usize,
        draw: usize,
        keys: &[Key],
        batch: &mut Batch,
    ) -> [Vec3; BATCH] {
        let [sx, sy] = self.viewport.pattern.offsets()[sample].map(|o| f64::from(o) / 256.0);
        let at = |key: &Key| {
            let (x, y) = (key.pixel % TILE_SIZE, key.pixel / TILE_SIZE);
            [f64::from(tile.x + x) + sx, f64::from(tile.y + y) + sy]
        };
        Gather::new(self, draw).fill(keys, at, batch)
    }

    /// Stages 3 to 5: shading normals, shadows, lighting.
    pub fn light(&self, draw: usize, origins: &[Vec3; BATCH], batch: &mut Batch) {
        let draw = &self.prepared.draws[draw];
        let settings = &self.settings;
        complete(self.level, settings, draw, batch);
        if let Some(environment) = &self.environment {
            surround::look_up(environment, settings.shading, draw, batch);
        }
        if settings.shadows {
            trace_shadows(self.prepared, &self.sources, origins, batch);
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
            let coverage = match alpha {
                AlphaMode::Opaque => 1.0,
                AlphaMode::Mask(cutoff) => f32::from(u8::from(batch.alpha[i] >= cutoff)),
                AlphaMode::Blend => batch.alpha[i].clamp(0.0, 1.0),
            };
            shaded.push(Shaded { key: *key, radiance: get3(&batch.radiance, i), coverage });
        }
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

    /// Keeps what is nearest so far and at least half there.
    fn note_aovs(&mut self, shaded: &[Shaded], batch: &Batch, view: &View) {
        let [normals, depth, albedo, uv, triangle] = &mut self.picture.aovs;
        if normals.is_empty() {
            return;
        }
        for (i, fragment) in shaded.iter().enumerate().filter(|(_, f)| f.coverage >= 0.5) {
            let pixel = fragment.key.pixel as usize;
            let distance = view.depth(get3(&batch.position, i));
            if depth[pixel][3] != 0.0 && depth[pixel][0] <= distance {
                continue;
            }
            let with_one = |v: Vec3| [v.x, v.y, v.z, 1.0];
            normals[pixel] = with_one(get3(&batch.n, i));
            depth[pixel] = [distance, distance, distance, 1.0];
            albedo[pixel] = with_one(get3(&batch.albedo, i));
            uv[pixel] = [batch.uv[0][i], batch.uv[1][i], 0.0, 1.0];
            let id = fragment.key.triangle as f32;
            triangle[pixel] = [id, id, id, 1.0];
        }
    }
}
