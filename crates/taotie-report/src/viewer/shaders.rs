//! The shaders of a page, with each variant and each paragraph of source text stored once.

use serde::Serialize;
use std::collections::HashMap;
use taotie_shader::{Interface, Language, PixelShader, Variant, buffer_size, pixel_shader};

/// The separator between the paragraphs of a shader's text.
const BETWEEN: &str = "\n\n";

/// The shaders of a page.
#[derive(Default)]
pub(super) struct Shaders {
    known: HashMap<Variant, usize>,
    numbers: HashMap<String, usize>,
    pieces: Vec<String>,
    written: Vec<WrittenShader>,
    interfaces: Vec<Interface>,
}

/// The texts of all shaders: paragraphs, and shaders as lists of paragraphs.
#[derive(Serialize)]
pub(super) struct Texts {
    pieces: Vec<String>,
    shaders: Vec<WrittenShader>,
}

/// A shader in the form that the page binds.
#[derive(Serialize)]
struct WrittenShader {
    fragment: Vec<usize>,
    vertex: Vec<usize>,
    /// The names of the vertex inputs.
    inputs: Vec<String>,
    /// The uniform blocks: the names of the variable and of the block.
    blocks: Vec<[&'static str; 2]>,
    textures: Vec<&'static str>,
}

/// A field of the block `frame` and its byte offset.
#[derive(Serialize)]
struct Field(String, usize);

/// The fields of the block `frame`, and its size in bytes.
#[derive(Serialize)]
pub(super) struct FrameLayout {
    fields: Vec<Field>,
    bytes: usize,
}

impl Shaders {
    /// Returns the index of a variant's shader, writing the shader if it is new.
    pub fn number(&mut self, variant: &Variant) -> usize {
        if let Some(number) = self.known.get(variant) {
            return *number;
        }
        let shader = pixel_shader(variant, Language::GlslEs);
        let written = self.written(&shader);
        self.written.push(written);
        self.interfaces.push(shader.interface);
        self.known.insert(variant.clone(), self.written.len() - 1);
        self.written.len() - 1
    }

    /// Returns the interface of the shader with this index.
    pub fn interface(&self, number: usize) -> &Interface {
        &self.interfaces[number]
    }

    /// Returns the layout of the block `frame`, which all shaders share; `None` if there is no shader.
    pub fn frame(&self) -> Option<FrameLayout> {
        let frame = &self.interfaces.first()?.frame;
        let fields = frame.iter().map(|field| Field(field.name.clone(), field.offset)).collect();
        Some(FrameLayout { fields, bytes: buffer_size(frame) })
    }

    /// Returns the texts of all shaders.
    pub fn texts(self) -> Texts {
        Texts { pieces: self.pieces, shaders: self.written }
    }

    fn written(&mut self, shader: &PixelShader) -> WrittenShader {
        let interface = &shader.interface;
        WrittenShader {
            fragment: self.cut(&shader.text),
            vertex: self.cut(shader.vertex_text.as_deref().unwrap_or_default()),
            inputs: interface.vertex.iter().map(|input| input.name.clone()).collect(),
            blocks: interface.buffers.iter().map(|buffer| [buffer.name, buffer.block]).collect(),
            textures: interface.textures.iter().map(|slot| slot.name).collect(),
        }
    }

    /// Returns the indices of a text's paragraphs.
    fn cut(&mut self, text: &str) -> Vec<usize> {
        text.split(BETWEEN).map(|piece| self.piece(piece)).collect()
    }

    fn piece(&mut self, text: &str) -> usize {
        if let Some(number) = self.numbers.get(text) {
            return *number;
        }
        self.pieces.push(text.into());
        self.numbers.insert(text.into(), self.pieces.len() - 1);
        self.pieces.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::names::Named;
    use taotie_engine::scene::Material;
    use taotie_engine::shade::Shading;
    use taotie_shader::VariantOptions;

    fn variant(shading: Shading) -> Variant {
        Variant::new(&Material::default(), &VariantOptions { shading, ..VariantOptions::default() })
    }

    #[test]
    fn texts_are_restored_and_share_their_paragraphs() {
        let mut shaders = Shaders::default();
        let all: Vec<Variant> = Shading::NAMES.iter().map(|(_, shading)| variant(*shading)).collect();
        let numbers: Vec<usize> = all.iter().map(|variant| shaders.number(variant)).collect();
        assert_eq!(numbers, (0..all.len()).collect::<Vec<_>>());
        assert_eq!(shaders.number(&all[3]), 3, "a variant is written once");
        let texts = shaders.texts();
        let mut bytes = 0;
        for (variant, shader) in all.iter().zip(&texts.shaders) {
            let expected = pixel_shader(variant, Language::GlslEs);
            let joined = |list: &[usize]| {
                list.iter().map(|piece| texts.pieces[*piece].as_str()).collect::<Vec<_>>().join(BETWEEN)
            };
            assert_eq!(joined(&shader.fragment), expected.text);
            assert_eq!(Some(joined(&shader.vertex)), expected.vertex_text);
            bytes += expected.text.len();
        }
        let kept: usize = texts.pieces.iter().map(String::len).sum();
        assert!(3 * kept < bytes, "{kept} of {bytes} bytes");
    }
}
