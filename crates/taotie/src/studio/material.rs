//! The requested materials: a variant, a preset or a material in a TOML file, and factors and maps.

use super::overrides::{Change, MapOptions, MaterialFactors, ReadMap, reader};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result};
use taotie_engine::image::Bitmap;
use taotie_engine::math::Vec3;
use taotie_engine::scene::{
    AlphaMode, GreenChannel, Light, Material, NormalSpace, PRESETS, Scene, SceneData, preset,
};
use taotie_io::Limits;

/// The requested materials; by default those of the file.
///
/// ```
/// use taotie::studio::MaterialOptions;
/// use taotie::{Material, Mesh, Scene};
///
/// let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let bronze = MaterialOptions { material: Some("bronze".into()), ..MaterialOptions::default() };
/// bronze.apply(&mut scene)?;
/// assert_eq!(scene.materials()[0].metallic, 1.0);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct MaterialOptions {
    /// A variant of the file: one of the sets of materials that it contains. [`super::load`] chooses it.
    pub variant: Option<String>,
    /// A preset's name, or a TOML file's path; see [`MaterialFile`].
    pub material: Option<String>,
    /// Factors for every material, replacing those of the file or of `material`.
    pub factors: MaterialFactors,
    /// Maps for every material.
    pub maps: MapOptions,
    /// `Down` makes green point down in every normal map, including the file's own; `Up` leaves each unchanged.
    pub green: GreenChannel,
}

impl MaterialOptions {
    /// Applies the material, the factors and the maps to every material of `scene`.
    ///
    /// # Errors
    /// As [`MaterialFile::choose`], [`MaterialFile::apply`] and [`MaterialFactors::apply`], and those of the maps.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        self.apply_within(scene, &Limits::default())
    }

    /// Like [`MaterialOptions::apply`], within limits of memory and pixels.
    pub(super) fn apply_within(&self, scene: &mut Scene, limits: &Limits) -> Result<()> {
        self.apply_with(scene, &mut reader(limits))
    }

    /// Like [`MaterialOptions::apply`], with the texels of maps from `read`, which need not be in files.
    ///
    /// # Errors
    /// As [`MaterialOptions::apply`], and those of `read`.
    pub fn apply_with(&self, scene: &mut Scene, read: &mut dyn FnMut(&Path) -> Result<Bitmap>) -> Result<()> {
        if let Some(choice) = &self.material {
            MaterialFile::choose(choice)?.apply_with(scene, read)?;
        }
        self.factors.apply(scene)?;
        self.maps.apply_with(scene, read)?;
        if self.green == GreenChannel::Down {
            scene.edit(point_down)?;
        }
        Ok(())
    }

    /// Returns the files that are read for the materials: a TOML file, its maps, and the requested maps.
    ///
    /// # Errors
    /// As [`MaterialFile::choose`].
    pub fn files(&self) -> Result<Vec<PathBuf>> {
        let mut files = self.maps.files();
        if let Some(choice) = self.material.as_ref().filter(|choice| preset(choice).is_none()) {
            files.push(PathBuf::from(choice));
            files.extend(MaterialFile::choose(choice)?.files());
        }
        Ok(files)
    }
}

/// Makes green point down in every normal map.
fn point_down(scene: &mut SceneData) {
    for material in &mut scene.materials {
        let coat = material.clearcoat.as_mut().and_then(|coat| coat.normal.as_mut());
        material.normal.iter_mut().chain(coat).for_each(|map| map.green = GreenChannel::Down);
    }
}

/// A material in a TOML file: factors, a base preset, and a table `[maps]`. Colours are linear RGB; paths are
/// relative to the file.
///
/// ```
/// use taotie::studio::MaterialFile;
/// use taotie::{Material, Mesh, Scene};
///
/// let old_bronze = MaterialFile::parse("preset = 'bronze'\nroughness = 0.6", "old_bronze.toml".as_ref())?;
/// let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// old_bronze.apply(&mut scene)?;
/// assert_eq!(scene.materials()[0].roughness, 0.6);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct MaterialFile {
    content: Content,
}

/// The content of the file.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Content {
    /// The base preset.
    preset: Option<String>,
    base_color: Option<[f32; 3]>,
    alpha: Option<f32>,
    metallic: Option<f32>,
    roughness: Option<f32>,
    f0: Option<[f32; 3]>,
    f82: Option<[f32; 3]>,
    ambient: Option<[f32; 3]>,
    diffuse: Option<[f32; 3]>,
    specular: Option<[f32; 3]>,
    shininess: Option<f32>,
    slope: Option<f32>,
    emissive: Option<[f32; 3]>,
    alpha_mode: Option<AlphaName>,
    alpha_cutoff: Option<f32>,
    double_sided: Option<bool>,
    unlit: Option<bool>,
    maps: MapNames,
}

/// The `[maps]` table.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MapNames {
    base_color: Option<PathBuf>,
    metallic_roughness: Option<PathBuf>,
    normal: Option<PathBuf>,
    normal_scale: Option<f32>,
    normal_space: Option<SpaceName>,
    green: Option<GreenName>,
    height: Option<PathBuf>,
    height_scale: Option<f32>,
    occlusion: Option<PathBuf>,
    emissive: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum AlphaName {
    Opaque,
    Mask,
    Blend,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum SpaceName {
    Tangent,
    Object,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum GreenName {
    Up,
    Down,
}

/// Returns an error that states the line and the fault, on a single line.
fn parse_error(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
    Error::parse(path, format!("line {line}"), error.message().replace('\n', " "))
}

fn unknown_preset() -> String {
    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    format!("no such preset; use a .toml file or one of: {}", names.join(", "))
}

impl MaterialFile {
    /// Returns the preset of this name, or reads the TOML file at this path.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `choice` is neither; the message lists the presets. As [`MaterialFile::parse`].
    pub fn choose(choice: &str) -> Result<Self> {
        if preset(choice).is_some() {
            let preset = Some(choice.to_string());
            return Ok(Self { content: Content { preset, ..Content::default() } });
        }
        let path = Path::new(choice);
        if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
            return Err(Error::invalid(format!("material {choice}"), unknown_preset()));
        }
        let text = String::from_utf8(taotie_io::read_bytes(path)?).map_err(|error| {
            let at = format!("byte {}", error.utf8_error().valid_up_to());
            Error::parse(path, at, "not valid UTF-8")
        })?;
        Self::parse(&text, path)
    }

    /// Parses the text of a file. Maps are relative to the folder of `path`, which appears in errors.
    ///
    /// # Errors
    /// [`Error::Parse`] if it is not valid TOML or has unknown keys, [`Error::Invalid`] for a value out of range.
    pub fn parse(text: &str, path: &Path) -> Result<Self> {
        let mut content: Content = toml::from_str(text).map_err(|error| parse_error(path, text, &error))?;
        content.maps.lie_in(path.parent().unwrap_or(Path::new("")));
        content.check().map_err(|error| error.within(path.display()))?;
        Ok(Self { content })
    }

    /// Returns the files of its maps.
    pub fn files(&self) -> Vec<PathBuf> {
        self.content.maps.options().files()
    }

    /// Applies the material to every material of `scene`; their relief and occlusion are kept if it has none.
    ///
    /// # Errors
    /// Those of the maps, and [`Error::Invalid`] for an unknown preset.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        self.apply_with(scene, &mut reader(&Limits::default()))
    }

    /// Like [`MaterialFile::apply`], with texels from `read`.
    fn apply_with(&self, scene: &mut Scene, read: &mut ReadMap<'_>) -> Result<()> {
        self.content.change(scene, read)?.apply(scene)?;
        Ok(())
    }
}

impl Content {
    /// Checks ranges, so that shading gets valid values only.
    fn check(&self) -> Result<()> {
        self.factors().check()?;
        for (name, value) in [("alpha", self.alpha), ("alpha_cutoff", self.alpha_cutoff)] {
            if value.is_some_and(|v| !(0.0..=1.0).contains(&v)) {
                return Err(Error::invalid(name, "it must be between 0 and 1"));
            }
        }
        let colors = [
            ("f0", self.f0),
            ("f82", self.f82),
            ("ambient", self.ambient),
            ("diffuse", self.diffuse),
            ("specular", self.specular),
        ];
        for (name, color) in colors {
            if color.is_some_and(|c| !Light::is_strength(Vec3::from_array(c))) {
                return Err(Error::invalid(name, "its components must be between 0 and 1e12"));
            }
        }
        Ok(())
    }

    fn change(&self, scene: &mut Scene, read: &mut ReadMap<'_>) -> Result<Change> {
        let mut material = match &self.preset {
            Some(name) => {
                Some(preset(name).ok_or_else(|| Error::invalid(format!("preset {name}"), unknown_preset()))?)
            }
            None => None,
        };
        if self.authors_reflectance() {
            let target = material.get_or_insert_with(Material::default);
            self.write_into(target);
        }
        let maps = self.maps.options().load(scene, read)?;
        Ok(Change { reflectance: material, ..maps })
    }

    fn authors_reflectance(&self) -> bool {
        let colors =
            [self.base_color, self.f0, self.f82, self.ambient, self.diffuse, self.specular, self.emissive];
        let numbers =
            [self.alpha, self.metallic, self.roughness, self.shininess, self.slope, self.alpha_cutoff];
        colors.iter().any(Option::is_some)
            || numbers.iter().any(Option::is_some)
            || self.alpha_mode.is_some()
            || self.double_sided.is_some()
            || self.unlit.is_some()
    }

    fn factors(&self) -> MaterialFactors {
        MaterialFactors {
            base_color: self.base_color,
            metallic: self.metallic,
            roughness: self.roughness,
            slope: self.slope,
            shininess: self.shininess,
            emissive: self.emissive,
        }
    }

    fn write_into(&self, material: &mut Material) {
        self.factors().write_into(material);
        material.base_color[3] = self.alpha.unwrap_or(material.base_color[3]);
        material.f0 = self.f0.or(material.f0);
        material.f82 = self.f82.or(material.f82);
        material.double_sided = self.double_sided.unwrap_or(material.double_sided);
        material.unlit = self.unlit.unwrap_or(material.unlit);
        let classic = &mut material.classic;
        classic.ambient = self.ambient.or(classic.ambient);
        classic.diffuse = self.diffuse.or(classic.diffuse);
        classic.specular = self.specular.or(classic.specular);
        material.alpha = match self.alpha_mode {
            Some(AlphaName::Opaque) => AlphaMode::Opaque,
            Some(AlphaName::Mask) => AlphaMode::Mask(self.alpha_cutoff.unwrap_or(0.5)),
            Some(AlphaName::Blend) => AlphaMode::Blend,
            None => material.alpha,
        };
    }
}

impl MapNames {
    /// Makes paths relative to `folder`.
    fn lie_in(&mut self, folder: &Path) {
        let names = [
            &mut self.base_color,
            &mut self.metallic_roughness,
            &mut self.normal,
            &mut self.height,
            &mut self.occlusion,
            &mut self.emissive,
        ];
        for name in names.into_iter().flatten() {
            *name = folder.join(&*name);
        }
    }

    fn options(&self) -> MapOptions {
        MapOptions {
            base_color: self.base_color.clone(),
            metallic_roughness: self.metallic_roughness.clone(),
            normal: self.normal.clone(),
            normal_scale: self.normal_scale.unwrap_or(1.0),
            normal_space: match self.normal_space {
                Some(SpaceName::Object) => NormalSpace::Object,
                _ => NormalSpace::Tangent,
            },
            green: match self.green {
                Some(GreenName::Down) => GreenChannel::Down,
                _ => GreenChannel::Up,
            },
            height: self.height.clone(),
            height_scale: self.height_scale,
            occlusion: self.occlusion.clone(),
            emissive: self.emissive.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        MaterialFile::parse(text, Path::new("a/m.toml")).unwrap_err().to_string()
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        assert!(refused("roughness = 0.5\nshinyness = 3").starts_with("a/m.toml: line 2: unknown field"));
        assert_eq!(refused("roughness = 2"), "a/m.toml: roughness: it must be between 0 and 1");
        assert_eq!(refused("slope = 0.0"), "a/m.toml: slope: it must be above 0 and at most 1e9");
        assert_eq!(refused("f0 = [0, 0, -1]"), "a/m.toml: f0: its components must be between 0 and 1e12");
        assert!(MaterialFile::choose("unobtainium").unwrap_err().to_string().contains("bronze-patina"));
    }

    #[test]
    fn maps_lie_beside_the_file() {
        let file = MaterialFile::parse("maps = { normal = 'n.png' }", Path::new("a/m.toml")).unwrap();
        assert_eq!(file.content.maps.options().normal, Some(PathBuf::from("a/n.png")));
    }
    /// A type that serde reads matches two implementations, and then the compiler cannot choose.
    trait Choice<T> {
        fn is_made() -> bool {
            true
        }
    }
    struct ReadBySerde;
    impl<T> Choice<()> for T {}
    impl<T: serde::de::DeserializeOwned> Choice<ReadBySerde> for T {}

    #[test]
    fn the_parser_is_no_part_of_the_interface() {
        assert!(<MaterialFile as Choice<_>>::is_made());
    }
}
