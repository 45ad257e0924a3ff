//! The materials of a surface joined from several meshes: what each of its triangles shows at a point.

use super::mapped_normal::{MappedNormal, of_heights, of_object_map, of_tangent_map};
use super::texture_lookup::{LookupPoint, TextureOnMesh, premultiplied};
use crate::error::Result;
use crate::image::Texture;
use crate::math::{Mat4, Vec3};
use crate::mesh::{Mesh, Point, blend, each};
use crate::pixel::NormalSource;
use crate::scene::{AlphaMode, Instance, Material, SceneData, TextureRef};

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
        let part = self.parts.partition_point(|part| part.triangle <= triangle);
        &self.parts[part - 1]
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
