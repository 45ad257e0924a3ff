//! Computes fragments from interpolated vertices and textures.

use super::batch::{BATCH, Batch, Column, Lanes, Points, TexelColumns, get3, load, store3, texel_columns};
use super::camera::Eye;
use super::interpolate::Interpolation;
use super::lookups::{Coordinates, TextureUse};
use super::tree::SmoothTriangle;
use crate::math::{Aligned, Mask, Pack, Vec3, dispatch_pack, poly};
use crate::pixel::{
    NormalSource, Texel, has_packed_occlusion, height_derivative, height_step, mapped_variance, occluded,
};
use crate::scene::{HeightMap, NormalMap, TextureRef};
use crate::shade::SubPixelVariance;

impl Interpolation<'_> {
    /// Computes fragments of points with known runs and weights: interpolates, and reads textures.
    pub(super) fn fill(&self, eye: Option<Eye>, batch: &mut Batch) {
        self.interpolate(eye, batch);
        batch.texels.lookups.forget();
        self.normal_inputs(batch);
        let fresh = batch.texels.constants_of != Some(self.draw.first_triangle);
        self.read_texels(batch, fresh);
        dispatch_pack!(self.level, P, token => self.finish::<P>(token, batch));
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

    /// Fills in the texture data for the method of the shading normal.
    fn normal_inputs(&self, batch: &mut Batch) {
        let len = batch.len;
        match &self.draw.normal_source {
            NormalSource::Facet | NormalSource::Smooth => {}
            NormalSource::ObjectMap(map) | NormalSource::TangentMap(map) => {
                let TexelColumns { map: [x, y, z], normal_variance, lookups, .. } = &mut batch.texels;
                let at = Coordinates { sets: &batch.points.uv_sets, len };
                lookups.read(self.texture(&map.texture), at, [x, y, z, normal_variance]);
            }
            NormalSource::Bump(map, factor) => {
                [batch.texels.dh_du, batch.texels.dh_dv] = self.height_derivatives(map, batch);
                scale(&mut batch.texels.dh_du, *factor, len);
                scale(&mut batch.texels.dh_dv, *factor, len);
            }
            NormalSource::BumpPrinted(map, _) => {
                // The paper's g: half the difference between the grey levels (0 to 255) of the two neighbours along
                // u.
                let width = self.scene.textures()[map.texture.texture].width() as f32;
                [batch.texels.dh_du, _] = self.height_derivatives(map, batch);
                scale(&mut batch.texels.dh_du, 255.0 / width, len);
            }
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

    /// Reads the texels of the material's values, and multiplies them by their factors. Without a texture, a column
    /// contains the factor; it is filled if `fresh`, or if vertex colours have changed it.
    fn read_texels(&self, batch: &mut Batch, fresh: bool) {
        let (material, len) = (self.draw.material, batch.len);
        let packed = has_packed_occlusion(material);
        let texture = |texel: Texel| texel.role(packed).and_then(|role| role.of(material));
        let at = Coordinates { sets: &batch.points.uv_sets, len };
        let colored = !self.draw.mesh.colors().is_empty();
        let changes = |texel: Texel| colored && matches!(texel, Texel::BaseColor | Texel::Alpha);
        let TexelColumns { lookups, spare, groups, roughness, .. } = &mut batch.texels;
        if !fresh && groups.is_empty() {
            return;
        }
        let mut all = texel_columns(&mut batch.material, &mut batch.layers, roughness);
        if fresh {
            groups.clear();
            for group in all.chunk_by(|a, b| a.0.role(packed) == b.0.role(packed)) {
                let start = groups.last().map_or(0, |[_, end]| *end);
                groups.push([start, start + group.len()]);
            }
        }
        for [start, end] in groups.iter().copied() {
            let group = &mut all[start..end];
            let texture = texture(group[0].0);
            if let Some(texture) = texture {
                let mut channels = spare.each_mut();
                for (texel, columns) in group.iter_mut() {
                    let places = channels[texel.first_channel()..].iter_mut();
                    for (place, column) in places.zip(columns.iter_mut()) {
                        *place = column;
                    }
                }
                lookups.read(self.texture(texture), at, channels);
            }
            for (texel, columns) in group {
                let factors = texel.factor(material).into_iter().flatten();
                for (column, factor) in columns.iter_mut().zip(factors) {
                    match texture {
                        Some(_) if factor != 1.0 => scale(column, factor, len),
                        None if fresh || changes(*texel) => column.fill(factor),
                        _ => {}
                    }
                }
            }
        }
        if fresh {
            // Constants that stay are valid for all batches of the draw.
            groups.retain(|[start, end]| {
                let mut group = all[*start..*end].iter();
                group.any(|(texel, _)| texture(*texel).is_some() || changes(*texel))
            });
        }
    }

    /// Turns texels into values: adds vertex colours, the strength of occlusion and subpixel detail.
    #[inline(always)]
    fn finish<P: Pack>(&self, token: P::Token, batch: &mut Batch) {
        let material = self.draw.material;
        let colored = !self.draw.mesh.colors().is_empty();
        let is_occluded = material.occlusion_texture.is_some() && material.occlusion_strength != 1.0;
        for i in batch.packs::<P>() {
            if colored {
                let at: Lanes<'_, P> = batch.lanes(token, i);
                let [r, g, b, a] = &batch.points.color;
                let color = Vec3::new(at.load(r), at.load(g), at.load(b));
                let tint = at.load3(&batch.material.tint).mul_elements(color);
                let alpha = at.load(&batch.material.alpha) * at.load(a);
                store3(tint, &mut batch.material.tint, i);
                alpha.store(&mut batch.material.alpha[i..]);
            }
            if is_occluded {
                let at: Lanes<'_, P> = batch.lanes(token, i);
                let strength = at.splat(material.occlusion_strength);
                let occlusion = occluded(at.load(&batch.material.occlusion), strength);
                occlusion.store(&mut batch.material.occlusion[i..]);
            }
            self.subpixel_detail::<P>(token, batch, i);
        }
    }

    /// Fills the variance of normals, and widens roughness by it.
    #[inline(always)]
    fn subpixel_detail<P: Pack>(&self, token: P::Token, batch: &mut Batch, i: usize) {
        let map = self.draw.normal_source.normal_map();
        let hidden = self.hidden::<P>(batch.lanes(token, i), map, &batch.texels.normal_variance);
        hidden.variance().store(&mut batch.material.variance[i..]);
        let [roughness, coat_roughness] = &batch.texels.roughness;
        let roughness = load(token, roughness, i);
        let value = if self.takes_roughness { widened_by(token, hidden, roughness) } else { roughness };
        value.store(&mut batch.material.roughness[i..]);
        if let Some(coat) = &self.draw.material.clearcoat {
            let map = coat.normal.as_ref();
            let hidden = self.hidden::<P>(batch.lanes(token, i), map, &batch.layers.coat_variance);
            let roughness = load(token, coat_roughness, i);
            widened_by(token, hidden, roughness).store(&mut batch.layers.coat_roughness[i..]);
        }
    }

    /// The subpixel detail of the surface: its curvature and the `variance` of a normal map.
    #[inline(always)]
    fn hidden<P: Pack>(
        &self,
        at: Lanes<'_, P>,
        map: Option<&NormalMap>,
        variance: &Column,
    ) -> SubPixelVariance<P> {
        let normal_variance = match map {
            Some(map) if self.specular_aa => mapped_variance(at.load(variance), at.splat(map.scale)),
            _ => at.splat(0.0),
        };
        SubPixelVariance { curvature: at.load(&at.batch.geometry.curvature), normal_variance }
    }

    fn texture<'t>(&'t self, texture: &'t TextureRef) -> TextureUse<'t> {
        TextureUse::new(self.level, self.scene, texture)
    }
}

/// Returns the roughness widened by subpixel detail; as it is if no fragment of the pack has any.
#[inline(always)]
fn widened_by<P: Pack>(token: P::Token, hidden: SubPixelVariance<P>, roughness: P) -> P {
    match P::splat(token, 0.0).lt(hidden.variance()).any() {
        true => hidden.widened(roughness),
        false => roughness,
    }
}

fn scale(column: &mut Column, factor: f32, len: usize) {
    column[..len].iter_mut().for_each(|value| *value *= factor);
}
