//! The options of `taotie render`.

use crate::options;
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use taotie::film::{Development, ToneCurve};
use taotie::math::{SimdLevel, Vec3};
use taotie::render::{Aovs, RenderSettings, SurfaceSettings};
use taotie::scene::{GreenChannel, NormalSpace, Scene};
use taotie::shade::Shading;
use taotie::surface::{SurfaceMethod, TangentMethod};

const EXAMPLES: &str = "\
Examples:
  taotie render statue.obj --normal-map statue_normals.png --material bronze --shadows -o statue.png
  taotie render model.glb --orbit 30,20 --size 1920x1080 --samples 16 -o model.png
  taotie render model.glb --light \"directional from=-75,10 strength=4\" --shadows -o raking.png
  taotie render model.glb --turntable 36 -o turn.png";

/// Renders a model (glTF, GLB, OBJ, PLY, STL) to a picture (PNG, EXR).
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct RenderArgs {
    /// The model: .gltf, .glb, .obj, .ply or .stl
    pub model: PathBuf,
    /// The picture to write: .png (sRGB) or .exr (linear)
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,

    /// Reflectance model: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or
    /// cook-torrance-printed, blinn-phong-printed, ggx-printed
    #[arg(long, value_parser = options::named::<Shading>, default_value = "ggx", help_heading = "Surface")]
    pub shading: Shading,
    /// Where normals come from: facet, smooth, bump, bump-printed, object-normal, tangent-normal; the best that the
    /// material provides if not given
    #[arg(long, value_parser = options::named::<SurfaceMethod>, help_heading = "Surface")]
    pub surface: Option<SurfaceMethod>,
    /// How tangents are made: face, averaged, mikktspace; if not given the file's own, else mikktspace
    #[arg(long, value_parser = options::named::<TangentMethod>, help_heading = "Surface")]
    pub tangents: Option<TangentMethod>,
    /// Height of white in model units for `bump`, the paper's factor for `bump-printed`
    #[arg(long, value_name = "X", value_parser = options::number, allow_negative_numbers = true, help_heading = "Surface")]
    pub bump_scale: Option<f64>,
    /// A preset's name or a TOML file; maps of the model stay
    #[arg(long, value_name = "NAME|FILE", help_heading = "Surface")]
    pub material: Option<String>,
    /// A base colour texture for every material
    #[arg(long, value_name = "FILE", help_heading = "Surface")]
    pub base_color_map: Option<PathBuf>,
    /// A normal map for every material
    #[arg(long, value_name = "FILE", help_heading = "Surface")]
    pub normal_map: Option<PathBuf>,
    /// Space of the normal map
    #[arg(long, value_enum, default_value_t = Space::Tangent, help_heading = "Surface")]
    pub normal_space: Space,
    /// Which way green points in normal maps: up (OpenGL, glTF) or down (DirectX)
    #[arg(long, value_enum, default_value_t = Green::Up, help_heading = "Surface")]
    pub green: Green,
    /// A height map for every material, white is high
    #[arg(long, value_name = "FILE", help_heading = "Surface")]
    pub height_map: Option<PathBuf>,
    /// An occlusion map for every material
    #[arg(long, value_name = "FILE", help_heading = "Surface")]
    pub occlusion_map: Option<PathBuf>,

    /// A light: `point at=X,Y,Z`, `spot at=X,Y,Z toward=X,Y,Z angle=DEG`, or `directional from=AZIMUTH,ELEVATION`
    /// (degrees, relative to the view), each with strength=, color=, falloff=none|inverse-square; may be repeated.
    /// Without any: the file's lights, else key, fill and rim
    #[arg(long = "light", value_name = "SPEC", help_heading = "Light")]
    pub lights: Vec<String>,
    /// Radiance from all around, a colour or a linear grey
    #[arg(long, value_name = "COLOR", value_parser = options::color, help_heading = "Light")]
    pub ambient: Option<Vec3>,
    /// Lights cast shadows
    #[arg(long, help_heading = "Light")]
    pub shadows: bool,

    /// A camera of the file by name
    #[arg(long, value_name = "NAME", conflicts_with = "orbit", help_heading = "Camera")]
    pub camera: Option<String>,
    /// Look from AZIMUTH,ELEVATION in degrees at a distance in model units, or as far as frames the object
    #[arg(long, value_name = "AZ,EL[,DIST]", value_parser = options::numbers, allow_hyphen_values = true, help_heading = "Camera")]
    pub orbit: Option<std::vec::Vec<f64>>,
    /// What to look at; the object's middle if not given
    #[arg(long, value_name = "X,Y,Z", value_parser = options::vector, allow_hyphen_values = true, help_heading = "Camera")]
    pub target: Option<Vec3<f64>>,
    /// Vertical angle of view in degrees
    #[arg(long, value_name = "DEG", value_parser = options::number, default_value = "30", help_heading = "Camera")]
    pub fov_deg: f64,
    /// Writes N pictures around the object, numbered
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=9999), help_heading = "Camera")]
    pub turntable: Option<u32>,

    /// Pixels across and down
    #[arg(long, value_name = "WxH", value_parser = options::size, default_value = "1024x1024", help_heading = "Picture")]
    pub size: [u32; 2],
    /// Samples a pixel: 1, 4 or 16
    #[arg(long, default_value_t = 4, help_heading = "Picture")]
    pub samples: u32,
    /// Tone curve: neutral, linear, reinhard, aces, agx
    #[arg(long, value_parser = options::named::<ToneCurve>, default_value = "neutral", help_heading = "Picture")]
    pub tone: ToneCurve,
    /// Exposure in stops
    #[arg(long, value_name = "STOPS", value_parser = options::number, default_value = "0", allow_negative_numbers = true, help_heading = "Picture")]
    pub exposure: f64,
    /// A colour, or `transparent`
    #[arg(long, value_name = "COLOR|transparent", default_value = "#2a2b2e", help_heading = "Picture")]
    pub background: String,
    /// Bits a channel of a PNG
    #[arg(long, value_parser = ["8", "16"], default_value = "8", help_heading = "Picture")]
    pub bits: String,
    /// Also write what was seen, unfiltered, as OUT.NAME.exr and OUT.NAME.png: normals, depth, albedo, uv, triangle
    #[arg(long = "aov", value_name = "LIST", value_delimiter = ',', help_heading = "Picture")]
    pub aovs: Vec<String>,

    /// Threads; all of the machine's if not given. Pixels do not depend on it
    #[arg(long, value_name = "N", help_heading = "Running")]
    pub threads: Option<usize>,
    /// SIMD level: auto, scalar, sse2, avx2, neon. Pixels do not depend on it
    #[arg(long, value_parser = options::named::<SimdLevel>, default_value = "auto", help_heading = "Running")]
    pub simd: SimdLevel,
    /// Print a report as JSON
    #[arg(long, help_heading = "Running")]
    pub json: bool,
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

/// Ambient radiance where no light is named: a dim room.
const ROOM: f32 = 0.12;

impl RenderArgs {
    /// What can be refused before any work is done.
    pub fn check(&self) -> Result<()> {
        if let Some(unknown) = self.aovs.iter().find(|name| !Aovs::NAMES.contains(&name.as_str())) {
            bail!("--aov {unknown}: there is no such output; choose from: {}", Aovs::NAMES.join(", "));
        }
        if self.threads == Some(0) {
            bail!("--threads 0: at least one thread is needed; leave it out for all of the machine's");
        }
        if !(self.fov_deg > 0.0 && self.fov_deg < 180.0) {
            bail!("--fov-deg {}: the angle must lie between 0 and 180 degrees", self.fov_deg);
        }
        taotie::raster::SamplePattern::new(self.samples)?;
        self.simd.dispatch()?;
        super::output::PictureFormat::of(&self.output, &self.bits)?;
        super::output::check_place(&self.output)?;
        self.background()?;
        Ok(())
    }

    /// How the picture is taken.
    pub fn settings(&self) -> RenderSettings {
        RenderSettings {
            width: self.size[0],
            height: self.size[1],
            samples: self.samples,
            shading: self.shading,
            surface: SurfaceSettings {
                method: self.surface,
                tangents: self.tangents,
                bump_scale: self.bump_scale.map(|scale| scale as f32),
            },
            shadows: self.shadows,
            aovs: !self.aovs.is_empty(),
            simd: self.simd,
        }
    }

    /// How the picture is developed.
    pub fn development(&self) -> Result<Development> {
        Ok(Development {
            exposure_stops: self.exposure as f32,
            tone: self.tone,
            background: self.background()?,
            simd: self.simd,
        })
    }

    /// Ambient radiance: as asked for, else none where lights were named, else a dim room.
    pub fn ambient(&self, scene: &Scene) -> Vec3 {
        let room = if self.lights.is_empty() && scene.lights.is_empty() { ROOM } else { 0.0 };
        self.ambient.unwrap_or(Vec3::splat(room))
    }

    fn background(&self) -> Result<Option<Vec3>> {
        if self.background == "transparent" {
            return Ok(None);
        }
        let color = options::color(&self.background).map_err(|why| anyhow::anyhow!("--background: {why}"))?;
        Ok(Some(color))
    }
}
