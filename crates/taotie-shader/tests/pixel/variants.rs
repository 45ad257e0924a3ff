//! Materials and variants of all kinds.

use taotie_engine::names::Named;
use taotie_engine::scene::{
    AlphaMode, Anisotropy, Classic, Clearcoat, GreenChannel, HeightMap, Material, NormalMap, NormalSpace,
    Sheen, Specular, TextureRef, Transmission, UvTransform,
};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{Variant, VariantOptions};

/// A variant with a descriptive name.
pub struct Case {
    pub name: String,
    pub material: Material,
    pub options: VariantOptions,
}

impl Case {
    pub fn variant(&self) -> Variant {
        Variant::new(&self.material, &self.options)
    }
}

pub fn texture(uv_set: usize) -> TextureRef {
    TextureRef {
        texture: 0,
        uv_set,
        sampler: taotie_engine::image::Sampler::default(),
        transform: UvTransform::default(),
    }
}

fn transformed(uv_set: usize) -> TextureRef {
    let transform = UvTransform { linear: [[2.0, 0.5], [-0.25, 1.5]], offset: [0.1, -0.3] };
    TextureRef { transform, ..texture(uv_set) }
}

fn normal_map(space: NormalSpace) -> NormalMap {
    NormalMap { texture: texture(0), scale: 0.8, space, green: GreenChannel::Down }
}

/// A material with every texture and layer.
pub fn rich() -> Material {
    Material {
        base_color_texture: Some(texture(0)),
        metallic_roughness_texture: Some(transformed(0)),
        occlusion_texture: Some(texture(1)),
        occlusion_strength: 0.7,
        emissive: [0.1, 0.2, 0.3],
        emissive_texture: Some(transformed(1)),
        normal: Some(normal_map(NormalSpace::Tangent)),
        height: Some(HeightMap { texture: transformed(0), scale: 0.1 }),
        specular: Specular {
            factor: 0.9,
            factor_texture: Some(texture(0)),
            color: [1.0, 0.9, 0.8],
            color_texture: Some(texture(0)),
        },
        ..layered()
    }
}

/// A material with all layers, and only the textures of the layers.
pub fn layered() -> Material {
    Material {
        clearcoat: Some(Clearcoat {
            factor: 0.8,
            factor_texture: Some(texture(0)),
            roughness: 0.2,
            roughness_texture: Some(texture(0)),
            normal: Some(normal_map(NormalSpace::Tangent)),
        }),
        anisotropy: Some(Anisotropy { strength: 0.6, rotation: 0.4, texture: Some(texture(0)) }),
        sheen: Some(Sheen {
            color: [0.3, 0.2, 0.5],
            color_texture: Some(texture(0)),
            roughness: 0.4,
            roughness_texture: Some(texture(0)),
        }),
        ..Material::default()
    }
}

/// A thin glass with textures.
fn glass() -> Material {
    glass_of(Material { base_color_texture: Some(texture(0)), ..Material::default() })
}

fn glass_of(material: Material) -> Material {
    Material { transmission: Some(Transmission { factor: 0.7, texture: Some(texture(0)) }), ..material }
}

/// A material whose classic parameters are all authored.
fn authored() -> Material {
    Material {
        f0: Some([0.9, 0.6, 0.3]),
        f82: Some([0.8, 0.7, 0.6]),
        classic: Classic {
            ambient: Some([0.1; 3]),
            diffuse: Some([0.5; 3]),
            specular: Some([0.4; 3]),
            shininess: Some(40.0),
            slope: Some(0.3),
        },
        ..Material::default()
    }
}

/// The options with everything on.
pub fn everything(shading: Shading, method: SurfaceMethod) -> VariantOptions {
    VariantOptions {
        shading,
        method,
        environment: true,
        both_sides: true,
        vertex_color: true,
        uv_sets: 2,
        ..VariantOptions::default()
    }
}

pub fn shadings() -> impl Iterator<Item = Shading> {
    Shading::NAMES.iter().map(|(_, shading)| *shading)
}

/// A material with the map that a method needs.
pub fn mapped(method: SurfaceMethod, material: Material) -> Material {
    let space =
        if method == SurfaceMethod::ObjectNormal { NormalSpace::Object } else { NormalSpace::Tangent };
    Material {
        normal: Some(normal_map(space)),
        height: Some(HeightMap { texture: texture(0), scale: 0.1 }),
        ..material
    }
}

/// All models by all methods with plain and rich materials, and everything else individually.
pub fn all() -> Vec<Case> {
    let mut cases = Vec::new();
    for shading in shadings() {
        for method in SurfaceMethod::ALL {
            let name = |kind: &str| format!("{}, {method:?}, {kind}", shading.name());
            let plain = VariantOptions { shading, method, ..VariantOptions::default() };
            let material = mapped(method, Material::default());
            cases.push(Case { name: name("plain"), material, options: plain });
            let material = mapped(method, rich());
            cases.push(Case { name: name("rich"), material, options: everything(shading, method) });
        }
        let options = everything(shading, SurfaceMethod::Smooth);
        let name = format!("{}, authored", shading.name());
        cases.push(Case { name, material: authored(), options });
    }
    cases.extend(special());
    cases
}

/// The cases that do not depend on a model.
fn special() -> Vec<Case> {
    let case = |name: &str, material: Material, options: VariantOptions| Case {
        name: name.into(),
        material,
        options,
    };
    let options = VariantOptions::default;
    let ggx = || everything(Shading::Ggx, SurfaceMethod::TangentNormal);
    let textured = || Material { base_color_texture: Some(texture(0)), ..Material::default() };
    vec![
        case("unlit", Material { unlit: true, ..Material::default() }, options()),
        case("unlit, rich", Material { unlit: true, alpha: AlphaMode::Blend, ..rich() }, ggx()),
        case("mask", Material { alpha: AlphaMode::Mask(0.5), ..textured() }, options()),
        case("blend", Material { alpha: AlphaMode::Blend, ..textured() }, options()),
        case("glass", glass(), options()),
        case("glass, rich", Material { alpha: AlphaMode::Blend, ..glass_of(rich()) }, ggx()),
        case("double-sided", Material { double_sided: true, ..rich() }, options()),
        case("layers", layered(), VariantOptions { environment: true, ..options() }),
        case("layers without tangents", layered(), VariantOptions { tangents: false, ..ggx_smooth() }),
        case("hard normals", rich(), VariantOptions { softened: false, specular_aa: false, ..ggx() }),
        case("single scattering", rich(), VariantOptions { compensated: false, ..ggx() }),
        case("without uvs", rich(), VariantOptions { uv_sets: 0, ..ggx_smooth() }),
        case(
            "packed occlusion",
            Material {
                metallic_roughness_texture: Some(texture(0)),
                occlusion_texture: Some(texture(0)),
                ..Material::default()
            },
            ggx_smooth(),
        ),
    ]
}

fn ggx_smooth() -> VariantOptions {
    everything(Shading::Ggx, SurfaceMethod::Smooth)
}
