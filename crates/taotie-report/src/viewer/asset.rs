//! The model as the page loads it: a GLB of one mesh a surface, in world space, with the normals and tangents that the
//! renderer has.

use taotie::io::{GltfFormat, ImageCodec, encode_scene_as};
use taotie::math::Mat4;
use taotie::mesh::{Mesh, MeshData};
use taotie::render::{Prepared, Surface};
use taotie::scene::{Classic, GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData};
use taotie::{Result, Warnings};

/// Returns the GLB of all surfaces; a mesh has the number of its surface as its name.
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
        materials: scene.materials().iter().map(said).collect(),
        textures: scene.textures().to_vec(),
        ..SceneData::default()
    })?;
    // WebP loses nothing here, and every browser reads it.
    let format = GltfFormat {
        meshopt: true,
        images: ImageCodec::WebP.into(),
        quick_webp: true,
        ..GltfFormat::default()
    };
    encode_scene_as(&written, &names, &format, warnings)
}

/// A surface in world space, its triangles counter-clockwise.
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

/// The part of a material that glTF can say. The page has the rest beside it.
fn said(material: &Material) -> Material {
    Material {
        f0: None,
        f82: None,
        height: None,
        classic: Classic::default(),
        normal: material.normal.filter(|map| map.space == NormalSpace::Tangent),
        ..material.clone()
    }
}

/// The material with green up in its normal maps of tangent space, as those of the GLB are.
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
