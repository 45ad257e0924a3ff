//! The text can be read, and holds what its variant needs and no more.

use crate::variants::{all, everything, layered, mapped, texture};
use taotie::scene::Material;
use taotie::shade::Shading;
use taotie_shader::{Language, NormalMethod, Variant, VariantOptions, pixel_shader};

/// The lines of each function between its braces.
fn bodies(text: &str) -> Vec<Vec<&str>> {
    let lines: Vec<&str> = text.lines().collect();
    let functions = lines.split(|line| *line == "}" || *line == "};");
    let inside = functions.filter_map(|lines| {
        let opening = lines.iter().position(|line| line.ends_with(") {") || line.contains(") -> "))?;
        Some(lines[opening + 1..].to_vec())
    });
    inside.collect()
}

#[test]
fn shaders_can_be_read() {
    for case in all() {
        for language in [Language::Wgsl, Language::GlslEs] {
            let text = pixel_shader(&case.variant(), language).text;
            for body in bodies(&text) {
                assert!((1..=45).contains(&body.len()), "{}: {} lines: {body:#?}", case.name, body.len());
                let widest = body.iter().map(|line| line.len()).max().unwrap_or_default();
                assert!(widest <= 170, "{}: {widest} {body:#?}", case.name);
            }
            assert!(!text.contains("inf\n") && !text.contains("NaN"), "{text}");
        }
    }
}

#[test]
fn a_shader_holds_what_its_variant_needs_and_no_more() {
    let lambert = VariantOptions { shading: Shading::Lambert, ..VariantOptions::default() };
    let text = pixel_shader(&Variant::new(&Material::default(), &lambert), Language::Wgsl).text;
    for absent in ["distribution_", "albedo_tables", "environment_", "coat", "sheen", "fn power("] {
        let found = text.lines().find(|line| line.contains(absent) && !line.contains("environment_"));
        assert_eq!(found, None, "{absent}: {text}");
    }
    let ggx = everything(Shading::Ggx, NormalMethod::TangentMap);
    let text = pixel_shader(&Variant::new(&mapped(ggx.method, layered()), &ggx), Language::Wgsl).text;
    for part in ["distribution_ggx(", "anisotropic_lobe(", "coat_lobe(", "angles(", "distribution_charlie("] {
        assert!(text.matches(part).count() > 1, "{part} is called: {text}");
    }
}

#[test]
fn textures_that_lie_alike_share_their_coordinates() {
    let material = Material {
        base_color_texture: Some(texture(0)),
        metallic_roughness_texture: Some(texture(0)),
        ..Material::default()
    };
    let text = pixel_shader(&Variant::new(&material, &VariantOptions::default()), Language::Wgsl).text;
    assert_eq!(text.matches("= coordinates(i.uv0)").count(), 1, "{text}");
    assert!(!text.contains("_rows"), "{text}");
}

#[test]
fn functions_are_those_of_the_formulas_in_both_languages() {
    let options = everything(Shading::Ggx, NormalMethod::TangentMap);
    let variant = Variant::new(&mapped(options.method, layered()), &options);
    let count = |language| {
        let shader = pixel_shader(&variant, language);
        bodies(&shader.text).len()
    };
    // WGSL has its vertex shader beside them.
    assert_eq!(count(Language::Wgsl), count(Language::GlslEs) + 1);
}
