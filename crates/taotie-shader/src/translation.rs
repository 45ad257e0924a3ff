//! Translation of WGSL shaders to other languages, by naga.

use crate::interface::Interface;
use crate::pixel_shader::PixelShader;
use naga::back::{hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ResourceBinding};

/// A target language for WGSL shaders. Each output has both `vertex_main` and `fragment_main`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Translation {
    /// HLSL, shader model 5.1. A resource of group g and binding b is register b of space g; samplers come from the
    /// heap `nagaSamplerHeap`, indexed through a buffer per group.
    Hlsl,
    /// MSL 2.0. Buffers, textures and samplers are numbered by their positions in [`Interface::buffers`] and
    /// [`Interface::textures`]; a sampler has the number of its texture. If the shader reads `lights`, the buffer
    /// after the last holds its size in bytes as a 32-bit integer.
    Msl,
    /// SPIR-V 1.0. A resource of group g and binding b is binding b of descriptor set g.
    SpirV,
}

/// The error returned when a text cannot be translated.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TranslationError {
    /// The text is not valid WGSL; holds the reason.
    #[error("the shader is not valid WGSL: {0}")]
    Invalid(String),
    /// The target language cannot express the shader; holds the reason.
    #[error("the shader cannot be translated: {0}")]
    Untranslatable(String),
}

/// Translates a WGSL shader. SPIR-V is returned as words in little-endian order.
///
/// ```
/// use taotie_engine::scene::Material;
/// use taotie_shader::{Language, Translation, Variant, VariantOptions, pixel_shader, translate};
///
/// let variant = Variant::new(&Material::default(), &VariantOptions::default());
/// let spirv = translate(&pixel_shader(&variant, Language::Wgsl), Translation::SpirV)?;
/// assert_eq!(spirv[..4], 0x0723_0203_u32.to_le_bytes());
/// # Ok::<(), taotie_shader::TranslationError>(())
/// ```
///
/// # Errors
/// [`TranslationError::Invalid`] if the text is not valid WGSL (GLSL ES, say); [`TranslationError::Untranslatable`]
/// if the language lacks a feature.
pub fn translate(shader: &PixelShader, to: Translation) -> Result<Vec<u8>, TranslationError> {
    let module = naga::front::wgsl::parse_str(&shader.text)
        .map_err(|error| TranslationError::Invalid(error.emit_to_string(&shader.text)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .map_err(|error| TranslationError::Invalid(error.emit_to_string(&shader.text)))?;
    match to {
        Translation::Hlsl => hlsl_text(&module, &info).map(String::into_bytes),
        Translation::Msl => msl_text(&module, &info, &shader.interface).map(String::into_bytes),
        Translation::SpirV => spirv(&module, &info),
    }
}

fn untranslatable(error: impl std::fmt::Display) -> TranslationError {
    TranslationError::Untranslatable(error.to_string())
}

fn hlsl_text(module: &Module, info: &ModuleInfo) -> Result<String, TranslationError> {
    let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions { entry_point: None });
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(module, info, None).map_err(untranslatable)?;
    Ok(text)
}

fn msl_text(module: &Module, info: &ModuleInfo, interface: &Interface) -> Result<String, TranslationError> {
    let resources = metal_resources(interface);
    let entries = ["vertex_main", "fragment_main"].map(|entry| (entry.to_owned(), resources.clone()));
    let options = msl::Options {
        lang_version: (2, 0),
        per_entry_point_map: entries.into_iter().collect(),
        fake_missing_bindings: false,
        ..msl::Options::default()
    };
    let (text, translated) = msl::write_string(module, info, &options, &msl::PipelineOptions::default())
        .map_err(untranslatable)?;
    // The writer continues even if an entry point cannot be written.
    for name in translated.entry_point_names {
        name.map_err(untranslatable)?;
    }
    Ok(text)
}

/// The numbering of Metal bindings.
fn metal_resources(interface: &Interface) -> msl::EntryPointResources {
    let place = |group, binding| ResourceBinding { group, binding };
    let buffers = interface.buffers.iter().zip(0..).map(|(slot, number)| {
        let target = msl::BindTarget { buffer: Some(number), ..msl::BindTarget::default() };
        (place(slot.group, slot.binding), target)
    });
    let textures = interface.textures.iter().zip(0..).map(|(slot, number)| {
        let target = msl::BindTarget { texture: Some(number), ..msl::BindTarget::default() };
        (place(slot.group, slot.binding), target)
    });
    let samplers = interface.textures.iter().zip(0..).filter_map(|(slot, number)| {
        let sampler = Some(msl::BindSamplerTarget::Resource(number));
        Some((place(slot.group, slot.sampler?), msl::BindTarget { sampler, ..msl::BindTarget::default() }))
    });
    msl::EntryPointResources {
        resources: buffers.chain(textures).chain(samplers).collect(),
        sizes_buffer: u8::try_from(interface.buffers.len()).ok(),
        ..msl::EntryPointResources::default()
    }
}

fn spirv(module: &Module, info: &ModuleInfo) -> Result<Vec<u8>, TranslationError> {
    let words = spv::write_vec(module, info, &spv::Options::default(), None).map_err(untranslatable)?;
    Ok(words.into_iter().flat_map(u32::to_le_bytes).collect())
}
