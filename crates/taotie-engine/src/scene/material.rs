//! Materials: factors and textures; and materials by name.

use crate::image::Sampler;
use crate::math::Vec2;
use crate::names::Named;

/// A texture as a material uses it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into [`super::SceneData::textures`].
    pub texture: usize,
    /// The uv set of the mesh.
    pub uv_set: usize,
    /// The wrapping and filtering of texels.
    pub sampler: Sampler,
    /// The transform applied to the uv before the lookup.
    pub transform: UvTransform,
}

/// KHR_texture_transform: uv' = offset + R(rotation) · (scale · uv), as a 2×3 matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTransform {
    /// Rows of the linear part.
    pub linear: [[f32; 2]; 2],
    /// The offset, added last.
    pub offset: [f32; 2],
}

impl Default for UvTransform {
    fn default() -> Self {
        Self { linear: [[1.0, 0.0], [0.0, 1.0]], offset: [0.0, 0.0] }
    }
}

impl UvTransform {
    /// The maximum magnitude of its numbers.
    pub const MOST: f32 = 1e12;

    /// Returns `true` if all numbers are within ±[`Self::MOST`], so that uvs of that range stay finite.
    pub fn is_bounded(&self) -> bool {
        self.linear.iter().chain([&self.offset]).flatten().all(|v| v.abs() <= Self::MOST)
    }

    /// Returns the transformed uv.
    #[inline]
    pub fn apply(&self, uv: Vec2) -> Vec2 {
        let d = self.apply_linear(uv);
        Vec2::new(d.x + self.offset[0], d.y + self.offset[1])
    }

    /// Returns the transformed difference of two uvs.
    #[inline]
    pub fn apply_linear(&self, uv: Vec2) -> Vec2 {
        let [[a, b], [c, d]] = self.linear;
        Vec2::new(a * uv.x + b * uv.y, c * uv.x + d * uv.y)
    }
}

/// The direction of the green channel of a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GreenChannel {
    /// +Y, towards decreasing v (up in the image): OpenGL and glTF.
    #[default]
    Up,
    /// −Y: DirectX.
    Down,
}

impl GreenChannel {
    /// Returns 1 for up and −1 for down.
    #[inline(always)]
    pub fn sign(self) -> f32 {
        match self {
            Self::Up => 1.0,
            Self::Down => -1.0,
        }
    }
}

impl Named for GreenChannel {
    const WHAT: &'static str = "direction of green";
    const NAMES: &'static [(&'static str, Self)] = &[("up", Self::Up), ("down", Self::Down)];
}

/// The space of a normal map's vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NormalSpace {
    /// Relative to tangent, bitangent and normal.
    #[default]
    Tangent,
    /// Object space.
    Object,
}

impl Named for NormalSpace {
    const WHAT: &'static str = "space of normals";
    const NAMES: &'static [(&'static str, Self)] = &[("tangent", Self::Tangent), ("object", Self::Object)];
}

/// A normal map in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalMap {
    /// The texture, linear.
    pub texture: TextureRef,
    /// Multiplies x and y before normalising.
    pub scale: f32,
    /// The space of its vectors.
    pub space: NormalSpace,
    /// The direction of its green channel.
    pub green: GreenChannel,
}

/// A height map in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightMap {
    /// The texture, linear; the first channel is the height in [0, 1].
    pub texture: TextureRef,
    /// The height of 1, in model units.
    pub scale: f32,
}

/// The treatment of alpha on a surface that is not fully opaque.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Drawn if alpha is at least the cutoff.
    Mask(f32),
    /// Composited over the background.
    Blend,
}

/// The authored parameters of the classic models. Those that are `None` follow from the metallic-roughness values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Classic {
    /// k_a, linear RGB.
    pub ambient: Option<[f32; 3]>,
    /// k_d, linear RGB; multiplies the base colour texture.
    pub diffuse: Option<[f32; 3]>,
    /// k_s, linear RGB.
    pub specular: Option<[f32; 3]>,
    /// Phong and Blinn-Phong exponent, at least 0.
    pub shininess: Option<f32>,
    /// Beckmann rms slope, above 0.
    pub slope: Option<f32>,
}

/// The strength of a dielectric's reflection: KHR_materials_specular. Metals ignore it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specular {
    /// [0, 1]; multiplies the reflectance at every angle.
    pub factor: f32,
    /// Alpha multiplies `factor`; linear.
    pub factor_texture: Option<TextureRef>,
    /// Multiplies the reflectance at normal incidence, linear RGB, at least 0; the product is at most 1.
    pub color: [f32; 3],
    /// Multiplies `color`; sRGB-encoded colour.
    pub color_texture: Option<TextureRef>,
}

impl Default for Specular {
    fn default() -> Self {
        Self { factor: 1.0, factor_texture: None, color: [1.0; 3], color_texture: None }
    }
}

/// A clearcoat over the surface: KHR_materials_clearcoat.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Clearcoat {
    /// The share of the surface that it covers, [0, 1].
    pub factor: f32,
    /// Red multiplies `factor`; linear.
    pub factor_texture: Option<TextureRef>,
    /// The perceptual roughness, as artists set it, [0, 1].
    pub roughness: f32,
    /// Green multiplies `roughness`; linear.
    pub roughness_texture: Option<TextureRef>,
    /// The clearcoat's normal map; without one it follows the smooth surface.
    pub normal: Option<NormalMap>,
}

/// Anisotropic highlights, wider along one direction: KHR_materials_anisotropy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Anisotropy {
    /// [0, 1].
    pub strength: f32,
    /// The direction of the anisotropy, radians counter-clockwise from the tangent.
    pub rotation: f64,
    /// Red and green rotate the direction further, blue multiplies `strength`; linear.
    pub texture: Option<TextureRef>,
}

/// Sheen, the reflection of upright fibres on the surface: KHR_materials_sheen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sheen {
    /// Linear RGB, [0, 1].
    pub color: [f32; 3],
    /// Multiplies `color`; sRGB-encoded colour.
    pub color_texture: Option<TextureRef>,
    /// The perceptual roughness, as artists set it, [0, 1].
    pub roughness: f32,
    /// Alpha multiplies `roughness`; linear.
    pub roughness_texture: Option<TextureRef>,
}

/// The light that passes through a thin surface: KHR_materials_transmission. Metals have none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Transmission {
    /// The share of the light that is not reflected specularly and passes, [0, 1].
    pub factor: f32,
    /// Red multiplies `factor`; linear.
    pub texture: Option<TextureRef>,
}

/// The volume below a surface: KHR_materials_volume. Kept in files; surfaces are drawn thin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Volume {
    /// Its thickness, model units; 0 for a thin surface.
    pub thickness: f32,
    /// Green multiplies `thickness`; linear.
    pub thickness_texture: Option<TextureRef>,
    /// The mean distance that light travels before it is absorbed, model units; [`Light::MOST`](super::Light::MOST) if
    /// nothing is absorbed.
    pub attenuation_distance: f32,
    /// The colour of white light after that distance, linear RGB, [0, 1].
    pub attenuation_color: [f32; 3],
}

impl Default for Volume {
    fn default() -> Self {
        Self {
            thickness: 0.0,
            thickness_texture: None,
            attenuation_distance: super::Light::MOST,
            attenuation_color: [1.0; 3],
        }
    }
}

/// The colours of a thin film on the surface: KHR_materials_iridescence. Kept in files, but not drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iridescence {
    /// [0, 1].
    pub factor: f32,
    /// Red multiplies `factor`; linear.
    pub factor_texture: Option<TextureRef>,
    /// The film's index of refraction, at least 1.
    pub ior: f32,
    /// The film's thickness if the texture's green is 0, nanometres.
    pub thickness_minimum: f32,
    /// That if green is 1, or there is no texture, nanometres.
    pub thickness_maximum: f32,
    /// Green interpolates between the thicknesses; linear.
    pub thickness_texture: Option<TextureRef>,
}

impl Default for Iridescence {
    fn default() -> Self {
        Self {
            factor: 0.0,
            factor_texture: None,
            ior: 1.3,
            thickness_minimum: 100.0,
            thickness_maximum: 400.0,
            thickness_texture: None,
        }
    }
}

/// The dependence of the index of refraction on the wavelength: KHR_materials_dispersion. Kept in files, but not drawn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dispersion {
    /// 20 divided by the Abbe number, at least 0.
    pub factor: f32,
}

/// A surface: metallic-roughness as in glTF 2.0, along with the parameters of other models.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Its name; may be empty.
    pub name: String,
    /// Linear RGB and alpha; multiplies texture and vertex colour.
    pub base_color: [f32; 4],
    /// RGBA, sRGB-encoded colour.
    pub base_color_texture: Option<TextureRef>,
    /// [0, 1].
    pub metallic: f32,
    /// The perceptual roughness, as artists set it, [0, 1]; α is its square.
    pub roughness: f32,
    /// Green is roughness, blue is metallic; linear.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Reflectance at normal incidence, linear RGB, if authored; else mixed from 0.04 and the base colour.
    pub f0: Option<[f32; 3]>,
    /// Reflectance at 82° (cos θ = 1/7), linear RGB, if authored; else Schlick's.
    pub f82: Option<[f32; 3]>,
    /// Index of refraction of the dielectric part, at least 1, or 0 for total reflection: KHR_materials_ior.
    pub ior: f32,
    /// The strength of the dielectric part's reflection.
    pub specular: Specular,
    /// The clearcoat over the surface.
    pub clearcoat: Option<Clearcoat>,
    /// The anisotropy of highlights.
    pub anisotropy: Option<Anisotropy>,
    /// The sheen.
    pub sheen: Option<Sheen>,
    /// The light that passes through it.
    pub transmission: Option<Transmission>,
    /// The volume below it.
    pub volume: Option<Volume>,
    /// The thin film on it.
    pub iridescence: Option<Iridescence>,
    /// The dispersion in the volume below it.
    pub dispersion: Option<Dispersion>,
    /// The normal map.
    pub normal: Option<NormalMap>,
    /// The height map, for bump mapping.
    pub height: Option<HeightMap>,
    /// Red is occlusion; darkens ambient light only.
    pub occlusion_texture: Option<TextureRef>,
    /// [0, 1]: the weight of the occlusion.
    pub occlusion_strength: f32,
    /// Emitted radiance, linear RGB.
    pub emissive: [f32; 3],
    /// Multiplies `emissive`; sRGB-encoded colour.
    pub emissive_texture: Option<TextureRef>,
    /// The treatment of alpha.
    pub alpha: AlphaMode,
    /// `true` if back faces are drawn, with the normal reversed.
    pub double_sided: bool,
    /// `true` for KHR_materials_unlit: the base colour is shown without lighting.
    pub unlit: bool,
    /// The parameters of the classic models.
    pub classic: Classic,
}

impl Material {
    /// Returns true if light passes through the surface.
    pub fn transmits(&self) -> bool {
        !self.unlit && self.transmission.is_some_and(|transmission| transmission.factor > 0.0)
    }

    /// Returns true if the surface is composited over what is behind it.
    pub fn is_blended(&self) -> bool {
        self.alpha == AlphaMode::Blend || self.transmits()
    }

    /// Returns the default material of a glTF file: white metal, as in the specification.
    pub fn default_of_gltf() -> Self {
        Self { base_color: [1.0; 4], metallic: 1.0, roughness: 1.0, ..Self::default() }
    }
}

impl Default for Material {
    /// Returns a neutral grey dielectric, for files without materials.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [0.6, 0.6, 0.6, 1.0],
            base_color_texture: None,
            metallic: 0.0,
            roughness: 0.6,
            metallic_roughness_texture: None,
            f0: None,
            f82: None,
            ior: 1.5,
            specular: Specular::default(),
            clearcoat: None,
            anisotropy: None,
            sheen: None,
            transmission: None,
            volume: None,
            iridescence: None,
            dispersion: None,
            normal: None,
            height: None,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: [0.0; 3],
            emissive_texture: None,
            alpha: AlphaMode::Opaque,
            double_sided: false,
            unlit: false,
            classic: Classic::default(),
        }
    }
}

/// A material that `--material` accepts by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// The name on the command line.
    pub name: &'static str,
    /// A short description.
    pub what: &'static str,
    /// The source of its colours: a measurement, or another origin.
    pub source: &'static str,
}

/// Every preset.
///
/// The metals' colours are measured: exact Fresnel reflectance from tabulated n and k (refractiveindex.info, CC0)
/// under the CIE 1931 observer and D65, in linear sRGB; `tests/oracle/metals_oracle.py` computes them and a test
/// compares. A value above 1 is outside the gamut of sRGB and is clipped to 1, which happens only to gold's red.
/// Roughness is not measured: a dull polish that lights relief well.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "guo-wang-2025",
        what: "a ruby lacquer that its authors call bronze, as published",
        source: "Guo and Wang 2025, Table 1",
    },
    Preset {
        name: "bronze",
        what: "commercial bronze Cu90Zn10, for lack of measured tin bronze",
        source: "Querry 1985",
    },
    Preset {
        name: "bronze-patina",
        what: "aged bronze: brown-green minerals half covering the metal",
        source: "by eye, over Querry 1985",
    },
    Preset { name: "copper", what: "pure copper", source: "Johnson and Christy 1972" },
    Preset { name: "cu85zn15", what: "red brass Cu85Zn15", source: "Querry 1985" },
    Preset { name: "brass", what: "cartridge brass Cu70Zn30", source: "Querry 1985" },
    Preset {
        name: "gold",
        what: "pure gold; red clipped from 1.038 to 1",
        source: "Johnson and Christy 1972",
    },
    Preset { name: "silver", what: "pure silver", source: "Johnson and Christy 1972" },
    Preset { name: "clay", what: "fired red clay", source: "by eye" },
    Preset { name: "plaster", what: "white plaster, the colour of casts", source: "by eye" },
    Preset { name: "marble", what: "polished white marble without veins or translucency", source: "by eye" },
];

/// Returns the material of this name, or `None`; [`PRESETS`] lists the names.
pub fn preset(name: &str) -> Option<Material> {
    let material = match name {
        "guo-wang-2025" => guo_wang_2025(),
        "bronze" => metal(BRONZE_F0, [0.9511, 0.8406, 0.7258]),
        "bronze-patina" => bronze_patina(),
        "copper" => metal([0.9317, 0.6227, 0.5223], [0.9459, 0.7549, 0.7024]),
        "cu85zn15" => metal([0.9125, 0.7141, 0.4199], [0.9203, 0.8492, 0.7270]),
        "brass" => metal([0.9097, 0.7783, 0.4228], [0.9057, 0.8621, 0.7043]),
        "gold" => metal([1.0, 0.7283, 0.3646], [0.9909, 0.8572, 0.6464]),
        "silver" => metal([0.9894, 0.9840, 0.9778], [0.9876, 0.9860, 0.9870]),
        "clay" => matte([0.46, 0.22, 0.13], 0.85),
        "plaster" => matte([0.80, 0.78, 0.74], 0.90),
        "marble" => Material { f0: Some([0.05; 3]), ..matte([0.82, 0.80, 0.76], 0.30) },
        _ => return None,
    };
    Some(Material { name: name.to_owned(), ..material })
}

/// The reflectance of Cu90Zn10 at normal incidence.
const BRONZE_F0: [f32; 3] = [0.9626, 0.7133, 0.4640];

/// Returns a bare metal.
fn metal(f0: [f32; 3], f82: [f32; 3]) -> Material {
    Material {
        base_color: opaque(f0),
        metallic: 1.0,
        roughness: 0.35,
        f0: Some(f0),
        f82: Some(f82),
        ..Material::default()
    }
}

/// Returns a dielectric of the usual reflectance.
fn matte(base_color: [f32; 3], roughness: f32) -> Material {
    Material { base_color: opaque(base_color), metallic: 0.0, roughness, ..Material::default() }
}

/// Source: Guo and Wang 2025, Table 1. The metallic-roughness values are ours: k_d for the base colour and the
/// roughness whose α equals the slope.
fn guo_wang_2025() -> Material {
    let diffuse = [0.614, 0.341, 0.041];
    Material {
        roughness: std::f32::consts::FRAC_1_SQRT_2,
        f0: Some([0.3; 3]),
        classic: Classic {
            ambient: Some([0.175, 0.012, 0.012]),
            diffuse: Some(diffuse),
            specular: Some([0.8; 3]),
            shininess: None,
            slope: Some(0.5),
        },
        ..matte(diffuse, 0.0)
    }
}

/// Cuprite and malachite behave as dielectrics with an index near 1.8 (F0 0.08); a map may vary the fraction of bare
/// metal, here 0.4 everywhere.
fn bronze_patina() -> Material {
    let metallic = 0.4;
    let f0 = BRONZE_F0.map(|metal| 0.08 * (1.0 - metallic) + metal * metallic);
    Material { metallic, f0: Some(f0), ..matte([0.155, 0.140, 0.085], 0.45) }
}

fn opaque([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_is_a_material() {
        for listed in PRESETS {
            let material = preset(listed.name).unwrap();
            assert_eq!(material.name, listed.name);
            let colors =
                [material.f0, material.f82, material.classic.diffuse].into_iter().flatten().flatten();
            assert!(colors.chain(material.base_color).all(|c| (0.0..=1.0).contains(&c)), "{}", listed.name);
        }
        assert_eq!(preset("bronz"), None);
    }

    #[test]
    fn the_papers_table_is_kept() {
        let paper = preset("guo-wang-2025").unwrap();
        assert_eq!(paper.classic.ambient, Some([0.175, 0.012, 0.012]));
        assert_eq!(paper.classic.diffuse, Some([0.614, 0.341, 0.041]));
        assert_eq!(
            (paper.classic.specular, paper.f0, paper.classic.slope),
            (Some([0.8; 3]), Some([0.3; 3]), Some(0.5))
        );
    }
}
