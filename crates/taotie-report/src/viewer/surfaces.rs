//! The surfaces of a model: the shader and the values for each reflectance model and surface method.

use super::asset::with_green_up;
use super::shaders::Shaders;
use serde::Serialize;
use std::collections::BTreeMap;
use taotie_engine::names::Named;
use taotie_engine::render::{PRINTED_BUMP, Prepared, RenderSettings, Surface};
use taotie_engine::scene::{AlphaMode, Material, NormalSpace, Scene, TextureRef, TextureRole};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{Interface, SurfaceFactors, Variant, VariantOptions};

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
            blended: matches!(own.alpha, AlphaMode::Blend),
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
        Self { texture: used.texture, sampler: super::textures::sampler(&used.sampler) }
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
