//! The values of buffers, and the interface as JSON.

use crate::variants::{all, rich};
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{LightSource, Turn};
use taotie_engine::scene::{Falloff, Light, LightKind, Material, TextureRole};
use taotie_shader::{
    FrameFactors, Language, SurfaceFactors, UniformField, Variant, VariantOptions, light_numbers,
    pixel_shader,
};

fn numbers(bytes: &[u8], field: &UniformField) -> Vec<f32> {
    let own = &bytes[field.offset..field.offset + 4 * field.kind.numbers()];
    own.chunks(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect()
}

fn surface(material: &Material) -> SurfaceFactors<'_> {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::from_array);
    SurfaceFactors { material, normal_matrix: axes, bump: 0.25, height_levels: 9 }
}

#[test]
fn factors_are_those_of_the_material() {
    let (material, options) = (rich(), VariantOptions { uv_sets: 2, ..VariantOptions::default() });
    let interface = pixel_shader(&Variant::new(&material, &options), Language::Wgsl).interface;
    let bytes = interface.material_bytes(&surface(&material));
    let value = |name: &str| {
        let field = interface.material.iter().find(|field| field.name == name);
        numbers(&bytes, field.unwrap_or_else(|| panic!("{name} is missing")))
    };
    assert_eq!(value("base_color"), material.base_color[..3]);
    assert_eq!(value("roughness"), [material.roughness]);
    assert_eq!(value("sheen_color"), [0.3, 0.2, 0.5]);
    assert_eq!(value("clearcoat_normal_green"), [-1.0]);
    assert_eq!(value("metallic_roughness_texture_rows"), [2.0, 0.5, -0.25, 1.5]);
    assert_eq!(value("metallic_roughness_texture_offset"), [0.1, -0.3]);
}

#[test]
fn every_field_has_a_value_and_a_meaning() {
    for case in all() {
        let interface = pixel_shader(&case.variant(), Language::GlslEs).interface;
        let meanings = interface.material.iter().chain(&interface.frame).map(|field| field.meaning);
        let textures = interface.textures.iter().map(|slot| slot.meaning);
        assert!(meanings.chain(textures).all(|meaning| meaning.ends_with('.')), "{}", case.name);
        for slot in interface.textures.iter().filter(|slot| slot.group == 1) {
            let role = TextureRole::named(slot.name).expect("it is a texture role");
            assert!(role.of(&case.material).is_some(), "{}: {}", case.name, slot.name);
        }
    }
}

#[test]
fn frames_are_laid_out_as_told() {
    let frame = FrameFactors {
        clip_from_world: std::array::from_fn(|i| std::array::from_fn(|j| (4 * i + j) as f32)),
        eye: [1.0, 2.0, 3.0, 1.0],
        ambient: Vec3::new(0.1, 0.2, 0.3),
        spacing: 0.5,
        turn: Turn { sin: 0.6, cos: 0.8 },
        intensity: 2.0,
        levels: 31,
        smoothest_alpha: 0.004,
        lights: 3,
    };
    let variant = Variant::new(&Material::default(), &VariantOptions::default());
    let (bytes, interface) = (frame.bytes(), pixel_shader(&variant, Language::Wgsl).interface);
    let value = |name: &str| {
        let field = interface.frame.iter().find(|field| field.name == name);
        numbers(&bytes, field.expect("the field exists"))
    };
    assert_eq!(value("clip_from_world")[4..8], [4.0, 5.0, 6.0, 7.0]);
    assert_eq!(value("eye"), frame.eye);
    assert_eq!((value("spacing"), value("light_count")), (vec![0.5], vec![3.0]));
    assert_eq!((value("environment_sin"), value("environment_cos")), (vec![0.6], vec![0.8]));
}

#[test]
fn lights_have_sixteen_numbers() {
    let kind = LightKind::Directional { direction: Vec3::new(0.0, 0.0, -1.0) };
    let light = Light { name: String::new(), kind, color: Vec3::splat(2.0), falloff: Falloff::None };
    let numbers = light_numbers(&LightSource::new(&light));
    assert_eq!(numbers[..7], [0.0, 0.0, 1.0, 0.0, 2.0, 2.0, 2.0]);
    let kind = LightKind::Point { position: Vec3::new(1.0, 2.0, 3.0) };
    let light = Light { kind, falloff: Falloff::Windowed(7.0), ..light };
    let numbers = light_numbers(&LightSource::new(&light));
    assert_eq!((numbers[3], numbers[7], numbers[12]), (2.0, 7.0, -3.0));
}

#[test]
fn the_interface_is_json() {
    let variant = Variant::new(&rich(), &VariantOptions::default());
    let interface = pixel_shader(&variant, Language::Wgsl).interface;
    let json = serde_json::to_value(&interface).expect("it serialises");
    assert_eq!(json["frame"][0]["name"], "clip_from_world");
    assert_eq!(json["frame"][0]["kind"], "mat4");
    assert_eq!(json["textures"][0]["group"], 0);
}
