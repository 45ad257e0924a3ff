//! The request that the options of a bake make: which options work together, the bake and the packing, and the target
//! of a search, unless triangles, size or packing are given.

use super::args::{Auto, BakeArgs, Images, Skew};
use crate::studio::{Green, Space};
use anyhow::{Result, anyhow, bail};
use std::path::{Path, PathBuf};
use taotie::Limits;
use taotie::asset::{
    BakeOptions, Baker, Channels, Figure, Lod, Looking, MeshSource, Packing, Preset, RayDistance,
    Requirement, VerifyOptions,
};
use taotie_engine::bake::MapKind;
use taotie_engine::names::Named;
use taotie_io::{CodecKind, CodecSet, FileSet, MapFormat, TextureCodecs};

impl BakeArgs {
    /// Rejects options that cannot work together, before any work is done.
    pub fn check(&self) -> Result<()> {
        if !self.is_alone() && !["glb", "gltf"].into_iter().any(|model| self.has_extension(model)) {
            bail!(
                "{}: unsupported format; write assets as .glb or .gltf, standalone maps as .png, .tiff, .exr, .tga, \
                 .dds or .webp",
                self.output.display()
            );
        }
        self.check_alone()?;
        let same = |path: &Path| {
            path.canonicalize().ok().is_some_and(|p| Some(p) == self.output.canonicalize().ok())
        };
        if let Some(input) = self.inputs().find(|input| same(input)) {
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
        let turns = |map: &MapKind| matches!(map, MapKind::Normal | MapKind::Bent | MapKind::Bevel);
        let turns = self.maps().iter().any(turns);
        if self.green == Green::Down && (self.space == Space::Object || !turns) {
            bail!(
                "--green down: no normal, bent or bevel map is baked in tangent space; bake one, or leave it out"
            );
        }
        if self.cage.is_some() && self.skew == Some(Skew::Auto) {
            bail!("--skew auto: rays follow the cage; leave it out, or use a mask");
        }
        self.check_unread()?;
        self.check_channels()?;
        self.proof.signature().check()?;
        self.options().check()?;
        Ok(self.packing().check()?)
    }

    /// Returns the files to read.
    fn inputs(&self) -> impl Iterator<Item = &PathBuf> {
        let others = [self.low.as_ref(), self.cage.as_ref(), self.skew_mask(), self.provenance.as_ref()];
        self.high.iter().chain(others.into_iter().flatten())
    }

    /// Returns the mask of skew correction.
    fn skew_mask(&self) -> Option<&PathBuf> {
        match &self.skew {
            Some(Skew::Mask(path)) => Some(path),
            _ => None,
        }
    }

    /// Returns true if there is an output for each UDIM tile.
    fn has_tiles(&self) -> bool {
        self.output.file_name().is_some_and(|name| name.to_string_lossy().contains(BakeOptions::UDIM))
    }

    /// Returns the output with a name in place of the number of a UDIM tile.
    fn with_tile(&self, name: &str) -> PathBuf {
        match self.has_tiles() {
            true => {
                let file = self.output.file_name().unwrap_or_default().to_string_lossy();
                self.output.with_file_name(file.replace(BakeOptions::UDIM, name))
            }
            false => self.output.clone(),
        }
    }

    /// Returns true if only maps are written, without a model.
    fn is_alone(&self) -> bool {
        self.map_format().is_some()
    }

    /// Returns the format of standalone maps; `None` for a model.
    fn map_format(&self) -> Option<MapFormat> {
        MapFormat::of(&self.output)
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
            ("--remesh", self.remesh),
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
        let Some(format) = self.map_format() else {
            if self.bits() == 32 {
                bail!("--bits 32: a model stores no floats; write standalone maps as .tiff or .exr");
            }
            return Ok(());
        };
        let (maps, name) = (self.maps(), format.name());
        match maps.iter().find(|map| map.is_fine()) {
            _ if format == MapFormat::Exr && !matches!(self.bits.as_deref(), None | Some("32")) => {
                bail!("--bits: an .exr stores floats; leave it out, or write a .png")
            }
            _ if self.bits() == 32 && format.bits() < 32 => {
                bail!("--bits 32: a .{name} stores no floats; write a .tiff or .exr, or use 16")
            }
            _ if format.bits() > 8 => Ok(()),
            Some(map) => {
                bail!("--maps {}: it needs 16 bits, and a .{name} stores 8; write a .png", map.name())
            }
            None if self.bits() == 16 => bail!("--bits 16: a .{name} stores 8 bits; write a .png, or use 8"),
            None => Ok(()),
        }
    }

    /// Rejects options that have no effect.
    fn check_unread(&self) -> Result<()> {
        let (maps, carries) = (self.maps(), self.carries());
        let bakes = |map: MapKind| maps.contains(&map);
        let sky = bakes(MapKind::Occlusion) || bakes(MapKind::Bent);
        if self.ao_rays.is_some() && !sky && !bakes(MapKind::Thickness) && !bakes(MapKind::Bevel) {
            bail!("--ao-rays: none of ao, bent, thickness and bevel is baked; add one of them to --maps");
        }
        if self.bevel_radius.is_some() && !bakes(MapKind::Bevel) {
            bail!("--bevel-radius: no bevel map is baked; add bevel to --maps");
        }
        if self.ao_distance.is_some() && !sky {
            bail!("--ao-distance: neither ao nor bent is baked; add one of them to --maps");
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

    /// Rejects packed textures of maps that are not baked, or of the same file.
    fn check_channels(&self) -> Result<()> {
        Channels::check_all(&self.channels, &self.maps(), self.carries())
            .map_err(|why| anyhow!("--channels: {why}"))
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
            other => !other.is_separate(),
        }
    }

    /// Rejects outputs that cannot be written or that are inputs.
    pub fn claim(&self, files: &FileSet) -> Result<()> {
        files.protect(self.inputs())?;
        let output = self.with_tile("1001");
        let asset = Baker::new(self.options()).may_write(&output, &self.packing());
        asset.iter().try_for_each(|path| files.reserve(path))?;
        files.claim(&output)?;
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
        let output = self.with_tile("udim");
        ["report.html", "report.json"].map(|kind| output.with_extension(kind))
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
    fn unsearched(&self) -> BakeOptions {
        BakeOptions {
            low: self.low.clone().map(MeshSource::File),
            triangles: self.triangles(),
            remesh: self.remesh,
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
            bevel_radius: self.bevel_radius,
            matching: self.matching.unwrap_or_default(),
            sizes: self.sizes.clone().unwrap_or_default(),
            new_uvs: self.new_uvs,
            udim: self.has_tiles(),
            ray_distance: self.ray_distance(),
            ray_colors: self.ray_colors,
            straighten: self.skew != Some(Skew::Keep),
            skew_mask: self.skew_mask().cloned(),
            noise: self.noise,
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
    fn maps(&self) -> Vec<MapKind> {
        let named = self.maps.iter().filter_map(|map| map.given());
        let normal = self.carries().then_some(MapKind::Normal);
        normal.into_iter().chain(named).collect()
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
            channels: self.channels.clone(),
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
            Some("32") => 32,
            None if self.has_extension("exr") => 32,
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

/// The target of a search.
impl BakeArgs {
    /// Returns the requirements of a search for the smallest asset; `None` without one, or with only a number of
    /// bytes.
    fn goal(&self) -> Option<Vec<Requirement>> {
        let is_asked = self.asked().is_some();
        if !is_asked && self.is_by_hand() {
            return None;
        }
        let target = self.target();
        let ceilings = self.ceilings();
        match (target.is_empty(), self.bytes.is_some()) {
            (true, true) => (!ceilings.is_empty()).then_some(ceilings),
            (true, false) => Some([Requirement::visually_lossless(), ceilings].concat()),
            (false, _) => Some([target, ceilings].concat()),
        }
    }

    /// Returns the limits on differences: those of the preset, unless an option limits the same figure.
    fn target(&self) -> Vec<Requirement> {
        let asked = self.error.map(Requirement::mean_angle_deg).into_iter().chain(self.proof.requirements());
        let asked: Vec<Requirement> = asked.collect();
        let of_preset = self.of_preset().filter(|own| !is_ceiling(own));
        let kept = of_preset.filter(|own| !self.overrides(own, &asked));
        kept.chain(asked.iter().copied()).collect()
    }

    /// Returns the ceilings of the options, otherwise of the preset.
    fn ceilings(&self) -> Vec<Requirement> {
        let triangles = self.max_triangles.map(f64::from).map(|most| (Figure::Triangles, most));
        let gpu_memory = self.max_gpu_memory.map(|most| (Figure::GpuMemory, most as f64));
        let given =
            triangles.into_iter().chain(gpu_memory).map(|(figure, most)| Requirement::of(figure, most));
        let given: Vec<Requirement> = given.collect();
        let required = self.proof.requirements();
        let of_preset = self.of_preset().filter(is_ceiling);
        let kept = of_preset.filter(|own| !self.overrides(own, &given) && !self.overrides(own, &required));
        kept.chain(given.iter().copied()).collect()
    }

    /// Returns `true` if one of `others` limits the same figure of the finest level as `own` of a preset; `--error`
    /// overrides all angle limits.
    fn overrides(&self, own: &Requirement, others: &[Requirement]) -> bool {
        let is_finest = |other: &Requirement| other.level.is_none_or(|level| level == 0);
        let is_angle = matches!(own.figure, Figure::MeanAngle | Figure::P95Angle | Figure::PatchDetail);
        (self.error.is_some() && is_angle)
            || others.iter().any(|other| other.figure == own.figure && is_finest(other))
    }

    fn of_preset(&self) -> impl Iterator<Item = Requirement> {
        self.preset.into_iter().flat_map(|preset| preset.requirements())
    }

    /// Returns the options of the proof, which also checks ceilings and the number of bytes.
    pub(super) fn proof_options(&self) -> VerifyOptions {
        let mut options = self.proof.options();
        options.requirements.extend(self.ceilings());
        options.requirements.extend(self.bytes.map(Requirement::bytes));
        options
    }

    /// Rejects a search that could not find anything.
    fn check_search(&self) -> Result<()> {
        if self.trials.is_some() && !self.searches() {
            bail!("--trials: these options run no search; leave it out");
        }
        if self.codecs != CodecSet::Portable && !self.searches() && !self.meshopt {
            bail!(
                "--codecs {}: these options run no search and do not compress geometry; add --meshopt",
                self.codecs.name()
            );
        }
        let Some(option) = self.asked() else { return Ok(()) };
        if self.space == Space::Object || !self.maps().contains(&MapKind::Normal) {
            bail!(
                "{option} needs a normal map in tangent space: add normal to --maps, and leave out --space object"
            );
        }
        if matches!(self.images, Images::Given(_)) {
            bail!("{option} chooses the quality of images: leave it out of --images");
        }
        Ok(())
    }

    /// Returns `true` if these options run a search.
    fn searches(&self) -> bool {
        self.goal().is_some() || self.bytes.is_some()
    }

    /// Returns the option that requests a search.
    fn asked(&self) -> Option<&'static str> {
        let given = [
            ("--error", self.error.is_some()),
            ("--bytes", self.bytes.is_some()),
            ("--preset", self.preset.is_some()),
            ("--max-triangles", self.max_triangles.is_some()),
            ("--max-gpu-memory", self.max_gpu_memory.is_some()),
        ];
        given.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }

    /// Returns `true` if triangles, size or packing are given, or an option that a search does not support.
    fn is_by_hand(&self) -> bool {
        let is_given = self.triangles.is_some() || self.size.is_some() || self.meshopt || self.bits.is_some();
        // The scan itself, packed, has no texels to pack into channels.
        let is_beside = self.green == Green::Down || !self.channels.is_empty();
        let is_unsearched = is_beside || !self.unsearched().may_search();
        is_given || matches!(self.images, Images::Given(_)) || is_unsearched
    }
}

/// Returns `true` for a limit on the asset's resources rather than its appearance.
fn is_ceiling(required: &Requirement) -> bool {
    required.figure.looking() == Looking::Files
}
