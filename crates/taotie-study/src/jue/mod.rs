//! The demonstration's object: a Shang bronze *jue* (爵), a tripod for warm wine, made by code alone.

mod atlas;
mod bake;
mod builder;
mod curves;
mod displaced;
mod ground;
mod limbs;
mod mask;
mod noise;
mod normals;
mod patch;
mod patina;
pub mod pour;
mod profile;
mod relief;
mod rings;
mod rounded;
mod split;
mod strokes;
mod vessel;
mod welds;

pub use relief::{DEPTH, height};

use bake::Bake;
use taotie::image::{Bitmap, Encoding, Sampler, Texture, Wrap};
use taotie::math::Mat4;
use taotie::mesh::Mesh;
use taotie::scene::{
    GreenChannel, HeightMap, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
    UvTransform,
};

/// The low mesh: 251 vertices, metres, standing on y = 0 with its spout along +x and its handle towards −z.
///
/// Every part is closed and turned outward; the one uv set has no mirrored and no overlapping UV islands. Tangents are
/// left to the renderer.
pub fn low_mesh() -> Mesh {
    let mut builder = builder::Builder::default();
    vessel::add(&mut builder);
    limbs::add(&mut builder);
    builder.finish()
}

/// The relief as a 16-bit grey map of `size` × `size` texels (1 to [`Bitmap::MAX_SIDE`]), grown beyond the UV islands'
/// borders by 1/128 of its side. To be read as linear.
pub fn height_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).height_map()
}

/// The relief as a 16-bit tangent-space normal map for [`low_mesh`] with MikkTSpace tangents: green up, linear.
pub fn normal_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).normal_map()
}

/// The relief as a 16-bit object-space normal map for [`low_mesh`], linear.
pub fn object_normal_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).object_normal_map()
}

/// Bare bronze and its patina as an 8-bit colour map, sRGB-encoded.
pub fn base_color_map(size: u32) -> Bitmap {
    let [color, _] = Bake::new(&low_mesh(), size).material_maps();
    color
}

/// Occlusion (red), roughness (green) and metallic (blue), 8 bits, linear.
pub fn orm_map(size: u32) -> Bitmap {
    let [_, orm] = Bake::new(&low_mesh(), size).material_maps();
    orm
}

/// The vessel with its material: one instance, no light and no camera. Textures 0 to 3 are colour, occlusion with
/// roughness and metallic, normals, and heights, each of `size` × `size` texels.
pub fn scene(size: u32) -> Scene {
    let mesh = low_mesh();
    let bake = Bake::new(&mesh, size);
    let [color, orm] = bake.material_maps();
    let textures = vec![
        Texture::new(color, Encoding::Srgb),
        Texture::new(orm, Encoding::Linear),
        Texture::new(bake.normal_map(), Encoding::Normal),
        Texture::new(bake.height_map(), Encoding::Linear),
    ];
    let instances = vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }];
    let (meshes, materials) = (vec![mesh], vec![material()]);
    let data = SceneData { meshes, materials, textures, instances, ..SceneData::default() };
    Scene::new(data).expect("four textures are there")
}

/// Returns `scene`, as [`scene`] makes it, with the relief as an object-space map of `size` × `size` texels.
pub fn with_object_map(scene: &Scene, size: u32) -> Scene {
    let mut scene = scene.clone();
    let index = scene.add_texture(Texture::new(object_normal_map(size), Encoding::Normal));
    let edited = scene.edit(|scene| {
        for map in scene.materials.iter_mut().filter_map(|material| material.normal.as_mut()) {
            map.texture.texture = index;
            map.space = NormalSpace::Object;
        }
    });
    edited.expect("the texture is there");
    scene
}

/// Returns `scene`, as [`scene`] makes it, with its relief as geometry, which `mesh` has, and in no map.
pub fn with_relief(scene: &Scene, mesh: Mesh) -> Scene {
    let mut scene = scene.clone();
    let edited = scene.edit(|scene| {
        scene.meshes = vec![mesh];
        for material in &mut scene.materials {
            (material.normal, material.height) = (None, None);
        }
    });
    edited.expect("a mesh stands for a mesh");
    scene
}

/// Factors of one everywhere: the textures say it all.
fn material() -> Material {
    let texture = |texture| TextureRef {
        texture,
        uv_set: 0,
        sampler: Sampler { wrap_u: Wrap::Clamp, wrap_v: Wrap::Clamp, ..Sampler::default() },
        transform: UvTransform::default(),
    };
    Material {
        name: "excavated bronze".into(),
        base_color: [1.0; 4],
        base_color_texture: Some(texture(0)),
        metallic: 1.0,
        roughness: 1.0,
        metallic_roughness_texture: Some(texture(1)),
        occlusion_texture: Some(texture(1)),
        // Fully occluded texels would turn black under the few lights of a demo.
        occlusion_strength: 0.7,
        normal: Some(NormalMap {
            texture: texture(2),
            scale: 1.0,
            space: NormalSpace::Tangent,
            green: GreenChannel::Up,
        }),
        height: Some(HeightMap { texture: texture(3), scale: DEPTH as f32 }),
        ..Material::default()
    }
}

/// The shortest edges of a [`displaced_mesh`] that resolves the finest lines, metres: more than a million triangles.
pub const FINEST: f64 = 0.0002;

/// The vessel with its relief as geometry: each triangle of [`low_mesh`] rounded by its normals, displaced by
/// [`height`], and split until its edges follow the relief or are no longer than `finest`, metres.
///
/// Its uvs are the low mesh's, so the two can be compared place by place; its normals are those of the displaced
/// surface.
pub fn displaced_mesh(finest: f64) -> Mesh {
    displaced::mesh(&low_mesh(), finest, height)
}

#[cfg(test)]
mod tests;
