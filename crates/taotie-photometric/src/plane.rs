//! A rectangle with the estimated normals and albedo as textures, to be shown, rendered and compared.

use crate::estimate::{Estimate, Estimator};
use crate::indirect::quantile;
use crate::program::Finish;
use taotie_engine::error::Result;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture, Wrap};
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    AlphaMode, GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
    UvTransform,
};

/// The roughness of matt surfaces.
const MATT: Finish = Finish { roughness: 1.0, f0: 0.04 };

impl Estimate {
    /// Returns a rectangle that faces +z, with the longer side `longer`, a tangent-space normal map of 16 bits, and a
    /// base colour that is transparent outside the mask.
    ///
    /// # Errors
    /// Those of [`Scene::new`], none of which can occur.
    pub fn plane(&self, longer: f64) -> Result<Scene> {
        let opaque = |[x, y, z, _]: [u16; 4]| [x, y, z, u16::MAX];
        let normals = Texels::U16(self.normal_codes().into_iter().map(opaque).collect());
        let normals = Texture::new(Bitmap::new(self.width(), self.height(), 3, normals)?, Encoding::Normal);
        Scene::new(SceneData {
            meshes: vec![rectangle([self.width(), self.height()], longer)?],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..self.appearance(Some(normals))?
        })
    }

    /// Returns a material and its textures: the base colour, and a normal map if there is one.
    pub(crate) fn appearance(&self, normals: Option<Texture>) -> Result<SceneData> {
        let (width, height) = (self.width(), self.height());
        let colors = Texels::U8(self.base_colors());
        let colors = Texture::new(Bitmap::new(width, height, 4, colors)?, Encoding::Srgb);
        let sampler = Sampler { wrap_u: Wrap::Clamp, wrap_v: Wrap::Clamp, ..Sampler::default() };
        let used = |texture| TextureRef { texture, uv_set: 0, sampler, transform: UvTransform::default() };
        let normal = normals.as_ref().map(|_| NormalMap {
            texture: used(1),
            scale: 1.0,
            space: NormalSpace::Tangent,
            green: GreenChannel::Up,
        });
        let masked =
            self.best.len() < width as usize * height as usize || self.best.iter().any(Option::is_none);
        let largest = self.regions.iter().max_by_key(|region| region.pixels);
        let finish = largest.and_then(|region| region.finish).unwrap_or(MATT);
        let material = Material {
            name: "photographs".to_owned(),
            base_color_texture: Some(used(0)),
            metallic: 0.0,
            roughness: finish.roughness as f32,
            ior: index(finish.f0) as f32,
            normal,
            alpha: if masked { AlphaMode::Mask(0.5) } else { AlphaMode::Opaque },
            ..Material::default()
        };
        let textures = [colors].into_iter().chain(normals).collect();
        Ok(SceneData { materials: vec![material], textures, ..SceneData::default() })
    }

    /// Returns the best normals as codes of 16 bits, (n + 1) / 2; transparent and towards the camera without one.
    pub fn normal_codes(&self) -> Vec<[u16; 4]> {
        let code = |v: f32| ((0.5 * v + 0.5) * 65_535.0 + 0.5) as u16;
        let texel = |[x, y, z, has]: &[f32; 4]| match *has > 0.0 {
            true => [code(*x), code(*y), code(*z), u16::MAX],
            false => [32_768, 32_768, u16::MAX, 0],
        };
        self.normals(Estimator::Best).pixels().iter().map(texel).collect()
    }

    /// Returns the base colour of each pixel as codes of sRGB: the albedo that indirect light shows, or assumed; 0 without a
    /// normal.
    pub fn base_color_codes(&self) -> Vec<[u8; 3]> {
        self.base_colors().into_iter().map(|[red, green, blue, _]| [red, green, blue]).collect()
    }

    /// Returns the roughness of each pixel as a code, 255 for 1 and for matt pixels; 0 without a normal.
    pub fn roughness_codes(&self) -> Vec<u8> {
        let roughness =
            self.image(|i, _| [self.finishes[i].map_or(MATT.roughness, |finish| finish.roughness); 3]);
        roughness.pixels().iter().map(|pixel| (pixel[0] * 255.0 + 0.5) as u8).collect()
    }

    fn base_colors(&self) -> Vec<[u8; 4]> {
        let bright = quantile(self.best.iter().flatten().map(|best| best.albedo).collect(), 0.95);
        let factor = self.albedo / bright.max(f64::MIN_POSITIVE);
        let code = |v: f64| (v * 255.0 + 0.5) as u8;
        let color = |v: f32| code(srgb_from_linear((f64::from(v) * factor).clamp(0.0, 1.0)));
        let texel = |[red, green, blue, has]: &[f32; 4]| {
            let [red, green, blue] = [*red, *green, *blue].map(color);
            [red, green, blue, code(f64::from(*has))]
        };
        self.albedos().pixels().iter().map(texel).collect()
    }
}

/// Returns the index of refraction of a dielectric with this reflectance at normal incidence.
fn index(f0: f64) -> f64 {
    let root = f0.clamp(0.0, 0.99).sqrt();
    (1.0 + root) / (1.0 - root)
}

fn rectangle(sides: [u32; 2], longer: f64) -> Result<Mesh> {
    let most = f64::from(sides[0].max(sides[1]));
    let [x, y] = sides.map(|side| 0.5 * longer * f64::from(side) / most);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let uv = |[u, v]: [f64; 2]| Vec2::new(0.5 + 0.5 * u as f32, 0.5 - 0.5 * v as f32);
    Mesh::new(MeshData {
        positions: corners.iter().map(|[u, v]| Vec3::new(x * u, y * v, 0.0).to_f32()).collect(),
        normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
        uvs: vec![corners.map(uv).to_vec()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    })
}
