//! The geometry hit by shadow rays, as shaders read it.

use crate::error::Result;
use crate::gpu::Gpu;
use crate::shadow_masks::ShadowMasks;
use crate::variants::is_blended;
use taotie_engine::render::{Prepared, Surface};
use taotie_engine::scene::AlphaMode;
use taotie_engine::trace::FlatBox;
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
    format!("const SHADOW_OFFSET: f32 = {offset:e};\nconst SHADOW_REACH: f32 = {reach:e};\n{TEXT}")
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
        casters.boxes = flat.boxes.iter().map(box_words).collect();
        casters
    }

    /// Adds the triangles of the next surface.
    fn add(&mut self, prepared: &Prepared, surface: &Surface<'_>) {
        let first = self.vertices.len() as u32;
        let is_masked = matches!(surface.material.alpha, AlphaMode::Mask(_));
        let kind = match is_masked {
            true => MASKED + self.masks.add(prepared.scene().textures(), surface, first),
            false if is_blended(surface) => CASTS_NOT,
            false => CASTS,
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
        self.boxes.push(END);
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

/// The end of the list of boxes, which the shader recognises by its `skip`.
const END: [u32; 8] = [0; 8];

/// The words of a box: the low four bits of the last one are the number of its triangles, the others the index of the
/// first.
fn box_words(around: &FlatBox) -> [u32; 8] {
    let [[a, b, c], [d, e, f]] = [around.low, around.high].map(|corner| corner.map(f32::to_bits));
    let triangles = around.triangles.start << 4 | around.triangles.len() as u32;
    [a, b, c, around.skip, d, e, f, triangles]
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::math::{Mat4, Vec3};
    use taotie_engine::mesh::Mesh;
    use taotie_engine::render::SurfaceSettings;
    use taotie_engine::scene::{Instance, Material, Scene};

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
}
