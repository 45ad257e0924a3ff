//! Generated shaders are valid, translate to other languages, and are readable.

#[path = "shared/bodies.rs"]
mod bodies;

use bodies::bodies;
use naga::back::{hlsl, msl, spv};
use naga::front::{glsl, wgsl};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use taotie_engine::names::Named;
use taotie_engine::shade::Shading;
use taotie_shader::{Language, functions, library, shader};

const WGSL_HOST: &str = "
@group(0) @binding(0) var<uniform> sample_here: MaterialSample;

@fragment
fn main(@location(0) n: vec3f, @location(1) v: vec3f, @location(2) l: vec3f) -> @location(0) vec4f {
    return vec4f(shade(sample_here, normalize(n), normalize(v), normalize(l)), 1.0);
}
";

const GLSL_HOST: &str = "
layout(location = 0) in vec3 n;
layout(location = 1) in vec3 v;
layout(location = 2) in vec3 l;
layout(location = 0) out vec4 color;

void main() {
    vec3 grey = vec3(0.5);
    MaterialSample s = MaterialSample(grey, n.x, n.y, grey, 1.0, grey, grey, grey, 20.0, 0.3);
    color = vec4(shade(s, normalize(n), normalize(v), normalize(l)), 1.0);
}
";

fn shadings() -> impl Iterator<Item = Shading> {
    Shading::NAMES.iter().map(|(_, shading)| *shading)
}

fn validated(module: &Module, text: &str) -> ModuleInfo {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(module).unwrap_or_else(|error| panic!("{error:?} in\n{text}"))
}

fn parsed(shading: Shading) -> (String, Module) {
    let text = shader(shading, Language::Wgsl) + WGSL_HOST;
    let module = wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}\n{text}", e.emit_to_string(&text)));
    (text, module)
}

#[test]
fn wgsl_is_valid_and_becomes_hlsl_msl_and_spir_v() {
    for shading in shadings() {
        let (text, module) = parsed(shading);
        let info = validated(&module, &text);
        let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions { entry_point: None });
        let mut written = String::new();
        let mut writer = hlsl::Writer::new(&mut written, &options, &pipeline);
        writer.write(&module, &info, None).expect("it translates to HLSL");
        assert!(written.contains("reflect_"), "{written}");
        let metal =
            msl::write_string(&module, &info, &msl::Options::default(), &msl::PipelineOptions::default());
        assert!(metal.expect("it translates to MSL").0.contains("reflect_"));
        let words =
            spv::write_vec(&module, &info, &spv::Options::default(), None).expect("it translates to SPIR-V");
        assert_eq!(words[0], 0x0723_0203, "SPIR-V's mark");
    }
}

/// naga reads only desktop GLSL, which contains GLSL ES 3.00 as far as these functions are concerned.
#[test]
fn glsl_is_valid() {
    for shading in shadings() {
        let text = format!("#version 450\n{}{GLSL_HOST}", shader(shading, Language::GlslEs));
        let options = glsl::Options::from(ShaderStage::Fragment);
        let module = glsl::Frontend::default().parse(&options, &text);
        let module = module.unwrap_or_else(|errors| panic!("{}\n{text}", errors.emit_to_string(&text)));
        validated(&module, &text);
    }
}

#[test]
fn all_functions_of_the_library_are_valid_side_by_side() {
    let program = library();
    let names: Vec<&str> = program.formulas().iter().map(|formula| formula.name.as_str()).collect();
    let text = functions(&names, Language::Wgsl);
    let module = wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}\n{text}", e.emit_to_string(&text)));
    validated(&module, &text);
    assert!(module.functions.len() >= names.len(), "{} functions", module.functions.len());
    let text = format!("#version 450\n{}\nvoid main() {{}}\n", functions(&names, Language::GlslEs));
    let module = glsl::Frontend::default().parse(&glsl::Options::from(ShaderStage::Fragment), &text);
    let module = module.unwrap_or_else(|errors| panic!("{}\n{text}", errors.emit_to_string(&text)));
    validated(&module, &text);
}

#[test]
fn shaders_can_be_read() {
    for shading in shadings() {
        for language in [Language::Wgsl, Language::GlslEs] {
            let text = shader(shading, language);
            for body in bodies(&text) {
                assert!((1..=20).contains(&body.len()), "{} lines: {body:#?}", body.len());
                let returns = body.iter().filter(|line| line.starts_with("    return ")).count();
                assert!(returns == 1 && body.iter().all(|line| line.len() <= 160), "{body:#?}");
            }
            assert!(text.contains("struct MaterialSample {") && text.contains("Source: "), "{text}");
            assert!(!text.contains("inf") && !text.contains("NaN"), "{text}");
        }
    }
}

#[test]
fn the_distribution_of_ggx_reads_like_the_formula() {
    let text = shader(Shading::Ggx, Language::Wgsl);
    let expected = "// Source: Walter et al. 2007, eq. 33.
fn distribution_ggx(n_dot_h: f32, sin2_h: f32, alpha: f32) -> f32 {
    let alpha_squared = alpha * alpha;
    let sum = n_dot_h * n_dot_h * alpha_squared + sin2_h;
    return alpha_squared / (sum * sum * 3.1415927);
}
";
    assert!(text.contains(expected), "{text}");
    let text = shader(Shading::Ggx, Language::GlslEs);
    let expected = "float distribution_ggx(float n_dot_h, float sin2_h, float alpha) {
    float alpha_squared = alpha * alpha;
    float sum = n_dot_h * n_dot_h * alpha_squared + sin2_h;
    return alpha_squared / (sum * sum * 3.1415927);
}
";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn a_model_reads_like_its_definition() {
    let text = shader(Shading::Ggx, Language::Wgsl);
    let expected = "fn reflect_ggx(s: MaterialSample, a: Angles) -> vec3f {
    let f = fresnel(s.f0, s.f90, s.f82_drop, a.v_dot_h);
    let alpha = alpha_from_roughness(s.roughness);
    let d = distribution_ggx(a.n_dot_h, a.sin2_h, alpha);
    let v = visibility_smith_ggx(a.n_dot_l, a.n_dot_v, alpha);
    let sum = (1.0 - f) * (s.base_color * ((1.0 - s.metallic) * 0.31830987)) + f * (d * v);
    return select(vec3f(0.0), sum * a.n_dot_l, 0.0 < a.n_dot_l);
}
";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn channels_stay_together() {
    let text = functions(&["compensation"], Language::Wgsl);
    assert!(text.contains("max(max(product.x, product.y), product.z)"), "{text}");
    assert!(!text.contains("f0.x") && text.contains(") -> Compensation {"), "{text}");
}

#[test]
fn a_shader_holds_what_its_model_needs_and_no_more() {
    let text = shader(Shading::Lambert, Language::Wgsl);
    assert!(text.contains("fn angles(") && text.contains("fn reflect_lambert("), "{text}");
    assert!(!text.contains("distribution_") && !text.contains("fn power("), "{text}");
    assert!(shader(Shading::Phong, Language::Wgsl).contains("fn power("));
    let text = shader(Shading::CookTorrance, Language::Wgsl);
    for part in ["distribution_beckmann", "masking_v_cavity", "fresnel", "pow5"] {
        assert_eq!(text.matches(&format!("fn {part}(")).count(), 1, "{part}: {text}");
        assert!(text.matches(&format!("{part}(")).count() > 1, "{part} is called: {text}");
    }
}

/// The fields of all structures of a GLSL text, each with the line before it.
fn fields(text: &str) -> Vec<[&str; 2]> {
    let lines: Vec<&str> = text.lines().collect();
    let structures = lines.split(|line| *line == "};").filter_map(|lines| {
        let opening = lines.iter().rposition(|line| line.starts_with("struct "))?;
        Some(lines[opening..].windows(2).filter(|pair| pair[1].ends_with(';')))
    });
    structures.flatten().map(|pair| [pair[0], pair[1]]).collect()
}

#[test]
fn fields_of_structures_are_documented() {
    let program = library();
    let names: Vec<&str> = program.formulas().iter().map(|formula| formula.name.as_str()).collect();
    let text = functions(&names, Language::GlslEs);
    let fields = fields(&text);
    // MaterialSample, Angles, Compensation, Dfg, EnvironmentWeights.
    assert_eq!(fields.len(), 10 + 6 + 2 + 4 + 2, "{fields:#?}");
    for [doc, field] in fields {
        assert!(doc.starts_with("    // ") && doc.len() > 8, "{field}: {doc}");
    }
}
