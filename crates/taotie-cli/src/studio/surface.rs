//! The options of surfaces: their shading, their material, and the details of reflection.

use crate::options;
use anyhow::{Result, bail};
use clap::{ArgAction, Args, ValueEnum, ValueHint};
use serde::Serialize;
use std::borrow::Cow;
use std::path::PathBuf;
use taotie::studio::{MapOptions, MaterialFactors, MaterialOptions};
use taotie_engine::Warnings;
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::render::{GrazingNormals, RenderSettings, SurfaceSettings};
use taotie_engine::scene::{GreenChannel, Material, NormalSpace, Scene};
use taotie_engine::shade::{Energy, Shading};
use taotie_engine::surface::{SurfaceMethod, TangentMethod};

/// How the surface is shaded.
#[derive(Args)]
#[command(next_help_heading = "Surface")]
pub struct SurfaceArgs {
    /// Reflectance model: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or
    /// cook-torrance-printed, blinn-phong-printed, ggx-printed
    #[arg(long, value_parser = options::named::<Shading>, default_value = "ggx")]
    pub shading: Shading,
    /// Source of the shading normals: facet, smooth, bump, bump-printed, object-normal, tangent-normal
    /// [default: the best that the material provides]
    #[arg(id = "surface", long, value_name = "SURFACE", value_parser = options::named::<SurfaceMethod>)]
    pub method: Option<SurfaceMethod>,
    /// Height of white for `bump`, model units; for `bump-printed` the factor s of Guo and Wang 2025, which has no
    /// unit
    #[arg(long, value_name = "X", value_parser = options::number, allow_negative_numbers = true)]
    pub bump_scale: Option<f64>,
}

impl SurfaceArgs {
    /// Rejects options that the requested method does not use: a height of white, and maps of `material`.
    pub fn check(&self, material: Option<&MaterialArgs>) -> Result<()> {
        use SurfaceMethod::{Bump, BumpPrinted, ObjectNormal, TangentNormal};
        let Some(method) = self.method else { return Ok(()) };
        let bumps = matches!(method, Bump | BumpPrinted);
        let maps = matches!(method, ObjectNormal | TangentNormal);
        let unread = [
            ("--bump-scale", self.bump_scale.is_some() && !bumps),
            ("--height-map", material.is_some_and(|m| m.height_map.is_some()) && !bumps),
            ("--normal-map", material.is_some_and(|m| m.normal_map.is_some()) && !maps),
        ];
        match unread.iter().find(|(_, is)| *is) {
            Some((option, _)) => {
                bail!("{option}: --surface {} does not use it; leave one of them out", method.name())
            }
            None => Ok(()),
        }
    }

    /// Returns the settings of the renderer that show it.
    pub fn settings(&self) -> RenderSettings {
        let bump_scale = self.bump_scale.map(|scale| scale as f32);
        let surface = SurfaceSettings { method: self.method, bump_scale, ..SurfaceSettings::default() };
        RenderSettings { shading: self.shading, surface, ..RenderSettings::default() }
    }
}

/// The material of the surface.
#[derive(Args)]
#[command(next_help_heading = "Surface")]
pub struct MaterialArgs {
    /// Tangents: face, averaged, mikktspace [default: those of the file, otherwise mikktspace]
    #[arg(long, value_parser = options::named::<TangentMethod>)]
    pub tangents: Option<TangentMethod>,
    /// Material variant of the file (KHR_materials_variants)
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// A preset, as `taotie materials` lists them, or a TOML file; the model keeps its maps
    #[arg(long, value_name = "NAME|FILE", value_hint = ValueHint::FilePath)]
    pub material: Option<String>,
    /// Base colour of every material, a colour or a linear grey value; textures are multiplied by it
    #[arg(long, value_name = "COLOR", value_parser = options::color)]
    pub base_color: Option<Vec3>,
    /// Metallic factor of every material, [0, 1]; textures are multiplied by it
    #[arg(long, value_name = "X", value_parser = options::fraction)]
    pub metallic: Option<f64>,
    /// Roughness of every material, [0, 1]; textures are multiplied by it
    #[arg(long, value_name = "X", value_parser = options::fraction)]
    pub roughness: Option<f64>,
    /// Root mean square slope of every material, above 0, for cook-torrance [default: the square of the roughness]
    #[arg(long, value_name = "X", value_parser = options::positive)]
    pub slope: Option<f64>,
    /// Exponent of every material, 0 or more, for phong and blinn-phong [default: derived from the roughness]
    #[arg(long, value_name = "X", value_parser = options::at_least_0)]
    pub shininess: Option<f64>,
    /// A base colour texture for every material
    #[arg(long, value_name = "FILE")]
    pub base_color_map: Option<PathBuf>,
    /// A normal map for every material
    #[arg(long, value_name = "FILE")]
    pub normal_map: Option<PathBuf>,
    /// Space of --normal-map
    #[arg(long, value_enum, default_value_t = Space::Tangent, requires = "normal_map")]
    pub normal_space: Space,
    /// Direction of green in normal maps: up (OpenGL, glTF) or down (DirectX) [default: up]
    #[arg(long, value_enum)]
    pub green: Option<Green>,
    /// A height map for every material; white is high
    #[arg(long, value_name = "FILE")]
    pub height_map: Option<PathBuf>,
    /// An ambient-occlusion map for every material
    #[arg(long, value_name = "FILE")]
    pub occlusion_map: Option<PathBuf>,
}

/// Space of a normal map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Space {
    /// Relative to tangent, bitangent and normal
    Tangent,
    /// Object space
    Object,
}

/// Direction of a normal map's green channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Green {
    /// OpenGL, glTF
    Up,
    /// DirectX
    Down,
}

impl From<Space> for NormalSpace {
    fn from(space: Space) -> Self {
        match space {
            Space::Tangent => Self::Tangent,
            Space::Object => Self::Object,
        }
    }
}

impl From<Green> for GreenChannel {
    fn from(green: Green) -> Self {
        match green {
            Green::Up => Self::Up,
            Green::Down => Self::Down,
        }
    }
}

impl MaterialArgs {
    /// Adds a warning for tangents that nothing uses although a material has a normal map: no normal map is read, no
    /// material is anisotropic, and no clearcoat has its own normal map.
    pub fn note_tangents(&self, reads_normal_maps: bool, scene: &Scene, warnings: &mut Warnings) {
        let materials = scene.materials();
        let has_coat_map =
            |material: &Material| material.clearcoat.as_ref().is_some_and(|c| c.normal.is_some());
        let stretched = materials.iter().any(|m| m.has_direction() || has_coat_map(m));
        let mapped = materials.iter().any(|material| material.normal.is_some());
        // Without any map, the warning is added when the model is read.
        let unread = self.tangents.is_some() && mapped && !stretched && !reads_normal_maps;
        warnings.note("--tangents has no effect: no normal map is used", usize::from(unread));
    }

    /// Returns the requested materials. `height_scale` is the height of white in model units, if given.
    pub fn options(&self, height_scale: Option<f64>) -> MaterialOptions {
        let maps = MapOptions {
            base_color: self.base_color_map.clone(),
            normal: self.normal_map.clone(),
            normal_space: self.normal_space.into(),
            green: self.green().into(),
            height: self.height_map.clone(),
            height_scale: height_scale.map(|scale| scale as f32),
            occlusion: self.occlusion_map.clone(),
            ..MapOptions::default()
        };
        let (variant, material) = (self.variant.clone(), self.material.clone());
        MaterialOptions { variant, material, factors: self.factors(), maps, green: self.green().into() }
    }

    /// Returns the requested factors.
    pub fn factors(&self) -> MaterialFactors {
        let number = |value: Option<f64>| value.map(|value| value as f32);
        MaterialFactors {
            base_color: self.base_color.map(Vec3::to_array),
            metallic: number(self.metallic),
            roughness: number(self.roughness),
            slope: number(self.slope),
            shininess: number(self.shininess),
            emissive: None,
        }
    }

    /// Rejects factors that none of the reflectance models uses.
    pub fn check(&self, shadings: &[Shading]) -> Result<()> {
        use Shading::{
            BlinnPhong, BlinnPhongClassic, BlinnPhongPrinted, CookTorrance, CookTorrancePrinted, Lambert,
            Phong,
        };
        let any = |reads: fn(&Shading) -> bool| shadings.iter().any(reads);
        let of_slope = any(|shading| matches!(shading, CookTorrance | CookTorrancePrinted));
        let of_shininess =
            any(|shading| matches!(shading, Phong | BlinnPhong | BlinnPhongClassic | BlinnPhongPrinted));
        let unread = [
            ("--slope", self.slope.is_some() && !of_slope, "cook-torrance"),
            ("--shininess", self.shininess.is_some() && !of_shininess, "phong or blinn-phong"),
            ("--roughness", self.roughness.is_some() && !any(|shading| *shading != Lambert), "ggx"),
        ];
        match unread.iter().find(|(_, is, _)| *is) {
            Some((option, _, reader)) => {
                bail!("{option}: the shading does not use it; leave it out, or use --shading {reader}")
            }
            None => Ok(()),
        }
    }

    fn green(&self) -> Green {
        self.green.unwrap_or(Green::Up)
    }

    /// Returns the options for reports.
    pub fn report(&self) -> MaterialReport<'_> {
        MaterialReport {
            variant: self.variant.as_deref(),
            material: self.material.as_deref(),
            base_color: self.base_color.map(Vec3::to_array),
            metallic: self.metallic,
            roughness: self.roughness,
            slope: self.slope,
            shininess: self.shininess,
            base_color_map: lossy(self.base_color_map.as_ref()),
            normal_map: lossy(self.normal_map.as_ref()),
            normal_space: self.normal_space.to_possible_value().map(|value| value.get_name().to_owned()),
            green: self.green().to_possible_value().map(|value| value.get_name().to_owned()),
            height_map: lossy(self.height_map.as_ref()),
            occlusion_map: lossy(self.occlusion_map.as_ref()),
        }
    }
}

fn lossy(path: Option<&PathBuf>) -> Option<Cow<'_, str>> {
    path.map(|path| path.to_string_lossy())
}

/// The options that replace parts of the model's materials, for reports; `None` keeps the model's.
#[derive(Serialize)]
pub struct MaterialReport<'a> {
    /// The material variant of the file.
    variant: Option<&'a str>,
    /// The preset, or the TOML file.
    material: Option<&'a str>,
    /// Linear RGB.
    base_color: Option<[f32; 3]>,
    /// The metallic factor, [0, 1].
    metallic: Option<f64>,
    /// The perceptual roughness, [0, 1].
    roughness: Option<f64>,
    /// The slope of `cook-torrance`.
    slope: Option<f64>,
    /// The exponent of Phong and Blinn-Phong.
    shininess: Option<f64>,
    /// The texture of the base colour.
    base_color_map: Option<Cow<'a, str>>,
    /// The normal map.
    normal_map: Option<Cow<'a, str>>,
    /// The space of the normal map: `tangent` or `object`.
    normal_space: Option<String>,
    /// The green direction of the normal map: `up` or `down`.
    green: Option<String>,
    /// The height map.
    height_map: Option<Cow<'a, str>>,
    /// The occlusion map.
    occlusion_map: Option<Cow<'a, str>>,
}

/// Adds a warning for each option that has no effect on the scene. `height_scale` is the height of white, if given.
pub fn note_unread(args: &MaterialArgs, height_scale: Option<f64>, scene: &Scene, warnings: &mut Warnings) {
    let materials = scene.materials();
    let is_plain = scene.meshes().iter().all(|mesh| mesh.uvs().is_empty());
    let (mapped, lifted) = (materials.iter().any(has_normal_map), materials.iter().any(has_heights));
    let framed = mapped || materials.iter().any(Material::has_direction);
    let unread = [
        ("--green has no effect: no material has a normal map", args.green.is_some() && !mapped),
        ("--bump-scale has no effect: no material has a height map", height_scale.is_some() && !lifted),
        (
            "--tangents has no effect: no material has a normal map or is anisotropic",
            args.tangents.is_some() && !framed,
        ),
        (
            "--base-color-map shows one texel everywhere: no mesh has uvs",
            args.base_color_map.is_some() && is_plain,
        ),
        (
            "--occlusion-map shows one texel everywhere: no mesh has uvs",
            args.occlusion_map.is_some() && is_plain,
        ),
    ];
    unread.iter().for_each(|(what, is)| warnings.note(*what, usize::from(*is)));
}

fn has_normal_map(material: &Material) -> bool {
    material.normal.is_some() || material.clearcoat.as_ref().is_some_and(|coat| coat.normal.is_some())
}

fn has_heights(material: &Material) -> bool {
    material.height.is_some()
}

/// The details of reflection.
#[derive(Args)]
#[command(next_help_heading = "Surface")]
pub struct ReflectionArgs {
    /// Light between microfacets in ggx and cook-torrance: compensated (multiple scattering) or single (lost)
    /// [default: compensated]
    #[arg(long, value_parser = options::named::<Energy>)]
    pub energy: Option<Energy>,
    /// Specular antialiasing: relief finer than a pixel widens the highlight instead of sparkling [default: on]
    #[arg(long, value_name = "on|off", value_parser = options::switch, action = ArgAction::Set)]
    pub specular_aa: Option<bool>,
    /// Mapped normals that face away from the viewer: soften bends them until they are just visible, keep leaves them
    /// as in the map [default: soften]
    #[arg(long, value_name = "HOW", value_parser = options::named::<GrazingNormals>)]
    pub grazing_normals: Option<GrazingNormals>,
}

impl ReflectionArgs {
    /// Rejects options that none of the reflectance models uses.
    pub fn check(&self, shadings: &[Shading]) -> Result<()> {
        let compensates = |shading: &Shading| matches!(shading, Shading::Ggx | Shading::CookTorrance);
        if self.energy.is_some() && !shadings.iter().any(compensates) {
            bail!("--energy: only ggx and cook-torrance use it; choose one of them with --shading");
        }
        let corrections = [
            ("--specular-aa", self.specular_aa.is_some()),
            ("--grazing-normals", self.grazing_normals.is_some()),
        ];
        let given = corrections.iter().find(|(_, given)| *given);
        match given {
            Some((option, _)) if shadings.iter().all(|shading| shading.is_printed()) => {
                bail!("{option}: the printed models take no corrections; choose another with --shading")
            }
            _ => Ok(()),
        }
    }

    /// Returns `settings` with these details.
    pub fn apply(&self, settings: RenderSettings) -> RenderSettings {
        RenderSettings {
            energy: self.energy(),
            specular_aa: self.specular_aa(),
            grazing_normals: self.grazing_normals(),
            ..settings
        }
    }

    fn energy(&self) -> Energy {
        self.energy.unwrap_or_default()
    }

    fn specular_aa(&self) -> bool {
        self.specular_aa.unwrap_or(true)
    }

    fn grazing_normals(&self) -> GrazingNormals {
        self.grazing_normals.unwrap_or_default()
    }

    /// Returns the options for reports.
    pub fn report(&self) -> ReflectionReport {
        ReflectionReport {
            energy: self.energy(),
            specular_aa: self.specular_aa(),
            grazing_normals: self.grazing_normals(),
        }
    }
}

/// The details of reflection, for reports.
#[derive(Serialize)]
pub struct ReflectionReport {
    /// How microfacet models treat energy.
    energy: Energy,
    /// `true` if relief finer than a pixel widens the highlight.
    specular_aa: bool,
    /// How mapped normals that face away from the viewer are treated.
    grazing_normals: GrazingNormals,
}
