//! The material of a model to be written: its factors, its textures by role, and its JSON.
//!
//! This is the only code that writes the JSON of materials: baked assets and whole scenes describe a new one, a graft
//! describes what changes in an existing one; where factors and textures belong follows from the tables [`LAYERS`]
//! and [`TextureRole`].

use super::draft::GltfDraft;
use super::edit::{drop_extension, member, remove, short};
use serde_json::{Map, Value, json};
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Bitmap;
use taotie_engine::math::scalar;
use taotie_engine::scene::{
    AlphaMode, Factor, FactorValue, LAYERS, Layer, Material, TextureRole, UvTransform,
};

/// glTF's metallic-roughness material; textures are multiplied by the factors and use the first uv set.
#[derive(Debug, Clone, Copy)]
pub struct GltfMaterial<'a> {
    /// Its name; may be empty.
    pub name: &'a str,
    /// The base colour, linear RGBA, each in [0, 1]; `alpha` determines whether the last is used.
    pub base_color: [f32; 4],
    /// The metalness, [0, 1].
    pub metallic: f32,
    /// The roughness, [0, 1]; α is its square.
    pub roughness: f32,
    /// The base colour texture, sRGB-encoded; its alpha is written if `alpha` uses it.
    pub base_color_map: Option<GltfImage<'a>>,
    /// The roughness in green and the metalness in blue; linear.
    pub metallic_roughness_map: Option<GltfImage<'a>>,
    /// The occlusion in red, 1 where nothing is occluded; linear. It may be the image of `metallic_roughness_map`,
    /// which is then written once.
    pub occlusion_map: Option<GltfImage<'a>>,
    /// The strength of the occlusion, [0, 1].
    pub occlusion_strength: f32,
    /// The tangent-space normal map, linear, +Y up.
    pub normal_map: Option<GltfImage<'a>>,
    /// The scale of x and y of the normals; finite.
    pub normal_scale: f32,
    /// The emitted radiance, linear RGB, 0 or more.
    pub emissive: [f32; 3],
    /// The texture that multiplies `emissive`, sRGB-encoded.
    pub emissive_map: Option<GltfImage<'a>>,
    /// The alpha mode.
    pub alpha: AlphaMode,
    /// A material whose index of refraction, unlit and [`LAYERS`] this one shares: factors are written, but not
    /// textures.
    pub layers: Option<&'a Material>,
    /// `true` if triangles are visible from both sides.
    pub double_sided: bool,
}

impl Default for GltfMaterial<'_> {
    /// Returns a white, rough, non-metallic material.
    fn default() -> Self {
        Self {
            name: "",
            base_color: [1.0; 4],
            metallic: 0.0,
            roughness: 1.0,
            base_color_map: None,
            metallic_roughness_map: None,
            occlusion_map: None,
            occlusion_strength: 1.0,
            normal_map: None,
            normal_scale: 1.0,
            emissive: [0.0; 3],
            emissive_map: None,
            alpha: AlphaMode::Opaque,
            layers: None,
            double_sided: false,
        }
    }
}

impl<'a> GltfMaterial<'a> {
    /// Describes it as a new material with these textures.
    pub(super) fn parts(&self, textures: Vec<TextureInfo>) -> MaterialParts<'a> {
        MaterialParts {
            name: self.name,
            double_sided: Some(self.double_sided),
            base_color: Some(self.base_color),
            metallic: Some(self.metallic),
            roughness: Some(self.roughness),
            emissive: Some(self.emissive).filter(|radiance| *radiance != [0.0; 3]),
            alpha: Some(self.alpha),
            layers: self.layers.into_iter().flat_map(layers).collect(),
            textures,
        }
    }

    /// Describes the use of a texture, given by index: uv set 0, untransformed.
    pub(super) fn texture(&self, role: TextureRole, texture: usize) -> TextureInfo {
        let weight = if role == TextureRole::Occlusion { self.occlusion_strength } else { self.normal_scale };
        TextureInfo { role, texture, uv_set: 0, transform: UvTransform::default(), weight }
    }

    /// Returns its textures in the order of writing.
    pub(super) fn maps(&self) -> impl Iterator<Item = (TextureRole, GltfImage<'a>)> {
        let maps = [
            self.base_color_map,
            self.metallic_roughness_map,
            self.occlusion_map,
            self.normal_map,
            self.emissive_map,
        ];
        CORE_TEXTURES.into_iter().zip(maps).filter_map(|(role, image)| Some((role, image?)))
    }

    /// Returns true if the material has at least one map.
    pub fn has_maps(&self) -> bool {
        self.maps().next().is_some()
    }

    /// Checks that its numbers are valid in glTF.
    pub(super) fn check(&self) -> Result<()> {
        let fractions = [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("occlusion strength", self.occlusion_strength),
        ];
        let colors = self.base_color.map(|v| ("base colour", v));
        for (name, value) in fractions.into_iter().chain(colors) {
            if !(0.0..=1.0).contains(&value) {
                return Err(Error::invalid(name, format!("{value} is not in [0, 1]")));
            }
        }
        if let Some(value) = self.emissive.into_iter().find(|v| !(0.0..=f32::MAX).contains(v)) {
            return Err(Error::invalid("emission", format!("{value} is negative, infinite or NaN")));
        }
        check_alpha(self.alpha)?;
        if !self.normal_scale.is_finite() {
            return Err(Error::invalid("normal scale", format!("{} is not finite", self.normal_scale)));
        }
        Ok(())
    }
}

/// Checks that the cutoff of a mask is valid in glTF.
pub(super) fn check_alpha(mode: AlphaMode) -> Result<()> {
    match mode {
        AlphaMode::Mask(cutoff) if !(0.0..=f32::MAX).contains(&cutoff) => {
            Err(Error::invalid("alpha cutoff", format!("{cutoff} is negative, infinite or NaN")))
        }
        _ => Ok(()),
    }
}

/// A texture's image.
#[derive(Debug, Clone, Copy)]
pub enum GltfImage<'a> {
    /// 8-bit or 16-bit texels; alpha is written if the material reads it.
    Bitmap(&'a Bitmap),
    /// An existing file next to the model, by its relative path with `/`.
    File(&'a str),
}

impl<'a> From<&'a Bitmap> for GltfImage<'a> {
    fn from(bitmap: &'a Bitmap) -> Self {
        Self::Bitmap(bitmap)
    }
}

impl GltfImage<'_> {
    /// Returns `true` if both are the same image, so that it only has to be written once.
    pub(super) fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Bitmap(a), Self::Bitmap(b)) => std::ptr::eq(*a, *b),
            (Self::File(a), Self::File(b)) => a == b,
            _ => false,
        }
    }
}

/// The member with the core's factors.
pub(super) const PBR: &str = "pbrMetallicRoughness";

/// The extension of emission beyond 1.
pub(super) const STRENGTH: &str = "KHR_materials_emissive_strength";

const TRANSFORM: &str = "KHR_texture_transform";

/// The textures of glTF's core, in the order of writing; those of [`LAYERS`] follow.
pub(super) const CORE_TEXTURES: [TextureRole; 5] = [
    TextureRole::BaseColor,
    TextureRole::MetallicRoughness,
    TextureRole::Occlusion,
    TextureRole::Normal,
    TextureRole::Emissive,
];

/// The default index of refraction of materials.
const IOR: f32 = 1.5;

/// The largest cosine between the axes of a uv transform that counts as orthogonal.
const SQUARE: f64 = 1e-5;

/// The parts of a material to be written; what is `None` is not written.
#[derive(Debug, Clone, Default)]
pub(super) struct MaterialParts<'a> {
    /// Not written if empty.
    pub name: &'a str,
    pub double_sided: Option<bool>,
    /// glTF clamps it to 1.
    pub base_color: Option<[f32; 4]>,
    pub metallic: Option<f32>,
    pub roughness: Option<f32>,
    /// The emitted radiance, linear RGB; above 1 it becomes a colour times a strength.
    pub emissive: Option<[f32; 3]>,
    pub alpha: Option<AlphaMode>,
    /// Extensions without textures, such as [`layers`] returns.
    pub layers: Vec<(&'static str, Value)>,
    pub textures: Vec<TextureInfo>,
}

impl MaterialParts<'_> {
    /// Returns the JSON of a new material and registers its extensions.
    pub fn into_json(self, draft: &mut GltfDraft) -> Value {
        let strength = self.emissive.and_then(|radiance| emission(radiance).1).map(|_| STRENGTH);
        let transform = self.textures.iter().any(TextureInfo::is_transformed).then_some(TRANSFORM);
        let layers = self.layers.iter().map(|(name, _)| *name);
        layers.chain(strength).chain(transform).for_each(|name| draft.uses(name));
        let mut json = json!({});
        self.put_into(&mut json);
        json
    }

    /// Writes the parts into the JSON of a material, replacing those it has.
    pub fn put_into(self, json: &mut Value) {
        if !self.name.is_empty() {
            *member(json, "name") = self.name.into();
        }
        if let Some(double_sided) = self.double_sided {
            *member(json, "doubleSided") = double_sided.into();
        }
        let core = [
            ("baseColorFactor", self.base_color.map(|color| json!(color.map(|v| short(v.min(1.0)))))),
            ("metallicFactor", self.metallic.map(|v| json!(short(v)))),
            ("roughnessFactor", self.roughness.map(|v| json!(short(v)))),
        ];
        for (name, factor) in core {
            if let Some(factor) = factor {
                *member(member(json, PBR), name) = factor;
            }
        }
        if let Some(radiance) = self.emissive {
            let (color, strength) = emission(radiance);
            *member(json, "emissiveFactor") = json!(color);
            match strength {
                Some(strength) => *extension(json, STRENGTH) = json!({ "emissiveStrength": strength }),
                None => drop_extension(json, STRENGTH),
            }
        }
        if let Some(alpha) = self.alpha {
            put_alpha(json, alpha);
        }
        for (name, layer) in self.layers {
            *extension(json, name) = layer;
        }
        for texture in self.textures {
            *place(json, texture.role) = texture.json();
        }
    }
}

/// A texture as a material uses it.
#[derive(Debug, Clone)]
pub(super) struct TextureInfo {
    pub role: TextureRole,
    /// Its index in the document.
    pub texture: usize,
    pub uv_set: usize,
    pub transform: UvTransform,
    /// The scale of normals or the strength of occlusion; other roles ignore it.
    pub weight: f32,
}

impl TextureInfo {
    fn json(&self) -> Value {
        let mut json = json!({ "index": self.texture });
        match self.role {
            TextureRole::Occlusion => json["strength"] = short(self.weight).into(),
            TextureRole::Normal | TextureRole::ClearcoatNormal => json["scale"] = short(self.weight).into(),
            _ => {}
        }
        if self.uv_set > 0 {
            json["texCoord"] = self.uv_set.into();
        }
        if self.is_transformed() {
            json["extensions"] = json!({ TRANSFORM: transform(&self.transform) });
        }
        json
    }

    fn is_transformed(&self) -> bool {
        self.transform != UvTransform::default()
    }

    /// Returns `true` if glTF cannot represent its uv transform fully.
    pub fn is_sheared(&self) -> bool {
        let [[a, b], [c, d]] = self.transform.linear.map(|row| row.map(f64::from));
        (a * b + c * d).abs() > SQUARE * (a * a + c * c).sqrt() * (b * b + d * d).sqrt()
    }
}

/// Returns the parts of a uv transform, T · R · S, without shear. Source: KHR_texture_transform.
fn transform(of: &UvTransform) -> Value {
    let [[a, b], [c, d]] = of.linear.map(|row| row.map(f64::from));
    let offset = of.offset.map(short);
    if b == 0.0 && c == 0.0 {
        let scale = [short(of.linear[0][0]), short(of.linear[1][1])];
        return json!({ "offset": offset, "scale": scale });
    }
    let (x, y) = ((a * a + c * c).sqrt(), (b * b + d * d).sqrt());
    let rotation = if x > 0.0 { scalar::atan2(-c, a) } else { scalar::atan2(b, d) };
    let mirrored = a * d - b * c < 0.0;
    let scale = [x, if mirrored { -y } else { y }];
    json!({ "offset": offset, "rotation": rotation, "scale": scale })
}

/// Returns the place of a texture in a material.
fn place(json: &mut Value, role: TextureRole) -> &mut Value {
    let layer = LAYERS.iter().find(|layer| layer.textures.contains(&role));
    let parent = match (role, layer) {
        (TextureRole::BaseColor | TextureRole::MetallicRoughness, _) => member(json, PBR),
        (_, Some(layer)) => extension(json, layer.extension),
        _ => json,
    };
    member(parent, role.gltf_member())
}

fn extension<'a>(json: &'a mut Value, name: &str) -> &'a mut Value {
    member(member(json, "extensions"), name)
}

/// Returns the index of refraction, unlit and the layers of a material: the name of each extension, and its factors.
pub(super) fn layers(material: &Material) -> Vec<(&'static str, Value)> {
    let unlit = material.unlit.then(|| ("KHR_materials_unlit", json!({})));
    let ior = (material.ior != IOR).then(|| ("KHR_materials_ior", json!({ "ior": short(material.ior) })));
    let layers = LAYERS.iter().filter(|layer| layer.is_present(material));
    let layers = layers.map(|layer| (layer.extension, layer_factors(layer, material)));
    unlit.into_iter().chain(ior).chain(layers).collect()
}

fn layer_factors(layer: &Layer, material: &Material) -> Value {
    let member =
        |factor: &Factor| Some((factor.member.to_owned(), written((factor.get)(material)?, factor.most)));
    layer.factors.iter().filter_map(member).collect::<Map<_, _>>().into()
}

/// Returns the JSON of a factor; glTF clamps values above `most`.
fn written(value: FactorValue, most: f32) -> Value {
    match value {
        FactorValue::Number(number) => short(number.min(most)).into(),
        FactorValue::Color(color) => json!(color.map(|v| short(v.min(most)))),
        FactorValue::Angle(angle) => angle.into(),
    }
}

/// Splits a radiance, linear RGB: a colour, and its multiplier if the emission exceeds 1.
fn emission(radiance: [f32; 3]) -> ([f64; 3], Option<f64>) {
    let most = radiance.into_iter().fold(1.0, f32::max);
    (radiance.map(|v| short(v / most)), (most > 1.0).then(|| short(most)))
}

fn put_alpha(json: &mut Value, alpha: AlphaMode) {
    ["alphaMode", "alphaCutoff"].into_iter().for_each(|name| remove(json, name));
    match alpha {
        AlphaMode::Opaque => {}
        AlphaMode::Blend => *member(json, "alphaMode") = "BLEND".into(),
        AlphaMode::Mask(cutoff) => {
            *member(json, "alphaMode") = "MASK".into();
            *member(json, "alphaCutoff") = short(cutoff).into();
        }
    }
}
