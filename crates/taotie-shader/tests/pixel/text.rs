//! The text is readable and contains exactly what its variant needs.

use crate::bodies::bodies;
use crate::variants::{all, everything, layered, mapped, texture};
use taotie_engine::scene::Material;
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{Language, Variant, VariantOptions, pixel_shader};

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
    let of_environments =
        ["environment_maps", "environment_picture", "environment_levels:", "reflect_environment"];
    let others = ["distribution_", "albedo_tables", "coat", "sheen", "fn power("];
    // The frame is the same in all shaders, with the number of environment levels.
    let lines = || text.lines().filter(|line| *line != "    environment_levels: f32,");
    for absent in of_environments.into_iter().chain(others) {
        assert_eq!(lines().find(|line| line.contains(absent)), None, "{absent}: {text}");
    }
    let ggx = everything(Shading::Ggx, SurfaceMethod::TangentNormal);
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
    let options = everything(Shading::Ggx, SurfaceMethod::TangentNormal);
    let variant = Variant::new(&mapped(options.method, layered()), &options);
    let count = |language| {
        let shader = pixel_shader(&variant, language);
        bodies(&shader.text).len()
    };
    // WGSL contains its vertex shader too.
    assert_eq!(count(Language::Wgsl), count(Language::GlslEs) + 1);
}
