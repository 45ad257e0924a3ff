//! The options of `taotie compare`, and the notation of methods and sample points.

use crate::options;
use crate::running::RunningArgs;
use crate::studio::{self, CameraArgs, FilmArgs, Framing, LightArgs, MaterialArgs, ReflectionArgs};
use anyhow::{Result, bail};
use clap::Args;
use std::path::PathBuf;
use taotie::comparison::{Matching, Method, SamplePoints};
use taotie_engine::names::Named;
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;
use taotie_io::FileSet;

const EXAMPLES: &str = "\
Examples:
  taotie compare statue.obj --normal-map statue_normals.png -o comparison
  taotie compare low.glb --reference scan.ply --method smooth,tangent-normal -o comparison
  taotie compare model.glb --method bump:5,bump-printed:5 --shading ggx,cook-torrance --points 10 -o comparison
  taotie compare model.glb --method tangent-normal --shading cook-torrance,phong --baseline ggx -o comparison
  taotie compare --paper -o recomputed";

/// All options that `--paper`, which renders nothing, does not use.
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

/// Renders a model with several surface methods and measures their error.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct CompareArgs {
    /// The model: .gltf, .glb, .obj, .ply, .stl or .fbx
    #[arg(required_unless_present = "paper")]
    pub model: Option<PathBuf>,
    /// Folder to write to; created if missing
    #[arg(short, long, value_name = "DIR", required_unless_present = "paper")]
    pub output: Option<PathBuf>,
    /// The high-poly reference: a model in the same position with its relief as geometry, such as the scan
    #[arg(long, value_name = "HIGH")]
    pub reference: Option<PathBuf>,
    /// Recompute Tables 2 and 3 of Guo and Wang 2025 instead, and list their misprints
    #[arg(long, conflicts_with_all = NOT_OF_PAPER)]
    pub paper: bool,
    /// Methods separated by commas: facet, smooth, bump, bump-printed, object-normal, tangent-normal. `bump` takes
    /// the height of white from the material or --bump-scale, in model units; `bump:5` sets it to 5 texels of the
    /// map; `bump-printed:5` is the formula of Guo and Wang 2025 with its factor s = 5, which has no unit [default:
    /// smooth, bump, bump:5, bump:50, bump-printed:5, bump-printed:50, object-normal, tangent-normal]
    #[arg(long = "method", value_name = "LIST", value_delimiter = ',', value_parser = parse_method)]
    pub methods: Vec<Method>,
    /// Sample points whose normals are listed: their number, or pixels as X,Y;X,Y
    #[arg(long, value_name = "N|PIXELS", value_parser = parse_points, default_value = "10")]
    pub points: SamplePoints,
    /// How points of the reference correspond to points of the model: along the vertex normal, as in baking (normal),
    /// by UV, for meshes that share their UVs (uv), or at the same pixel (pixel)
    #[arg(long = "match", value_name = "HOW", value_parser = options::named::<Matching>, default_value = "normal", requires = "reference")]
    pub matching: Matching,
    /// The angle at the top of the heat maps' scale, degrees
    #[arg(long, value_name = "DEG", value_parser = options::number, default_value = "30")]
    pub heat_top_deg: f64,
    /// Also write normals and angular errors as OpenEXR: METHOD.normals.exr holds unit vectors in world space as R,
    /// G, B = x, y, z, METHOD.error.exr degrees; alpha is 1 where there is a value
    #[arg(long)]
    pub exr: bool,

    /// Reflectance models separated by commas: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx,
    /// or cook-torrance-printed, blinn-phong-printed, ggx-printed
    #[arg(long = "shading", value_name = "LIST", value_delimiter = ',', value_parser = options::named::<Shading>, default_value = "ggx", help_heading = "Surface")]
    pub shadings: Vec<Shading>,
    /// Also measure the effect of the reflectance model: compare each surface's picture under the models of --shading
    /// with its picture under this one
    #[arg(long, value_name = "MODEL", value_parser = options::named::<Shading>, help_heading = "Surface")]
    pub baseline: Option<Shading>,
    /// Height of white for the method `bump`, model units; `bump:5` does not use it [default: the material's]
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
    /// Width and height of the pictures, pixels, or one number for both
    #[arg(long, value_name = "N|WxH", value_parser = options::size, default_value = "640x640", help_heading = "Picture")]
    pub size: [u32; 2],
    #[command(flatten)]
    pub film: FilmArgs,
    #[command(flatten)]
    pub running: RunningArgs,
}

impl CompareArgs {
    /// Rejects options that cannot work together, before any work is done.
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
            bail!("--background transparent: pictures are compared on an opaque background; give a colour");
        }
        if !(self.heat_top_deg > 0.0 && self.heat_top_deg <= 180.0) {
            bail!("--heat-top-deg {}: the angle must be above 0 and at most 180", self.heat_top_deg);
        }
        if let Some([x, y]) = self.points.outside(self.size) {
            let [width, height] = self.size;
            bail!("--points: pixel {x},{y} is outside the {width}×{height} picture");
        }
        Ok(())
    }

    /// Rejects a folder that cannot be written to, and outputs that are inputs.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect(self.model.iter().chain(&self.reference))?;
        files.protect(studio::material_files(&self.material)?)?;
        files.protect(self.light.environment_file())?;
        if let Some(output) = &self.output {
            files.claim_folder(output)?;
        }
        Ok(())
    }

    /// Rejects a comparison with nothing, and maps that no method uses.
    fn check_methods(&self) -> Result<()> {
        let methods = self.methods();
        let single = self.reference.is_none() && self.baseline.is_none() && !self.paper;
        if let (true, [method]) = (single, methods.as_slice()) {
            let id = method.id();
            bail!(
                "--method {id}: nothing to compare it with; add more methods, a --reference or a --baseline"
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
            Some((option, _)) => bail!("{option}: no method of --method uses it"),
            None => Ok(()),
        }
    }

    /// Returns true if any method uses normal maps.
    pub fn reads_normal_maps(&self) -> bool {
        let maps = [SurfaceMethod::ObjectNormal, SurfaceMethod::TangentNormal];
        self.methods().iter().any(|method| maps.contains(&method.surface))
    }

    /// Rejects a baseline without another model to compare with it.
    fn check_baseline(&self) -> Result<()> {
        match self.baseline {
            Some(baseline) if self.shadings() == [baseline] => {
                let name = baseline.name();
                bail!("--baseline {name}: nothing to compare it with; add another model to --shading")
            }
            _ => Ok(()),
        }
    }

    /// Returns the methods to compare, without duplicates.
    pub fn methods(&self) -> Vec<Method> {
        if self.methods.is_empty() { Method::defaults() } else { each_once(&self.methods) }
    }

    /// Returns the reflectance models to compare under, without duplicates; a baseline not among them comes first.
    pub fn shadings(&self) -> Vec<Shading> {
        let added = self.baseline.filter(|baseline| !self.shadings.contains(baseline));
        let all: Vec<Shading> = added.into_iter().chain(self.shadings.iter().copied()).collect();
        each_once(&all)
    }

    /// Returns the part of the scene that must fit into the picture.
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

/// Parses a method: `NAME` or `NAME:FACTOR`.
fn parse_method(value: &str) -> Result<Method, String> {
    let (name, factor) = match value.split_once(':') {
        Some((name, factor)) => (name, Some(options::number(factor)? as f32)),
        None => (value, None),
    };
    let surface = options::named(name)?;
    if factor.is_some() && !Method::takes_factor(surface) {
        return Err(format!("`{name}` takes no factor; only bump and bump-printed do, such as bump:5"));
    }
    Ok(Method { surface, factor })
}

/// Maximum number of points: more would be a picture, not a table.
const MOST_POINTS: usize = 1000;

/// Parses sample points: `N`, or `X,Y;X,Y`.
fn parse_points(value: &str) -> Result<SamplePoints, String> {
    if let Ok(count) = value.trim().parse::<usize>() {
        return match count {
            0..=MOST_POINTS => Ok(SamplePoints::Spread(count)),
            _ => Err(format!("at most {MOST_POINTS} points can be listed")),
        };
    }
    let pixels: Result<Vec<_>, _> = value.split(';').map(pixel).collect();
    pixels.map(SamplePoints::Pixels)
}

fn pixel(text: &str) -> Result<[u32; 2], String> {
    let wrong =
        || format!("`{text}` is not a pixel; give a number of points, or pixels such as 320,200;100,50");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    Ok([number(x)?, number(y)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for method in Method::defaults() {
            assert_eq!(parse_method(&method.id()), Ok(method));
        }
    }

    #[test]
    fn factors_belong_to_bump() {
        assert!(parse_method("smooth:5").unwrap_err().contains("bump:5"));
        assert!(parse_method("bump:high").unwrap_err().contains("high"));
        assert!(parse_method("bmup").unwrap_err().contains("tangent-normal"));
    }

    #[test]
    fn reads_counts_and_pixels() {
        assert_eq!(parse_points("10"), Ok(SamplePoints::Spread(10)));
        assert_eq!(parse_points("1,2; 3,4"), Ok(SamplePoints::Pixels(vec![[1, 2], [3, 4]])));
        for written in ["10", "1,2;3,4"] {
            assert_eq!(parse_points(written).unwrap().to_string(), written);
        }
        assert!(
            parse_points("1,2;x").is_err() && parse_points("1001").is_err() && parse_points("-1").is_err()
        );
    }
}
