//! The options of `taotie bake`.

use super::purpose::{Defaults, Purpose};
use super::scan_args::ScanArgs;
use crate::limits::LimitArgs;
use crate::options::{self, fraction, positive};
use crate::proof_args::ProofArgs;
use crate::running::RunArgs;
use crate::studio::{Green, Space};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use taotie::Error;
use taotie::asset::{AUTO_SIZE, BakeOptions, Baker, Limits, MeshSource, Packing, RayDistance, Requirement};
use taotie::bake::MapKind;
use taotie::io::{FileSet, GltfImages};
use taotie::names::Named;

const EXAMPLES: &str = "\
Examples:
  taotie bake scan.ply -o scan.glb
  taotie bake scan.ply --low low.glb -o baked.glb --size 4096 --maps normal,ao
  taotie bake scan.ply --low low.glb -o normal.png
  taotie bake scan.ply -o scan.glb --triangles 150000 --lods 50000,10000 --meshopt
  taotie bake scan.ply -o scan.glb --for web
  taotie bake scan.ply -o scan.glb --error 0.9 --require standard,bytes=3MB

Without --low the smallest asset that looks like the scan is found: made from it, or the scan itself, packed. \
The asset is read back and measured against the scan: \
OUT.report.html and OUT.report.json, beside OUT, hold its normal error in degrees, its shape error, and where they are.";

/// Bakes a high-poly scan to the smallest glTF asset that looks the same, and measures the error.
#[derive(Args)]
#[command(before_help = EXAMPLES)]
pub struct BakeArgs {
    /// The high-poly scan (.gltf, .glb, .obj, .ply, .stl)
    pub high: PathBuf,
    /// The asset to write (.glb, or .gltf with its files beside it). A .png, .webp or .exr gets the maps alone, for a --low with UVs: the
    /// first, normals if not asked otherwise, in OUT, each other beside it, such as OUT.ao.png
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// The low-poly mesh; its UVs and triangles stay as they are. So do meshes, materials, skins and animations of
    /// glTF: each material gets maps of its own. Made from the scan if not given
    #[arg(long, value_name = "LOW")]
    pub low: Option<PathBuf>,
    /// Choose size and packing for a use; options that are given go before it
    #[arg(long = "for", value_name = "USE", value_enum)]
    pub purpose: Option<Purpose>,

    #[command(flatten)]
    pub scan: ScanArgs,

    /// Triangles of the low-poly mesh; nothing is searched for then. 50000 if only the size or the packing is given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(4..), help_heading = "Low-poly mesh", conflicts_with = "low")]
    pub triangles: Option<u32>,
    /// Find the smallest asset with a mean normal error, as seen, of at most DEG degrees: one that is made of the scan, or the
    /// scan itself, packed. Triangles, bits of vertices, normal map or none, sizes and qualities are chosen by what they cost.
    /// Files need EXT_meshopt_compression, and with maps WebP. Without it, and unless triangles, size or packing are chosen,
    /// the smallest one that meets what --require says of angles and colours as seen is found; without that, one that meets
    /// `visually-lossless`
    #[arg(long, value_name = "DEG", value_parser = degrees, help_heading = "Low-poly mesh", conflicts_with_all = ["low", "triangles", "size", "purpose", "bits", "ktx2", "webp", "jpeg", "meshopt"])]
    pub error: Option<f64>,
    /// Find the asset nearest to the scan with at most so many bytes, such as 500kB. With --error or --require, one that meets
    /// them is enough. Exit with 1 if none is so small
    #[arg(long, value_name = "SIZE", value_parser = bytes, help_heading = "Low-poly mesh", conflicts_with_all = ["low", "triangles", "size", "lods", "purpose", "bits", "ktx2", "webp", "jpeg", "meshopt", "no_verify"])]
    pub bytes: Option<u64>,
    /// Further levels of detail in the same file (MSFT_lod): the triangles of each, separated by commas
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = options::triangles, help_heading = "Low-poly mesh")]
    pub lods: Vec<u32>,

    /// Width and height of the maps, texels: one number, two as in 2048x1024 for a --low with UVs, or auto: the smallest power
    /// of two, 256 to 8192, that preserves the scan's detail [default: 2048]
    #[arg(long, value_name = "N|WxH|auto", value_parser = options::map_size, help_heading = "Maps")]
    pub size: Option<[u32; 2]>,
    /// Maps to bake, separated by commas: auto (normal, and whatever varies in the scan's materials), normal, ao (ambient
    /// occlusion), albedo (base colour), height, bent (bent normals), curvature, roughness (widened by fine relief),
    /// metallic-roughness, emission, alpha, occlusion (the scan's own texture)
    #[arg(long, value_name = "auto|MAP,...", value_delimiter = ',', default_value = "auto", value_parser = map, help_heading = "Maps")]
    pub maps: Vec<Auto<MapKind>>,
    /// Space of the normal map. glTF has only tangent space, so an object-space map is written beside the asset
    #[arg(long, value_enum, default_value_t = Space::Tangent, help_heading = "Maps")]
    pub space: Space,
    /// Direction of green in maps for other programs: down (DirectX) also writes OUT.normal.png, and OUT.bent.png so. The
    /// asset's own normal map points up, as glTF demands; maps alone point down then
    #[arg(long, value_enum, default_value_t = Green::Up, help_heading = "Maps")]
    pub green: Green,
    /// Samples per texel
    #[arg(long, value_name = "K", default_value = "4", value_parser = ["1", "4", "9", "16", "25", "36", "49", "64"], help_heading = "Maps")]
    pub samples: String,
    /// Bits per channel of normal maps; 8 if not given. 8-bit maps are dithered where they would show bands
    #[arg(long, value_parser = ["8", "16"], help_heading = "Maps")]
    pub bits: Option<String>,
    /// Padding around UV islands, 0 to 16384 texels; auto fills the whole map
    #[arg(long, value_name = "auto|N", default_value = "auto", value_parser = dilation, help_heading = "Maps")]
    pub dilation: Auto<u32>,
    /// Rays per texel over the hemisphere, for ao and bent; 64 if not given
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), help_heading = "Maps")]
    pub ao_rays: Option<u32>,
    /// Largest distance at which the scan occludes, for ao and bent, model units; any distance if not given
    #[arg(long, value_name = "X", value_parser = positive, help_heading = "Maps")]
    pub ao_distance: Option<f64>,
    /// Roughness of the scan's surface, [0, 1]; that of its material if not given
    #[arg(long, value_name = "X", value_parser = fraction, help_heading = "Maps")]
    pub roughness: Option<f64>,

    /// Length of the projection rays, model units; auto measures the gap between the meshes
    #[arg(long, value_name = "auto|X", default_value = "auto", value_parser = distance, help_heading = "Rays", conflicts_with = "cage")]
    pub ray_distance: Auto<f64>,
    /// The low-poly mesh with its vertices moved outward: projection rays begin there
    #[arg(long, value_name = "FILE", requires = "low", help_heading = "Rays")]
    pub cage: Option<PathBuf>,

    /// Write textures as KTX2 with UASTC under Zstandard instead of PNG
    #[arg(long, conflicts_with = "webp", help_heading = "File")]
    pub ktx2: bool,
    /// Let blocks of KTX2 repeat earlier ones where that saves enough (rate–distortion optimisation): the mean square
    /// error of a block rises by at most the square of this, 1 to 64, of 255². Normals are left out
    #[arg(long, value_name = "LAMBDA", value_parser = clap::value_parser!(u8).range(1..=64), help_heading = "File")]
    pub uastc_rdo: Option<u8>,
    /// Write textures as WebP instead of PNG, lossless
    #[arg(long, help_heading = "File")]
    pub webp: bool,
    /// Write base colour and emission as lossy WebP of this quality, 1 to 100. All other textures stay lossless, and
    /// alpha too
    #[arg(long, value_name = "QUALITY", value_parser = clap::value_parser!(u8).range(1..=100), help_heading = "File")]
    pub webp_quality: Option<u8>,
    /// Write the base colour as JPEG of this quality, 1 to 100. All other textures stay as they are: they are numbers
    #[arg(long, value_name = "QUALITY", value_parser = clap::value_parser!(u8).range(1..=100), help_heading = "File")]
    pub jpeg: Option<u8>,
    /// Compress geometry (EXT_meshopt_compression)
    #[arg(long, help_heading = "File")]
    pub meshopt: bool,
    /// XMP metadata (JSON-LD, such as dc:title or dc:rights) to add to that of the scan. Where the scan has no
    /// copyright notice, dc:rights becomes the asset's
    #[arg(long, value_name = "FILE.json", help_heading = "File")]
    pub provenance: Option<PathBuf>,

    #[command(flatten)]
    pub proof: ProofArgs,
    /// Do not measure the error and write no report
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
    /// The value asked for.
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
            _ => Err("write auto, or a number of texels from 0 to 16384".into()),
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
    /// Returns the value asked for.
    fn given(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Given(value) => Some(value),
        }
    }
}

impl BakeArgs {
    /// Refuses options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        let extension = self.output.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        if !matches!(extension.as_deref(), Some("glb" | "gltf" | "png" | "webp" | "exr")) {
            bail!(
                "{}: assets are written as .glb or .gltf, maps alone as .png, .webp or .exr",
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
            bail!("{output}: it would be written over {input}, which is read; give another name or folder");
        }
        let made = (self.low.is_none() && !self.searches()).then_some(self.triangles());
        let levels: Vec<u32> = made.into_iter().chain(self.lods()).collect();
        if let Some(pair) = levels.windows(2).find(|pair| pair[0] <= pair[1]) {
            bail!(
                "--lods: a level of {} triangles follows one of {}; each must have fewer triangles than the one before",
                pair[1],
                pair[0]
            );
        }
        let [width, height] = self.size();
        let size = if width == height { width.to_string() } else { format!("{width}x{height}") };
        if width != height && self.low.is_none() {
            bail!("--size {size}: atlases that are made are square; give one number, or --low with UVs");
        }
        if self.images() == GltfImages::Ktx2 && !self.size().iter().all(|side| side.is_multiple_of(4)) {
            let other = if self.ktx2 { "leave out --ktx2" } else { "take another --for" };
            bail!("--size {size}: KTX2 needs a multiple of 4; choose another size, or {other}");
        }
        self.check_search()?;
        self.check_levels()?;
        if self.green == Green::Down && (self.space == Space::Object || !self.bakes_normals()) {
            bail!("--green down: no normal or bent map in tangent space is baked; bake one, or leave it out");
        }
        self.check_unread()?;
        self.proof.signature().check()?;
        Ok(self.packing().check()?)
    }

    /// Says whether maps are written without a model.
    fn is_alone(&self) -> bool {
        ["png", "webp", "exr"].into_iter().any(|extension| self.has_extension(extension))
    }

    fn has_extension(&self, wanted: &str) -> bool {
        self.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
    }

    /// Refuses what only a model has, where maps are written alone.
    fn check_alone(&self) -> Result<()> {
        let given = [
            ("--lods", !self.lods.is_empty()),
            ("--ktx2", self.ktx2),
            ("--webp", self.webp),
            ("--jpeg", self.jpeg.is_some()),
            ("--meshopt", self.meshopt),
            ("--provenance", self.provenance.is_some()),
            ("--for", self.purpose.is_some()),
            ("--error", self.error.is_some()),
            ("--bytes", self.bytes.is_some()),
            ("--triangles", self.triangles.is_some()),
        ];
        let output = self.output.display();
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) if self.is_alone() => {
                bail!("{option}: {output} gets maps alone, without a model; leave it out, or write a .glb")
            }
            None if self.is_alone() && self.low.is_none() => {
                bail!(
                    "{output}: maps alone need the mesh that they are for: give --low with UVs, or write a .glb"
                )
            }
            _ => self.check_depth(),
        }
    }

    /// Refuses maps of 16 bits in a file that holds 8.
    fn check_depth(&self) -> Result<()> {
        let deep = [MapKind::Height, MapKind::Curvature];
        let maps = self.maps();
        match maps.iter().find(|map| deep.contains(map)) {
            _ if self.has_extension("exr") && self.bits.is_some() => {
                bail!("--bits: an .exr holds floats; leave it out, or write a .png")
            }
            _ if !self.has_extension("webp") => Ok(()),
            Some(map) => bail!("--maps {}: it needs 16 bits and WebP holds 8; write a .png", map.name()),
            None if self.bits() == 16 => bail!("--bits 16: WebP holds 8 bits; write a .png, or take 8"),
            None => Ok(()),
        }
    }

    /// Refuses options that nothing reads.
    fn check_unread(&self) -> Result<()> {
        let (maps, carries) = (self.maps(), self.carries());
        let bakes = |map: MapKind| maps.contains(&map);
        let of_sky = [("--ao-rays", self.ao_rays.is_some()), ("--ao-distance", self.ao_distance.is_some())];
        let sky = bakes(MapKind::Occlusion) || bakes(MapKind::Bent);
        if let Some((option, _)) = of_sky.iter().find(|(_, given)| *given && !sky) {
            bail!("{option}: neither ao nor bent is baked; add one of them to --maps");
        }
        let colors = bakes(MapKind::Albedo) || bakes(MapKind::Alpha) || carries;
        if self.jpeg.is_some() && self.low.is_none() && !colors {
            bail!("--jpeg: the asset has no base colour texture; add albedo to --maps");
        }
        if self.names_images()
            && self.low.is_none()
            && !maps.iter().any(|map| self.is_inside(*map))
            && !carries
        {
            bail!("--webp, --ktx2: the asset holds no texture; leave them out, or add such a map to --maps");
        }
        self.check_loss()?;
        let packs = self.is_packed();
        let beside = self.space == Space::Object || self.green == Green::Down || bakes(MapKind::Bent);
        if self.bits() == 16 && packs && bakes(MapKind::Normal) && !beside {
            bail!("--bits 16: WebP and KTX2 hold 8 bits; write PNG, or take 8");
        }
        Ok(())
    }

    /// Refuses a quality or an RDO that no texture has.
    fn check_loss(&self) -> Result<()> {
        let given = [
            ("--webp-quality", self.webp_quality, GltfImages::WebP, "--webp"),
            ("--uastc-rdo", self.uastc_rdo, GltfImages::Ktx2, "--ktx2"),
        ];
        for (option, _, images, other) in given.into_iter().filter(|(_, given, ..)| given.is_some()) {
            if self.images() != images {
                bail!("{option}: textures are {}; add {other}, or leave it out", self.images());
            }
            if !self.may_lose() {
                bail!(
                    "{option}: the asset holds no texture but normals, which it leaves alone; leave it out"
                );
            }
        }
        Ok(())
    }

    /// Says whether the asset may hold textures other than normals.
    fn may_lose(&self) -> bool {
        let is_lossy = |map: &MapKind| *map != MapKind::Normal && self.is_inside(*map);
        self.low.is_some() || self.carries() || self.maps().iter().any(is_lossy)
    }

    /// Says whether a map lies inside of the asset, and not beside it.
    fn is_inside(&self, map: MapKind) -> bool {
        match map {
            MapKind::Normal => self.space == Space::Tangent,
            other => !matches!(other, MapKind::Height | MapKind::Curvature | MapKind::Bent),
        }
    }

    /// Refuses files that cannot be written, or that are read.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        let read = [Some(&self.high), self.low.as_ref(), self.cage.as_ref(), self.provenance.as_ref()];
        files.protect(read.into_iter().flatten())?;
        let asset = Baker::new(self.options()).may_write(&self.output, &self.packing());
        asset.iter().try_for_each(|path| files.reserve(path))?;
        files.claim(&self.output)?;
        let reports = self.reports();
        let mut reports = reports.iter().filter(|_| !self.no_verify);
        Ok(reports.try_for_each(|path| files.claim(path))?)
    }

    /// Returns the files of the report: a page and JSON.
    pub fn reports(&self) -> [PathBuf; 2] {
        ["report.html", "report.json"].map(|kind| self.output.with_extension(kind))
    }

    /// Returns the model that the report shows; `None` where no file holds it with its normal map.
    pub fn shown_model(&self) -> Option<&Path> {
        (!self.is_alone() && self.space == Space::Tangent).then_some(&self.output)
    }

    /// Refuses requirements of levels of detail that are not asked for.
    fn check_levels(&self) -> Result<()> {
        let coarsest = self.lods().len();
        for requirement in self.proof.requirements() {
            if let Some(level) = requirement.level.filter(|level| *level > coarsest) {
                bail!(
                    "--require {}@{level}: the coarsest level of detail is {coarsest}; --lods asks for more",
                    requirement.name()
                );
            }
        }
        Ok(())
    }

    /// Returns the options of the bake.
    pub fn options(&self) -> BakeOptions {
        BakeOptions { goal: self.goal(), bytes: self.bytes, lods: self.lods(), ..self.unsearched() }
    }

    /// Returns the options of a bake that searches for nothing, without the levels of detail of a use.
    pub(super) fn unsearched(&self) -> BakeOptions {
        BakeOptions {
            low: self.low.clone().map(MeshSource::File),
            triangles: self.triangles(),
            lods: self.lods.clone(),
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

    /// Says whether the maps of the scan's own materials are baked beside those that are named.
    fn carries(&self) -> bool {
        self.maps.contains(&Auto::Auto)
    }

    /// Returns the maps that are asked for by name; `auto` asks for normals at least.
    pub(super) fn maps(&self) -> Vec<MapKind> {
        let named = self.maps.iter().filter_map(|map| map.given());
        let normal = self.carries().then_some(MapKind::Normal);
        normal.into_iter().chain(named).collect()
    }

    /// Says whether maps of normals are baked, which alone have a choice of bits.
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
            images: self.images(),
            webp_quality: self.webp_quality(),
            uastc_rdo: self.uastc_rdo(),
            jpeg: self.jpeg,
            meshopt: self.is_compressed(),
            provenance: self.provenance.clone(),
            green: self.green.into(),
            ..Packing::default()
        }
    }

    /// Returns what `--for` comes to with all other options, in words.
    pub fn chosen(&self) -> Option<String> {
        let name = self.purpose?.to_possible_value()?.get_name().to_owned();
        let made = self.low.is_none() && !self.searches();
        let levels: Vec<String> =
            made.then_some(self.triangles()).into_iter().chain(self.lods()).map(|n| n.to_string()).collect();
        let [width, height] = self.size();
        let parts = [
            (!levels.is_empty()).then(|| format!("{} triangles", levels.join(", "))),
            (!self.searches()).then(|| match width {
                AUTO_SIZE => "maps of automatic size".into(),
                _ => format!("maps of {width}×{height}"),
            }),
            self.bakes_normals().then(|| format!("normals in {} bits", self.bits())),
            Some(self.images().to_string()),
            self.webp_quality().map(|quality| format!("colours of quality {quality}")),
            self.uastc_rdo().map(|rdo| format!("RDO of {rdo}")),
            self.jpeg.map(|quality| format!("base colour as JPEG of quality {quality}")),
            self.is_compressed().then(|| "meshopt".into()),
        ];
        Some(format!("--for {name}: {}", parts.into_iter().flatten().collect::<Vec<String>>().join("; ")))
    }

    fn defaults(&self) -> Defaults {
        Defaults::of(self.purpose)
    }

    fn triangles(&self) -> u32 {
        self.triangles.unwrap_or(self.defaults().triangles)
    }

    /// Returns the levels asked for, else those for the use that are coarser than the mesh that is made.
    fn lods(&self) -> Vec<u32> {
        let made = self.low.is_none() && !self.searches();
        match (self.lods.is_empty(), made) {
            (false, _) => self.lods.clone(),
            (true, false) => Vec::new(),
            (true, true) => {
                self.defaults().lods.iter().copied().filter(|level| *level < self.triangles()).collect()
            }
        }
    }

    fn size(&self) -> [u32; 2] {
        self.size.unwrap_or([self.defaults().size; 2])
    }

    fn bits(&self) -> u8 {
        match self.bits.as_deref() {
            Some("16") => 16,
            None if self.has_extension("exr") && self.bakes_normals() => 16,
            None if self.images() == GltfImages::Png && self.bakes_normals() => self.defaults().bits,
            _ => 8,
        }
    }

    fn images(&self) -> GltfImages {
        match (self.ktx2, self.webp) {
            (true, _) => GltfImages::Ktx2,
            (_, true) => GltfImages::WebP,
            _ => self.defaults().images,
        }
    }

    /// Says whether textures are packed as WebP or KTX2, which takes longer than PNG.
    pub fn is_packed(&self) -> bool {
        self.images() != GltfImages::Png
    }

    /// Returns the quality of lossy WebP; WebP that is asked for by name is lossless.
    fn webp_quality(&self) -> Option<u8> {
        self.webp_quality.or(self.defaults().webp_quality.filter(|_| self.chooses_losses()))
    }

    /// Returns the RDO of KTX2; KTX2 that is asked for by name has none.
    fn uastc_rdo(&self) -> Option<u8> {
        self.uastc_rdo.or(self.defaults().uastc_rdo.filter(|_| self.chooses_losses()))
    }

    /// Says whether `--for` chooses what textures may lose.
    fn chooses_losses(&self) -> bool {
        !self.names_images() && self.may_lose()
    }

    /// Says whether the packing of textures is asked for, and not chosen by `--for`.
    fn names_images(&self) -> bool {
        self.webp || self.ktx2
    }

    fn is_compressed(&self) -> bool {
        self.meshopt || self.defaults().meshopt
    }

    /// Returns the limits of the bake.
    pub fn limits(&self) -> Limits {
        self.limits.limits()
    }
}
