//! A whole pixel of a surface as a shader.

use crate::interface::Interface;
use crate::language::Language;
use crate::variant::Variant;

/// A whole pixel shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PixelShader {
    /// The text: in WGSL with `vertex_main` and `fragment_main`, in GLSL ES the fragment shader.
    pub text: String,
    /// The text of the vertex shader in GLSL ES; `None` in WGSL, where it stands in `text`.
    pub vertex_text: Option<String>,
    /// The inputs that its host binds.
    pub interface: Interface,
}

/// Writes the shader of a variant: linear RGB radiance and alpha of a pixel.
pub fn pixel_shader(variant: &Variant, language: Language) -> PixelShader {
    let _ = (variant, language);
    PixelShader {
        text: String::new(),
        vertex_text: None,
        interface: Interface {
            vertex: Vec::new(),
            frame: crate::frame::frame_fields(),
            material: Vec::new(),
            buffers: Vec::new(),
            textures: Vec::new(),
        },
    }
}
