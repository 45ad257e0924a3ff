//! Overrides for every material of a scene: factors, maps from files, and the change that they make.

use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texture};
use taotie_engine::math::Vec3;
use taotie_engine::normal_map::unsigned;
use taotie_engine::scene::{
    GreenChannel, HeightMap, Light, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform,
};
use taotie_io::Limits;

/// The maximum of factors without their own limit: results computed with it still fit single precision.
const MOST: f32 = 1e9;

/// Factors for every material of a scene; those that are `None` are unchanged. Textures are kept and multiplied by
/// them.
///
/// ```
/// use taotie::studio::MaterialFactors;
/// use taotie::{Material, Mesh, Scene};
///
/// let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let polished = MaterialFactors { metallic: Some(1.0), roughness: Some(0.2), ..MaterialFactors::default() };
/// polished.apply(&mut scene)?;
/// assert_eq!((scene.materials()[0].metallic, scene.materials()[0].roughness), (1.0, 0.2));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct MaterialFactors {
    /// Base colour, linear RGB, at least 0.
    pub base_color: Option<[f32; 3]>,
    /// The fraction that reflects as a metal, [0, 1].
    pub metallic: Option<f32>,
    /// Roughness, [0, 1]; α is its square.
    pub roughness: Option<f32>,
    /// Root mean square slope of Beckmann's distribution, above 0; `None` uses α.
    pub slope: Option<f32>,
    /// Exponent of Phong and Blinn-Phong, at least 0; `None` derives it from α.
    pub shininess: Option<f32>,
    /// Emitted radiance, linear RGB, at least 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emissive: Option<[f32; 3]>,
}

impl MaterialFactors {
    /// Checks ranges.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the first factor that is out of range.
    pub fn check(&self) -> Result<()> {
        for (name, value) in [("metallic", self.metallic), ("roughness", self.roughness)] {
            if value.is_some_and(|v| !(0.0..=1.0).contains(&v)) {
                return Err(Error::invalid(name, "it must be between 0 and 1"));
            }
        }
        if self.shininess.is_some_and(|s| !(0.0..=MOST).contains(&s)) {
            return Err(Error::invalid("shininess", "it must be between 0 and 1e9"));
        }
        if self.slope.is_some_and(|s| !(s > 0.0 && s <= MOST)) {
            return Err(Error::invalid("slope", "it must be above 0 and at most 1e9"));
        }
        if self.base_color.is_some_and(|c| c.iter().any(|v| !(0.0..=MOST).contains(v))) {
            return Err(Error::invalid("base_color", "its components must be between 0 and 1e9"));
        }
        if self.emissive.is_some_and(|c| !Light::is_strength(Vec3::from_array(c))) {
            return Err(Error::invalid("emissive", "its components must be between 0 and 1e12"));
        }
        Ok(())
    }

    /// Applies the factors to every material of `scene`.
    ///
    /// # Errors
    /// As [`MaterialFactors::check`].
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        if *self == Self::default() {
            return Ok(());
        }
        self.check()?;
        scene.edit(|scene| scene.materials.iter_mut().for_each(|material| self.write_into(material)))
    }

    /// Applies the factors to a material.
    pub(super) fn write_into(&self, material: &mut Material) {
        let [r, g, b, alpha] = material.base_color;
        let [r, g, b] = self.base_color.unwrap_or([r, g, b]);
        material.base_color = [r, g, b, alpha];
        material.metallic = self.metallic.unwrap_or(material.metallic);
        material.roughness = self.roughness.unwrap_or(material.roughness);
        material.classic.slope = self.slope.or(material.classic.slope);
        material.classic.shininess = self.shininess.or(material.classic.shininess);
        material.emissive = self.emissive.unwrap_or(material.emissive);
    }
}

/// Returns the texels of a map by its path.
pub(super) type ReadMap<'r> = dyn FnMut(&Path) -> Result<Bitmap> + 'r;

/// Returns a function that reads maps from files, within limits of memory and pixels.
pub(super) fn reader(limits: &Limits) -> impl FnMut(&Path) -> Result<Bitmap> {
    let limits = *limits;
    move |path| taotie_io::read_bitmap_within(path, &limits)
}

/// Default height of white, as a fraction of the model's size.
const DEFAULT_HEIGHT: f64 = 0.01;

/// Maps for every material of a scene: paths of images. Maps not specified are unchanged.
///
/// ```
/// use taotie_engine::scene::GreenChannel;
/// use taotie::studio::MapOptions;
///
/// let maps = MapOptions { normal: Some("dx.png".into()), green: GreenChannel::Down, ..MapOptions::default() };
/// assert_eq!((maps.normal_scale, maps.height), (1.0, None));
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct MapOptions {
    /// Base colour, sRGB.
    pub base_color: Option<PathBuf>,
    /// Roughness in green and metallic in blue, linear.
    pub metallic_roughness: Option<PathBuf>,
    /// A normal map.
    pub normal: Option<PathBuf>,
    /// Multiplies x and y of the normal map.
    pub normal_scale: f32,
    /// The space of the normal map.
    pub normal_space: NormalSpace,
    /// The direction of green in the normal map.
    pub green: GreenChannel,
    /// A height map; white is high.
    pub height: Option<PathBuf>,
    /// The height of white, in model units; `None` for a hundredth of the model's size.
    pub height_scale: Option<f32>,
    /// Occlusion in red, linear.
    pub occlusion: Option<PathBuf>,
    /// Emitted light, sRGB.
    pub emissive: Option<PathBuf>,
}

impl Default for MapOptions {
    fn default() -> Self {
        Self {
            base_color: None,
            metallic_roughness: None,
            normal: None,
            normal_scale: 1.0,
            normal_space: NormalSpace::Tangent,
            green: GreenChannel::Up,
            height: None,
            height_scale: None,
            occlusion: None,
            emissive: None,
        }
    }
}

impl MapOptions {
    /// Reads the maps and applies them to every material of `scene`.
    ///
    /// # Errors
    /// Those of the files.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        self.apply_with(scene, &mut reader(&Limits::default()))
    }

    /// Like [`MapOptions::apply`], with texels from `read`.
    pub(super) fn apply_with(&self, scene: &mut Scene, read: &mut ReadMap<'_>) -> Result<()> {
        self.load(scene, read)?.apply(scene)?;
        Ok(())
    }

    /// Returns the files of the maps.
    pub fn files(&self) -> Vec<PathBuf> {
        let Self { base_color, metallic_roughness, normal, height, occlusion, emissive, .. } = self;
        let all = [base_color, metallic_roughness, normal, height, occlusion, emissive];
        all.into_iter().flatten().cloned().collect()
    }

    /// Adds the maps to the textures of `scene`; returns the change to its materials.
    pub(super) fn load(&self, scene: &mut Scene, read: &mut ReadMap<'_>) -> Result<Change> {
        let size = scene.bounds().map_or(1.0, |bounds| bounds.diagonal());
        let mut load = |path: &Option<PathBuf>, encoding| {
            let Some(path) = path else { return Ok::<_, Error>(None) };
            let bitmap = if encoding == Encoding::Normal { unsigned(read(path)?)? } else { read(path)? };
            Ok(Some(whole(scene, Texture::new(bitmap, encoding))))
        };
        Ok(Change {
            reflectance: None,
            base_color: load(&self.base_color, Encoding::Srgb)?,
            metallic_roughness: load(&self.metallic_roughness, Encoding::Linear)?,
            normal: load(&self.normal, Encoding::Normal)?.map(|texture| NormalMap {
                texture,
                scale: self.normal_scale,
                space: self.normal_space,
                green: self.green,
            }),
            height: load(&self.height, Encoding::Linear)?.map(|texture| HeightMap {
                texture,
                scale: self.height_scale.unwrap_or((size * DEFAULT_HEIGHT) as f32),
            }),
            occlusion: load(&self.occlusion, Encoding::Linear)?,
            emissive: load(&self.emissive, Encoding::Srgb)?,
        })
    }
}

/// Adds a texture, shown unchanged.
fn whole(scene: &mut Scene, texture: Texture) -> TextureRef {
    let (sampler, transform) = (Sampler::default(), UvTransform::default());
    TextureRef { texture: scene.add_texture(texture), uv_set: 0, sampler, transform }
}

/// A change to every material; parts that are `None` are unchanged.
#[derive(Debug, Default)]
pub(super) struct Change {
    /// Replaces the reflectance; relief and occlusion maps are kept.
    pub reflectance: Option<Material>,
    pub base_color: Option<TextureRef>,
    pub metallic_roughness: Option<TextureRef>,
    pub normal: Option<NormalMap>,
    pub height: Option<HeightMap>,
    pub occlusion: Option<TextureRef>,
    pub emissive: Option<TextureRef>,
}

impl Change {
    /// Changes every material of `scene`.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if a factor is out of range.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        scene.edit(|scene| scene.materials.iter_mut().for_each(|material| self.change(material)))
    }

    fn change(&self, material: &mut Material) {
        if let Some(reflectance) = &self.reflectance {
            *material = Material {
                name: std::mem::take(&mut material.name),
                normal: material.normal,
                height: material.height,
                occlusion_texture: material.occlusion_texture,
                occlusion_strength: material.occlusion_strength,
                double_sided: material.double_sided || reflectance.double_sided,
                ..reflectance.clone()
            };
        }
        material.base_color_texture = self.base_color.or(material.base_color_texture);
        material.metallic_roughness_texture = self.metallic_roughness.or(material.metallic_roughness_texture);
        material.normal = self.normal.or(material.normal);
        material.height = self.height.or(material.height);
        material.occlusion_texture = self.occlusion.or(material.occlusion_texture);
        material.emissive_texture = self.emissive.or(material.emissive_texture);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::Mesh;

    #[test]
    fn what_is_not_named_stays() {
        let brown = Material { base_color: [0.5, 0.25, 0.1, 0.75], metallic: 0.5, ..Material::default() };
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), brown.clone()).unwrap();
        let grey =
            MaterialFactors { base_color: Some([0.2; 3]), slope: Some(0.3), ..MaterialFactors::default() };
        grey.apply(&mut scene).unwrap();
        let mut expected = Material { base_color: [0.2, 0.2, 0.2, 0.75], ..brown };
        expected.classic.slope = Some(0.3);
        assert_eq!(scene.materials()[0], expected);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let why = |factors: MaterialFactors| factors.check().unwrap_err().to_string();
        let none = MaterialFactors::default();
        assert!(why(MaterialFactors { roughness: Some(1.5), ..none }).starts_with("roughness: "));
        assert!(why(MaterialFactors { metallic: Some(f32::NAN), ..none }).starts_with("metallic: "));
        assert!(why(MaterialFactors { slope: Some(0.0), ..none }).starts_with("slope: "));
        assert!(why(MaterialFactors { shininess: Some(-1.0), ..none }).starts_with("shininess: "));
        assert!(
            why(MaterialFactors { base_color: Some([0.0, 0.0, -0.1]), ..none }).starts_with("base_color: ")
        );
    }
}
