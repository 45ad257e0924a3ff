//! The materials of a surface joined from several meshes: what each of its triangles shows at a point, the alpha mode
//! that shows all of them, and the positions of vertices on their maps.

use super::texture_lookup::{
    LookupPoint, MappedNormal, TextureOnMesh, of_heights, of_object_map, of_tangent_map, premultiplied,
};
use crate::error::Result;
use crate::image::Texture;
use crate::math::{Mat4, Vec2, Vec3};
use crate::mesh::{Mesh, Point, blend, each};
use crate::pixel::{MaterialUniforms, NormalSource, PassedLight};
use crate::scene::{AlphaMode, Instance, Material, SceneData, TextureRef, UvTransform};
use std::borrow::Cow;

/// The values of a material at a point: factors, vertex colours and textures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialSample {
    /// The base colour, linear RGB.
    pub color: Vec3,
    /// The alpha before any cutoff, [0, 1]; 1 if the material is opaque.
    pub alpha: f32,
    /// [0, 1].
    pub metallic: f32,
    /// The perceptual roughness, as artists set it, [0, 1].
    pub roughness: f32,
    /// The open part of the hemisphere from the occlusion texture, [0, 1]; 1 without one.
    pub occlusion: f32,
    /// Emitted radiance, linear RGB.
    pub emission: Vec3,
}

/// The triangles of one instance within the joined mesh.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// The first triangle.
    pub triangle: u32,
    /// The first vertex.
    pub vertex: u32,
    /// The number of uv sets of the original mesh.
    pub uv_sets: usize,
    /// Index of its material.
    pub material: usize,
    pub normal_source: NormalSource,
    /// The transform that was applied to its triangles.
    pub world_from_object: Mat4,
}

impl Part {
    /// Returns the parts that instances become when their triangles are joined in order.
    pub fn of(scene: &SceneData, instances: &[Instance]) -> Vec<Self> {
        let (mut triangle, mut vertex) = (0, 0);
        let mut parts = Vec::with_capacity(instances.len());
        for instance in instances {
            let mesh = &scene.meshes[instance.mesh];
            let uv_sets = mesh.uvs().len();
            let normal_source = NormalSource::best(&scene.materials[instance.material]).on_mesh(uv_sets);
            let Instance { material, world_from_object, .. } = *instance;
            parts.push(Self { triangle, vertex, uv_sets, material, normal_source, world_from_object });
            triangle += mesh.triangles().len() as u32;
            vertex += mesh.positions().len() as u32;
        }
        parts
    }
}

/// The materials of all parts.
#[derive(Debug, Clone)]
pub(super) struct Appearance {
    /// The parts, in the order of their triangles.
    pub parts: Vec<Part>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    /// `true` if a part has a normal or height map.
    bends: bool,
    /// The premultiplied copy of each texture with alpha of which only visible colours are averaged. Empty if all
    /// colours are averaged.
    premultiplied: Vec<Option<Texture>>,
    /// The textures of each material.
    used: Vec<Vec<TextureRef>>,
}

impl Appearance {
    pub fn new(parts: Vec<Part>, materials: Vec<Material>, textures: Vec<Texture>) -> Self {
        let bends = parts.iter().any(|part| part.normal_source != NormalSource::Smooth);
        let used = materials.iter().map(Material::textures).collect();
        Self { parts, materials, textures, bends, premultiplied: Vec::new(), used }
    }

    /// Makes lookups of masked and blended base colours beyond the finest level average visible colours only.
    pub fn with_visible_means(self) -> Result<Self> {
        let mut is_read = vec![false; self.textures.len()];
        let materials = self.parts.iter().map(|part| &self.materials[part.material]);
        let see_through = materials.filter(|material| material.alpha != AlphaMode::Opaque);
        for used in see_through.filter_map(|material| material.base_color_texture.as_ref()) {
            is_read[used.texture] = true;
        }
        let read = self.textures.iter().zip(is_read);
        let of = |(texture, is_read): (&Texture, bool)| {
            (is_read && texture.bitmap().has_alpha()).then(|| premultiplied(texture)).transpose()
        };
        Ok(Self { premultiplied: read.map(of).collect::<Result<_>>()?, ..self })
    }

    /// Repeats [`Self::with_visible_means`] for some textures that were replaced.
    pub fn renew_visible_means(&mut self, textures: &[usize]) -> Result<()> {
        for texture in textures {
            if let Some(Some(known)) = self.premultiplied.get_mut(*texture) {
                *known = premultiplied(&self.textures[*texture])?;
            }
        }
        Ok(())
    }

    /// Returns the material of a triangle.
    pub fn material(&self, triangle: u32) -> &Material {
        &self.materials[self.material_number(triangle)]
    }

    /// Returns the index of a triangle's material.
    pub fn material_number(&self, triangle: u32) -> usize {
        self.part(triangle).material
    }

    /// Returns the number of parts.
    pub fn part_count(&self) -> usize {
        self.parts.len()
    }

    /// Returns the index of a triangle's part.
    pub fn part_number(&self, triangle: u32) -> usize {
        self.parts.partition_point(|part| part.triangle <= triangle) - 1
    }

    /// Returns the factors of the first part's material, used if nothing is found.
    pub fn first_factors(&self) -> MaterialSample {
        let neutral = Material::default();
        let material = self.parts.first().map_or(&neutral, |part| &self.materials[part.material]);
        MaterialSample {
            color: rgb(material.base_color),
            alpha: 1.0,
            metallic: material.metallic,
            roughness: material.roughness,
            occlusion: 1.0,
            emission: Vec3::default(),
        }
    }

    /// Returns the normal at a point as a renderer shades it: `smooth`, the interpolated one, bent by the part's map.
    /// Bit-identical to `smooth` if the part has no map or the uvs span no area.
    pub fn normal(&self, mesh: &Mesh, at: LookupPoint, smooth: Vec3) -> MappedNormal {
        let flat = MappedNormal { normal: smooth, variance: 0.0 };
        if !self.bends {
            return flat;
        }
        let part = self.part(at.point.triangle);
        let bent = match &part.normal_source {
            NormalSource::Facet | NormalSource::Smooth | NormalSource::BumpPrinted(..) => None,
            NormalSource::ObjectMap(map) => {
                Some(of_object_map(&self.texture(mesh, &map.texture), at, &part.world_from_object))
            }
            NormalSource::TangentMap(map) => of_tangent_map(&self.texture(mesh, &map.texture), at, map),
            NormalSource::Bump(map, scale) => {
                of_heights(&self.texture(mesh, &map.texture), at, *scale, smooth)
            }
        };
        bent.unwrap_or(flat)
    }

    /// Returns the values of the material at a point.
    pub fn sample(&self, mesh: &Mesh, at: LookupPoint) -> MaterialSample {
        let material = self.material(at.point.triangle);
        let read = |used: &Option<TextureRef>| {
            used.as_ref().map_or([1.0; 4], |used| self.texture(mesh, used).read(at))
        };
        let base = self.base_texture(mesh, at, material);
        let [_, green, blue, _] = read(&material.metallic_roughness_texture);
        let [open, ..] = read(&material.occlusion_texture);
        MaterialSample {
            color: base_color(mesh, at.point, material).mul_elements(rgb(base)),
            alpha: match material.alpha {
                AlphaMode::Opaque => 1.0,
                _ => (base_alpha(mesh, at.point, material) * base[3]).clamp(0.0, 1.0),
            },
            metallic: material.metallic * blue,
            roughness: material.roughness * green,
            occlusion: 1.0 + material.occlusion_strength * (open - 1.0),
            emission: Vec3::from_array(material.emissive).mul_elements(rgb(read(&material.emissive_texture))),
        }
    }

    /// Returns the share of light from behind that passes through the surface at a point, as [`PassedLight::share`].
    pub fn passed(&self, mesh: &Mesh, at: LookupPoint) -> f32 {
        let material = self.material(at.point.triangle);
        let Some(transmission) = material.transmission.filter(|_| material.transmits()) else { return 0.0 };
        let read = |used: &Option<TextureRef>| {
            used.as_ref().map_or([1.0; 4], |used| self.texture(mesh, used).read(at))
        };
        let MaterialSample { color, metallic, .. } = self.sample(mesh, at);
        let specular = material.specular.factor * read(&material.specular.factor_texture)[3];
        let passed = PassedLight {
            transmission: transmission.factor * read(&transmission.texture)[0],
            metallic,
            base_color: color,
            f0: MaterialUniforms::new(material).dielectric_f0 * specular,
        };
        passed.share()
    }

    /// Returns the width of the finest texel of all textures at a point, in model units; `None` without textures.
    pub fn texel_size(&self, mesh: &Mesh, point: Point) -> Option<f32> {
        let used = &self.used[self.material_number(point.triangle)];
        let widths = used.iter().filter_map(|used| self.texture(mesh, used).texel_size(point));
        widths.reduce(f32::min)
    }

    /// Returns the value of the base colour texture; white without one.
    fn base_texture(&self, mesh: &Mesh, at: LookupPoint, material: &Material) -> [f32; 4] {
        let Some(used) = &material.base_color_texture else { return [1.0; 4] };
        let on_mesh = self.texture(mesh, used);
        match self.premultiplied.get(used.texture) {
            Some(Some(texture)) if material.alpha != AlphaMode::Opaque => on_mesh.read_visible(texture, at),
            _ => on_mesh.read(at),
        }
    }

    fn part(&self, triangle: u32) -> &Part {
        &self.parts[self.part_number(triangle)]
    }

    fn texture<'a>(&'a self, mesh: &'a Mesh, used: &'a TextureRef) -> TextureOnMesh<'a> {
        TextureOnMesh { mesh, texture: &self.textures[used.texture], used }
    }
}

fn rgb([r, g, b, _]: [f32; 4]) -> Vec3 {
    Vec3::new(r, g, b)
}

/// Returns the base colour from material and vertex colours.
fn base_color(mesh: &Mesh, point: Point, material: &Material) -> Vec3 {
    let factor = rgb(material.base_color);
    if mesh.colors().is_empty() { factor } else { factor.mul_elements(point.color(mesh)) }
}

/// Returns the alpha from material and vertex colours.
fn base_alpha(mesh: &Mesh, point: Point, material: &Material) -> f32 {
    let [.., factor] = material.base_color;
    match mesh.colors() {
        [] => factor,
        colors => factor * blend(each(point.vertices(mesh), |v| colors[v][3]), point.weights),
    }
}

/// The cutoff of a material that replaces masks with different cutoffs.
const COMMON_CUTOFF: f32 = 0.5;

/// Returns the alpha mode of one material that shows all of these: blended if any is, else a mask with their common
/// cutoff, or 0.5 if they differ.
pub(super) fn common_mode(modes: impl Iterator<Item = AlphaMode>) -> AlphaMode {
    modes.fold(AlphaMode::Opaque, |common, mode| match (common, mode) {
        (AlphaMode::Blend, _) | (_, AlphaMode::Blend) => AlphaMode::Blend,
        (one, AlphaMode::Opaque) | (AlphaMode::Opaque, one) => one,
        (AlphaMode::Mask(a), AlphaMode::Mask(b)) if a == b => common,
        (AlphaMode::Mask(_), AlphaMode::Mask(_)) => AlphaMode::Mask(COMMON_CUTOFF),
    })
}

/// Returns the alpha that looks the same in another mode: for masks with another cutoff it is remapped piecewise
/// linearly so that contours stay in place; a mask shown as blended becomes 0 or 1.
pub(super) fn under_mode(alpha: f32, own: AlphaMode, shown: AlphaMode) -> f32 {
    match (own, shown) {
        (AlphaMode::Opaque, _) => 1.0,
        (AlphaMode::Blend, _) => alpha,
        (AlphaMode::Mask(own), AlphaMode::Mask(shown)) if own == shown => alpha,
        (AlphaMode::Mask(own), AlphaMode::Mask(_)) if alpha < own => COMMON_CUTOFF * alpha / own,
        (AlphaMode::Mask(own), AlphaMode::Mask(_)) if own < 1.0 => {
            COMMON_CUTOFF + (1.0 - COMMON_CUTOFF) * (alpha - own) / (1.0 - own)
        }
        (AlphaMode::Mask(own), _) => f32::from(u8::from(alpha >= own)),
    }
}

/// Returns the texture whose uv set and transform define where a material's errors are laid out, on a mesh with this
/// number of uv sets: its normal map, else its height map, its base colour, or any other. `None` if the mesh lacks
/// the uv sets of all of them.
pub fn leading_texture(material: &Material, uv_sets: usize) -> Option<TextureRef> {
    let normal = material.normal.map(|map| map.texture);
    let height = material.height.map(|map| map.texture);
    let first = normal.into_iter().chain(height).chain(material.base_color_texture);
    first.chain(material.textures()).find(|texture| texture.uv_set < uv_sets)
}

/// Returns the leading texture of each part.
pub(super) fn leading_textures<'a>(
    parts: &'a [Part],
    materials: &'a [Material],
) -> impl Iterator<Item = Option<TextureRef>> + 'a {
    parts.iter().map(|part| leading_texture(&materials[part.material], part.uv_sets))
}

/// Returns the position of each vertex of all parts on the maps of its material: transformed uvs; the first set's
/// untransformed ones without textures. Empty if no part has uvs.
pub(super) fn map_places<'a>(
    mesh: &'a Mesh,
    parts: &[Part],
    leads: &[Option<TextureRef>],
) -> Cow<'a, [Vec2]> {
    let first = mesh.uvs().first().map_or(&[][..], Vec::as_slice);
    let is_first = |lead: &TextureRef| lead.uv_set == 0 && lead.transform == UvTransform::default();
    if leads.iter().flatten().all(is_first) {
        return first.into();
    }
    let mut places = first.to_vec();
    let ends = parts.iter().skip(1).map(|part| part.vertex as usize).chain([places.len()]);
    for ((part, end), lead) in parts.iter().zip(ends).zip(leads) {
        let Some((lead, uvs)) = lead.and_then(|lead| Some((lead, mesh.uvs().get(lead.uv_set)?))) else {
            continue;
        };
        for v in part.vertex as usize..end {
            places[v] = lead.transform.apply(uvs[v]);
        }
    }
    places.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_material_shows_the_modes_of_all() {
        let common = |modes: &[AlphaMode]| common_mode(modes.iter().copied());
        let (opaque, blend, mask) = (AlphaMode::Opaque, AlphaMode::Blend, AlphaMode::Mask);
        assert_eq!(common(&[]), opaque);
        assert_eq!(common(&[opaque, mask(0.25), opaque]), mask(0.25));
        assert_eq!(common(&[mask(0.25), mask(0.25)]), mask(0.25));
        assert_eq!(common(&[mask(0.25), mask(0.75), mask(0.75)]), mask(0.5));
        assert_eq!(common(&[mask(0.25), blend, opaque]), blend);
    }

    #[test]
    fn contours_stay_where_they_are() {
        let mask = AlphaMode::Mask;
        for own in [0.0, 0.25, 0.5, 0.75, 1.0, 1.5] {
            for alpha in [0.0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0f32] {
                let moved = under_mode(alpha, mask(own), mask(0.5));
                assert_eq!(moved >= 0.5, alpha >= own, "{alpha} at {own} becomes {moved}");
                assert!((0.0..=1.0).contains(&moved));
                let there = under_mode(alpha, mask(own), AlphaMode::Blend);
                assert_eq!(there, f32::from(u8::from(alpha >= own)));
            }
        }
        assert_eq!(under_mode(0.3, mask(0.25), mask(0.25)), 0.3);
        assert_eq!(under_mode(0.3, AlphaMode::Blend, AlphaMode::Blend), 0.3);
        assert_eq!(under_mode(0.3, AlphaMode::Opaque, mask(0.5)), 1.0);
        assert_eq!(under_mode(0.3, AlphaMode::Blend, mask(0.5)), 0.3);
        let shown = [0.3, 0.7].map(|alpha| under_mode(alpha, mask(0.5), AlphaMode::Opaque));
        assert_eq!(shown, [0.0, 1.0], "absent texels contribute no colour");
    }
}
