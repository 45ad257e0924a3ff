//! `xtask shaders`: writes the generated shaders of a few surfaces to docs/shaders.

use crate::generated::{Content, Generated};
use anyhow::Result;
use std::collections::BTreeMap;
use std::path::Path;
use taotie_engine::image::Sampler;
use taotie_engine::scene::{
    GreenChannel, HeightMap, Material, NormalMap, NormalSpace, TextureRef, UvTransform,
};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{Language, PixelShader, Variant, VariantOptions, pixel_shader};

/// Returns the files of `docs/shaders`.
pub fn generated(root: &Path) -> Result<Generated> {
    let folder = root.join("docs/shaders");
    let mut files = BTreeMap::new();
    for (name, text) in texts()? {
        files.insert(folder.join(name), Content::Text(text));
    }
    Ok(Generated { files, folder: Some(folder) })
}

/// Returns the content of each file by name.
fn texts() -> Result<Vec<(&'static str, String)>> {
    let ggx = Variant::new(&textured(), &lit(Shading::Ggx, SurfaceMethod::TangentNormal));
    let bump = Variant::new(&raised(), &lit(Shading::CookTorrance, SurfaceMethod::Bump));
    let PixelShader { text, interface, .. } = pixel_shader(&ggx, Language::Wgsl);
    let es = pixel_shader(&ggx, Language::GlslEs);
    Ok(vec![
        ("ggx-tangent-normal.wgsl", text),
        ("ggx-tangent-normal.frag.glsl", es.text),
        ("ggx-tangent-normal.vert.glsl", es.vertex_text.unwrap_or_default()),
        ("ggx-tangent-normal.json", serde_json::to_string_pretty(&interface)? + "\n"),
        ("cook-torrance-bump.wgsl", pixel_shader(&bump, Language::Wgsl).text),
    ])
}

fn lit(shading: Shading, method: SurfaceMethod) -> VariantOptions {
    VariantOptions { shading, method, environment: true, ..VariantOptions::default() }
}

fn texture() -> TextureRef {
    TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() }
}

/// Returns the material of a baked asset: base colour, metallic-roughness with occlusion, and a normal map.
fn textured() -> Material {
    let normal =
        NormalMap { texture: texture(), scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
    Material {
        base_color_texture: Some(texture()),
        metallic_roughness_texture: Some(texture()),
        occlusion_texture: Some(texture()),
        normal: Some(normal),
        ..Material::default()
    }
}

/// Returns a material with a height map.
fn raised() -> Material {
    Material { height: Some(HeightMap { texture: texture(), scale: 0.01 }), ..Material::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_shaders_are_up_to_date() {
        let shaders = generated(&crate::root()).expect("the shaders can be generated");
        let stale = shaders.stale().expect("the shaders are readable");
        assert!(stale.is_empty(), "run `make shaders` to update {stale:?}");
    }

    #[test]
    fn each_file_has_its_entry_point() {
        for (name, text) in texts().expect("the shaders can be generated") {
            let entry = match name.rsplit('.').next() {
                Some("wgsl") => "fn fragment_main(",
                Some("glsl") => "void main() {",
                _ => "\"clip_from_world\"",
            };
            assert!(text.contains(entry), "{name}: {text}");
        }
    }
}
