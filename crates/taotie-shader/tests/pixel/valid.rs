//! Whole shaders in WGSL are valid and translate to other languages.

use crate::variants::{Case, all};
use naga::back::{hlsl, msl, spv};
use naga::front::wgsl;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Module};
use taotie_shader::{Language, PixelShader, VariantOptions, pixel_shader};

fn validated(module: &Module, name: &str, text: &str) -> ModuleInfo {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator
        .validate(module)
        .unwrap_or_else(|error| panic!("{name}: {}\n{text}", error.emit_to_string(text)))
}

fn parsed(name: &str, text: &str) -> Module {
    wgsl::parse_str(text).unwrap_or_else(|error| panic!("{name}: {}\n{text}", error.emit_to_string(text)))
}

#[test]
fn wgsl_is_valid_and_becomes_hlsl_msl_and_spir_v() {
    for case in all() {
        let text = pixel_shader(&case.variant(), Language::Wgsl).text;
        let module = parsed(&case.name, &text);
        let info = validated(&module, &case.name, &text);
        let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions { entry_point: None });
        let mut written = String::new();
        let mut writer = hlsl::Writer::new(&mut written, &options, &pipeline);
        writer.write(&module, &info, None).unwrap_or_else(|error| panic!("{}: {error}", case.name));
        assert!(written.contains("fragment_main"), "{written}");
        let metal =
            msl::write_string(&module, &info, &msl::Options::default(), &msl::PipelineOptions::default());
        assert!(metal.expect("it translates to MSL").0.contains("fragment_main"), "{}", case.name);
        let words = spv::write_vec(&module, &info, &spv::Options::default(), None);
        assert_eq!(words.expect("it translates to SPIR-V")[0], 0x0723_0203, "SPIR-V's magic number");
    }
}

#[test]
fn a_host_can_add_shadows() {
    let mut case: Case = all().remove(1);
    case.options = VariantOptions { shadows: true, ..case.options };
    let text = pixel_shader(&case.variant(), Language::Wgsl).text;
    assert!(wgsl::parse_str(&text).is_err(), "`visibility` is missing");
    let host = "fn visibility(light: i32, position: vec3f, n: vec3f) -> f32 { return 0.5; }\n";
    let text = text + host;
    validated(&parsed(&case.name, &text), &case.name, &text);
}

/// The group, the binding and the name of everything that a module binds, in order.
fn bound(module: &Module) -> Vec<(u32, u32, String)> {
    let variables = module.global_variables.iter().filter_map(|(_, variable)| {
        let place = variable.binding?;
        Some((place.group, place.binding, variable.name.clone().unwrap_or_default()))
    });
    let mut all: Vec<_> = variables.collect();
    all.sort();
    all
}

/// The same for an interface.
fn specified(shader: &PixelShader) -> Vec<(u32, u32, String)> {
    let interface = &shader.interface;
    let buffers = interface.buffers.iter().map(|slot| (slot.group, slot.binding, slot.name.to_owned()));
    let textures = interface.textures.iter().map(|slot| (slot.group, slot.binding, slot.name.to_owned()));
    let samplers = interface
        .textures
        .iter()
        .filter_map(|slot| Some((slot.group, slot.sampler?, format!("{}_sampler", slot.name))));
    let mut all: Vec<_> = buffers.chain(textures).chain(samplers).collect();
    all.sort();
    all
}

#[test]
fn everything_is_bound_where_the_interface_says_and_read() {
    for case in all() {
        let shader = pixel_shader(&case.variant(), Language::Wgsl);
        let module = parsed(&case.name, &shader.text);
        assert_eq!(bound(&module), specified(&shader), "{}", case.name);
        let info = validated(&module, &case.name, &shader.text);
        let fragment = module.entry_points.iter().position(|entry| entry.name == "fragment_main");
        let uses = info.get_entry_point(fragment.expect("it exists"));
        for (handle, variable) in module.global_variables.iter() {
            let is_shared = matches!(variable.name.as_deref(), Some("frame"));
            assert!(is_shared || !uses[handle].is_empty(), "{}: {:?} is not read", case.name, variable.name);
        }
    }
}

/// The offsets of uniforms' fields as naga lays them out.
#[test]
fn fields_lie_where_the_interface_says() {
    for case in all() {
        let shader = pixel_shader(&case.variant(), Language::Wgsl);
        let module = parsed(&case.name, &shader.text);
        for (name, fields) in [("frame", &shader.interface.frame), ("material", &shader.interface.material)] {
            let found = module.global_variables.iter().find(|(_, variable)| {
                variable.name.as_deref() == Some(name) && variable.space == AddressSpace::Uniform
            });
            let (_, variable) = found.unwrap_or_else(|| panic!("{}: {name} is missing", case.name));
            let naga::TypeInner::Struct { members, span } = &module.types[variable.ty].inner else {
                panic!("{name} is not a structure")
            };
            let laid: Vec<(String, usize)> = members
                .iter()
                .map(|member| (member.name.clone().unwrap_or_default(), member.offset as usize))
                .collect();
            let specified: Vec<(String, usize)> =
                fields.iter().map(|field| (field.name.clone(), field.offset)).collect();
            assert_eq!(laid, specified, "{}: {name}", case.name);
            assert_eq!(*span as usize, taotie_shader::buffer_size(fields), "{}: {name}", case.name);
        }
    }
}
