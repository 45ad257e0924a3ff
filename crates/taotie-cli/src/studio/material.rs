//! Materials from the command line: presets, TOML files and maps.

use super::MaterialArgs;
use super::args::Green;
use anyhow::{Context, Result, anyhow, bail};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use taotie::image::{Encoding, Sampler, Texture};
use taotie::scene::{
    AlphaMode, GreenChannel, HeightMap, Material, NormalMap, NormalSpace, PRESETS, Scene, TextureRef,
    UvTransform, preset,
};
use taotie::{Error, io};

/// Height of white where nothing says otherwise, as a fraction of the model's size.
const DEFAULT_HEIGHT: f64 = 0.01;

/// Puts what `--material` and the map options ask for into every material of the scene. `height_scale` is the height
/// of white in model units, where it was asked for.
pub fn apply(args: &MaterialArgs, height_scale: Option<f64>, scene: &mut Scene) -> Result<()> {
    if let Some(choice) = &args.material {
        apply_choice(choice, scene)?;
    }
    let maps = MapOptions {
        base_color: args.base_color_map.clone(),
        normal: args.normal_map.clone(),
        height: args.height_map.clone(),
        occlusion: args.occlusion_map.clone(),
        normal_space: args.normal_space.into(),
        green: args.green.into(),
        height_scale: height_scale.map(|scale| scale as f32),
        ..MapOptions::default()
    };
    let change = maps.load(scene)?;
    scene.edit(|scene| {
        for material in &mut scene.materials {
            change.apply(material);
            if args.green == Green::Down {
                let coat = material.clearcoat.as_mut().and_then(|coat| coat.normal.as_mut());
                material.normal.iter_mut().chain(coat).for_each(|map| map.green = GreenChannel::Down);
            }
        }
    })?;
    Ok(())
}

/// Puts a preset or what a TOML file asks for into every material of the scene.
pub fn apply_choice(choice: &str, scene: &mut Scene) -> Result<()> {
    let change = read_choice(choice)?.resolve(scene)?;
    scene.edit(|scene| scene.materials.iter_mut().for_each(|material| change.apply(material)))?;
    Ok(())
}

/// A material as a TOML file writes it. Colours are linear RGB; paths are relative to the file.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct MaterialFile {
    /// Start from a preset.
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

fn read_choice(choice: &str) -> Result<MaterialFile> {
    if preset(choice).is_some() {
        return Ok(MaterialFile { preset: Some(choice.to_string()), ..MaterialFile::default() });
    }
    let path = Path::new(choice);
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
        bail!("--material {choice}: {}", unknown_preset());
    }
    let text = std::fs::read_to_string(path).map_err(|error| Error::io(path, error))?;
    let mut file: MaterialFile = toml::from_str(&text).map_err(|error| parse_error(path, &text, &error))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let maps = &mut file.maps;
    let names = [
        &mut maps.base_color,
        &mut maps.metallic_roughness,
        &mut maps.normal,
        &mut maps.height,
        &mut maps.occlusion,
        &mut maps.emissive,
    ];
    for name in names.into_iter().flatten() {
        *name = folder.join(&*name);
    }
    file.check().with_context(|| path.display().to_string())?;
    Ok(file)
}

/// The line and what was wrong, in one line.
fn parse_error(path: &Path, text: &str, error: &toml::de::Error) -> Error {
    let line = error.span().map_or(1, |span| text[..span.start.min(text.len())].matches('\n').count() + 1);
    Error::parse(path, format!("line {line}"), error.message().replace('\n', " "))
}

fn unknown_preset() -> String {
    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    format!("there is no preset of this name; name a .toml file or choose one of: {}", names.join(", "))
}

impl MaterialFile {
    /// Ranges, so that shading cannot be given nonsense.
    fn check(&self) -> Result<()> {
        let unit = [
            ("metallic", self.metallic),
            ("roughness", self.roughness),
            ("alpha", self.alpha),
            ("alpha_cutoff", self.alpha_cutoff),
        ];
        for (name, value) in unit {
            if value.is_some_and(|v| !(0.0..=1.0).contains(&v)) {
                bail!("{name}: it must lie between 0 and 1");
            }
        }
        if self.shininess.is_some_and(|s| !(s >= 0.0 && s.is_finite())) {
            bail!("shininess: it must be 0 or more");
        }
        if self.slope.is_some_and(|s| !(s > 0.0 && s.is_finite())) {
            bail!("slope: it must be above 0");
        }
        let colors = [
            ("base_color", self.base_color),
            ("f0", self.f0),
            ("f82", self.f82),
            ("ambient", self.ambient),
            ("diffuse", self.diffuse),
            ("specular", self.specular),
            ("emissive", self.emissive),
        ];
        for (name, color) in colors {
            if color.is_some_and(|c| c.iter().any(|v| !(*v >= 0.0 && v.is_finite()))) {
                bail!("{name}: its numbers must be 0 or more");
            }
        }
        Ok(())
    }

    fn resolve(&self, scene: &mut Scene) -> Result<Change> {
        let mut material = match &self.preset {
            Some(name) => Some(preset(name).ok_or_else(|| anyhow!("preset {name}: {}", unknown_preset()))?),
            None => None,
        };
        if self.authors_reflectance() {
            let target = material.get_or_insert_with(Material::default);
            self.write_into(target);
        }
        let maps = self.maps.options().load(scene)?;
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

    fn write_into(&self, material: &mut Material) {
        let [r, g, b, a] = material.base_color;
        let [r, g, b] = self.base_color.unwrap_or([r, g, b]);
        material.base_color = [r, g, b, self.alpha.unwrap_or(a)];
        material.metallic = self.metallic.unwrap_or(material.metallic);
        material.roughness = self.roughness.unwrap_or(material.roughness);
        material.f0 = self.f0.or(material.f0);
        material.f82 = self.f82.or(material.f82);
        material.emissive = self.emissive.unwrap_or(material.emissive);
        material.double_sided = self.double_sided.unwrap_or(material.double_sided);
        material.unlit = self.unlit.unwrap_or(material.unlit);
        let classic = &mut material.classic;
        classic.ambient = self.ambient.or(classic.ambient);
        classic.diffuse = self.diffuse.or(classic.diffuse);
        classic.specular = self.specular.or(classic.specular);
        classic.shininess = self.shininess.or(classic.shininess);
        classic.slope = self.slope.or(classic.slope);
        material.alpha = match self.alpha_mode {
            Some(AlphaName::Opaque) => AlphaMode::Opaque,
            Some(AlphaName::Mask) => AlphaMode::Mask(self.alpha_cutoff.unwrap_or(0.5)),
            Some(AlphaName::Blend) => AlphaMode::Blend,
            None => material.alpha,
        };
    }
}

impl MapNames {
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

/// Maps to load.
#[derive(Debug, Clone)]
struct MapOptions {
    base_color: Option<PathBuf>,
    metallic_roughness: Option<PathBuf>,
    normal: Option<PathBuf>,
    normal_scale: f32,
    normal_space: NormalSpace,
    green: GreenChannel,
    height: Option<PathBuf>,
    height_scale: Option<f32>,
    occlusion: Option<PathBuf>,
    emissive: Option<PathBuf>,
}

impl Default for MapOptions {
    fn default() -> Self {
        MapNames::default().options()
    }
}

impl MapOptions {
    fn load(&self, scene: &mut Scene) -> Result<Change> {
        let size = scene.bounds().map_or(1.0, |bounds| bounds.diagonal());
        let mut load = |path: &Option<PathBuf>, encoding| {
            path.as_ref().map(|path| load_texture(scene, path, encoding)).transpose()
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

fn load_texture(scene: &mut Scene, path: &Path, encoding: Encoding) -> Result<TextureRef> {
    Ok(TextureRef {
        texture: scene.add_texture(Texture::new(io::read_bitmap(path)?, encoding)),
        uv_set: 0,
        sampler: Sampler::default(),
        transform: UvTransform::default(),
    })
}

/// What becomes of each material.
struct Change {
    /// Replaces how it reflects; maps of relief and occlusion stay.
    reflectance: Option<Material>,
    base_color: Option<TextureRef>,
    metallic_roughness: Option<TextureRef>,
    normal: Option<NormalMap>,
    height: Option<HeightMap>,
    occlusion: Option<TextureRef>,
    emissive: Option<TextureRef>,
}

impl Change {
    fn apply(&self, material: &mut Material) {
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
