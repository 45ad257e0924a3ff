//! The options of `taotie bake`.

use super::images::Images;
use super::scan_args::ScanArgs;
use crate::limits::LimitArgs;
use crate::options::{self, fraction, positive};
use crate::proof_args::ProofArgs;
use crate::running::RunArgs;
use crate::studio::{Green, Space};
use anyhow::{Result, bail};
use clap::Args;
use std::path::{Path, PathBuf};
use taotie::asset::{
    BakeOptions, Baker, Figure, Limits, Lod, MeshSource, Packing, Preset, RayDistance, Requirement,
};
use taotie_engine::Error;
use taotie_engine::bake::MapKind;
use taotie_engine::names::Named;
use taotie_io::{CodecKind, CodecSet, FileSet, TextureCodecs};

/// Options that fix what a search would choose.
const BY_HAND: [&str; 5] = ["low", "triangles", "size", "bits", "meshopt"];

const EXAMPLES: &str = "\
Examples:
  taotie bake scan.ply -o scan.glb
  taotie bake scan.ply --low low.glb -o baked.glb --size 4096 --maps normal,ao
  taotie bake scan.ply --low low.glb -o normal.png
  taotie bake scan.ply -o scan.glb --triangles 150000 --lods 50000,64px --meshopt
  taotie bake scan.ply -o scan.glb --preset web --max-gpu-memory 64MB
  taotie bake scan.ply -o scan.glb --error 0.9 --require standard,bytes=3MB

Without --low, finds the smallest asset that looks like the scan: made from it, or the scan itself, packed. \
The asset is read back and measured against the scan: OUT.report.html and OUT.report.json, next to OUT, \
state its normal error in degrees, its shape error, and where they occur.";

/// Bakes a high-poly scan to the smallest glTF asset that looks the same, and measures the error.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct BakeArgs {
    /// The high-poly scan (.gltf, .glb, .obj, .ply, .stl)
    pub high: PathBuf,
    /// The asset to write: .glb, or .gltf with its files next to it. A .png, .webp or .exr gets only the maps, for a
    /// --low with UVs: the first (by default the normal map) in OUT, the others next to it, such as OUT.ao.png
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The low-poly mesh; its UVs and triangles are kept, as are meshes, materials, skins and animations of glTF:
    /// each material gets its own maps [default: made from the scan]
    #[arg(long, value_name = "LOW")]
    pub low: Option<PathBuf>,
    #[command(flatten)]
    pub scan: ScanArgs,

    /// Triangles of the low-poly mesh; turns the search off [default: 50000 if only size or packing is given]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..), help_heading = "Low-poly mesh", conflicts_with = "low")]
    pub triangles: Option<u32>,
    /// Target and ceilings for a use: web (mean 1°, 100,000 triangles, 80 MB of GPU memory), archive (mean
    /// 0.1°, no ceilings), or engine (mean 0.5°, 50,000 triangles, 32 MB, textures in KTX2). --error (all angle
    /// limits), --require, --images and explicit ceilings override them; --lods overrides the levels of detail of
    /// engine
    #[arg(long, value_name = "web|archive|engine", value_parser = options::named::<Preset>, help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub preset: Option<Preset>,
    /// Find the smallest asset with a mean normal error, as seen, of at most DEG degrees: made from the scan, or the
    /// scan itself, packed. The search chooses triangles, vertex bits, normal map or none, sizes, formats and
    /// qualities by their cost [default, unless triangles, size or packing are given: the target of --preset, or the
    /// limits of --require on angles and colours as seen, or `visually-lossless`]
    #[arg(long, value_name = "DEG", value_parser = degrees, help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub error: Option<f64>,
    /// Find the asset closest to the scan within SIZE bytes, such as 500kB. With --error, --preset or --require, an
    /// asset that meets them is good enough. Exit with 1 if none is that small
    #[arg(long, value_name = "SIZE", value_parser = bytes, help_heading = "Search", conflicts_with_all = BY_HAND, conflicts_with_all = ["lods", "no_verify"])]
    pub bytes: Option<u64>,
    /// Maximum number of triangles of the asset that a search finds. Exit with 1 if it has more
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..), help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub max_triangles: Option<u32>,
    /// Maximum GPU memory of the asset, such as 64MB: vertices, and textures with mip levels at four
    /// bytes per texel, or one with KTX2. Exit with 1 if it takes more
    #[arg(long, value_name = "SIZE", value_parser = bytes, help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub max_gpu_memory: Option<u64>,
    /// Write every trial of the search as CSV: bytes, GPU memory, triangles, maps, degrees, ΔE
    #[arg(long, value_name = "FILE.csv", help_heading = "Search", conflicts_with_all = BY_HAND)]
    pub trials: Option<PathBuf>,
    /// Coarser levels of detail in the same file (MSFT_lod), separated by commas. Npx (32 to 511) is the lightest
    /// level that meets the target when the object fills N² pixels; N is a level of N triangles, shown at the size at
    /// which it meets the target [default: none; 256px,128px,64px with --preset engine]
    #[arg(long, value_name = "Npx|N,...", value_delimiter = ',', help_heading = "Low-poly mesh")]
    pub lods: Vec<Lod>,

    /// Width and height of the maps, texels: one number, two as in 2048x1024 for a --low with UVs, or auto: the
    /// smallest power of two, 256 to 8192, that preserves the scan's detail [default: 2048]
    #[arg(long, value_name = "N|WxH|auto", value_parser = options::map_size, help_heading = "Maps")]
    pub size: Option<[u32; 2]>,
    /// Maps to bake, separated by commas: auto (normal, and all that varies in the scan's materials), normal, ao
    /// (ambient occlusion), albedo (base colour), height, bent (bent normals), curvature, roughness (widened by fine
    /// relief), metallic-roughness, emission, alpha, occlusion (the scan's own texture)
    #[arg(long, value_name = "auto|MAP,...", value_delimiter = ',', default_value = "auto", value_parser = map, help_heading = "Maps")]
    pub maps: Vec<Auto<MapKind>>,
    /// Space of the normal map. glTF has only tangent space, so an object-space map is written next to the asset
    #[arg(long, value_enum, default_value_t = Space::Tangent, help_heading = "Maps")]
    pub space: Space,
    /// Direction of green in maps for other programs: down (DirectX) adds OUT.normal.png, and also applies to
    /// OUT.bent.png and to standalone maps. The asset's own normal map always points up, as glTF requires
    #[arg(long, value_enum, default_value_t = Green::Up, help_heading = "Maps")]
    pub green: Green,
    /// Samples per texel
    #[arg(long, value_name = "K", default_value = "4", value_parser = ["1", "4", "9", "16", "25", "36", "49", "64"], help_heading = "Maps")]
    pub samples: String,
    /// Bits per channel of normal maps; 8-bit maps are dithered where they would show banding [default: 8]
    #[arg(long, value_parser = ["8", "16"], help_heading = "Maps")]
    pub bits: Option<String>,
    /// Padding around UV islands, 0 to 16384 texels; auto fills the whole map
    #[arg(long, value_name = "auto|N", default_value = "auto", value_parser = dilation, help_heading = "Maps")]
    pub dilation: Auto<u32>,
    /// Rays per texel over the hemisphere, for ao and bent [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), help_heading = "Maps")]
    pub ao_rays: Option<u32>,
    /// Maximum distance at which the scan occludes, for ao and bent, model units [default: unlimited]
    #[arg(long, value_name = "X", value_parser = positive, help_heading = "Maps")]
    pub ao_distance: Option<f64>,
    /// Roughness of the scan's surface, 0 to 1 [default: that of its material]
    #[arg(long, value_name = "X", value_parser = fraction, help_heading = "Maps")]
    pub roughness: Option<f64>,

    /// Length of the projection rays, model units; auto measures the gap between the meshes
    #[arg(long, value_name = "auto|X", default_value = "auto", value_parser = distance, help_heading = "Rays", conflicts_with = "cage")]
    pub ray_distance: Auto<f64>,
    /// The low-poly mesh with its vertices moved outward, where projection rays start
    #[arg(long, value_name = "FILE", requires = "low", help_heading = "Rays")]
    pub cage: Option<PathBuf>,

    /// Image formats of textures. For a search, the candidates: names separated by commas, or auto for those of
    /// --codecs. Otherwise one format: png, webp (lossless), ktx2 (UASTC with Zstandard), or with a quality: webp:85,
    /// jpeg:85 and avif:80 (base colour and emission; the rest stays lossless), ktx2:2 (λ of rate–distortion
    /// optimisation, 1 to 64, for all but normals). Separate formats for colours, normals and numbers:
    /// jpeg:90/webp/webp:75. A quality turns the search off
    #[arg(long, value_name = "auto|FORMAT[:QUALITY],...", value_parser = super::images::images, default_value = "auto", help_heading = "File")]
    pub images: Images,
    /// Compress geometry with meshoptimizer
    #[arg(long, help_heading = "File")]
    pub meshopt: bool,
    /// Codecs for a search, and the extension for --meshopt: portable (PNG, JPEG, WebP, EXT_meshopt_compression), or
    /// web-latest for the newest web viewers (also AVIF, KHR_meshopt_compression). --images overrides the image
    /// formats
    #[arg(long, value_name = "portable|web-latest", value_parser = options::named::<CodecSet>, default_value = "portable", help_heading = "File")]
    pub codecs: CodecSet,
    /// XMP metadata (JSON-LD, such as dc:title or dc:rights) to add to the scan's. If the scan has no copyright
    /// notice, dc:rights becomes the asset's
    #[arg(long, value_name = "FILE.json", help_heading = "File")]
    pub provenance: Option<PathBuf>,

    #[command(flatten)]
    pub proof: ProofArgs,
    /// Do not measure the error or write a report
    #[arg(long, help_heading = "Proof", conflicts_with_all = ["require", "proof_points", "proof_view", "date", "operator"])]
    pub no_verify: bool,

    #[command(flatten)]
    pub limits: LimitArgs,
    #[command(flatten)]
    pub run: RunArgs,
}

/// A value, or the program's choice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Auto<T> {
    /// The program's choice.
    Auto,
    /// An explicit value.
    Given(T),
}

fn map(text: &str) -> Result<Auto<MapKind>, String> {
    match text.trim() {
        "auto" => Ok(Auto::Auto),
        name => options::named(name).map(Auto::Given).map_err(|error| format!("{error}, or auto")),
    }
}

fn dilation(text: &str) -> Result<Auto<u32>, String> {
    match text {
        "auto" => Ok(Auto::Auto),
        _ => match text.parse() {
            Ok(texels) if texels <= 16_384 => Ok(Auto::Given(texels)),
            _ => Err("expected auto or 0 to 16384 texels".into()),
        },
    }
}

fn distance(text: &str) -> Result<Auto<f64>, String> {
    match text {
        "auto" => Ok(Auto::Auto),
        _ => positive(text).map(Auto::Given),
    }
}

fn bytes(text: &str) -> Result<u64, String> {
    let required: Requirement = format!("bytes={text}").parse().map_err(|error: Error| error.to_string())?;
    Ok(required.most as u64)
}

fn degrees(text: &str) -> Result<f64, String> {
    let number = positive(text)?;
    if number < 180.0 { Ok(number) } else { Err(format!("{text} is not below 180")) }
}

impl<T> Auto<T> {
    /// Returns the explicit value.
    fn given(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Given(value) => Some(value),
        }
    }
}

impl BakeArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        let extension = self.output.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        if !matches!(extension.as_deref(), Some("glb" | "gltf" | "png" | "webp" | "exr")) {
            bail!(
                "{}: unsupported format; write assets as .glb or .gltf, standalone maps as .png, .webp or .exr",
                self.output.display()
            );
        }
        self.check_alone()?;
        let same = |path: &Path| {
            path.canonicalize().ok().is_some_and(|p| Some(p) == self.output.canonicalize().ok())
        };
        let mut inputs = [Some(&self.high), self.low.as_ref(), self.cage.as_ref()].into_iter().flatten();
        if let Some(input) = inputs.find(|input| same(input)) {
            let (output, input) = (self.output.display(), input.display());
            bail!("{output}: it would overwrite the input {input}; choose another name or folder");
        }
        let [width, height] = self.size();
        let size = if width == height { width.to_string() } else { format!("{width}x{height}") };
        if width != height && self.low.is_none() {
            bail!("--size {size}: generated atlases are square; give one number, or --low with UVs");
        }
        self.check_search()?;
        if !self.searches()
            && let Err(why) = self.images.codecs()
        {
            bail!("--images: {why}");
        }
        if self.formats().has(CodecKind::Ktx2) && !self.size().iter().all(|side| side.is_multiple_of(4)) {
            bail!(
                "--size {size}: KTX2 needs multiples of 4; choose another size, or another format in --images"
            );
        }
        self.check_levels()?;
        if self.green == Green::Down && (self.space == Space::Object || !self.bakes_normals()) {
            bail!("--green down: no normal or bent map is baked in tangent space; bake one, or leave it out");
        }
        self.check_unread()?;
        self.proof.signature().check()?;
        self.options().check()?;
        Ok(self.packing().check()?)
    }

    /// Returns true if only maps are written, without a model.
    fn is_alone(&self) -> bool {
        ["png", "webp", "exr"].into_iter().any(|extension| self.has_extension(extension))
    }

    fn has_extension(&self, wanted: &str) -> bool {
        self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
    }

    /// Rejects options that need a model if only maps are written.
    fn check_alone(&self) -> Result<()> {
        let given = [
            ("--lods", !self.lods.is_empty()),
            ("--images", self.images != Images::Auto),
            ("--meshopt", self.meshopt),
            ("--codecs", self.codecs != CodecSet::Portable),
            ("--provenance", self.provenance.is_some()),
            ("--preset", self.preset.is_some()),
            ("--max-triangles", self.max_triangles.is_some()),
            ("--trials", self.trials.is_some()),
            ("--max-gpu-memory", self.max_gpu_memory.is_some()),
            ("--error", self.error.is_some()),
            ("--bytes", self.bytes.is_some()),
            ("--triangles", self.triangles.is_some()),
        ];
        let output = self.output.display();
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) if self.is_alone() => {
                bail!("{option}: {output} holds only maps, not a model; leave it out, or write a .glb")
            }
            None if self.is_alone() && self.low.is_none() => {
                bail!("{output}: standalone maps need a mesh with UVs: give one with --low, or write a .glb")
            }
            _ => self.check_depth(),
        }
    }

    /// Rejects 16-bit maps in an 8-bit file format.
    fn check_depth(&self) -> Result<()> {
        let deep = [MapKind::Height, MapKind::Curvature];
        let maps = self.maps();
        match maps.iter().find(|map| deep.contains(map)) {
            _ if self.has_extension("exr") && self.bits.is_some() => {
                bail!("--bits: an .exr stores floats; leave it out, or write a .png")
            }
            _ if !self.has_extension("webp") => Ok(()),
            Some(map) => bail!("--maps {}: it needs 16 bits, and WebP stores 8; write a .png", map.name()),
            None if self.bits() == 16 => bail!("--bits 16: WebP stores 8 bits; write a .png, or use 8"),
            None => Ok(()),
        }
    }

    /// Rejects options that have no effect.
    fn check_unread(&self) -> Result<()> {
        let (maps, carries) = (self.maps(), self.carries());
        let bakes = |map: MapKind| maps.contains(&map);
        let of_sky = [("--ao-rays", self.ao_rays.is_some()), ("--ao-distance", self.ao_distance.is_some())];
        let sky = bakes(MapKind::Occlusion) || bakes(MapKind::Bent);
        if let Some((option, _)) = of_sky.iter().find(|(_, given)| *given && !sky) {
            bail!("{option}: neither ao nor bent is baked; add one of them to --maps");
        }
        let has_texture = self.low.is_some() || carries || maps.iter().any(|map| self.is_inside(*map));
        if self.images != Images::Auto && !has_texture {
            bail!(
                "--images: the asset has no textures; leave it out, or add a map that is stored in the asset to --maps"
            );
        }
        self.check_loss()?;
        let separate = self.space == Space::Object || self.green == Green::Down || bakes(MapKind::Bent);
        let kind = self.formats().normals.kind();
        if self.bits() == 16 && kind != CodecKind::Png && bakes(MapKind::Normal) && !separate {
            bail!("--bits 16: {kind} stores 8 bits; write PNG, or use 8");
        }
        Ok(())
    }

    /// Rejects a quality that applies to no texture.
    fn check_loss(&self) -> Result<()> {
        let codecs = self.formats();
        if codecs.colors.number().is_some() && !self.may_lose() {
            bail!(
                "--images {codecs}: the only textures are normals, which the quality does not affect; use {}",
                codecs.normals
            );
        }
        Ok(())
    }

    /// Returns true if the asset may hold textures other than normals.
    fn may_lose(&self) -> bool {
        let is_lossy = |map: &MapKind| *map != MapKind::Normal && self.is_inside(*map);
        self.low.is_some() || self.carries() || self.maps().iter().any(is_lossy)
    }

    /// Returns true if a map is stored in the asset rather than next to it.
    fn is_inside(&self, map: MapKind) -> bool {
        match map {
            MapKind::Normal => self.space == Space::Tangent,
            other => !matches!(other, MapKind::Height | MapKind::Curvature | MapKind::Bent),
        }
    }

    /// Rejects outputs that cannot be written or that are inputs.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        let read = [Some(&self.high), self.low.as_ref(), self.cage.as_ref(), self.provenance.as_ref()];
        files.protect(read.into_iter().flatten())?;
        let asset = Baker::new(self.options()).may_write(&self.output, &self.packing());
        asset.iter().try_for_each(|path| files.reserve(path))?;
        files.claim(&self.output)?;
        let reports = self.reports();
        if let Some(path) = &self.trials {
            let written = asset.iter().chain(&reports).find(|written| *written == path);
            if written.is_some() || path.extension().is_none_or(|extension| extension != "csv") {
                bail!("--trials {}: choose another file, with the extension .csv", path.display());
            }
            files.claim(path)?;
        }
        let mut reports = reports.iter().filter(|_| !self.no_verify);
        Ok(reports.try_for_each(|path| files.claim(path))?)
    }

    /// Returns the files of the report: a page and JSON.
    pub fn reports(&self) -> [PathBuf; 2] {
        ["report.html", "report.json"].map(|kind| self.output.with_extension(kind))
    }

    /// Returns the model that the report shows; `None` if no file holds it with its normal map.
    pub fn shown_model(&self) -> Option<&Path> {
        (!self.is_alone() && self.space == Space::Tangent).then_some(&self.output)
    }

    /// Rejects requirements on levels of detail that are not made.
    fn check_levels(&self) -> Result<()> {
        let coarsest = self.lods().len();
        for requirement in self.proof.requirements() {
            if let Some(level) = requirement.level.filter(|level| *level > coarsest) {
                bail!(
                    "--require {}@{level}: the coarsest level of detail is {coarsest}; add more with --lods",
                    requirement.name()
                );
            }
        }
        Ok(())
    }

    /// Returns the options of the bake.
    pub fn options(&self) -> BakeOptions {
        BakeOptions {
            goal: self.goal(),
            bytes: self.bytes,
            images: self.kinds(),
            codecs: self.codecs,
            ..self.unsearched()
        }
    }

    /// Returns the options of a bake without a search.
    pub(super) fn unsearched(&self) -> BakeOptions {
        BakeOptions {
            low: self.low.clone().map(MeshSource::File),
            triangles: self.triangles(),
            lods: self.lods(),
            keep_uvs: self.is_alone(),
            size: self.size()[0],
            height: (self.size()[1] != self.size()[0]).then_some(self.size()[1]),
            maps: self.maps(),
            carry: self.carries(),
            space: self.space.into(),
            side: self.samples.parse().unwrap_or(4u32).isqrt(),
            bits: self.bits(),
            dilation: self.dilation.given(),
            ao_rays: self.ao_rays.unwrap_or(BakeOptions::default().ao_rays),
            ao_distance: self.ao_distance,
            roughness: self.roughness,
            ray_distance: self.ray_distance(),
            inspect: !self.no_verify,
            ..BakeOptions::default()
        }
    }

    /// Returns the coarser levels of detail, by default those of the preset.
    fn lods(&self) -> Vec<Lod> {
        let has_budget = self.proof.requirements().iter().any(|required| required.figure == Figure::Bytes);
        let is_open = self.lods.is_empty() && self.bytes.is_none() && !has_budget;
        let of_preset = self.preset.filter(|_| is_open).map(Preset::lods);
        of_preset.unwrap_or_else(|| self.lods.clone())
    }

    /// Returns true if the maps of the scan's own materials are baked in addition to the named ones.
    fn carries(&self) -> bool {
        self.maps.contains(&Auto::Auto)
    }

    /// Returns the maps requested by name; `auto` implies normals.
    pub(super) fn maps(&self) -> Vec<MapKind> {
        let named = self.maps.iter().filter_map(|map| map.given());
        let normal = self.carries().then_some(MapKind::Normal);
        normal.into_iter().chain(named).collect()
    }

    /// Returns true if normal or bent maps are baked, the only ones with a choice of bits.
    fn bakes_normals(&self) -> bool {
        self.maps().iter().any(|map| matches!(map, MapKind::Normal | MapKind::Bent))
    }

    fn ray_distance(&self) -> RayDistance {
        match (&self.cage, self.ray_distance) {
            (Some(path), _) => RayDistance::Cage(MeshSource::File(path.clone())),
            (None, Auto::Auto) => RayDistance::Auto,
            (None, Auto::Given(distance)) => RayDistance::Uniform(distance),
        }
    }

    /// Returns the packing of the asset.
    pub fn packing(&self) -> Packing {
        Packing {
            images: self.formats(),
            meshopt: self.meshopt,
            codecs: if self.searches() { CodecSet::default() } else { self.codecs },
            provenance: self.provenance.clone(),
            green: self.green.into(),
            ..Packing::default()
        }
    }

    /// Returns the image formats that a search chooses from; empty without a search.
    fn kinds(&self) -> Vec<CodecKind> {
        match (&self.images, self.preset) {
            _ if !self.searches() => Vec::new(),
            (Images::Auto, Some(preset)) => preset.images(),
            (images, _) => images.kinds(),
        }
    }

    fn triangles(&self) -> u32 {
        self.triangles.unwrap_or(BakeOptions::default().triangles)
    }

    fn size(&self) -> [u32; 2] {
        self.size.unwrap_or([BakeOptions::default().size; 2])
    }

    fn bits(&self) -> u8 {
        match self.bits.as_deref() {
            Some("16") => 16,
            None if self.has_extension("exr") && self.bakes_normals() => 16,
            _ => BakeOptions::default().bits,
        }
    }

    /// Returns the formats of textures without a search; PNG with one.
    fn formats(&self) -> TextureCodecs {
        if self.searches() {
            return TextureCodecs::default();
        }
        self.images.codecs().unwrap_or_default()
    }

    /// Returns `true` if textures are packed as WebP, AVIF or KTX2, which takes longer than PNG.
    pub fn is_packed(&self) -> bool {
        self.formats() != TextureCodecs::default()
    }

    /// Returns the limits of the bake.
    pub fn limits(&self) -> Limits {
        self.limits.limits()
    }
}
