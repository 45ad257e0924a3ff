//! Estimates the memory that images take, from their settings and the scene.

use super::settings::RenderSettings;
use crate::image::Texture;
use crate::mesh::Mesh;
use crate::scene::{Instance, NormalSpace, Scene};
use crate::surface::tangent_bytes;

/// The form in which the pixels of an image are kept until they are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldPixels {
    /// 8-bit codes, developed tile by tile.
    Codes,
    /// Light in floats, then 8-bit codes.
    Light8,
    /// Light in floats, then 16-bit codes.
    Light16,
    /// Light in floats, written unchanged.
    Floats,
}

impl HeldPixels {
    /// Light in four floats.
    const LIGHT: u64 = 16;
    /// Floats in output form: row by row, channel by channel, compressed.
    const WRITTEN_FLOATS: u64 = 16 + 16 + 4;

    /// Returns the bytes per pixel: light, codes, and their copies during compression.
    fn bytes(self) -> u64 {
        match self {
            Self::Codes => 4 + 4,
            Self::Light8 => Self::LIGHT + 4 + 4,
            Self::Light16 => Self::LIGHT + 8 + 8 + 8,
            Self::Floats => Self::LIGHT + Self::WRITTEN_FLOATS,
        }
    }
}

/// Returns the memory for preparing a scene and rendering an image of it, in bytes: the scene itself, placed
/// triangles, the tree of shadow rays, pixels, and the program.
pub fn image_bytes(scene: &Scene, settings: &RenderSettings, held: HeldPixels) -> u64 {
    /// The program itself.
    const PROGRAM: u64 = 32 << 20;
    /// The memory in which a thread draws tiles.
    const THREAD: u64 = 1 << 20;
    let rest = PROGRAM + THREAD * rayon::current_num_threads() as u64;
    let drawing = prepared_bytes(scene, settings) + pixel_bytes(settings, held);
    rest + scene_bytes(scene) + drawing.max(framing_bytes(scene, |mesh| mesh.tangents().is_empty()))
}

/// Returns the memory of the pixels of an image until it is written, in bytes.
pub fn pixel_bytes(settings: &RenderSettings, held: HeldPixels) -> u64 {
    /// Light, six output variables, and one of them in output form.
    const WITH_AOVS: u64 = HeldPixels::LIGHT + 6 * 16 + HeldPixels::WRITTEN_FLOATS;
    let pixels = u64::from(settings.width) * u64::from(settings.height);
    pixels * if settings.aovs { WITH_AOVS } else { held.bytes() }
}

/// Returns the memory for computing tangents, in bytes, of the largest mesh under a normal map that gets them.
pub fn framing_bytes(scene: &Scene, gets_them: impl Fn(&Mesh) -> bool) -> u64 {
    let is_framed = |instance: &&Instance| {
        let normal = scene.materials()[instance.material].normal;
        normal.is_some_and(|map| map.space == NormalSpace::Tangent)
            && gets_them(&scene.meshes()[instance.mesh])
    };
    let of_mesh = |instance: &Instance| {
        let mesh = &scene.meshes()[instance.mesh];
        tangent_bytes(mesh.triangles().len() as u64, mesh.positions().len() as u64)
    };
    scene.instances().iter().filter(is_framed).map(of_mesh).max().unwrap_or(0)
}

/// Returns the memory of a scene, in bytes.
pub fn scene_bytes(scene: &Scene) -> u64 {
    const TRIANGLE: usize = 12;
    const POSITION: usize = 12;
    const NORMAL: usize = 12;
    const UV: usize = 8;
    const TANGENT: usize = 16;
    const COLOR: usize = 16;
    let of_mesh = |mesh: &Mesh| {
        let uvs: usize = mesh.uvs().iter().map(Vec::len).sum();
        mesh.triangles().len() * TRIANGLE
            + mesh.positions().len() * POSITION
            + mesh.normals().len() * NORMAL
            + uvs * UV
            + mesh.tangents().len() * TANGENT
            + mesh.colors().len() * COLOR
    };
    let meshes: u64 = scene.meshes().iter().map(|mesh| of_mesh(mesh) as u64).sum();
    meshes + scene.textures().iter().map(Texture::bytes).sum::<u64>()
}

fn prepared_bytes(scene: &Scene, settings: &RenderSettings) -> u64 {
    /// A placed vertex with normal and tangent, and its position in the image.
    const VERTEX: u64 = 40 + 32;
    /// A triangle prepared for tiles, and its entries in them.
    const TRIANGLE: u64 = 12 + 48;
    /// Leaves of the tree that are 60 % full, their triangles, nodes, and the boxes that are split.
    const TREE: u64 = 80 + 32;
    /// A placed instance, and the text stored with its name.
    const INSTANCE: u64 = 1280;
    /// Positions in the image and entries in tiles, of output variables too if they are drawn apart.
    const APART: [u64; 2] = [32, 48];
    let is_apart = settings.aovs && settings.samples != 1;
    let [of_vertex, of_triangle] = if is_apart { APART } else { [0; 2] };
    let tree = if settings.shadows || settings.ground { TREE } else { 0 };
    let (vertex, triangle) = (VERTEX + of_vertex, TRIANGLE + tree + of_triangle);
    let placed = scene.instances().iter().map(|instance| {
        let mesh = &scene.meshes()[instance.mesh];
        INSTANCE + mesh.positions().len() as u64 * vertex + mesh.triangles().len() as u64 * triangle
    });
    placed.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Sampler, Texels};
    use crate::scene::{GreenChannel, Material, NormalMap, TextureRef, UvTransform};

    fn ball() -> Scene {
        Scene::of_mesh(Mesh::sphere(1.0, 64, 32), Material::default()).unwrap()
    }

    #[test]
    fn sizes_variables_and_instances_count() {
        let (scene, held) = (ball(), HeldPixels::Codes);
        let small = RenderSettings::default();
        let large = RenderSettings { width: 16_384, height: 16_384, aovs: true, ..small.clone() };
        assert!(image_bytes(&scene, &small, held) < 1 << 28);
        assert!(image_bytes(&scene, &large, held) > 32 << 30);
        let mut many = scene.clone();
        many.edit(|scene| scene.instances = vec![scene.instances[0]; 1000]).unwrap();
        assert!(image_bytes(&many, &small, held) > image_bytes(&scene, &small, held) + 1000 * 100_000);
        let shadows = RenderSettings { shadows: true, ..small.clone() };
        assert!(image_bytes(&many, &shadows, held) > image_bytes(&many, &small, held));
    }

    #[test]
    fn what_is_written_decides_the_bytes_of_a_pixel() {
        let settings = RenderSettings { width: 1000, height: 1000, ..RenderSettings::default() };
        let forms = [HeldPixels::Codes, HeldPixels::Light8, HeldPixels::Light16, HeldPixels::Floats];
        assert_eq!(
            forms.map(|held| pixel_bytes(&settings, held)),
            [8, 24, 40, 52].map(|bytes| bytes * 1_000_000)
        );
        let variables = RenderSettings { aovs: true, ..settings };
        assert_eq!(pixel_bytes(&variables, HeldPixels::Codes), 148_000_000);
    }

    #[test]
    fn tangents_count_under_a_normal_map_alone() {
        let mut scene = ball();
        assert_eq!(framing_bytes(&scene, |_| true), 0);
        let texture = TextureRef {
            texture: 0,
            uv_set: 0,
            sampler: Sampler::default(),
            transform: UvTransform::default(),
        };
        let normal = NormalMap { texture, scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
        let texel = Bitmap::new(1, 1, 3, Texels::U8(vec![[128, 128, 255, 255]])).unwrap();
        scene
            .edit(|scene| {
                scene.textures = vec![Texture::new(texel, Encoding::Normal)];
                scene.materials[0].normal = Some(normal);
            })
            .unwrap();
        let triangles = scene.meshes()[0].triangles().len() as u64;
        assert!(framing_bytes(&scene, |_| true) > 352 * triangles);
        assert_eq!(framing_bytes(&scene, |_| false), 0);
    }

    #[test]
    fn the_scene_itself_counts() {
        let scene = ball();
        let mesh = &scene.meshes()[0];
        let least = mesh.triangles().len() * 12 + mesh.positions().len() * 24;
        let textures: u64 = scene.textures().iter().map(Texture::bytes).sum();
        assert!(scene_bytes(&scene) >= least as u64 + textures);
        assert!(scene_bytes(&scene) <= 3 * least as u64 + textures);
    }
}
