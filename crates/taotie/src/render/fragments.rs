//! From hits to fragments: which points of which triangles, and what textures say there.

use super::batch::{BATCH, Batch, Run, get3, load};
use super::interpolate::{Interpolation, Screen};
use super::pass::Pass;
use super::prepare::NormalSource;
use super::shadows::shadow_origin;
use super::view::Eye;
use crate::math::{Column, Pack, Vec3, dispatch_pack, poly, scalar};
use crate::raster::{TILE_SIZE, Tile};
use crate::scene::{HeightMap, Material, TextureRef};
use crate::shade::Hidden;

/// A triangle seen at a sample of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// `y · TILE_SIZE + x` in the tile.
    pub pixel: u32,
    /// The triangle's number over all draws.
    pub triangle: u32,
    /// Reversed depth.
    pub depth: f32,
}

/// Fills `batch` with the fragments of one draw that `keys` name, at most [`BATCH`].
pub(super) fn gather(
    pass: &Pass<'_, '_>,
    (tile, sample): (&Tile, usize),
    draw: usize,
    keys: &[Key],
    batch: &mut Batch,
) {
    let offset = pass.viewport.pattern.offsets()[sample].map(|o| o as f32 / 256.0);
    batch.len = keys.len();
    batch.runs.clear();
    for (i, key) in keys.iter().enumerate() {
        batch.place[0][i] = (key.pixel % TILE_SIZE) as f32 + offset[0];
        batch.place[1][i] = (key.pixel / TILE_SIZE) as f32 + offset[1];
        match batch.runs.last_mut() {
            Some(run) if run.triangle == key.triangle => run.end = i + 1,
            _ => batch.runs.push(Run { triangle: key.triangle, start: i, end: i + 1 }),
        }
    }
    let interpolation = pass.interpolation(draw);
    let screen = Screen {
        viewport: &pass.viewport,
        clip: &pass.clip[draw],
        origin: [f64::from(tile.x), f64::from(tile.y)],
    };
    interpolation.weigh(&screen, batch);
    interpolation.fill(Some(pass.view.eye), batch);
}

impl Interpolation<'_, '_> {
    /// Makes fragments of points whose runs and weights are there: interpolates, and reads textures.
    pub(super) fn fill(&self, eye: Option<Eye>, batch: &mut Batch) {
        self.interpolate(eye, batch);
        batch.lookups.forget();
        self.normal_inputs(batch);
        self.colors_and_widths(batch);
        self.specular(batch);
        self.layers(batch);
    }

    /// Where rays leave from, `lift` above the surface, model units.
    pub(super) fn origins(&self, lift: f32, batch: &Batch) -> [Vec3; BATCH] {
        let (draw, mut origins) = (self.draw, [Vec3::default(); BATCH]);
        for run in &batch.runs {
            let vertices = draw.mesh.triangles()[(run.triangle - draw.first_triangle) as usize];
            let corners = vertices.map(|v| draw.positions[v as usize]);
            let normals = vertices.map(|v| draw.normals[v as usize]);
            for (i, origin) in origins.iter_mut().enumerate().take(run.end).skip(run.start) {
                let normals = normals.map(|n| n * batch.facing[i]);
                let weights = get3(&batch.weights, i).to_array();
                let lift = get3(&batch.n_geom, i) * lift;
                *origin = shadow_origin(get3(&batch.position, i), corners, normals, weights, lift);
            }
        }
        origins
    }

    /// What the method of the shading normal needs from textures, and what of the surface is too fine for the pixel.
    fn normal_inputs(&self, batch: &mut Batch) {
        batch.relief[..batch.len].fill(0.0);
        match self.draw.normal_source {
            NormalSource::Facet | NormalSource::Smooth => {}
            NormalSource::ObjectMap(map) | NormalSource::TangentMap(map) => {
                let [r, g, b, variance] = self.read(&map.texture, batch);
                batch.map = [r, g, b];
                if self.specular_aa {
                    scale_into(&mut batch.relief, &variance, map.scale * map.scale, batch.len);
                }
            }
            NormalSource::Bump(map, scale) => {
                let [du, dv] = self.height_derivatives(map, batch);
                scale_into(&mut batch.dh_du, &du, scale, batch.len);
                scale_into(&mut batch.dh_dv, &dv, scale, batch.len);
            }
            NormalSource::BumpPrinted(map, _) => {
                // The paper's g: half the difference of the grey levels (0 to 255) of the two neighbours along u.
                let width = self.scene.textures[map.texture.texture].width() as f32;
                let [du, _] = self.height_derivatives(map, batch);
                scale_into(&mut batch.dh_du, &du, 255.0 / width, batch.len);
            }
        }
        for i in 0..batch.len {
            batch.variance[i] = batch.bend[i] + batch.relief[i];
        }
    }

    /// ∂h/∂u and ∂h/∂v by central differences one texel of the level in use to each side.
    fn height_derivatives(&self, map: &HeightMap, batch: &mut Batch) -> [Column; 2] {
        let texture = &self.scene.textures[map.texture.texture];
        let Batch { lookups, uv_sets, len, .. } = batch;
        lookups.locate(self.level, texture, &map.texture, (uv_sets, *len));
        let last = (texture.levels() - 1) as f32;
        let texels = lookups.lod.map(|lod| poly::exp2(lod.clamp(0.0, last)));
        let size = [texture.width() as f32, texture.height() as f32];
        let mut derivatives = [texels; 2];
        for (axis, derivative) in derivatives.iter_mut().enumerate() {
            let heights = [1.0, -1.0].map(|side| {
                let mut out = [[0.0; crate::math::COLUMN]; 4];
                let shift = |i: usize| {
                    let step = side * texels[i] / size[axis];
                    if axis == 0 { [step, 0.0] } else { [0.0, step] }
                };
                lookups.read_shifted(self.level, (self.scene, &map.texture), *len, shift, &mut out);
                out[0]
            });
            for i in 0..*len {
                derivative[i] = (heights[0][i] - heights[1][i]) / (2.0 * (texels[i] / size[axis]));
            }
        }
        derivatives
    }

    /// Base colour, opacity, roughness, metalness, occlusion and emission.
    fn colors_and_widths(&self, batch: &mut Batch) {
        let material = self.draw.material;
        let [r, g, b, mut a] = self.read_or_white(&material.base_color_texture, batch);
        batch.tint = [r, g, b];
        if !self.draw.mesh.colors().is_empty() {
            for (channel, column) in batch.tint.iter_mut().chain([&mut a]).enumerate() {
                multiply(column, &batch.color[channel], batch.len);
            }
        }
        scale_into(&mut batch.alpha, &a, material.base_color[3], batch.len);
        let packed = self.read_or_white(&material.metallic_roughness_texture, batch);
        scale_into(&mut batch.roughness, &packed[1], material.roughness, batch.len);
        scale_into(&mut batch.metallic, &packed[2], material.metallic, batch.len);
        let Batch { roughness, bend, relief, len, .. } = batch;
        dispatch_pack!(self.level, P, token => widen::<P>(token, roughness, [bend, relief], *len));
        // Files often pack occlusion into the red channel of the same texture.
        let occlusion = match material.occlusion_texture == material.metallic_roughness_texture {
            true => packed[0],
            false => self.read_or_white(&material.occlusion_texture, batch)[0],
        };
        for i in 0..batch.len {
            batch.occlusion[i] = 1.0 + material.occlusion_strength * (occlusion[i] - 1.0);
        }
        let [r, g, b, _] = self.read_or_white(&material.emissive_texture, batch);
        batch.emissive = tinted(material.emissive, [r, g, b], batch.len);
    }

    /// Strength and colour of a dielectric's reflection.
    fn specular(&self, batch: &mut Batch) {
        let specular = &self.draw.material.specular;
        let [.., a] = self.read_or_white(&specular.factor_texture, batch);
        scale_into(&mut batch.specular, &a, specular.factor, batch.len);
        let [r, g, b, _] = self.read_or_white(&specular.color_texture, batch);
        batch.specular_color = tinted(specular.color, [r, g, b], batch.len);
    }

    fn layers(&self, batch: &mut Batch) {
        let material = self.draw.material;
        self.coat(material, batch);
        if let Some(sheen) = &material.sheen {
            let [r, g, b, _] = self.read_or_white(&sheen.color_texture, batch);
            batch.layers.sheen_color = tinted(sheen.color, [r, g, b], batch.len);
            let [.., a] = self.read_or_white(&sheen.roughness_texture, batch);
            scale_into(&mut batch.layers.sheen_roughness, &a, sheen.roughness, batch.len);
        }
        if let Some(anisotropy) = &material.anisotropy {
            let angle = f64::from(anisotropy.rotation);
            let (sin, cos) = (scalar::sin(angle) as f32, scalar::cos(angle) as f32);
            let texels = anisotropy.texture.as_ref().map(|texture| self.read(texture, batch));
            let layers = &mut batch.layers;
            for i in 0..batch.len {
                let [x, y, strength] = texels
                    .as_ref()
                    .map_or([1.0, 0.0, 1.0], |[r, g, b, _]| [2.0 * r[i] - 1.0, 2.0 * g[i] - 1.0, b[i]]);
                layers.stretch[i] = anisotropy.strength * strength;
                layers.stretch_turn[0][i] = cos * x - sin * y;
                layers.stretch_turn[1][i] = sin * x + cos * y;
            }
        }
    }

    fn coat(&self, material: &Material, batch: &mut Batch) {
        let Some(coat) = &material.clearcoat else { return };
        let [factor, ..] = self.read_or_white(&coat.factor_texture, batch);
        scale_into(&mut batch.layers.coat, &factor, coat.factor, batch.len);
        let mut relief = [0.0; crate::math::COLUMN];
        if let Some(map) = &coat.normal {
            let [r, g, b, variance] = self.read(&map.texture, batch);
            batch.layers.coat_map = [r, g, b];
            if self.specular_aa {
                scale_into(&mut relief, &variance, map.scale * map.scale, batch.len);
            }
        }
        let [_, roughness, ..] = self.read_or_white(&coat.roughness_texture, batch);
        scale_into(&mut batch.layers.coat_roughness, &roughness, coat.roughness, batch.len);
        let Batch { layers, bend, len, .. } = batch;
        let roughness = &mut layers.coat_roughness;
        dispatch_pack!(self.level, P, token => widen::<P>(token, roughness, [bend, &relief], *len));
    }

    fn read(&self, texture: &TextureRef, batch: &mut Batch) -> [Column; 4] {
        let mut out = [[1.0; crate::math::COLUMN]; 4];
        let Batch { lookups, uv_sets, len, .. } = batch;
        lookups.read(self.level, (self.scene, texture), (uv_sets, *len), &mut out);
        out
    }

    /// A texture's linear values; white where there is none.
    fn read_or_white(&self, texture: &Option<TextureRef>, batch: &mut Batch) -> [Column; 4] {
        match texture {
            Some(texture) => self.read(texture, batch),
            None => [[1.0; crate::math::COLUMN]; 4],
        }
    }
}

/// Widens roughness by what bend and relief hide within a pixel.
#[inline(always)]
fn widen<P: Pack>(token: P::Token, roughness: &mut Column, [bend, relief]: [&Column; 2], len: usize) {
    let zero = P::splat(token, 0.0);
    for i in (0..len).step_by(P::LANES) {
        let hidden: Hidden<P> = Hidden { bend: load(token, bend, i), relief: load(token, relief, i) };
        if crate::math::Mask::any(zero.lt(hidden.variance())) {
            hidden.widened(load(token, roughness, i)).store(&mut roughness[i..]);
        }
    }
}

fn scale_into(column: &mut Column, values: &Column, factor: f32, len: usize) {
    for (out, value) in column[..len].iter_mut().zip(values) {
        *out = factor * value;
    }
}

fn multiply(column: &mut Column, values: &Column, len: usize) {
    for (out, value) in column[..len].iter_mut().zip(values) {
        *out *= value;
    }
}

fn tinted(color: [f32; 3], mut texels: [Column; 3], len: usize) -> [Column; 3] {
    for (column, factor) in texels.iter_mut().zip(color) {
        column[..len].iter_mut().for_each(|value| *value *= factor);
    }
    texels
}
