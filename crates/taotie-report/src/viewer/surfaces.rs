//! The surfaces of a model: the shader and the values for each reflectance model and surface method. Each variant of
//! a shader and each paragraph of source text is stored once.

use super::model::with_green_up;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};
use taotie_engine::names::Named;
use taotie_engine::render::{PRINTED_BUMP, Prepared, RenderSettings, Surface};
use taotie_engine::scene::{Material, NormalSpace, Scene, TextureRef, TextureRole};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_io::sampler_constants;
use taotie_shader::{
    Interface, Language, PixelShader, SurfaceFactors, Variant, VariantOptions, buffer_size, pixel_shader,
};

/// A surface in the form that the page draws.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct SurfaceData {
    /// The index of its material.
    material: usize,
    double_sided: bool,
    blended: bool,
    /// The index of the best method for its material, and for each method the index of the one actually drawn.
    best: usize,
    drawn: Vec<usize>,
    /// The columns of the matrix from object-space to world-space normals.
    normal_matrix: [[f32; 3]; 3],
    own: Dress,
    clay: Dress,
}

/// A surface with one material.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Dress {
    /// The shader indices: a row for each reflectance model, with an entry for each surface method.
    looks: Vec<Vec<usize>>,
    /// The values of the uniform block `material`, by field name.
    factors: BTreeMap<String, Vec<f32>>,
    /// The field `bump` of `bump-printed`.
    printed_bump: f32,
    /// The textures, by slot name.
    textures: BTreeMap<&'static str, TextureUse>,
}

/// A texture of the model and its sampler: WebGL constants for wrapping in u and v, magnification and minification.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct TextureUse {
    texture: usize,
    sampler: [u32; 4],
}

/// The inputs for drawing all surfaces.
pub(super) struct Drawing<'a> {
    pub prepared: &'a Prepared,
    pub settings: &'a RenderSettings,
    /// True if there is light from an environment.
    pub environment: bool,
    pub shaders: &'a mut Shaders,
}

impl Drawing<'_> {
    /// Returns the surfaces as data, in order, and writes their shaders.
    pub fn surfaces(&mut self) -> Vec<SurfaceData> {
        let prepared = self.prepared;
        let instances = prepared.scene().instances().iter();
        let surfaces = prepared.surfaces();
        surfaces.iter().zip(instances).map(|(surface, at)| self.surface(surface, at.material)).collect()
    }

    fn surface(&mut self, surface: &Surface<'_>, material: usize) -> SurfaceData {
        let own = with_green_up(surface.material);
        let methods = methods(surface);
        let best = surface.normal_source.method();
        SurfaceData {
            material,
            double_sided: own.double_sided,
            blended: own.is_blended(),
            best: SurfaceMethod::ALL.iter().position(|method| *method == best).unwrap_or(1),
            drawn: methods.iter().map(|method| number(*method)).collect(),
            normal_matrix: surface.normal_matrix.map(|column| column.to_array()),
            clay: self.dress(surface, &clay(&own), &methods),
            own: self.dress(surface, &own, &methods),
        }
    }

    fn dress(&mut self, surface: &Surface<'_>, material: &Material, methods: &[SurfaceMethod]) -> Dress {
        let base = VariantOptions::of_surface(surface, self.settings, self.environment);
        let bump = self.settings.surface.bump_scale;
        let mut dress = Dress {
            looks: Vec::new(),
            factors: BTreeMap::new(),
            printed_bump: bump.unwrap_or(PRINTED_BUMP),
            textures: BTreeMap::new(),
        };
        let factors = SurfaceFactors {
            material,
            normal_matrix: surface.normal_matrix,
            bump: bump.or(material.height.map(|map| map.scale)).unwrap_or_default(),
            height_levels: height_levels(material, self.prepared.scene()),
        };
        for (_, shading) in Shading::NAMES {
            let mut row = Vec::new();
            for method in methods {
                // The page computes the visibility of each light.
                let options =
                    VariantOptions { shading: *shading, method: *method, shadows: true, ..base.clone() };
                row.push(self.shaders.number(&Variant::new(material, &options)));
            }
            dress.looks.push(row);
        }
        for shader in dress.looks.concat() {
            dress.take(self.shaders.interface(shader), &factors);
        }
        dress
    }
}

impl Dress {
    /// Adds the values and textures read by a shader.
    fn take(&mut self, interface: &Interface, factors: &SurfaceFactors<'_>) {
        let bytes = interface.material_bytes(factors);
        for field in &interface.material {
            let words = bytes[field.offset..].as_chunks::<4>().0.iter().take(field.kind.numbers());
            let numbers = words.map(|word| f32::from_le_bytes(*word)).collect();
            self.factors.insert(field.name.clone(), numbers);
        }
        for slot in &interface.textures {
            let texture = TextureRole::named(slot.name).and_then(|role| role.of(factors.material));
            if let Some(texture) = texture {
                self.textures.insert(slot.name, TextureUse::new(texture));
            }
        }
    }
}

impl TextureUse {
    fn new(used: &TextureRef) -> Self {
        Self { texture: used.texture, sampler: sampler_constants(&used.sampler) }
    }
}

/// Returns the method drawn for each: smooth if the material lacks the required map, as in the renderer.
fn methods(surface: &Surface<'_>) -> Vec<SurfaceMethod> {
    let has_map = |space| surface.material.normal.is_some_and(|map| map.space == space);
    let has = |method| match method {
        SurfaceMethod::Facet | SurfaceMethod::Smooth => true,
        SurfaceMethod::Bump | SurfaceMethod::BumpPrinted => surface.material.height.is_some(),
        SurfaceMethod::ObjectNormal => has_map(NormalSpace::Object),
        SurfaceMethod::TangentNormal => has_map(NormalSpace::Tangent) && !surface.tangents.is_empty(),
    };
    let drawn = |method| if has(method) { method } else { SurfaceMethod::Smooth };
    SurfaceMethod::ALL.map(drawn).into()
}

/// Returns the index of a method among those of the command, which have the same order.
fn number(method: SurfaceMethod) -> usize {
    SurfaceMethod::ALL.iter().position(|known| *known == method).unwrap_or_default()
}

/// Returns the names of the methods, in order.
pub(super) fn method_names() -> Vec<&'static str> {
    SurfaceMethod::NAMES.iter().map(|(name, _)| *name).collect()
}

/// Returns the surface in matte grey: its relief without its colours.
fn clay(own: &Material) -> Material {
    Material {
        normal: own.normal,
        height: own.height,
        double_sided: own.double_sided,
        base_color: [0.5, 0.5, 0.5, 1.0],
        roughness: 0.8,
        ..Material::default()
    }
}

fn height_levels(material: &Material, scene: &Scene) -> usize {
    let texture = material.height.and_then(|map| scene.textures().get(map.texture.texture));
    texture.map_or(1, |texture| texture.levels())
}

/// The separator between the paragraphs of a shader's text.
const BETWEEN: &str = "\n\n";

/// The shaders of a page, with each variant and each paragraph of source text stored once.
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
    fn number(&mut self, variant: &Variant) -> usize {
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
    fn interface(&self, number: usize) -> &Interface {
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
