//! The model that the page loads: a world-space GLB with one mesh per surface and the renderer's tangent frames, and
//! its textures: those in the GLB by index, and those that glTF cannot express as numbers.

use super::document::{Blob, bytes_of_words};
use serde::Serialize;
use taotie_engine::image::{Encoding, Texels, Texture};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{Prepared, Surface};
use taotie_engine::scene::{
    Classic, GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData,
};
use taotie_engine::{Result, Warnings};
use taotie_io::{GltfFormat, ImageCodec, encode_scene_as};

/// Returns the GLB of all surfaces; each mesh is named by the index of its surface.
pub(super) fn glb(prepared: &Prepared, warnings: &mut Warnings) -> Result<Vec<u8>> {
    let surfaces = prepared.surfaces();
    let meshes: Vec<Mesh> = surfaces.iter().map(mesh).collect::<Result<_>>()?;
    let names: Vec<String> = (0..meshes.len()).map(|number| number.to_string()).collect();
    let scene = prepared.scene();
    let instances = scene.instances().iter().enumerate();
    let shown = instances.map(|(mesh, instance)| Instance {
        mesh,
        material: instance.material,
        world_from_object: Mat4::IDENTITY,
    });
    let written = Scene::new(SceneData {
        instances: shown.collect(),
        meshes,
        materials: scene.materials().iter().map(gltf_part).collect(),
        textures: scene.textures().to_vec(),
        ..SceneData::default()
    })?;
    // WebP is lossless here, and all browsers support it. Most files of textures are smaller.
    let format = GltfFormat {
        meshopt: true,
        images: ImageCodec::WebP.into(),
        for_page: true,
        ..GltfFormat::default()
    };
    encode_scene_as(&written, &names, &format, warnings)
}

/// Returns a surface in world space, with counter-clockwise triangles.
fn mesh(surface: &Surface<'_>) -> Result<Mesh> {
    let turned = |[a, b, c]: &[u32; 3]| if surface.mirrored { [*a, *c, *b] } else { [*a, *b, *c] };
    Mesh::new(MeshData {
        positions: surface.positions.to_vec(),
        normals: surface.normals.to_vec(),
        tangents: surface.tangents.to_vec(),
        uvs: surface.uvs.to_vec(),
        colors: surface.colors.to_vec(),
        triangles: surface.triangles.iter().map(turned).collect(),
    })
}

/// Returns the part of a material that glTF can express. The page stores the rest separately.
fn gltf_part(material: &Material) -> Material {
    Material {
        f0: None,
        f82: None,
        height: None,
        classic: Classic::default(),
        normal: material.normal.filter(|map| map.space == NormalSpace::Tangent),
        ..material.clone()
    }
}

/// Returns the material with green up in its tangent-space normal maps, like those in the GLB.
pub(super) fn with_green_up(material: &Material) -> Material {
    let up = |map: NormalMap| match map.space {
        NormalSpace::Tangent => NormalMap { green: GreenChannel::Up, ..map },
        NormalSpace::Object => map,
    };
    let mut turned = material.clone();
    turned.normal = material.normal.map(up);
    if let Some(coat) = &mut turned.clearcoat {
        coat.normal = coat.normal.map(up);
    }
    turned
}

/// A texture of the model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct TextureData {
    /// `srgb`, `linear` or `normal`.
    encoding: &'static str,
    /// Its texels, if they are not in the GLB.
    codes: Option<Codes>,
}

/// The texels of a texture as 16-bit numbers in the blob `codes`, row by row.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
struct Codes {
    width: u32,
    height: u32,
    channels: usize,
    /// Their offset, in numbers.
    from: usize,
}

/// Returns all textures as data, and the numbers of those that glTF cannot express as a blob called `name`.
pub(super) fn textures(scene: &Scene, name: &'static str) -> (Vec<TextureData>, Option<Blob>) {
    let mut all = Vec::new();
    let mut codes: Vec<u16> = Vec::new();
    for (number, texture) in scene.textures().iter().enumerate() {
        let channels = unsaid_channels(scene.materials(), number);
        let codes = channels.map(|channels| Codes::put(texture, channels, &mut codes));
        all.push(TextureData { encoding: encoding(texture.encoding()), codes });
    }
    let blob = (!codes.is_empty()).then(|| Blob::new(name, bytes_of_words(codes.into_iter())));
    (all, blob)
}

/// Returns the number of channels of a texture that glTF cannot express: 1 for heights, 3 for object-space normals.
fn unsaid_channels(materials: &[Material], number: usize) -> Option<usize> {
    let is_height = |m: &Material| m.height.is_some_and(|map| map.texture.texture == number);
    let is_object = |m: &Material| {
        m.normal.is_some_and(|map| map.space == NormalSpace::Object && map.texture.texture == number)
    };
    match (materials.iter().any(is_object), materials.iter().any(is_height)) {
        (true, _) => Some(3),
        (false, true) => Some(1),
        (false, false) => None,
    }
}

impl Codes {
    fn put(texture: &Texture, channels: usize, codes: &mut Vec<u16>) -> Self {
        let bitmap = texture.bitmap();
        let from = codes.len();
        match bitmap.texels() {
            Texels::U8(texels) => {
                codes.extend(texels.iter().flat_map(|t| t[..channels].iter().map(|v| u16::from(*v) * 257)));
            }
            Texels::U16(texels) => codes.extend(texels.iter().flat_map(|t| &t[..channels])),
            Texels::F32(texels) => codes.extend(texels.iter().flat_map(|t| t[..channels].iter().map(code))),
        }
        Self { width: bitmap.width(), height: bitmap.height(), channels, from }
    }
}

fn code(value: &f32) -> u16 {
    (value.clamp(0.0, 1.0) * 65535.0 + 0.5) as u16
}

fn encoding(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Srgb => "srgb",
        Encoding::Linear => "linear",
        Encoding::Normal => "normal",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::image::{Bitmap, Sampler};
    use taotie_engine::scene::{HeightMap, TextureRef, UvTransform};

    #[test]
    fn heights_are_numbers_and_colours_are_in_the_model() {
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
        let bitmap =
            |texel| Texture::new(Bitmap::new(2, 1, 3, Texels::U8(vec![texel; 2])).unwrap(), Encoding::Linear);
        scene.add_texture(bitmap([9, 9, 9, 255]));
        let number = scene.add_texture(bitmap([128, 0, 0, 255]));
        let (sampler, transform) = (Sampler::default(), UvTransform::default());
        let texture = TextureRef { texture: number, uv_set: 0, sampler, transform };
        scene.edit(|data| data.materials[0].height = Some(HeightMap { texture, scale: 1.0 })).unwrap();
        let (all, blob) = textures(&scene, "codes");
        assert_eq!(all[0].codes, None);
        assert_eq!(all[1].codes, Some(Codes { width: 2, height: 1, channels: 1, from: 0 }));
        assert!(blob.is_some());
    }
}
