//! Computes fragments from interpolated vertices and textures.

use super::batch::{BATCH, Batch, Column, Points, TexelColumns, get3, load};
use super::camera::Eye;
use super::interpolate::Interpolation;
use super::lookups::{Coordinates, Lookups, TextureUse};
use super::tree::SmoothTriangle;
use crate::math::{Aligned, Mask, Pack, Vec3, dispatch_pack, poly, scalar};
use crate::pixel::{NormalSource, anisotropy_turn, height_derivative, height_step, occluded};
use crate::scene::{Clearcoat, HeightMap, TextureRef};
use crate::shade::SubPixelVariance;
use fearless_simd::Level;

impl Interpolation<'_> {
    /// Computes fragments of points with known runs and weights: interpolates, and reads textures.
    pub(super) fn fill(&self, eye: Option<Eye>, batch: &mut Batch) {
        self.interpolate(eye, batch);
        batch.texels.lookups.forget();
        self.normal_inputs(batch);
        let fresh = batch.texels.constants_of != Some(self.draw.first_triangle);
        self.colors_and_widths(batch, fresh);
        self.specular(batch, fresh);
        self.layers(batch);
        batch.texels.constants_of = Some(self.draw.first_triangle);
    }

    /// The origins of rays, at the height `offset` above the surface, in model units.
    pub(super) fn origins(&self, offset: f32, batch: &Batch) -> [Vec3; BATCH] {
        let (draw, mut origins) = (self.draw, [Vec3::default(); BATCH]);
        for run in &batch.points.runs {
            let vertices = draw.vertices(run.triangle);
            let corners = vertices.map(|v| draw.positions[v as usize]);
            let normals = vertices.map(|v| draw.normals[v as usize]);
            for (i, origin) in origins.iter_mut().enumerate().take(run.end).skip(run.start) {
                let smooth =
                    SmoothTriangle { corners, normals: normals.map(|n| n * batch.geometry.facing[i]) };
                let weights = get3(&batch.points.weights, i).to_array();
                let offset = get3(&batch.geometry.n_geom, i) * offset;
                *origin = smooth.shadow_origin(get3(&batch.geometry.position, i), weights, offset);
            }
        }
        origins
    }

    /// Fills in the texture data for the method of the shading normal, and the subpixel detail of the surface.
    fn normal_inputs(&self, batch: &mut Batch) {
        let len = batch.len;
        match &self.draw.normal_source {
            NormalSource::Facet | NormalSource::Smooth => batch.texels.normal_variance.fill(0.0),
            NormalSource::ObjectMap(map) | NormalSource::TangentMap(map) => {
                let TexelColumns { map: [x, y, z], normal_variance, lookups, .. } = &mut batch.texels;
                let at = Coordinates { sets: &batch.points.uv_sets, len };
                lookups.read(self.texture(&map.texture), at, [x, y, z, normal_variance]);
                let squared = if self.specular_aa { map.scale * map.scale } else { 0.0 };
                if squared != 1.0 {
                    scale(normal_variance, squared, len);
                }
            }
            NormalSource::Bump(map, factor) => {
                batch.texels.normal_variance.fill(0.0);
                [batch.texels.dh_du, batch.texels.dh_dv] = self.height_derivatives(map, batch);
                scale(&mut batch.texels.dh_du, *factor, len);
                scale(&mut batch.texels.dh_dv, *factor, len);
            }
            NormalSource::BumpPrinted(map, _) => {
                // The paper's g: half the difference between the grey levels (0 to 255) of the two neighbours along
                // u.
                batch.texels.normal_variance.fill(0.0);
                let width = self.scene.textures()[map.texture.texture].width() as f32;
                [batch.texels.dh_du, _] = self.height_derivatives(map, batch);
                scale(&mut batch.texels.dh_du, 255.0 / width, len);
            }
        }
        for i in 0..len {
            batch.material.variance[i] = batch.geometry.curvature[i] + batch.texels.normal_variance[i];
        }
    }

    /// Computes ∂h/∂u and ∂h/∂v by central differences one texel of the current level to each side.
    fn height_derivatives(&self, map: &HeightMap, batch: &mut Batch) -> [Column; 2] {
        let texture = &self.scene.textures()[map.texture.texture];
        let Batch { texels: TexelColumns { lookups, .. }, points: Points { uv_sets, .. }, len, .. } = batch;
        let used = self.texture(&map.texture);
        lookups.locate(used, Coordinates { sets: uv_sets, len: *len });
        let last = (texture.levels() - 1) as f32;
        let texels = Aligned(lookups.lod.map(|lod| poly::exp2(lod.clamp(0.0, last))));
        let size = [texture.width() as f32, texture.height() as f32];
        let mut derivatives = [texels; 2];
        for (axis, derivative) in derivatives.iter_mut().enumerate() {
            let heights = [1.0, -1.0].map(|side| {
                let mut out = [Column::ZERO; 4];
                let shift = |i: usize| {
                    let step = side * height_step(texels[i], size[axis]);
                    if axis == 0 { [step, 0.0] } else { [0.0, step] }
                };
                lookups.read_shifted(used, *len, shift, out.each_mut());
                out[0]
            });
            for i in 0..*len {
                let step = height_step(texels[i], size[axis]);
                derivative[i] = height_derivative(heights[0][i], heights[1][i], step);
            }
        }
        derivatives
    }

    /// Fills base colour, opacity, roughness, metalness, occlusion and emission.
    fn colors_and_widths(&self, batch: &mut Batch, fresh: bool) {
        let (material, len) = (self.draw.material, batch.len);
        let colored = !self.draw.mesh.colors().is_empty();
        let TexelColumns { lookups, spare: [spare, spare2, spare3], .. } = &mut batch.texels;
        let mut reader = TextureReader {
            interpolation: self,
            lookups,
            at: Coordinates { sets: &batch.points.uv_sets, len },
            fresh: fresh || colored,
        };
        let [r, g, b] = &mut batch.material.tint;
        let factors = [1.0, 1.0, 1.0, material.base_color[3]];
        reader.read(&material.base_color_texture, [r, g, b, &mut batch.material.alpha], factors);
        reader.fresh = fresh;
        let ([r, g, b], [red, green, blue]) = (&mut batch.material.emissive, material.emissive);
        reader.read(&material.emissive_texture, [r, g, b, spare], [red, green, blue, 1.0]);
        let packed = [
            &mut batch.material.occlusion,
            &mut batch.material.roughness,
            &mut batch.material.metallic,
            spare,
        ];
        let factors = [1.0, material.roughness, material.metallic, 1.0];
        reader.read(&material.metallic_roughness_texture, packed, factors);
        if material.metallic_roughness_texture.is_none() {
            // Widened by subpixel detail.
            batch.material.roughness.fill(material.roughness);
        }
        // Files often pack occlusion into the red channel of the same texture.
        if material.occlusion_texture != material.metallic_roughness_texture {
            reader.fresh = true;
            reader.read(
                &material.occlusion_texture,
                [&mut batch.material.occlusion, spare, spare2, spare3],
                [1.0; 4],
            );
        }
        if colored {
            for (column, color) in
                batch.material.tint.iter_mut().chain([&mut batch.material.alpha]).zip(&batch.points.color)
            {
                multiply(column, color, len);
            }
        }
        if material.occlusion_texture.is_some() && material.occlusion_strength != 1.0 {
            for occlusion in &mut batch.material.occlusion[..len] {
                *occlusion = occluded(*occlusion, material.occlusion_strength);
            }
        }
        let roughness = &mut batch.material.roughness;
        let (curvature, normal_variance) = (&batch.geometry.curvature, &batch.texels.normal_variance);
        if self.takes_roughness {
            Unseen { curvature, normal_variance, len }.widen(self.level, roughness);
        }
    }

    /// Fills strength and colour of a dielectric's reflection.
    fn specular(&self, batch: &mut Batch, fresh: bool) {
        let (specular, len) = (&self.draw.material.specular, batch.len);
        let TexelColumns { lookups, spare: [spare, spare2, spare3], .. } = &mut batch.texels;
        let mut reader = TextureReader {
            interpolation: self,
            lookups,
            at: Coordinates { sets: &batch.points.uv_sets, len },
            fresh,
        };
        let factors = [1.0, 1.0, 1.0, specular.factor];
        reader.read(&specular.factor_texture, [spare, spare2, spare3, &mut batch.material.specular], factors);
        let ([r, g, b], [red, green, blue]) = (&mut batch.material.specular_color, specular.color);
        reader.read(&specular.color_texture, [r, g, b, spare], [red, green, blue, 1.0]);
    }

    fn layers(&self, batch: &mut Batch) {
        let (material, len) = (self.draw.material, batch.len);
        if let Some(coat) = &material.clearcoat {
            self.coat(coat, batch);
        }
        let TexelColumns { lookups, spare: [spare, spare2, spare3], .. } = &mut batch.texels;
        let layers = &mut batch.layers;
        let mut reader = TextureReader {
            interpolation: self,
            lookups,
            at: Coordinates { sets: &batch.points.uv_sets, len },
            fresh: true,
        };
        if let Some(sheen) = &material.sheen {
            let ([r, g, b], [red, green, blue]) = (&mut layers.sheen_color, sheen.color);
            reader.read(&sheen.color_texture, [r, g, b, spare], [red, green, blue, 1.0]);
            let (roughness, factors) = (&mut layers.sheen_roughness, [1.0, 1.0, 1.0, sheen.roughness]);
            reader.read(&sheen.roughness_texture, [spare, spare2, spare3, roughness], factors);
        }
        if let Some(anisotropy) = &material.anisotropy {
            // At the 32-bit precision of files.
            let angle = f64::from(anisotropy.rotation as f32);
            let (sin, cos) = (scalar::sin(angle) as f32, scalar::cos(angle) as f32);
            let has_texture = anisotropy.texture.is_some();
            let factors = [1.0, 1.0, anisotropy.strength, 1.0];
            reader.read(&anisotropy.texture, [spare, spare2, &mut layers.anisotropy, spare3], factors);
            for i in 0..len {
                let turn =
                    if has_texture { anisotropy_turn([cos, sin], [spare[i], spare2[i]]) } else { [cos, sin] };
                for (column, value) in layers.anisotropy_turn.iter_mut().zip(turn) {
                    column[i] = value;
                }
            }
        }
    }

    fn texture<'t>(&'t self, texture: &'t TextureRef) -> TextureUse<'t> {
        TextureUse::new(self.level, self.scene, texture)
    }

    fn coat(&self, coat: &Clearcoat, batch: &mut Batch) {
        let len = batch.len;
        let TexelColumns { lookups, spare: [spare, spare2, spare3], .. } = &mut batch.texels;
        let (layers, curvature) = (&mut batch.layers, &batch.geometry.curvature);
        let mut reader = TextureReader {
            interpolation: self,
            lookups,
            at: Coordinates { sets: &batch.points.uv_sets, len },
            fresh: true,
        };
        let factors = [coat.factor, 1.0, 1.0, 1.0];
        reader.read(&coat.factor_texture, [&mut layers.coat, spare, spare2, spare3], factors);
        let factors = [1.0, coat.roughness, 1.0, 1.0];
        reader.read(&coat.roughness_texture, [spare, &mut layers.coat_roughness, spare2, spare3], factors);
        let mut normal_variance = Column::ZERO;
        if let Some(map) = &coat.normal {
            let [x, y, z] = &mut layers.coat_map;
            let squared = if self.specular_aa { map.scale * map.scale } else { 0.0 };
            reader.read(&Some(map.texture), [x, y, z, &mut normal_variance], [1.0, 1.0, 1.0, squared]);
        }
        let roughness = &mut layers.coat_roughness;
        Unseen { curvature, normal_variance: &normal_variance, len }.widen(self.level, roughness);
    }
}

/// Reads the textures of a batch.
struct TextureReader<'b, 'i> {
    interpolation: &'i Interpolation<'i>,
    lookups: &'b mut Lookups,
    at: Coordinates<'b>,
    /// `true` if columns without textures may contain values other than their factors.
    fresh: bool,
}

impl TextureReader<'_, '_> {
    /// A texture's linear values times `factors`; a missing texture is white.
    fn read(&mut self, texture: &Option<TextureRef>, mut out: [&mut Column; 4], factors: [f32; 4]) {
        match texture {
            Some(texture) => {
                let used = self.interpolation.texture(texture);
                self.lookups.read(used, self.at, out.each_mut().map(|column| &mut **column));
                for (column, factor) in out.into_iter().zip(factors).filter(|(_, factor)| *factor != 1.0) {
                    scale(column, factor, self.at.len);
                }
            }
            None if self.fresh => {
                for (column, factor) in out.into_iter().zip(factors) {
                    column.fill(factor);
                }
            }
            None => {}
        }
    }
}

/// The subpixel detail of the first `len` fragments: the variance of the curvature of their surface and of its normal
/// map.
struct Unseen<'b> {
    curvature: &'b Column,
    normal_variance: &'b Column,
    len: usize,
}

impl Unseen<'_> {
    /// Widens roughness by subpixel detail.
    fn widen(&self, level: Level, roughness: &mut Column) {
        dispatch_pack!(level, P, token => self.widen_packs::<P>(token, roughness));
    }

    #[inline(always)]
    fn widen_packs<P: Pack>(&self, token: P::Token, roughness: &mut Column) {
        let zero = P::splat(token, 0.0);
        for i in (0..self.len).step_by(P::LANES) {
            let curvature = load(token, self.curvature, i);
            let normal_variance = load(token, self.normal_variance, i);
            let hidden: SubPixelVariance<P> = SubPixelVariance { curvature, normal_variance };
            if zero.lt(hidden.variance()).any() {
                hidden.widened(load(token, roughness, i)).store(&mut roughness[i..]);
            }
        }
    }
}

fn scale(column: &mut Column, factor: f32, len: usize) {
    column[..len].iter_mut().for_each(|value| *value *= factor);
}

fn multiply(column: &mut Column, values: &Column, len: usize) {
    for (out, value) in column[..len].iter_mut().zip(values.iter()) {
        *out *= value;
    }
}
