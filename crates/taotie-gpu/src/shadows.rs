//! The targets of shadow rays, as shaders read them: the geometry, and the holes of surfaces, through which rays pass.

use crate::gpu::{Gpu, Result};
use crate::rays::{END_BOX, RAYS, box_words};
use std::collections::HashMap;
use taotie_engine::image::{Sampler, TexelFilter, Texture, Wrap};
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::pixel::{CLEAR, MaterialUniforms, PassedLight};
use taotie_engine::render::{Prepared, Surface};
use taotie_engine::scene::{AlphaMode, Material, TextureRef};
use wgpu::Buffer;

/// The shader functions that trace shadow rays.
const TEXT: &str = include_str!("shadows.wgsl");

/// The distance within which the triangle of an interpolated position is searched for, in multiples of the rays'
/// starting height.
const REACH: f32 = 32.0;

/// The last word of triangles that cast a shadow, and of those that do not. Larger values are 2 plus the index of a
/// mask.
const CASTS: u32 = 0;
const CASTS_NOT: u32 = 1;
const MASKED: u32 = 2;

/// Returns the function `visibility` and the functions that it calls, in WGSL. Rays start at the height `offset`
/// above the surface, in model units.
pub(crate) fn visibility_text(offset: f32) -> String {
    let reach = REACH * offset;
    format!("const SHADOW_OFFSET: f32 = {offset:e};\nconst SHADOW_REACH: f32 = {reach:e};\n{RAYS}{TEXT}")
}

/// The buffers that shadow rays read.
pub(crate) struct ShadowInputs([Buffer; 5]);

impl ShadowInputs {
    /// The number of buffers, which is also the number of bindings.
    pub(crate) const COUNT: usize = 5;

    /// Buffers without any shadow caster.
    ///
    /// # Errors
    /// If memory runs out.
    pub(crate) fn none(gpu: &Gpu) -> Result<Self> {
        Casters::default().upload(gpu)
    }

    /// Uploads all triangles of a scene.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`], or if memory runs out.
    pub(crate) fn new(gpu: &Gpu, prepared: &Prepared, surfaces: &[Surface<'_>]) -> Result<Self> {
        Casters::new(prepared, surfaces).upload(gpu)
    }

    /// The buffers in the order of their bindings.
    pub(crate) fn buffers(&self) -> [&Buffer; Self::COUNT] {
        self.0.each_ref()
    }
}

/// The triangles of a scene for shadow rays: words and floats in the shader's layout.
#[derive(Default)]
struct Casters {
    /// Low corner, skip, high corner, triangles; floats as bits.
    boxes: Vec<[u32; 8]>,
    /// Three corners, and the shadow word.
    triangles: Vec<[u32; 4]>,
    /// Position, u, normal, v.
    vertices: Vec<[f32; 8]>,
    masks: ShadowMasks,
}

impl Casters {
    fn new(prepared: &Prepared, surfaces: &[Surface<'_>]) -> Self {
        let mut casters = Self::default();
        for surface in surfaces {
            casters.add(prepared, surface);
        }
        let flat = prepared.bvh().flat();
        casters.triangles = flat.order.iter().map(|number| casters.triangles[*number as usize]).collect();
        casters.boxes = box_words(&flat.boxes);
        casters
    }

    /// Adds the triangles of the next surface.
    fn add(&mut self, prepared: &Prepared, surface: &Surface<'_>) {
        let first = self.vertices.len() as u32;
        let is_masked = matches!(surface.material.alpha, AlphaMode::Mask(_));
        let is_clear = surface.material.alpha == AlphaMode::Blend || lets_light_pass(surface.material);
        let kind = if is_clear {
            CASTS_NOT
        } else if is_masked {
            MASKED + self.masks.add(prepared.scene().textures(), surface, first)
        } else {
            CASTS
        };
        self.triangles.extend(surface.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|vertex| first + vertex);
            if surface.mirrored { [a, c, b, kind] } else { [a, b, c, kind] }
        }));
        let vertices = surface.positions.iter().zip(surface.normals).enumerate();
        self.vertices.extend(vertices.map(|(i, (p, n))| {
            let [u, v] = if is_masked { ShadowMasks::uv(surface, i) } else { [0.0; 2] };
            [p.x, p.y, p.z, u, n.x, n.y, n.z, v]
        }));
    }

    fn upload(mut self, gpu: &Gpu) -> Result<ShadowInputs> {
        self.boxes.push(END_BOX);
        self.triangles.resize(self.triangles.len().max(1), [0; 4]);
        self.vertices.resize(self.vertices.len().max(1), [0.0; 8]);
        let [masks, opacities] = self.masks.upload(gpu)?;
        Ok(ShadowInputs([
            gpu.storage("the boxes of shadow rays", bytemuck::cast_slice(&self.boxes))?,
            gpu.storage("the triangles that cast shadows", bytemuck::cast_slice(&self.triangles))?,
            gpu.storage("the vertices that cast shadows", bytemuck::cast_slice(&self.vertices))?,
            masks,
            opacities,
        ]))
    }
}

/// Returns `true` if so much light passes a surface that it casts no shadow, by its factors: a texture may darken it.
fn lets_light_pass(material: &Material) -> bool {
    let Some(transmission) = material.transmission.filter(|_| material.transmits()) else { return false };
    let [r, g, b, _] = material.base_color;
    let passed = PassedLight {
        transmission: transmission.factor,
        metallic: if material.metallic_roughness_texture.is_some() { 0.0 } else { material.metallic },
        base_color: Vec3::new(r, g, b),
        f0: MaterialUniforms::<f32>::new(material).dielectric_f0 * material.specular.factor,
    };
    passed.share() >= CLEAR
}

/// The masks of a scene's surfaces. A shader that draws one surface cannot read the textures of another, so their
/// opacities are numbers in a buffer.
#[derive(Default)]
struct ShadowMasks {
    /// Size, wrap modes, first texel, filter, factor, cutoff, and whether and where vertices have opacities; floats
    /// as bits.
    masks: Vec<[u32; 10]>,
    /// Opacities of texels and vertices.
    opacities: Vec<f32>,
    /// The index of the first texel of a texture's finest level.
    texels: HashMap<usize, u32>,
}

impl ShadowMasks {
    /// Adds the mask of a surface whose vertices start at index `first`; returns the mask's index.
    fn add(&mut self, textures: &[Texture], surface: &Surface<'_>, first: u32) -> u32 {
        let used = surface.material.base_color_texture.as_ref();
        let size = used.map_or((0, 0), |used| textures[used.texture].level_size(0));
        let texel = used.map_or(0, |used| self.texel(textures, used.texture));
        let sampler = used.map_or(Sampler::default(), |used| used.sampler);
        let cutoff = match surface.material.alpha {
            AlphaMode::Mask(cutoff) => cutoff,
            AlphaMode::Opaque | AlphaMode::Blend => 0.0,
        };
        let color = self.place().wrapping_sub(first);
        self.opacities.extend(surface.colors.iter().map(|color| color[3]));
        self.masks.push([
            size.0,
            size.1,
            wrap(sampler.wrap_u),
            wrap(sampler.wrap_v),
            texel,
            u32::from(sampler.magnify == TexelFilter::Linear),
            surface.material.base_color[3].to_bits(),
            cutoff.to_bits(),
            u32::from(!surface.colors.is_empty()),
            color,
        ]);
        self.masks.len() as u32 - 1
    }

    /// The coordinates of a vertex in the texture that cuts holes.
    fn uv(surface: &Surface<'_>, vertex: usize) -> [f32; 2] {
        let Some(TextureRef { uv_set, transform, .. }) = &surface.material.base_color_texture else {
            return [0.0; 2];
        };
        let uv = surface.uvs.get(*uv_set).map_or(Vec2::default(), |uvs| uvs[vertex]);
        let Vec2 { x, y } = transform.apply(uv);
        [x, y]
    }

    /// Uploads masks and opacities, at least one of each.
    ///
    /// # Errors
    /// [`crate::GpuError::TooLarge`], or if memory runs out.
    fn upload(mut self, gpu: &Gpu) -> Result<[Buffer; 2]> {
        self.masks.resize(self.masks.len().max(1), [0; 10]);
        self.opacities.resize(self.opacities.len().max(1), 0.0);
        Ok([
            gpu.storage("the masks of shadows", bytemuck::cast_slice(&self.masks))?,
            gpu.storage("the opacities of surfaces with holes", bytemuck::cast_slice(&self.opacities))?,
        ])
    }

    /// The index of a texture's first texel.
    fn texel(&mut self, textures: &[Texture], number: usize) -> u32 {
        if let Some(place) = self.texels.get(&number) {
            return *place;
        }
        let (place, texture) = (self.place(), &textures[number]);
        let (width, height) = texture.level_size(0);
        let all = (0..height as usize).flat_map(|y| (0..width as usize).map(move |x| (x, y)));
        self.opacities.extend(all.map(|(x, y)| texture.texel(0, x, y)[3]));
        self.texels.insert(number, place);
        place
    }

    /// The index of the next opacity.
    fn place(&self) -> u32 {
        self.opacities.len() as u32
    }
}

fn wrap(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Encoding, Texels};
    use taotie_engine::math::{Mat4, Vec3};
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::SurfaceSettings;
    use taotie_engine::scene::{Instance, Material, Scene, UvTransform};

    /// A sphere, a blended one next to it, and a mirrored one with holes.
    fn spheres() -> Prepared {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 24, 12), Material::default()).unwrap();
        let mut mirror = Mat4::translation(Vec3::new(5.0, 0.0, 0.0));
        mirror.columns[1][1] = -1.0;
        let aside = Mat4::translation(Vec3::new(0.0, 0.0, 5.0));
        scene
            .edit(|data| {
                let with = |alpha| Material { alpha, ..Material::default() };
                data.materials.extend([with(AlphaMode::Blend), with(AlphaMode::Mask(0.5))]);
                for (material, world_from_object) in [(1, aside), (2, mirror)] {
                    data.instances.push(Instance { mesh: 0, material, world_from_object });
                }
            })
            .unwrap();
        Prepared::new(scene, &SurfaceSettings::default()).unwrap()
    }

    #[test]
    fn triangles_lie_in_their_boxes_and_look_outwards() {
        let prepared = spheres();
        let Casters { boxes, triangles, vertices, .. } = Casters::new(&prepared, &prepared.surfaces());
        let vector = |v: &[f32]| Vec3::new(v[0], v[1], v[2]);
        let mut kinds = [0; 3];
        for words in boxes.iter().filter(|words| words[7] & 15 > 0) {
            let [low, high] =
                [&words[..3], &words[4..7]].map(|corner| [0, 1, 2].map(|i| f32::from_bits(corner[i])));
            for [corners @ .., kind] in &triangles[(words[7] >> 4) as usize..][..(words[7] & 15) as usize] {
                let [a, b, c] = corners.map(|vertex| vertices[vertex as usize]);
                for p in [a, b, c] {
                    assert!((0..3).all(|axis| (low[axis]..=high[axis]).contains(&p[axis])));
                }
                let front = (vector(&b) - vector(&a)).cross(vector(&c) - vector(&a));
                assert!(front.length() < 1e-6 || front.dot(vector(&a[4..])) > 0.0, "kind {kind}");
                kinds[*kind as usize] += 1;
            }
        }
        assert_eq!(kinds, [triangles.len() / 3; 3]);
    }

    #[test]
    fn lengths_are_written_as_the_shader_reads_them() {
        let text = visibility_text(1.5e-5);
        assert!(
            text.starts_with("const SHADOW_OFFSET: f32 = 1.5e-5;\nconst SHADOW_REACH: f32 = 4.8e-4;\n"),
            "{text}"
        );
    }

    #[test]
    fn textures_are_there_once_and_vertices_follow() {
        let texels = Texels::U8((0..6).map(|i| [9, 9, 9, 51 * i]).collect());
        let texture = Texture::new(Bitmap::new(3, 2, 4, texels).unwrap(), Encoding::Srgb);
        let transform = UvTransform { offset: [0.25, 0.5], ..UvTransform::default() };
        let sampler = Sampler { wrap_v: Wrap::Clamp, magnify: TexelFilter::Nearest, ..Sampler::default() };
        let holes = Material {
            alpha: AlphaMode::Mask(0.5),
            base_color_texture: Some(TextureRef { texture: 0, uv_set: 0, sampler, transform }),
            ..Material::default()
        };
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        scene.add_texture(texture);
        scene.edit(|scene| scene.materials = vec![holes]).unwrap();
        let prepared = Prepared::new(scene, &SurfaceSettings::default()).unwrap();
        let surface = &prepared.surfaces()[0];
        let mut masks = ShadowMasks::default();
        let textures = prepared.scene().textures();
        assert_eq!([masks.add(textures, surface, 0), masks.add(textures, surface, 40)], [0, 1]);
        let [half, one] = [0.5f32, 1.0].map(f32::to_bits);
        assert_eq!(masks.masks[0], [3, 2, 0, 2, 0, 0, one, half, 0, 6]);
        assert_eq!(masks.masks[1][4], 0, "the texture was already added");
        assert_eq!(masks.opacities, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        let uv = surface.uvs[0][3];
        assert_eq!(ShadowMasks::uv(surface, 3), [uv.x + 0.25, uv.y + 0.5]);
    }
}
