//! The options of `taotie compare`.

use super::{method, points};
use crate::options;
use crate::studio::{
    self, CameraArgs, FilmArgs, Framing, LightArgs, MaterialArgs, ReflectionArgs, RunningArgs,
};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie::comparison::{Matching, Method, SamplePoints};
use taotie::io::FileSet;
use taotie::names::Named;
use taotie::shade::Shading;
use taotie::surface::SurfaceMethod;

const EXAMPLES: &str = "\
Examples:
  taotie compare statue.obj --normal-map statue_normals.png -o comparison
  taotie compare low.glb --reference scan.ply --method smooth,tangent-normal -o comparison
  taotie compare model.glb --method bump:5,bump-printed:5 --shading ggx,cook-torrance --points 10 -o comparison
  taotie compare model.glb --method tangent-normal --shading cook-torrance,phong --baseline ggx -o comparison
  taotie compare --paper -o recomputed";

/// All options that `--paper`, which renders nothing, does not read.
const NOT_OF_PAPER: [&str; 45] = [
    "model",
    "reference",
    "methods",
    "points",
    "matching",
    "heat_top_deg",
    "exr",
    "shadings",
    "baseline",
    "bump_scale",
    "energy",
    "specular_aa",
    "grazing_normals",
    "tangents",
    "variant",
    "material",
    "base_color",
    "metallic",
    "roughness",
    "slope",
    "shininess",
    "base_color_map",
    "normal_map",
    "normal_space",
    "green",
    "height_map",
    "occlusion_map",
    "lights",
    "ambient",
    "shadows",
    "env",
    "env_rotate_deg",
    "env_intensity",
    "show_env",
    "camera",
    "orbit",
    "target",
    "fov_deg",
    "size",
    "samples",
    "tone",
    "exposure",
    "background",
    "threads",
    "simd",
];

/// Renders a model by several surface methods and measures their error.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct CompareArgs {
    /// The model: .gltf, .glb, .obj, .ply or .stl
    #[arg(required_unless_present = "paper")]
    pub model: Option<PathBuf>,
    /// The folder to write to; made if it is not there
    #[arg(short, long, value_name = "DIR", required_unless_present = "paper")]
    pub output: Option<PathBuf>,
    /// The high-poly reference: a model in the same place with its relief as geometry, such as the scan
    #[arg(long, value_name = "HIGH")]
    pub reference: Option<PathBuf>,
    /// Recompute Tables 2 and 3 of Guo and Wang 2025 instead, and list their misprints
    #[arg(long, conflicts_with_all = NOT_OF_PAPER)]
    pub paper: bool,
    /// Methods separated by commas: facet, smooth, bump, bump-printed, object-normal, tangent-normal. `bump` takes the
    /// height of white from the material or --bump-scale, in model units; `bump:5` sets it to 5 texels of the map;
    /// `bump-printed:5` is the formula of Guo and Wang 2025 with its factor s = 5, which has no unit. If not given:
    /// smooth, bump, bump:5, bump:50, bump-printed:5, bump-printed:50, object-normal, tangent-normal
    #[arg(long = "method", value_name = "LIST", value_delimiter = ',', value_parser = method::parse)]
    pub methods: Vec<Method>,
    /// Sample points whose normals are listed: their number, or pixels as X,Y;X,Y
    #[arg(long, value_name = "N|PIXELS", value_parser = points::parse, default_value = "10")]
    pub points: SamplePoints,
    /// The point of the reference that corresponds to a point of the model: the one along its vertex normal, as in baking
    /// (normal), the one of the same UV, for meshes that share their UVs (uv), or the one at the same pixel (pixel)
    #[arg(long = "match", value_name = "HOW", value_parser = options::named::<Matching>, default_value = "normal", requires = "reference")]
    pub matching: Matching,
    /// The angle at the top of the heat maps' scale, degrees
    #[arg(long, value_name = "DEG", value_parser = options::number, default_value = "30")]
    pub heat_top_deg: f64,
    /// Also write normals and angular errors as OpenEXR: METHOD.normals.exr holds unit vectors in world space as R, G, B =
    /// x, y, z, METHOD.error.exr degrees; alpha is 1 where there is a number
    #[arg(long)]
    pub exr: bool,

    /// Reflectance models separated by commas: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or
    /// cook-torrance-printed, blinn-phong-printed, ggx-printed
    #[arg(long = "shading", value_name = "LIST", value_delimiter = ',', value_parser = options::named::<Shading>, default_value = "ggx", help_heading = "Surface")]
    pub shadings: Vec<Shading>,
    /// Also measure what the reflectance model does: each surface's picture under the models of --shading against its own
    /// under this one
    #[arg(long, value_name = "MODEL", value_parser = options::named::<Shading>, help_heading = "Surface")]
    pub baseline: Option<Shading>,
    /// Height of white for the method `bump`, model units; the material's if not given. `bump:5` does not read it
    #[arg(long, value_name = "X", value_parser = options::number, allow_negative_numbers = true, help_heading = "Surface")]
    pub bump_scale: Option<f64>,
    #[command(flatten)]
    pub reflection: ReflectionArgs,
    #[command(flatten)]
    pub material: MaterialArgs,
    #[command(flatten)]
    pub light: LightArgs,
    #[command(flatten)]
    pub camera: CameraArgs,
    /// Width and height of the pictures, pixels; one number stands for both
    #[arg(long, value_name = "N|WxH", value_parser = options::size, default_value = "640x640", help_heading = "Picture")]
    pub size: [u32; 2],
    #[command(flatten)]
    pub film: FilmArgs,
    #[command(flatten)]
    pub running: RunningArgs,
}

impl CompareArgs {
    /// Refuses options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        self.check_methods()?;
        self.check_baseline()?;
        self.material.check(&self.shadings())?;
        self.reflection.check(&self.shadings())?;
        self.light.check()?;
        self.camera.check()?;
        self.film.check(self.light.show_env)?;
        self.running.check()?;
        if self.film.background.as_deref() == Some("transparent") {
            bail!("--background transparent: pictures are compared before a background; give a colour");
        }
        if !(self.heat_top_deg > 0.0 && self.heat_top_deg <= 180.0) {
            bail!("--heat-top-deg {}: the angle must lie above 0 and at most 180", self.heat_top_deg);
        }
        if let Some([x, y]) = self.points.outside(self.size) {
            let [width, height] = self.size;
            bail!("--points: pixel {x},{y} lies outside the picture of {width}×{height}");
        }
        Ok(())
    }

    /// Refuses a folder that cannot be written to, and files that are read.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect(self.model.iter().chain(&self.reference))?;
        files.protect(studio::material_files(&self.material)?)?;
        files.protect(self.light.environment_file())?;
        if let Some(output) = &self.output {
            files.claim_folder(output)?;
        }
        Ok(())
    }

    /// Refuses a comparison with nothing, and maps that no method reads.
    fn check_methods(&self) -> Result<()> {
        let methods = self.methods();
        let alone = self.reference.is_none() && self.baseline.is_none() && !self.paper;
        if let (true, [method]) = (alone, methods.as_slice()) {
            let id = method.id();
            bail!(
                "--method {id}: it is compared with nothing; name further methods, a --reference, or a --baseline"
            );
        }
        let bumps = |method: &Method| Method::takes_factor(method.surface);
        let unread = [
            ("--normal-map", self.material.normal_map.is_some() && !self.reads_normal_maps()),
            ("--height-map", self.material.height_map.is_some() && !methods.iter().any(bumps)),
            ("--bump-scale", {
                self.bump_scale.is_some() && !methods.iter().any(|m| bumps(m) && m.factor.is_none())
            }),
        ];
        match unread.iter().find(|(_, is)| *is) {
            Some((option, _)) => bail!("{option}: no method of --method reads it"),
            None => Ok(()),
        }
    }

    /// Says whether any method reads normal maps.
    pub fn reads_normal_maps(&self) -> bool {
        let maps = [SurfaceMethod::ObjectNormal, SurfaceMethod::TangentNormal];
        self.methods().iter().any(|method| maps.contains(&method.surface))
    }

    /// Refuses a baseline that nothing is measured against.
    fn check_baseline(&self) -> Result<()> {
        match self.baseline {
            Some(baseline) if self.shadings() == [baseline] => {
                let name = baseline.name();
                bail!("--baseline {name}: --shading names no other model to be measured against it")
            }
            _ => Ok(()),
        }
    }

    /// The methods to compare, each once.
    pub fn methods(&self) -> Vec<Method> {
        if self.methods.is_empty() { Method::defaults() } else { each_once(&self.methods) }
    }

    /// The reflectance models to compare under, each once, the baseline before those that do not name it.
    pub fn shadings(&self) -> Vec<Shading> {
        let added = self.baseline.filter(|baseline| !self.shadings.contains(baseline));
        let all: Vec<Shading> = added.into_iter().chain(self.shadings.iter().copied()).collect();
        each_once(&all)
    }

    /// Returns the part of the scene that has to fit into the picture.
    pub fn framing(&self) -> Framing {
        Framing { size: self.size, all_around: false }
    }
}

fn each_once<T: Copy + PartialEq>(given: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for value in given {
        if !once.contains(value) {
            once.push(*value);
        }
    }
    once
}
