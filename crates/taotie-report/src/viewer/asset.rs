//! The model that the page loads: a world-space GLB with one mesh per surface and the renderer's tangent frames.

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
    // WebP is lossless here, and all browsers support it.
    let format = GltfFormat {
        meshopt: true,
        images: ImageCodec::WebP.into(),
        quick_webp: true,
        ..GltfFormat::default()
    };
    encode_scene_as(&written, &names, &format, warnings)
}

/// Returns a surface in world space, with counter-clockwise triangles.
pub(super) fn mesh(surface: &Surface<'_>) -> Result<Mesh> {
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
