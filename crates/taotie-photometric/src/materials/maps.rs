//! The maps of a material, and the model with them.

use super::estimate::{MaterialEstimate, MaterialsEstimate, TexelEstimate};
use super::model::Model;
use super::reflection::{METALLIC, ROUGHNESS, VARIABLES};
use std::collections::{BTreeMap, BTreeSet};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::image::{Bitmap, Encoding, Image, Sampler, Texels, Texture};
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    AlphaMode, Classic, Instance, LAYERS, Layer, Material, Scene, Specular, TextureRef, UvTransform,
};

/// The maps of one material, row by row from the top. Texels that no photograph shows have the values of those around them.
pub struct MaterialMaps {
    /// Texels along a side.
    pub side: u32,
    /// Base colour in sRGB; alpha is the model's.
    pub base_color: Vec<[u8; 4]>,
    /// Roughness × 255.
    pub roughness: Vec<u8>,
    /// Metallic × 255.
    pub metallic: Vec<u8>,
    /// 255 where a photograph shows the texel lit.
    pub mask: Vec<u8>,
    /// Standard deviations of the base colour, linear RGB; the fourth channel is 1 where a photograph shows the texel.
    pub base_color_sigma: Image,
    /// Those of roughness and metallic, and the number of photographs.
    pub sigma: Image,
    /// Texels of the model that no photograph shows lit.
    pub unseen: usize,
}

impl MaterialEstimate {
    /// Returns the maps.
    ///
    /// # Errors
    /// Those of [`Image::from_pixels`], none of which can occur.
    pub fn maps(&self) -> Result<MaterialMaps> {
        let side = self.layout.side as usize;
        let mut known: Vec<Option<[f32; VARIABLES]>> = vec![None; side * side];
        let mut alpha = vec![1.0_f32; side * side];
        let mut sigmas = [vec![[0.0_f32; 4]; side * side], vec![[0.0; 4]; side * side]];
        for (texel, TexelEstimate { values, sigma, samples }) in self.layout.texels.iter().zip(&self.texels) {
            let i = texel.index as usize;
            alpha[i] = texel.alpha as f32;
            if *samples > 0 {
                known[i] = Some(*values);
                let [r, g, b, roughness, metallic] = *sigma;
                sigmas[0][i] = [r, g, b, 1.0];
                sigmas[1][i] = [roughness, metallic, *samples as f32, 1.0];
            }
        }
        let mask = known.iter().map(|known| if known.is_some() { 255 } else { 0 }).collect();
        let filled = filled(known, side);
        let code = |v: f32| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        let srgb = |v: f32| code(srgb_from_linear(f64::from(v.clamp(0.0, 1.0))) as f32);
        let color = |(values, alpha): (&[f32; VARIABLES], &f32)| {
            [srgb(values[0]), srgb(values[1]), srgb(values[2]), code(*alpha)]
        };
        let channel = |variable: usize| filled.iter().map(|values| code(values[variable])).collect();
        let [base_color_sigma, sigma] =
            sigmas.map(|pixels| Image::from_pixels(side as u32, side as u32, pixels));
        Ok(MaterialMaps {
            side: side as u32,
            base_color: filled.iter().zip(&alpha).map(color).collect(),
            roughness: channel(ROUGHNESS),
            metallic: channel(METALLIC),
            mask,
            base_color_sigma: base_color_sigma?,
            sigma: sigma?,
            unseen: self.texels.iter().filter(|texel| texel.samples == 0).count(),
        })
    }

    /// Returns the mean of a number over all texels that a photograph shows lit; NaN without any.
    pub fn mean(&self, value: impl Fn(&TexelEstimate) -> f32) -> f64 {
        let seen = self.texels.iter().filter(|texel| texel.samples > 0);
        let (sum, count) = seen.fold((0.0, 0.0), |(sum, n), texel| (sum + f64::from(value(texel)), n + 1.0));
        sum / count
    }

    /// Returns the number of texels whose base colour is above 1, so that the map clips it.
    pub fn clipped(&self) -> usize {
        let is_above = |texel: &&TexelEstimate| texel.values[..3].iter().any(|v| *v > 1.0);
        self.texels.iter().filter(is_above).count()
    }

    /// Returns the standard deviation of a texel's base colour: the root mean square over the channels.
    pub fn color_sigma(texel: &TexelEstimate) -> f32 {
        (texel.sigma[..3].iter().map(|v| v * v).sum::<f32>() / 3.0).sqrt()
    }

    /// Returns that of its roughness.
    pub fn roughness_sigma(texel: &TexelEstimate) -> f32 {
        texel.sigma[ROUGHNESS]
    }

    /// Returns its roughness.
    pub fn roughness(texel: &TexelEstimate) -> f32 {
        texel.values[ROUGHNESS]
    }

    /// Returns its metallic.
    pub fn metallic(texel: &TexelEstimate) -> f32 {
        texel.values[METALLIC]
    }
}

/// Gives unknown texels the mean of the known ones in the smallest square of 2ⁿ texels around them, aligned like mip levels
/// (Gortler et al. 1996, "The lumigraph", §3.4, with boxes as filters).
fn filled(known: Vec<Option<[f32; VARIABLES]>>, side: usize) -> Vec<[f32; VARIABLES]> {
    let mut levels = vec![(known, side)];
    while let Some((finer, side)) = levels.last().filter(|(_, side)| *side > 1) {
        let half = side.div_ceil(2);
        let of = |i: usize| {
            let (x, y) = (2 * (i % half), 2 * (i / half));
            let children = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
            let inside = children.into_iter().filter(|(x, y)| x < side && y < side);
            mean(inside.filter_map(|(x, y)| finer[y * side + x]))
        };
        let coarser = (0..half * half).map(of).collect();
        levels.push((coarser, half));
    }
    for k in (1..levels.len()).rev() {
        let (finer, coarser) = levels.split_at_mut(k);
        let ((finer, side), (coarser, half)) = (&mut finer[k - 1], &coarser[0]);
        for (i, texel) in finer.iter_mut().enumerate() {
            *texel = texel.or(coarser[i / *side / 2 * half + i % *side / 2]);
        }
    }
    let (finest, _) = levels.swap_remove(0);
    finest.into_iter().map(Option::unwrap_or_default).collect()
}

fn mean(values: impl Iterator<Item = [f32; VARIABLES]>) -> Option<[f32; VARIABLES]> {
    let add = |(sum, count): ([f32; VARIABLES], f32), v: [f32; VARIABLES]| {
        (std::array::from_fn(|i| sum[i] + v[i]), count + 1.0)
    };
    let (sum, count) = values.fold(([0.0; VARIABLES], 0.0), add);
    (count > 0.0).then(|| sum.map(|v| v / count))
}

impl MaterialsEstimate {
    /// Returns the model with the estimated materials. Normal maps and occlusion are kept.
    ///
    /// # Errors
    /// Those of [`Scene::new`], none of which can occur.
    pub fn scene(&self, model: &Model, maps: &[MaterialMaps], warnings: &mut Warnings) -> Result<Scene> {
        let mut scene = model.scene.clone();
        for (of, maps) in self.materials.iter().zip(maps) {
            let colors = Bitmap::new(maps.side, maps.side, 4, Texels::U8(maps.base_color.clone()))?;
            let texel = |(roughness, metallic): (&u8, &u8)| [255, *roughness, *metallic, 255];
            let others = maps.roughness.iter().zip(&maps.metallic).map(texel).collect();
            let others = Bitmap::new(maps.side, maps.side, 3, Texels::U8(others))?;
            let colors = scene.add_texture(Texture::new(colors, Encoding::Srgb));
            let others = scene.add_texture(Texture::new(others, Encoding::Linear));
            let used = of.layout.used.unwrap_or(TextureRef {
                texture: colors,
                uv_set: 0,
                sampler: Sampler::default(),
                transform: UvTransform::default(),
            });
            let index = of.layout.material;
            let [colors, others] = [colors, others].map(|texture| TextureRef { texture, ..used });
            let material = measured(model.material(index), [colors, others], warnings);
            scene.edit(|data| data.materials[index] = material)?;
        }
        let measured = self.materials.iter().map(|of| of.layout.material).collect();
        without_colors(scene, &measured, warnings)
    }
}

/// Removes the vertex colours of what has a measured material: they are part of the measured base colour.
fn without_colors(scene: Scene, measured: &BTreeSet<usize>, warnings: &mut Warnings) -> Result<Scene> {
    let mut data = scene.into_data();
    let others = data.instances.iter().filter(|instance| !measured.contains(&instance.material));
    let kept: BTreeSet<usize> = others.map(|instance| instance.mesh).collect();
    let mut plain = BTreeMap::new();
    for i in 0..data.instances.len() {
        let Instance { mesh, material, .. } = data.instances[i];
        if !measured.contains(&material) || data.meshes[mesh].colors().is_empty() {
            continue;
        }
        let own = data.meshes[mesh].clone().into_data();
        let own = Mesh::new(MeshData { colors: Vec::new(), ..own })?;
        let place = if kept.contains(&mesh) { *plain.entry(mesh).or_insert(data.meshes.len()) } else { mesh };
        match data.meshes.get_mut(place) {
            Some(known) => *known = own,
            None => data.meshes.push(own),
        }
        data.instances[i].mesh = place;
        warnings.note("vertex colours are part of the measured base colour, and removed", 1);
    }
    Scene::new(data)
}

/// The layer whose factors are part of the fit.
const SPECULAR: &str = "KHR_materials_specular";

/// Returns a material with other textures, without the layers that were not measured.
fn measured(old: &Material, [colors, others]: [TextureRef; 2], warnings: &mut Warnings) -> Material {
    // Of a specular strength, the factors are known and kept.
    let is_kept = |layer: &Layer| {
        layer.extension == SPECULAR && layer.textures.iter().all(|role| role.of(old).is_none())
    };
    for layer in LAYERS.iter().filter(|layer| (layer.is_visible)(old) && !is_kept(layer)) {
        warnings.note(format!("a material's {} is not measured, and removed", layer.name), 1);
    }
    let opaque = old.alpha == AlphaMode::Opaque;
    Material {
        name: old.name.clone(),
        base_color: [1.0; 4],
        base_color_texture: Some(colors),
        metallic: 1.0,
        roughness: 1.0,
        metallic_roughness_texture: Some(others),
        ior: old.ior,
        specular: Specular { factor_texture: None, color_texture: None, ..old.specular },
        normal: old.normal,
        height: old.height,
        occlusion_texture: old.occlusion_texture,
        occlusion_strength: old.occlusion_strength,
        alpha: if opaque { AlphaMode::Opaque } else { old.alpha },
        double_sided: old.double_sided,
        classic: Classic::default(),
        ..Material::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_texels_take_the_mean_of_the_nearest_square() {
        let mut known = vec![None; 25];
        known[0] = Some([1.0; VARIABLES]);
        known[6] = Some([3.0; VARIABLES]);
        known[24] = Some([9.0; VARIABLES]);
        let filled = filled(known, 5);
        assert_eq!([filled[0][0], filled[1][0], filled[24][0]], [1.0, 2.0, 9.0]);
        assert!((filled[3][0] - 2.0).abs() < 1e-6, "{:?}", filled[3]);
        assert!(filled.iter().all(|v| v[0] >= 1.0));
    }
}
