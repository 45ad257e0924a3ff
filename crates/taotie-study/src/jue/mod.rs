//! The demo object: a Shang bronze *jue* (爵), a tripod for warm wine, generated procedurally.

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
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texture, Wrap};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{
    GreenChannel, HeightMap, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
    UvTransform,
};

/// Returns the low-poly mesh: 251 vertices, metres, resting on y = 0, with its spout along +x and its handle at −z.
///
/// Every part is closed and faces outwards; the single uv set has no mirrored or overlapping UV islands. Tangents are
/// left to the renderer.
pub fn low_mesh() -> Mesh {
    let mut builder = builder::Builder::default();
    vessel::add(&mut builder);
    limbs::add(&mut builder);
    builder.finish()
}

/// Returns the relief as a linear 16-bit greyscale map of `size` × `size` texels (1 to [`Bitmap::MAX_SIDE`]), padded
/// around the UV islands by 1/128 of its side.
pub fn height_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).height_map()
}

/// Returns the relief as a linear 16-bit tangent-space normal map, green up, for [`low_mesh`] in MikkTSpace.
pub fn normal_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).normal_map()
}

/// Returns the relief as a linear 16-bit object-space normal map for [`low_mesh`].
pub fn object_normal_map(size: u32) -> Bitmap {
    Bake::new(&low_mesh(), size).object_normal_map()
}

/// Returns bare bronze and its patina as an sRGB-encoded 8-bit colour map.
pub fn base_color_map(size: u32) -> Bitmap {
    let [color, _] = Bake::new(&low_mesh(), size).material_maps();
    color
}

/// Returns occlusion (red), roughness (green) and metallic (blue) as a linear 8-bit map.
pub fn orm_map(size: u32) -> Bitmap {
    let [_, orm] = Bake::new(&low_mesh(), size).material_maps();
    orm
}

/// Returns the vessel with its material: one instance, no light and no camera. Textures 0 to 3 are colour;
/// occlusion, roughness and metallic; normals; and heights, each of `size` × `size` texels.
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
    Scene::new(data).expect("there are four textures")
}

/// Returns `scene`, made by [`scene`], with the relief as an object-space map of `size` × `size` texels.
pub fn with_object_map(scene: &Scene, size: u32) -> Scene {
    let mut scene = scene.clone();
    let index = scene.add_texture(Texture::new(object_normal_map(size), Encoding::Normal));
    let edited = scene.edit(|scene| {
        for map in scene.materials.iter_mut().filter_map(|material| material.normal.as_mut()) {
            map.texture.texture = index;
            map.space = NormalSpace::Object;
        }
    });
    edited.expect("the texture exists");
    scene
}

/// Returns `scene`, made by [`scene`], with `mesh`, which has its relief as geometry, instead of relief maps.
pub fn with_relief(scene: &Scene, mesh: Mesh) -> Scene {
    let mut scene = scene.clone();
    let edited = scene.edit(|scene| {
        scene.meshes = vec![mesh];
        for material in &mut scene.materials {
            (material.normal, material.height) = (None, None);
        }
    });
    edited.expect("one mesh replaces another");
    scene
}

/// The material, with all factors 1: everything is in the textures.
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

/// The edge length at which a [`displaced_mesh`] resolves the finest lines, metres: more than a million triangles.
pub const FINEST: f64 = 0.0002;

/// Returns the vessel with its relief as geometry: each triangle of [`low_mesh`] is rounded by its normals, displaced
/// by [`height`], and split until its edges follow the relief or are at most `finest` metres long.
///
/// Its uvs are those of the low-poly mesh, so the two can be compared point by point; its normals are those of the
/// displaced surface.
pub fn displaced_mesh(finest: f64) -> Mesh {
    displaced::mesh(&low_mesh(), finest, height)
}

#[cfg(test)]
mod tests;
