//! The facts known of a surface before any pixel: which parts of the pixel program it needs.

use crate::role::TextureRole;
use std::collections::BTreeMap;
use taotie::pixel::{Model, takes_compensation, takes_roughness};
use taotie::scene::{AlphaMode, Material, TextureRef, UvTransform};
use taotie::shade::Shading;

/// The facts known of a surface before any pixel.
///
/// Two surfaces of one variant are drawn by one shader; all else is in its uniforms and textures.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Variant {
    pub(crate) shading: Shading,
    pub(crate) method: NormalMethod,
    pub(crate) authored: Authored,
    pub(crate) layers: Layers,
    pub(crate) textures: BTreeMap<TextureRole, Placement>,
    pub(crate) alpha: Alpha,
    pub(crate) unlit: bool,
    /// Says whether occlusion is the red of the metallic-roughness texture.
    pub(crate) packed_occlusion: bool,
    pub(crate) vertex_color: bool,
    pub(crate) tangents: bool,
    /// Says whether the normal turns with the side that is seen.
    pub(crate) turns: bool,
    pub(crate) compensated: bool,
    pub(crate) softened: bool,
    pub(crate) specular_aa: bool,
    /// Says whether detail too fine for the pixel widens the roughness.
    pub(crate) widens: bool,
    pub(crate) environment: bool,
    pub(crate) shadows: bool,
}

/// The source of shading normals: `taotie::render`'s surface method, as far as the material has what it needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub enum NormalMethod {
    /// The triangle's own normal.
    Facet,
    /// The interpolated normal.
    #[default]
    Smooth,
    /// A height map.
    Bump,
    /// A height map as Guo and Wang 2025 print it; the vertices' normals are in object space.
    BumpPrinted,
    /// A normal map in object space.
    ObjectMap,
    /// A normal map in tangent space.
    TangentMap,
}

impl NormalMethod {
    /// All methods.
    pub const ALL: [Self; 6] =
        [Self::Facet, Self::Smooth, Self::Bump, Self::BumpPrinted, Self::ObjectMap, Self::TangentMap];

    /// Says whether an image turns the normals, and not as printed.
    fn is_mapped(self) -> bool {
        matches!(self, Self::Bump | Self::ObjectMap | Self::TangentMap)
    }
}

/// The choices that a [`Variant`] is made by, beside the material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VariantOptions {
    /// The reflectance model.
    pub shading: Shading,
    /// The source of shading normals.
    pub method: NormalMethod,
    /// `true` where light that scatters several times is added, for models that have a form of it.
    pub compensated: bool,
    /// `true` where mapped normals at grazing angles are softened. Models as printed never are.
    pub softened: bool,
    /// `true` where relief too fine for the pixel widens the highlight. Models as printed never do.
    pub specular_aa: bool,
    /// `true` where an environment sends light.
    pub environment: bool,
    /// `true` where every surface turns its normal to the side that is seen, double-sided or not.
    pub both_sides: bool,
    /// `true` where the shader multiplies each light by the host's function `visibility`.
    pub shadows: bool,
    /// `true` where the mesh has vertex colours.
    pub vertex_color: bool,
    /// `true` where the vertices have tangents.
    pub tangents: bool,
    /// The number of the mesh's uv sets; what asks for another reads the texel at the origin.
    pub uv_sets: usize,
}

impl Default for VariantOptions {
    /// The choices that `taotie render` makes of itself, with one uv set and tangents, and without environment.
    fn default() -> Self {
        Self {
            shading: Shading::Ggx,
            method: NormalMethod::Smooth,
            compensated: true,
            softened: true,
            specular_aa: true,
            environment: false,
            both_sides: false,
            shadows: false,
            vertex_color: false,
            tangents: true,
            uv_sets: 1,
        }
    }
}

/// The parameters that are authored and do not follow from the metallic-roughness values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Authored {
    pub f0: bool,
    pub f82: bool,
    pub ambient: bool,
    pub diffuse: bool,
    pub specular: bool,
    pub slope: bool,
    pub shininess: bool,
}

/// The layers of the material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Layers {
    /// Says whether the model takes layers and the material has any.
    pub taken: bool,
    pub clearcoat: bool,
    pub sheen: bool,
    pub anisotropy: bool,
}

/// The treatment of alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Alpha {
    Opaque,
    Mask,
    Blend,
}

/// The place of a texture on a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Placement {
    /// The uv set; `None` where the mesh has no such set.
    pub uv_set: Option<usize>,
    /// Says whether the uv is transformed.
    pub transformed: bool,
}

impl Variant {
    /// The variant of a material under some options.
    pub fn new(material: &Material, options: &VariantOptions) -> Self {
        let (shading, method) = (options.shading, options.method);
        let corrected = !shading.is_printed();
        let model = Model::new(shading, material);
        Self {
            shading,
            method,
            authored: Authored::new(material),
            layers: Layers {
                taken: model.layered,
                clearcoat: material.clearcoat.is_some(),
                sheen: material.sheen.is_some(),
                anisotropy: material.anisotropy.is_some(),
            },
            textures: placements(material, options),
            alpha: match material.alpha {
                AlphaMode::Opaque => Alpha::Opaque,
                AlphaMode::Mask(_) => Alpha::Mask,
                AlphaMode::Blend => Alpha::Blend,
            },
            unlit: material.unlit,
            packed_occlusion: has_packed_occlusion(material),
            vertex_color: options.vertex_color,
            tangents: options.tangents,
            turns: material.double_sided || options.both_sides,
            compensated: options.compensated && takes_compensation(shading),
            softened: options.softened && corrected && method.is_mapped(),
            specular_aa: options.specular_aa && corrected,
            widens: options.environment || takes_roughness(shading, material),
            environment: options.environment,
            shadows: options.shadows,
        }
    }

    /// The reflectance model.
    pub fn shading(&self) -> Shading {
        self.shading
    }

    /// The source of shading normals.
    pub fn method(&self) -> NormalMethod {
        self.method
    }

    /// Says whether base colour varies over the surface.
    pub(crate) fn is_tinted(&self) -> bool {
        self.vertex_color || self.textures.contains_key(&TextureRole::BaseColor)
    }

    /// Says whether anything is occluded.
    pub(crate) fn is_occluded(&self) -> bool {
        self.packed_occlusion || self.textures.contains_key(&TextureRole::Occlusion)
    }

    /// Says whether the curvature of the surface within a pixel counts.
    pub(crate) fn has_curvature(&self) -> bool {
        self.specular_aa && self.method != NormalMethod::Facet
    }

    /// Says whether anything hides within a pixel.
    pub(crate) fn has_variance(&self) -> bool {
        self.has_curvature() || self.has_normal_variance()
    }

    /// Says whether the variance of the normal map counts.
    pub(crate) fn has_normal_variance(&self) -> bool {
        self.specular_aa && self.textures.contains_key(&TextureRole::Normal)
    }

    /// The place of a texture, where the material has it.
    pub(crate) fn texture(&self, role: TextureRole) -> Option<Placement> {
        self.textures.get(&role).copied()
    }
}

impl Authored {
    fn new(material: &Material) -> Self {
        let classic = &material.classic;
        Self {
            f0: material.f0.is_some(),
            f82: material.f82.is_some(),
            ambient: classic.ambient.is_some(),
            diffuse: classic.diffuse.is_some(),
            specular: classic.specular.is_some(),
            slope: classic.slope.is_some(),
            shininess: classic.shininess.is_some(),
        }
    }
}

/// Says whether occlusion lies in the red channel of the metallic-roughness texture.
fn has_packed_occlusion(material: &Material) -> bool {
    material.occlusion_texture.is_some() && material.occlusion_texture == material.metallic_roughness_texture
}

/// The textures that a surface may read, and how they lie on it.
fn placements(material: &Material, options: &VariantOptions) -> BTreeMap<TextureRole, Placement> {
    let placed = |role: TextureRole| {
        let texture = role.of(material).filter(|_| is_read(role, material, options))?;
        Some((role, Placement::new(texture, options.uv_sets)))
    };
    TextureRole::ALL.into_iter().filter_map(placed).collect()
}

/// Says whether the method, and what the mesh has, let a texture be read.
fn is_read(role: TextureRole, material: &Material, options: &VariantOptions) -> bool {
    match role {
        TextureRole::Normal => matches!(options.method, NormalMethod::ObjectMap | NormalMethod::TangentMap),
        TextureRole::Height => matches!(options.method, NormalMethod::Bump | NormalMethod::BumpPrinted),
        TextureRole::Occlusion => !has_packed_occlusion(material),
        _ => true,
    }
}

impl Placement {
    fn new(texture: &TextureRef, uv_sets: usize) -> Self {
        let uv_set = Some(texture.uv_set).filter(|set| *set < uv_sets);
        Self { uv_set, transformed: texture.transform != UvTransform::default() }
    }
}
