//! The measured surfaces: models, surface methods and layers, with random factors.

use super::random::Random;
use taotie_engine::image::Sampler;
use taotie_engine::names::Named;
use taotie_engine::scene::{
    Anisotropy, Classic, Clearcoat, GreenChannel, HeightMap, Material, NormalMap, NormalSpace, Sheen,
    Specular, TextureRef, UvTransform,
};
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_shader::{SurfaceFactors, Variant, VariantOptions};

/// The layers of a surface, and other values in addition to those of glTF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layers {
    pub name: &'static str,
    pub clearcoat: bool,
    pub sheen: bool,
    pub anisotropy: bool,
    /// `true` if F0, F82 and the parameters of classic models are authored.
    pub authored: bool,
}

const NONE: Layers =
    Layers { name: "none", clearcoat: false, sheen: false, anisotropy: false, authored: false };

/// The layers that `ggx` supports.
const OF_GGX: [Layers; 4] = [
    Layers { name: "clearcoat", clearcoat: true, ..NONE },
    Layers { name: "sheen", sheen: true, ..NONE },
    Layers { name: "anisotropy", anisotropy: true, ..NONE },
    Layers { name: "all", clearcoat: true, sheen: true, anisotropy: true, authored: false },
];

const AUTHORED: Layers = Layers { name: "authored", authored: true, ..NONE };

/// A measured surface.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    pub shading: Shading,
    pub method: SurfaceMethod,
    pub layers: Layers,
}

/// Returns all models with all methods, `ggx` with each layer and all layers, and all models with authored values.
pub fn all() -> Vec<Case> {
    let mut cases = Vec::new();
    for (_, shading) in Shading::NAMES.iter().copied() {
        let layered: &[Layers] = if shading == Shading::Ggx { &OF_GGX } else { &[] };
        for layers in [NONE].iter().chain(layered) {
            cases.extend(SurfaceMethod::ALL.map(|method| Case { shading, method, layers: *layers }));
        }
        cases.push(Case { shading, method: SurfaceMethod::Smooth, layers: AUTHORED });
    }
    cases
}

/// The columns of the matrix from the object-space map to world space: a rotation with exact numbers.
pub const NORMAL_MATRIX: [[f32; 3]; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

const IDENTITY: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Case {
    /// Returns the name of the surface method.
    pub fn method_name(&self) -> &'static str {
        self.method.name()
    }

    /// Returns the options other than the material.
    pub fn options(&self) -> VariantOptions {
        VariantOptions {
            shading: self.shading,
            method: self.method,
            environment: true,
            both_sides: true,
            vertex_color: true,
            ..VariantOptions::default()
        }
    }

    /// Returns the variant of its shader, which does not depend on factors.
    pub fn variant(&self) -> Variant {
        Variant::new(&self.material(&mut Random::new(1)), &self.options())
    }

    /// Returns a material with all textures except those of layers it lacks. Occlusion is the red channel of the
    /// metallic-roughness texture, so that all textures fit into the sixteen guaranteed by WebGL 2.
    pub fn material(&self, random: &mut Random) -> Material {
        let mut near_one = || (0.7 + 0.3 * random.next()) as f32;
        let mut material = Material {
            base_color: [near_one(), near_one(), near_one(), 1.0],
            base_color_texture: Some(texture()),
            metallic: near_one(),
            roughness: near_one(),
            metallic_roughness_texture: Some(texture()),
            occlusion_texture: Some(texture()),
            occlusion_strength: near_one(),
            emissive: [near_one(), near_one(), near_one()],
            emissive_texture: Some(texture()),
            normal: Some(self.normal_map(near_one())),
            height: Some(HeightMap { texture: texture(), scale: 1.0 }),
            specular: Specular {
                factor: near_one(),
                factor_texture: Some(texture()),
                color: [near_one(), near_one(), near_one()],
                color_texture: Some(texture()),
            },
            ..Material::default()
        };
        self.add_layers(&mut material, random);
        material
    }

    fn normal_map(&self, scale: f32) -> NormalMap {
        let space = match self.method {
            SurfaceMethod::ObjectNormal => NormalSpace::Object,
            _ => NormalSpace::Tangent,
        };
        NormalMap { texture: texture(), scale, space, green: GreenChannel::Down }
    }

    fn add_layers(&self, material: &mut Material, random: &mut Random) {
        let mut between = |low: f64, high: f64| (low + (high - low) * random.next()) as f32;
        let Layers { clearcoat, sheen, anisotropy, authored, .. } = self.layers;
        material.clearcoat = clearcoat.then(|| Clearcoat {
            factor: between(0.5, 1.0),
            factor_texture: Some(texture()),
            roughness: between(0.7, 1.0),
            roughness_texture: Some(texture()),
            normal: Some(NormalMap { space: NormalSpace::Tangent, ..self.normal_map(between(0.3, 1.0)) }),
        });
        material.sheen = sheen.then(|| Sheen {
            color: [between(0.2, 1.0), between(0.2, 1.0), between(0.2, 1.0)],
            color_texture: Some(texture()),
            roughness: between(0.7, 1.0),
            roughness_texture: Some(texture()),
        });
        material.anisotropy = anisotropy.then(|| Anisotropy {
            strength: between(0.5, 1.0),
            rotation: f64::from(between(0.0, 6.0)),
            texture: Some(texture()),
        });
        if authored {
            let mut color = || Some([between(0.1, 0.9), between(0.1, 0.9), between(0.1, 0.9)]);
            material.f0 = color();
            material.f82 = color();
            let (ambient, diffuse, specular) = (color(), color(), color());
            let (shininess, slope) = (Some(between(2.0, 200.0)), Some(between(0.1, 0.6)));
            material.classic = Classic { ambient, diffuse, specular, shininess, slope };
        }
    }

    /// Returns the factors of the surface.
    pub fn factors<'m>(&self, material: &'m Material) -> SurfaceFactors<'m> {
        // The paper's normals are in object space, which is world space here. Heights change by a third between
        // texels, which gives slopes of about one.
        let (matrix, bump) = match self.method {
            SurfaceMethod::BumpPrinted => (IDENTITY, 1.0),
            _ => (NORMAL_MATRIX, 0.03),
        };
        let normal_matrix = matrix.map(taotie_engine::math::Vec3::from_array);
        SurfaceFactors { material, normal_matrix, bump, height_levels: 1 }
    }
}

/// Returns the reference that all textures share.
fn texture() -> TextureRef {
    TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() }
}
