//! The options of `taotie render`, with those of its integrator and device, and the file formats that they ask for.

use super::plan::MotionArgs;
use crate::device::{Device, Machine};
use crate::options;
use crate::running::RunningArgs;
use crate::studio::{
    self, CameraArgs, FilmArgs, Framing, LightArgs, MaterialArgs, ReflectionArgs, SurfaceArgs,
};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use taotie_engine::Warnings;
use taotie_engine::render::{Aovs, NormalMapping, ReferenceSettings, RenderSettings, SurfaceSettings};
use taotie_engine::scene::Scene;
use taotie_engine::surface::SurfaceMethod;
use taotie_io::{AnimationFormat, FileSet, ImageFormat};

const EXAMPLES: &str = "\
Examples:
  taotie render statue.obj --normal-map statue_normals.png --material bronze --shadows -o statue.png
  taotie render model.glb --orbit 30,20 --size 1920x1080 --samples 16 -o model.png
  taotie render model.glb --light \"directional from=-75,10 strength=4\" --shadows -o raking.png
  taotie render model.glb --integrator reference --spp 256 -o truth.png
  taotie render model.glb --turntable 36 -o turn.png
  taotie render model.glb --animation Walk --fps 24 -o walk.gif";

/// Renders a model (glTF, GLB, OBJ, PLY, STL, FBX) to a picture (PNG, EXR) or an animation (PNG, GIF).
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct RenderArgs {
    /// The model: .gltf, .glb, .obj, .ply, .stl or .fbx
    pub model: PathBuf,
    /// The picture to write: .png (sRGB) or .exr (linear). With several pictures, a .png or .gif holds them as an
    /// animation, and numbered pictures are written next to it
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    #[command(flatten)]
    pub surface: SurfaceArgs,
    #[command(flatten)]
    pub reflection: ReflectionArgs,
    #[command(flatten)]
    pub material: MaterialArgs,
    #[command(flatten)]
    pub light: LightArgs,
    /// Add an invisible ground that catches the object's soft shadow
    #[arg(long, help_heading = "Light")]
    pub ground: bool,
    #[command(flatten)]
    pub camera: CameraArgs,
    #[command(flatten)]
    pub motion: MotionArgs,

    /// Width and height of the picture, pixels, or one number for both
    #[arg(long, value_name = "N|WxH", value_parser = options::size, default_value = "1024x1024", help_heading = "Picture")]
    pub size: [u32; 2],
    #[command(flatten)]
    pub film: FilmArgs,
    /// Bits per channel of a PNG [default: 8]
    #[arg(long, value_parser = ["8", "16"], help_heading = "Picture")]
    pub bits: Option<String>,
    /// Also write output variables (AOVs), unfiltered, as OUT.NAME.exr and OUT.NAME.png, separated by commas:
    /// normals, depth, albedo, uv, triangle, position
    #[arg(long = "aov", value_name = "LIST", value_delimiter = ',', value_parser = options::word, help_heading = "Picture")]
    pub aovs: Vec<String>,

    #[command(flatten)]
    pub integrator: IntegratorArgs,
    /// Device to render on; only images from the CPU are bit-identical everywhere. Output variables and the reference
    /// integrator need the CPU, which auto then chooses
    #[arg(long, value_enum, default_value_t = Device::Cpu, help_heading = "Integrator")]
    pub device: Device,

    #[command(flatten)]
    pub running: RunningArgs,
}

impl RenderArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        if let Some(unknown) = self.aovs.iter().find(|name| !Aovs::NAMES.contains(&name.as_str())) {
            bail!("--aov {unknown}: unknown output variable; expected one of: {}", Aovs::NAMES.join(", "));
        }
        self.surface.check(Some(&self.material))?;
        self.material.check(&[self.surface.shading])?;
        self.reflection.check(&[self.surface.shading])?;
        self.light.check()?;
        self.camera.check()?;
        self.film.check(self.light.show_env)?;
        self.integrator.check(&self.film, &self.reflection)?;
        self.check_device()?;
        self.running.check()?;
        self.motion.check()?;
        self.check_picture(self.formats()?.still)
    }

    /// Rejects options that a GPU does not support.
    fn check_device(&self) -> Result<()> {
        if self.device != Device::Gpu {
            return Ok(());
        }
        if self.integrator.reference().is_some() {
            bail!("--device gpu: the reference integrator runs on the CPU; leave out --integrator reference");
        }
        if !self.aovs.is_empty() {
            bail!("--device gpu: output variables are computed on the CPU; leave out --aov");
        }
        Ok(())
    }

    /// Finds the device.
    pub fn machine(&self) -> Result<Machine> {
        let needs_cpu = self.settings().aovs || self.integrator.reference().is_some();
        let why = needs_cpu.then_some("output variables and the reference integrator need it");
        Machine::find(self.device, why)
    }

    /// Returns the file formats of the pictures.
    pub fn formats(&self) -> Result<Formats> {
        Formats::of(&self.output, self.bits.as_deref(), self.motion.takes_several())
    }

    /// Rejects a picture that cannot be written or that is an input.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect([&self.model])?;
        files.protect(studio::material_files(&self.material)?)?;
        files.protect(self.light.environment_file())?;
        Ok(files.claim(&self.output)?)
    }

    /// Adds a warning for each option without effect on this model: shadows without lights, heights behind normal
    /// maps.
    pub fn note_unread(&self, scene: &Scene, warnings: &mut Warnings) {
        self.light.note_unread(scene, warnings);
        let maps = [SurfaceMethod::ObjectNormal, SurfaceMethod::TangentNormal];
        let reads = self.surface.method.is_none_or(|surface| maps.contains(&surface));
        self.material.note_tangents(reads, scene, warnings);
        let asked = self.surface.bump_scale.is_some() || self.material.height_map.is_some();
        let mut lifted = scene.materials().iter().filter(|material| material.height.is_some()).peekable();
        if self.surface.method.is_none()
            && asked
            && lifted.peek().is_some()
            && lifted.all(|m| m.normal.is_some())
        {
            warnings.note(
                "heights have no effect: a normal map takes precedence; add --surface bump to use them",
                1,
            );
        }
    }

    /// Rejects options that a picture of this format does not support.
    fn check_picture(&self, format: ImageFormat) -> Result<()> {
        if format != ImageFormat::Exr {
            return Ok(());
        }
        if self.motion.turntable.is_some() && self.motion.fps.is_some() {
            bail!("--fps has no effect for .exr turntables; write .png or .gif for an animation");
        }
        if self.bits.is_some() {
            bail!("--bits: an .exr stores 32-bit floats; leave it out, or write a .png");
        }
        self.film.check_linear()
    }

    /// Returns the settings of the renderer.
    pub fn settings(&self) -> RenderSettings {
        let shown = self.surface.settings();
        self.reflection.apply(RenderSettings {
            width: self.size[0],
            height: self.size[1],
            samples: self.film.samples(),
            surface: SurfaceSettings {
                tangents: self.material.tangents,
                simd: self.running.simd,
                ..shown.surface
            },
            // Path tracing always has shadows.
            shadows: self.light.shadows || self.integrator.reference().is_some(),
            ground: self.ground,
            aovs: !self.aovs.is_empty(),
            ..shown
        })
    }

    /// Returns the part of the scene that must fit into the picture.
    pub fn framing(&self) -> Framing {
        Framing { size: self.size, all_around: self.motion.turntable.is_some() }
    }
}

/// The choice of renderer, and its options.
#[derive(Args)]
#[command(next_help_heading = "Integrator")]
pub struct IntegratorArgs {
    /// Renderer
    #[arg(long, value_enum, default_value_t = Integrator::Raster)]
    pub integrator: Integrator,
    /// Paths per pixel of `reference`; four times as many at least halve the noise [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub spp: Option<u32>,
    /// Reflections of light after the first one in `reference`; 0 is direct light only [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(ReferenceSettings::MOST_BOUNCES)))]
    pub bounces: Option<u32>,
    /// Seed of the noise of `reference` [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u32>,
    /// Meaning of a mapped normal in `reference`: classic, or microfacet, a groove of two facets that conserves
    /// energy and leaves no black pixels [default: classic]
    #[arg(long, value_name = "HOW", value_parser = options::named::<NormalMapping>)]
    pub normal_mapping: Option<NormalMapping>,
}

/// A renderer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// Rasteriser: fast, direct light and environment
    Raster,
    /// Path tracer: slow, the reference, with shadows and interreflections
    Reference,
}

impl IntegratorArgs {
    /// Rejects options that the chosen integrator does not use.
    fn check(&self, film: &FilmArgs, reflection: &ReflectionArgs) -> Result<()> {
        match self.integrator {
            Integrator::Raster => {
                let given = [
                    ("--spp", self.spp.is_some()),
                    ("--bounces", self.bounces.is_some()),
                    ("--seed", self.seed.is_some()),
                    ("--normal-mapping", self.normal_mapping.is_some()),
                ];
                if let Some((option, _)) = given.iter().find(|(_, given)| *given) {
                    bail!(
                        "{option}: the rasteriser traces no paths; add --integrator reference or leave it out"
                    );
                }
            }
            Integrator::Reference if film.samples.is_some() => {
                bail!("--samples: --integrator reference takes the number of paths per pixel from --spp N");
            }
            Integrator::Reference if reflection.specular_aa.is_some() => {
                bail!("--specular-aa: --integrator reference averages many paths instead; leave it out");
            }
            Integrator::Reference => {}
        }
        Ok(())
    }

    /// Returns the settings of the path tracer, or `None` for the rasteriser.
    pub fn reference(&self) -> Option<ReferenceSettings> {
        let default = ReferenceSettings::default();
        (self.integrator == Integrator::Reference).then(|| ReferenceSettings {
            spp: self.spp.unwrap_or(default.spp),
            bounces: self.bounces.unwrap_or(default.bounces),
            seed: self.seed.unwrap_or(default.seed),
            normal_mapping: self.normal_mapping.unwrap_or(default.normal_mapping),
            ..default
        })
    }

    /// Returns the choice for reports.
    pub fn report(&self) -> IntegratorReport {
        match self.reference() {
            None => IntegratorReport::Raster,
            Some(ReferenceSettings { spp, bounces, seed, normal_mapping, .. }) => {
                IntegratorReport::Reference { spp, bounces, seed, normal_mapping }
            }
        }
    }
}

/// The integrator of a picture, for reports.
#[derive(Serialize)]
#[serde(tag = "name", rename_all = "lowercase")]
pub enum IntegratorReport {
    /// The rasteriser.
    Raster,
    /// The path tracer.
    Reference {
        /// Paths per pixel.
        spp: u32,
        /// The largest number of bounces.
        bounces: u32,
        /// The seed of the random numbers.
        seed: u32,
        /// How light interprets a mapped normal.
        normal_mapping: NormalMapping,
    },
}

/// The file formats of the pictures of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Formats {
    /// The format of each picture.
    pub still: ImageFormat,
    /// The format of the animation, if there are several pictures and the format supports one.
    pub moving: Option<AnimationFormat>,
}

impl Formats {
    /// Chooses the formats by the extension of the output, the bits per channel of a PNG, and whether there are
    /// several pictures.
    fn of(output: &Path, bits: Option<&str>, several: bool) -> Result<Self> {
        let extension = output.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let png = if bits == Some("16") { ImageFormat::Png16 } else { ImageFormat::Png8 };
        let (still, moving) = match extension.as_str() {
            "png" => (png, Some(AnimationFormat::Png)),
            "gif" => (png, Some(AnimationFormat::Gif)),
            "exr" => (ImageFormat::Exr, None),
            _ => bail!(
                "{}: pictures are written as .png or .exr, animations as .png or .gif",
                output.display()
            ),
        };
        if !several && moving == Some(AnimationFormat::Gif) {
            let path = output.display();
            bail!("{path}: a .gif holds an animation; add --turntable, --frames or --fps, or write a .png");
        }
        Ok(Self { still, moving: moving.filter(|_| several) })
    }
}
