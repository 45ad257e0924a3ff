//! The part common to both files: the mesh with its material.

use taotie_engine::Result;
use taotie_engine::mesh::Mesh;
use taotie_io::{GltfAsset, GltfDraft, GltfFormat, GltfImage, GltfLevel, GltfMaterial};

/// Starts a file for the vessel with the texture files of its scene; `normals` is the one for its relief.
pub(super) fn draft(mesh: &Mesh, normals: Option<&str>) -> Result<GltfDraft> {
    let levels = [GltfLevel { mesh, coverage: None }];
    let asset =
        GltfAsset { name: "jue", levels: &levels, material: material(normals), ..GltfAsset::default() };
    GltfDraft::new(&asset, &GltfFormat::default())
}

/// Returns the material of the vessel's scene.
fn material(normals: Option<&str>) -> GltfMaterial<'_> {
    let orm = Some(GltfImage::File("jue_orm.png"));
    GltfMaterial {
        name: "excavated bronze",
        metallic: 1.0,
        roughness: 1.0,
        base_color_map: Some(GltfImage::File("jue_color.png")),
        metallic_roughness_map: orm,
        occlusion_map: orm,
        occlusion_strength: 0.7,
        normal_map: normals.map(GltfImage::File),
        ..GltfMaterial::default()
    }
}
