//! Shaders translate to other languages, with the documented bindings.
#![cfg(feature = "translate")]

use taotie_engine::image::Sampler;
use taotie_engine::scene::{Material, TextureRef, UvTransform};
use taotie_shader::{
    Language, PixelShader, Translation, TranslationError, Variant, VariantOptions, pixel_shader, translate,
};

/// A surface with a texture and an environment.
fn shader(language: Language) -> PixelShader {
    let texture =
        TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let material = Material { base_color_texture: Some(texture), ..Material::default() };
    let options = VariantOptions { environment: true, ..VariantOptions::default() };
    pixel_shader(&Variant::new(&material, &options), language)
}

fn text(to: Translation) -> String {
    String::from_utf8(translate(&shader(Language::Wgsl), to).expect("it translates")).expect("it is UTF-8")
}

#[test]
fn hlsl_has_registers_and_spaces() {
    let text = text(Translation::Hlsl);
    for slot in shader(Language::Wgsl).interface.textures {
        // Space 0 is implicit.
        let space = if slot.group == 0 { String::new() } else { format!(", space{}", slot.group) };
        let place = format!(": register(t{}{space})", slot.binding);
        assert!(
            text.lines().any(|line| line.contains(slot.name) && line.contains(&place)),
            "{place}: {text}"
        );
    }
}

#[test]
fn metal_numbers_things_by_their_places_in_the_interface() {
    let text = text(Translation::Msl);
    let interface = shader(Language::Wgsl).interface;
    for (number, slot) in interface.textures.iter().enumerate() {
        let place = format!("{} [[texture({number})]]", slot.name);
        assert!(text.contains(&place), "{place}: {text}");
        let sampler = format!("{}_sampler [[sampler({number})]]", slot.name);
        assert_eq!(text.contains(&sampler), slot.sampler.is_some(), "{sampler}: {text}");
    }
    for (number, slot) in interface.buffers.iter().enumerate() {
        let place = format!("{} [[buffer({number})]]", slot.name);
        assert!(text.contains(&place), "{place}: {text}");
    }
}

#[test]
fn spir_v_holds_both_entry_points() {
    let bytes = translate(&shader(Language::Wgsl), Translation::SpirV).expect("it translates");
    let has = |name: &str| bytes.windows(name.len()).any(|window| window == name.as_bytes());
    assert!(bytes.len().is_multiple_of(4) && has("vertex_main") && has("fragment_main"));
}

#[test]
fn what_is_not_wgsl_is_refused() {
    let refused = translate(&shader(Language::GlslEs), Translation::Hlsl);
    assert!(matches!(refused, Err(TranslationError::Invalid(_))), "{refused:?}");
}
