//! The factors of a surface: the fields of its uniform buffer, and their values.

use crate::interface::{Interface, UniformField, Unplaced, ValueKind, buffer_size};
use taotie_engine::math::Vec3;
use taotie_engine::pixel::{MaterialUniforms, Texel, own_turn};
use taotie_engine::render::Surface;
use taotie_engine::scene::{AlphaMode, HeightMap, Material, NormalMap, Scene, TextureRole};

/// A surface as its host knows it: the source of its uniform values.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceFactors<'m> {
    /// The material.
    pub material: &'m Material,
    /// The columns of the matrix that transforms object-space normals to world space.
    pub normal_matrix: [Vec3; 3],
    /// For `Bump` the height of 1 in model units, for `BumpPrinted` the paper's factor; otherwise unused.
    pub bump: f32,
    /// The number of levels of the height map, at least 1; unused without one.
    pub height_levels: usize,
}

impl<'s> SurfaceFactors<'s> {
    /// The factors of a surface of a scene.
    pub fn of_surface(surface: &Surface<'s>, scene: &Scene) -> Self {
        let levels =
            |map: &HeightMap| scene.textures().get(map.texture.texture).map_or(1, |texture| texture.levels());
        let height = surface.normal_source.height_map();
        let (bump, height_levels) = height.map_or((0.0, 1), |(map, factor)| (factor, levels(map)));
        Self { material: surface.material, normal_matrix: surface.normal_matrix, bump, height_levels }
    }
}

/// A field that a shader may read: its name and type, its meaning, and its value.
struct Factor {
    name: &'static str,
    kind: ValueKind,
    meaning: &'static str,
    /// `None` for the factor of the [`Texel`] with this name.
    value: Option<fn(&SurfaceFactors<'_>) -> Vec<f32>>,
}

const fn number(
    name: &'static str,
    meaning: &'static str,
    value: fn(&SurfaceFactors<'_>) -> Vec<f32>,
) -> Factor {
    Factor { name, kind: ValueKind::Number, meaning, value: Some(value) }
}

const fn vector(
    name: &'static str,
    meaning: &'static str,
    value: fn(&SurfaceFactors<'_>) -> Vec<f32>,
) -> Factor {
    Factor { name, kind: ValueKind::Vec3, meaning, value: Some(value) }
}

const fn of_texel(name: &'static str, kind: ValueKind, meaning: &'static str) -> Factor {
    Factor { name, kind, meaning, value: None }
}

/// All factors, except for texture transforms.
const FACTORS: [Factor; 34] = [
    vector("base_color", "Multiplies the tint, linear RGB in [0, 1].", |s| vec3(uniforms(s).base_color)),
    of_texel("alpha", ValueKind::Number, "Multiplies the opacity, [0, 1]."),
    number("cutoff", "The alpha below which a masked surface is discarded.", |s| vec![cutoff(s.material)]),
    of_texel("metallic", ValueKind::Number, "[0, 1]."),
    of_texel("roughness", ValueKind::Number, "Perceptual roughness, [0, 1]."),
    number("occlusion_strength", "The strength of occlusion, [0, 1].", |s| {
        vec![s.material.occlusion_strength]
    }),
    of_texel("emissive", ValueKind::Vec3, "Emitted radiance, linear RGB."),
    of_texel("specular", ValueKind::Number, "The strength of a dielectric's reflection, [0, 1]."),
    of_texel("specular_color", ValueKind::Vec3, "Multiplies a dielectric's F0, linear RGB, at least 0."),
    number("dielectric_f0", "F0 of the dielectric part, ((η − 1)/(η + 1))².", |s| {
        vec![uniforms(s).dielectric_f0]
    }),
    vector("f0", "Reflectance at normal incidence, linear RGB.", |s| or_zero(uniforms(s).f0)),
    vector("f82", "Reflectance at 82°, linear RGB.", |s| or_zero(uniforms(s).f82)),
    vector("k_ambient", "k_a, linear RGB; multiplies the tint.", |s| or_zero(uniforms(s).ambient)),
    vector("k_diffuse", "k_d, linear RGB; multiplies the tint.", |s| or_zero(uniforms(s).diffuse)),
    vector("k_specular", "k_s, linear RGB.", |s| or_zero(uniforms(s).specular)),
    number("slope", "Beckmann's rms slope, above 0.", |s| vec![uniforms(s).slope.unwrap_or_default()]),
    number("shininess", "Phong and Blinn-Phong exponent, at least 0.", |s| {
        vec![uniforms(s).shininess.unwrap_or_default()]
    }),
    number("normal_scale", "Multiplies x and y of the normal map.", |s| vec![scale(&s.material.normal)]),
    number("normal_green", "1 if green points up, −1 if it points down.", |s| {
        vec![green(&s.material.normal)]
    }),
    vector("normal_matrix_x", "Object space's x axis transformed by the normal matrix, world space.", |s| {
        vec3(s.normal_matrix[0])
    }),
    vector("normal_matrix_y", "Object space's y axis transformed by the normal matrix, world space.", |s| {
        vec3(s.normal_matrix[1])
    }),
    vector("normal_matrix_z", "Object space's z axis transformed by the normal matrix, world space.", |s| {
        vec3(s.normal_matrix[2])
    }),
    number("bump", "The height of 1 in model units; the paper's factor for `bump-printed`.", |s| {
        vec![s.bump]
    }),
    number("height_last_level", "The index of the height map's coarsest level.", |s| {
        vec![s.height_levels.saturating_sub(1) as f32]
    }),
    of_texel("clearcoat", ValueKind::Number, "The fraction of the surface covered by the clearcoat, [0, 1]."),
    of_texel("clearcoat_roughness", ValueKind::Number, "The clearcoat's perceptual roughness, [0, 1]."),
    number("clearcoat_normal_scale", "Multiplies x and y of the clearcoat's normal map.", |s| {
        vec![coat(s, |coat| scale(&coat.normal))]
    }),
    number("clearcoat_normal_green", "1 if green points up, −1 if it points down.", |s| {
        vec![coat(s, |coat| green(&coat.normal))]
    }),
    of_texel("sheen_color", ValueKind::Vec3, "The colour of the sheen, linear RGB in [0, 1]."),
    of_texel("sheen_roughness", ValueKind::Number, "The sheen's perceptual roughness, [0, 1]."),
    of_texel("anisotropy", ValueKind::Number, "The strength of the anisotropy, [0, 1]."),
    number(
        "anisotropy_cos",
        "The cosine of the angle from the tangent to the direction of anisotropy.",
        |s| vec![turn(s.material)[0]],
    ),
    number("anisotropy_sin", "The sine of the angle from the tangent to the direction of anisotropy.", |s| {
        vec![turn(s.material)[1]]
    }),
    of_texel(
        "transmission",
        ValueKind::Number,
        "The share of light that passes through a thin surface, [0, 1].",
    ),
];

fn uniforms(surface: &SurfaceFactors<'_>) -> MaterialUniforms<f32> {
    MaterialUniforms::new(surface.material)
}

fn vec3(vector: Vec3) -> Vec<f32> {
    vector.to_array().to_vec()
}

fn or_zero(vector: Option<Vec3>) -> Vec<f32> {
    vec3(vector.unwrap_or_default())
}

fn cutoff(material: &Material) -> f32 {
    match material.alpha {
        AlphaMode::Mask(cutoff) => cutoff,
        AlphaMode::Opaque | AlphaMode::Blend => 0.0,
    }
}

fn scale(map: &Option<NormalMap>) -> f32 {
    map.map_or(1.0, |map| map.scale)
}

fn green(map: &Option<NormalMap>) -> f32 {
    map.map_or(1.0, |map| map.green.sign())
}

fn coat(surface: &SurfaceFactors<'_>, value: impl Fn(&taotie_engine::scene::Clearcoat) -> f32) -> f32 {
    surface.material.clearcoat.as_ref().map_or(0.0, value)
}

/// Cosine and sine of the anisotropy angle.
fn turn(material: &Material) -> [f32; 2] {
    material.anisotropy.as_ref().map_or([1.0, 0.0], own_turn)
}

/// The meanings of the fields of a texture's transform.
const ROWS: &str = "The linear part of the texture's transform, row by row.";
const OFFSET: &str = "Added to the transformed uv.";

/// The names of the fields with the rows and the offset of a texture's transform.
pub(crate) fn transform_names(role: TextureRole) -> [String; 2] {
    ["rows", "offset"].map(|part| format!("{}_{part}", role.name()))
}

/// The name, type and meaning of a factor.
pub(crate) struct FactorName {
    pub name: &'static str,
    pub kind: ValueKind,
    pub meaning: &'static str,
}

/// The factors without texture transforms, in the order of the buffer.
pub(crate) fn named() -> impl Iterator<Item = FactorName> {
    FACTORS.iter().map(|Factor { name, kind, meaning, .. }| FactorName { name, kind: *kind, meaning })
}

/// The fields with these names, in the order of the buffer.
pub(crate) fn fields(is_read: impl Fn(&str) -> bool) -> Vec<Unplaced> {
    let factors = FACTORS.iter().map(|factor| Unplaced {
        name: factor.name.into(),
        kind: factor.kind,
        meaning: factor.meaning,
    });
    let transforms = TextureRole::ALL.into_iter().flat_map(|role| {
        let [rows, offset] = transform_names(role);
        [
            Unplaced { name: rows, kind: ValueKind::Vec4, meaning: ROWS },
            Unplaced { name: offset, kind: ValueKind::Vec2, meaning: OFFSET },
        ]
    });
    factors.chain(transforms).filter(|field| is_read(&field.name)).collect()
}

/// The value of a field, by its name.
fn value(surface: &SurfaceFactors<'_>, name: &str) -> Option<Vec<f32>> {
    if let Some(factor) = FACTORS.iter().find(|factor| factor.name == name) {
        return factor
            .value
            .map_or_else(|| texel_factor(surface.material, name), |value| Some(value(surface)));
    }
    let role = TextureRole::ALL.into_iter().find(|role| transform_names(*role).iter().any(|n| n == name))?;
    let transform = role.of(surface.material)?.transform;
    let is_offset = name.ends_with("_offset");
    Some(if is_offset { transform.offset.to_vec() } else { transform.linear.as_flattened().to_vec() })
}

/// The factor of the texel with this name; zero if the material lacks its layer.
fn texel_factor(material: &Material, name: &str) -> Option<Vec<f32>> {
    let texel = Texel::named(name)?;
    let factor = texel.factor(material).unwrap_or_default();
    Some(factor[..texel.channels().len()].to_vec())
}

impl Interface {
    /// Returns the bytes of group 1, binding 0, for a surface.
    pub fn material_bytes(&self, surface: &SurfaceFactors<'_>) -> Vec<u8> {
        let mut bytes = vec![0; buffer_size(&self.material)];
        for field in &self.material {
            write(field, value(surface, &field.name), &mut bytes);
        }
        bytes
    }
}

fn write(field: &UniformField, value: Option<Vec<f32>>, bytes: &mut [u8]) {
    if let Some(numbers) = value {
        field.write(&numbers, bytes);
    }
}
