//! The proof: an asset as its files show it, compared with the scan.

use super::figures::Figures;
use super::findings::{self, unseen};
use super::measurement::{Measurement, VerifyOptions, check_options};
use super::outcome::RequirementOutcome;
use super::pictures::{
    self, CloseUps, Looks, MeasuredPatch, PartFlip, PartView, PatchPictures, TakenCloseUps, Views, Wanted,
};
use super::shown::{ShownLevel, stacked};
use crate::asset::ask::{Requirement, pixels_across};
use crate::asset::bake::{Made, Part};
use crate::asset::source::{
    Scan, all_files, assign_object_map, from_metres, is_gltf, is_in_scan_unit, stated_unit,
};
use crate::asset::write::{MapNote, StoredValues, WrittenAsset, codes_of_normals, maps_alone};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::bake::{self, MapContent, MapKind, MatchRule, TexelChecks, UvIndex};
use taotie_engine::compare::Field;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Encoding, Texture};
use taotie_engine::length::Unit;
use taotie_engine::math::{Vec2, Vec3};
use taotie_engine::mesh::Point;
use taotie_engine::pixel::occluded;
use taotie_engine::progress::Progress;
use taotie_engine::proof::{Coarseness, MapCheck, MapError, StoredMap};
use taotie_engine::scene::{GreenChannel, NormalSpace, Scene};
use taotie_io::{GltfSizes, GltfSource, Limits, Loaded};

/// The differences of an asset from its scan: figures and images.
///
/// ```
/// use taotie::asset::{Proof, Requirement};
///
/// /// Returns `true` if an asset meets these requirements.
/// fn is_good(proof: &Proof) -> bool {
///     let wanted = [Requirement::mean_angle_deg(1.0), Requirement::missed(0.001)];
///     proof.require(&wanted).is_ok()
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Proof {
    /// The figures.
    pub figures: Figures,
    /// Angles between the normals of asset and scan at the texels of a map, on the surface, degrees; NaN between UV
    /// islands. It has the layout of the asset's normal map, or else its base colour. If there are several materials,
    /// their maps are stacked vertically, in the order of [`Figures::parts`]; narrower ones are left-aligned. `None`
    /// if the asset has no uvs or no textures, if they repeat more than 16 times across a triangle, or if
    /// [`VerifyOptions::map`] is 0.
    pub error_map: Option<Field>,
    /// CIEDE2000 between the base colours of asset and scan at the same texels; `None` if the scan specifies no
    /// material.
    pub color_map: Option<Field>,
    /// The ratio of the asset's texel width to the scan's finest detail, at the same texels: a texel of the scan's
    /// texture or half its median edge, as in [`Resolution`](super::Resolution). `None` if the asset has no textures.
    pub detail_map: Option<Field>,
    /// The angle between the normals of the scan as given and without its noise, degrees, from the front and from the
    /// back; NaN elsewhere. Empty if no noise was removed, or if [`VerifyOptions::map`] is 0.
    pub noise_maps: Vec<Field>,
    /// Scan and asset from all sides, in one grey material.
    pub views: Views,
    /// The same in full material; `None` if the scan specifies none.
    pub full_views: Option<Views>,
    /// Like `views`, for each coarser level of detail.
    pub coarser_views: Vec<Views>,
    /// The worst patches of the finest level, if [`VerifyOptions::patch_view`] requests pictures of them.
    pub patches: Vec<PatchPictures>,
    /// FLIP of close-ups of the worst UV island and the worst material of the finest level, likewise, with half as
    /// many pixels along a side.
    pub part_flips: Vec<PartFlip>,
    /// The maps of the asset, with the errors of those that no figure covers; empty if it was not baked here.
    pub maps: Vec<MapNote>,
    /// Problems with the file as read, and of the measurement.
    pub warnings: Warnings,
}

/// Reads an asset made by any program, and measures its differences from its scan, like [`WrittenAsset::verify`]. If the
/// scan's unit is known, a glTF asset is in metres, as its specification requires; other formats are in the scan's
/// space. A scan with the options of [`ScanOptions::recorded`](crate::asset::ScanOptions::recorded) is read as it was
/// for the bake of the asset.
///
/// ```no_run
/// use taotie::Progress;
/// use taotie::asset::{Requirement, Scan, VerifyOptions, verify};
/// use taotie::Limits;
///
/// let limits = Limits::default();
/// let scan = Scan::read("scan.ply", &limits, Progress::SILENT)?;
/// let options = VerifyOptions { requirements: Requirement::standard(), ..VerifyOptions::default() };
/// let proof = verify("packed.glb", scan, &options, Progress::SILENT)?;
/// proof.require(&options.requirements)?;
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// Those of [`WrittenAsset::verify`] and of reading the asset; [`Error::Invalid`] if its size shows that it is in the
/// scan's unit rather than in metres.
pub fn verify(
    asset: impl AsRef<Path>,
    scan: impl Into<Scan>,
    options: &VerifyOptions,
    progress: Progress<'_>,
) -> Result<Proof> {
    check_options(options)?;
    let (path, scan, options) = (asset.as_ref().to_path_buf(), scan.into(), options.clone());
    progress.apart(move |progress| {
        let unit = scan.unit();
        Requirement::check_unit(&options.requirements, unit)?;
        progress.begin("read back")?;
        let mut levels = taotie_io::load_levels_within(&path, &scan.limits)?;
        Requirement::check_levels(&options.requirements, levels.len())?;
        if let Some((finest, stated)) =
            levels.first().and_then(|finest| Some((finest, stated_unit(finest.format)?)))
        {
            refuse_scan_unit((&finest.scene, stated), &scan, &path)?;
            into_scan_space(&mut levels, unit)?;
        }
        let files = levels.iter().flat_map(|level| &level.files).cloned().collect();
        let bytes_out = bytes_of(&path, files)?;
        let gpu_bytes = gpu_bytes(&path, &levels, &scan.limits)?;
        prove(
            Shown { levels, path, bytes_out, gpu_bytes, is_searched: false, has_material: true, unit },
            scan,
            &options,
            progress,
        )
    })
}

/// Refuses an asset that is not in the unit that it states, as a text.
fn refuse_scan_unit((asset, stated): (&Scene, &str), scan: &Scan, path: &Path) -> Result<()> {
    match is_in_scan_unit(asset, scan) {
        None => Ok(()),
        Some(unit) => {
            let why = format!(
                "{stated}, but its size shows that it is in {unit} like the scan; scale it to metres, or specify no unit \
                 for the scan"
            );
            Err(Error::invalid(path.display().to_string(), why))
        }
    }
}

/// Transforms all levels of an asset in metres into the space of a scan in this unit.
fn into_scan_space(levels: &mut [Loaded], unit: Option<Unit>) -> Result<()> {
    levels.iter_mut().try_for_each(|level| from_metres(&mut level.scene, unit))
}

/// Returns the bytes of a model's file and all files that it references.
fn bytes_of(path: &Path, mut others: Vec<PathBuf>) -> Result<u64> {
    all_files(path, &mut others).iter().map(|file| taotie_io::file_size(file)).sum()
}

/// Returns the bytes that all levels of a file take on a graphics card; `None` unless it is glTF.
fn gpu_bytes(path: &Path, levels: &[Loaded], limits: &Limits) -> Result<Option<u64>> {
    let is_gltf = levels.first().is_some_and(|finest| is_gltf(finest.format));
    let sizes = is_gltf.then(|| GltfSizes::read(GltfSource::File(path), limits)).transpose()?;
    Ok(sizes.map(|sizes| sizes.gpu_bytes))
}

/// An asset as its files show it.
struct Shown {
    /// One for each level of detail, the finest first; at least one.
    levels: Vec<Loaded>,
    path: PathBuf,
    bytes_out: u64,
    /// Bytes on a graphics card; `None` unless it is glTF.
    gpu_bytes: Option<u64>,
    /// `true` if a search chose its texels by their cost.
    is_searched: bool,
    /// `true` if the files specify their material.
    has_material: bool,
    /// The unit of the scan, in whose space the levels are.
    unit: Option<Unit>,
}

fn prove(shown: Shown, scan: Scan, options: &VerifyOptions, progress: Progress<'_>) -> Result<Proof> {
    let Shown { mut levels, path, bytes_out, gpu_bytes, is_searched, has_material, unit } = shown;
    let mut warnings = Warnings::default();
    for level in &mut levels {
        warnings.absorb(std::mem::take(&mut level.warnings));
    }
    let poses = levels.iter().any(|level| level.rig.is_some()) || scan.about.is_rigged;
    let across: Vec<Option<f32>> = levels.iter().map(|level| level.coverage.map(pixels_across)).collect();
    let scenes: Vec<Scene> = levels.into_iter().map(|level| level.scene).collect();
    scan.sort(progress)?;
    progress.begin("measure normals")?;
    let level = |scene: &Scene| ShownLevel::of(scene, &scan, (&path, has_material));
    let finest = level(&scenes[0])?;
    let (mut figures, parts) = Measurement { scan: &scan, unit, options, across: &across }.all(
        &finest,
        &scenes[1..],
        &level,
        progress,
    )?;
    figures.parts = parts;
    findings::note_whole(&figures, &finest, &mut warnings);
    figures.bytes_in = scan.about.bytes;
    figures.bytes_out = bytes_out;
    figures.gpu_bytes = gpu_bytes;
    let [error_map, color_map, detail_map] = match options.map {
        0 => [None, None, None],
        most => {
            progress.begin("map errors")?;
            maps(&finest, scan.sorted(), most)?
        }
    };
    let close_ups = close_ups(&figures, &finest, options.patch_view)?;
    let unlit = findings::unlit(&finest);
    drop(finest);
    let views = progress.begin("compare views")?;
    let scan = scan.into_scene()?;
    figures.unseen = unseen([&scan, &scenes[0]], poses);
    figures.unseen.extend(unlit);
    findings::note_layers([&scan, &scenes[0]], &mut warnings);
    findings::note_sides([&scan, &scenes[0]], &figures, &mut warnings);
    let mut looks = pictures::take(scan, scenes, Wanted { side: options.view, close_ups }, views)?;
    if !has_material {
        looks.full.clear();
    }
    let proof = Proof::new(figures, looks);
    findings::note(&proof.figures, &options.requirements, &mut warnings);
    if !is_searched {
        findings::note_texels(&proof.figures, &mut warnings);
    }
    Ok(Proof { error_map, color_map, detail_map, warnings, ..proof })
}

/// Returns the close-ups to take of the finest level, with `side` pixels along a side; those of parts, which are not
/// displayed, have half as many.
fn close_ups(figures: &Figures, finest: &ShownLevel<'_>, side: u32) -> Result<CloseUps> {
    let Some(found) = figures.finest() else { return Ok(CloseUps::default()) };
    let patches = MeasuredPatch::all(&found.patches, finest, side)?;
    Ok(CloseUps { patches, parts: PartView::all(&found.worst_parts, figures.diagonal, side.div_ceil(2)) })
}

/// Returns the maps of normal errors, of colour errors, and of lost detail, of all parts with uvs, with at most
/// `most` texels along a side.
fn maps(level: &ShownLevel<'_>, scan: &bake::Scan, most: u32) -> Result<[Option<Field>; 3]> {
    let coarseness = Coarseness::between(scan, &level.surface);
    let coarser = |point: Point, texel: f32| coarseness.at(scan, point, texel);
    let (mut angles, mut colors, mut details) = (Vec::new(), Vec::new(), Vec::new());
    for (part, surface) in level.parts.iter().zip(level.part_surfaces()) {
        let has_uvs = !part.shown.mesh().uvs().is_empty();
        let Some(size) = part.shown.map_size().filter(|_| has_uvs).map(|size| within(size, most)) else {
            continue;
        };
        let checks = TexelChecks { colors: surface.material, coarser: Some((&part.shown, &coarser)) };
        let Some(found) = surface.mapped.error_maps(size, checks)? else { continue };
        angles.push(found.angles);
        colors.extend(found.colors);
        details.extend(found.coarser);
    }
    let stack = |maps: &[Field]| (!maps.is_empty()).then(|| stacked(maps)).transpose();
    Ok([stack(&angles)?, stack(&colors)?, stack(&details)?])
}

impl WrittenAsset {
    /// Reads the asset back and measures its differences from the scan. Standalone maps are measured on the low-poly
    /// mesh.
    ///
    /// Lengths have the unit of the scan that the asset was baked from.
    ///
    /// Each level of detail is measured, the coarser ones at a quarter of the points. If the scan is passed by value
    /// rather than borrowed, its tree is freed before images of it are rendered. The listener receives the stages
    /// `read back`, `measure maps` if some are in no figure, `measure normals`, `measure levels` if there are several, `map errors`, and `compare views`.
    ///
    /// # Errors
    /// [`Error::Cancelled`]; those of reading, if the files are not as written; [`Error::Invalid`] if an option is
    /// out of range.
    pub fn verify(
        &self,
        scan: impl Into<Scan>,
        options: &VerifyOptions,
        progress: Progress<'_>,
    ) -> Result<Proof> {
        check_options(options)?;
        Requirement::check_unit(&options.requirements, self.unit())?;
        let (written, scan, options) = (self.clone(), scan.into(), options.clone());
        progress.apart(move |progress| {
            progress.begin("read back")?;
            let shown = written.shown()?;
            let noise_maps = written.noise_maps(&scan, &options)?;
            let maps = written.measured_maps(&scan, &shown.levels[0].scene, progress)?;
            let mut proof = Proof { noise_maps, maps, ..prove(shown, scan, &options, progress)? };
            proof
                .figures
                .unseen
                .extend(maps_alone::unseen(&written.asset.made).filter(|_| written.is_alone()));
            Ok(proof)
        })
    }

    /// Reads all levels back, the finest first; standalone maps onto the low-poly mesh. Maps are decoded and in
    /// memory once.
    fn shown(&self) -> Result<Shown> {
        let (made, limits, unit) = (&self.asset.made, Limits::of_own_files(), self.unit());
        let path = self.path().to_path_buf();
        if self.is_alone() {
            let place = (self.requested.as_path(), &self.set);
            let loaded = maps_alone::read_back(made, self.packing.green, place)?;
            let files = self.files.iter().map(|file| taotie_io::file_size(&self.set.current(file)));
            let (bytes_out, has_material) = (files.sum::<Result<u64>>()?, maps_alone::has_material(made));
            let mut levels = vec![loaded];
            self.show_object_maps(&mut levels)?;
            let (gpu_bytes, is_searched) = (None, false);
            return Ok(Shown { levels, path, bytes_out, gpu_bytes, is_searched, has_material, unit });
        }
        let mut levels = taotie_io::load_levels_within(&self.current(), &limits)?;
        let files = levels.iter().flat_map(|level| &level.files).cloned().collect();
        let bytes_out = bytes_of(&self.current(), files)?;
        let gpu_bytes = gpu_bytes(&self.current(), &levels, &limits)?;
        self.check_read_back(&levels)?;
        self.show_object_maps(&mut levels)?;
        into_scan_space(&mut levels, unit)?;
        let is_searched = made.rounding.is_some();
        Ok(Shown { levels, path, bytes_out, gpu_bytes, is_searched, has_material: true, unit })
    }

    /// Returns the notes on all maps, with the errors of those that no figure covers, as their files store them; `shown` is
    /// the finest level, read back.
    fn measured_maps(&self, scan: &Scan, shown: &Scene, progress: Progress<'_>) -> Result<Vec<MapNote>> {
        let notes = self.maps();
        let is_measured = |note: &MapNote| note.is_in_no_figure() && self.is_of_scan(note, scan);
        if !notes.iter().any(is_measured) {
            return Ok(notes);
        }
        scan.sort(progress)?;
        progress.begin("measure maps")?;
        let Made { options, parts, .. } = &*self.asset.made;
        // The scan may be another than that of the bake.
        let uvs = (options.matching == MatchRule::Uv).then(|| UvIndex::of(scan.mesh()).map(Arc::new));
        let uvs = uvs.transpose()?;
        let mut notes = Vec::with_capacity(notes.len());
        for part in parts {
            let check = MapCheck {
                low: &part.low.mesh,
                cage: &part.maps.cage.clone().with_uvs(uvs.clone()),
                scan: scan.sorted(),
                isolated: options.matching == MatchRule::Isolated,
                sky_distance: options.ao_distance.map(|v| v as f32),
                bevel_radius: options.bevel_radius.map(|v| v as f32),
                roughness: options
                    .roughness
                    .filter(|_| options.bakes(&[MapKind::Roughness]))
                    .map(|v| v as f32),
            };
            for mut note in self.maps_of_part(part) {
                if is_measured(&note) {
                    note.error = match &note.file {
                        Some(file) => self.map_error(&note, file, &check)?,
                        None => occlusion_error(part, &note, (shown, &check))?,
                    };
                }
                notes.push(note);
            }
        }
        Ok(notes)
    }

    /// Returns `true` if a map shows the scan: properties of its material that were not baked are of the low-poly mesh if
    /// the scan specifies none.
    fn is_of_scan(&self, note: &MapNote, scan: &Scan) -> bool {
        use MapKind::{Albedo, Alpha, Emission, MetallicRoughness, Roughness};
        let options = &self.asset.made.options;
        match note.map {
            Roughness => !scan.about.is_plain || options.bakes(&[Roughness, MetallicRoughness]),
            own @ (Albedo | Alpha | Emission | MetallicRoughness) => {
                !scan.about.is_plain || options.bakes(&[own])
            }
            _ => true,
        }
    }

    fn map_error(&self, note: &MapNote, file: &Path, check: &MapCheck<'_>) -> Result<Option<MapError>> {
        let space = self.asset.made.options.space;
        let bitmap = taotie_io::read_bitmap_within(&self.set.current(file), &Limits::of_own_files())?;
        let component = note.packed.as_ref().and_then(|packed| packed.map.quantity.component());
        let is_turned = match note.map {
            MapKind::Bent | MapKind::Bevel | MapKind::Normal => space == NormalSpace::Tangent,
            _ => false,
        };
        let green = if is_turned { self.packing.green } else { GreenChannel::Up };
        let surface = check.scan.surface();
        let things = surface.part_count().max(surface.material_names().len());
        let values = StoredValues::of(note, bitmap, (green, things as u32));
        let map = StoredMap { kind: note.map, space, component, value: &|uv| values.at(uv) };
        let unit = match (note.map.content(), component) {
            (MapContent::Direction, None) => "°",
            (MapContent::Color, None) => "ΔE00",
            (MapContent::Label, _) => "share",
            _ => &note.unit,
        };
        check.error(&map, unit)
    }

    /// Returns pictures of the angles by which the removal of noise turned the normals of its scan.
    fn noise_maps(&self, scan: &Scan, options: &VerifyOptions) -> Result<Vec<Field>> {
        let removed = self.asset.made.noise.as_ref().map_or(&[][..], |noise| &noise.angles);
        match options.map > 0 && !removed.is_empty() && removed.len() == scan.mesh().positions().len() {
            true => pictures::vertex_angles(scan.mesh(), removed, options.view),
            false => Ok(Vec::new()),
        }
    }

    /// Returns the unit of the scan that it was baked from.
    fn unit(&self) -> Option<Unit> {
        self.asset.made.about.unit()
    }

    /// Refuses a file that does not contain what was written.
    fn check_read_back(&self, levels: &[Loaded]) -> Result<()> {
        let (made, name) = (&self.asset.made, self.path().display().to_string());
        let wanted = self.asset.levels().count();
        if (made.document.is_none() || wanted > 1) && levels.len() != wanted {
            let why = format!("read back, it has {} levels of detail instead of {wanted}", levels.len());
            return Err(Error::invalid(name, why));
        }
        let has_map = made.parts.iter().any(|part| part.maps.textures.normal.is_some());
        let shows_map =
            levels.iter().any(|level| level.scene.materials().iter().any(|own| own.normal.is_some()));
        if has_map && !shows_map {
            return Err(Error::invalid(name, "read back, it shows no normal map"));
        }
        Ok(())
    }

    /// Assigns the object-space maps written next to the asset to materials, since glTF cannot reference them.
    fn show_object_maps(&self, levels: &mut [Loaded]) -> Result<()> {
        let Made { parts, options, coarser, .. } = &*self.asset.made;
        if options.space != NormalSpace::Object {
            return Ok(());
        }
        let notes = self.maps();
        for part in parts {
            let label = part.low.label();
            let is_it = |note: &&MapNote| {
                note.map == MapKind::Normal && note.material.as_deref().unwrap_or("") == label
            };
            let Some(file) = notes.iter().find(is_it).and_then(|note| note.file.as_ref()) else { continue };
            let texture = self.read_normals(file)?;
            let coarser = coarser.iter().map(|level| &level.mesh);
            let sampler = taotie_io::gltf_sampler(std::iter::once(&part.low.mesh).chain(coarser));
            let own = part.low.own.as_ref().map(|own| own.number);
            levels
                .iter_mut()
                .try_for_each(|level| assign_object_map(&mut level.scene, own, (&texture, sampler)))?;
        }
        Ok(())
    }

    fn read_normals(&self, path: &Path) -> Result<Texture> {
        let codes = taotie_io::read_bitmap_within(&self.set.current(path), &Limits::of_own_files())?;
        let codes = codes_of_normals(codes)?;
        Ok(Texture::new(codes, Encoding::Normal))
    }
}

/// Measures the occlusion that the material of a part shows in a model, read back; without a texture it is 1.
fn occlusion_error(
    part: &Part,
    note: &MapNote,
    (shown, check): (&Scene, &MapCheck<'_>),
) -> Result<Option<MapError>> {
    let materials = shown.materials();
    let material = match &part.low.own {
        Some(own) => materials.get(own.number),
        None => materials.iter().find(|material| material.occlusion_texture.is_some()),
    };
    let used = material.and_then(|material| Some((material.occlusion_texture?, material.occlusion_strength)));
    let value = |uv: Vec2| {
        let open = used.map_or(1.0, |(texture, strength)| {
            let at = texture.transform.apply(uv);
            let [red, ..] = texture.sampler.sample(&shown.textures()[texture.texture], at, 0.0);
            occluded(red, strength)
        });
        Vec3::splat(open)
    };
    let space = NormalSpace::Tangent;
    check.error(&StoredMap { kind: note.map, space, component: None, value: &value }, "")
}

impl Proof {
    /// The mean and maximum angle, degrees, between unit vectors and their 8-bit encodings.
    ///
    /// ```
    /// use taotie::asset::Proof;
    ///
    /// /// Returns `true` if more bits would gain more than a finer map.
    /// fn is_near_floor(mean_angle: f64) -> bool {
    ///     mean_angle < 1.1 * Proof::FLOOR_8_BIT[0]
    /// }
    /// ```
    pub const FLOOR_8_BIT: [f64; 2] = [0.17, 0.38];

    /// Compares each requirement with the figures; see [`Figures::evaluate`].
    pub fn evaluate(&self, requirements: &[Requirement]) -> Vec<RequirementOutcome> {
        self.figures.evaluate(requirements)
    }

    /// Returns an error that lists the requirements that are not met, each with its value and limit.
    ///
    /// # Errors
    /// [`Error::Unmet`] unless all are met.
    pub fn require(&self, requirements: &[Requirement]) -> Result<()> {
        let outcomes = self.evaluate(requirements);
        let unmet: Vec<String> =
            outcomes.iter().filter(|met| !met.met).map(RequirementOutcome::in_list).collect();
        if unmet.is_empty() { Ok(()) } else { Err(Error::Unmet { what: unmet.join(", ") }) }
    }

    /// Adds the figures of the views, the finest level's first, to those of their levels.
    fn new(mut figures: Figures, looks: Looks) -> Self {
        for (level, views) in figures.levels.iter_mut().zip(&looks.grey) {
            level.views.clone_from(&views.figures);
        }
        for (level, views) in figures.levels.iter_mut().zip(&looks.full) {
            level.full_views.clone_from(&views.figures);
        }
        let mut grey = looks.grey.into_iter();
        let (views, full_views) = (grey.next().unwrap_or_default(), looks.full.into_iter().next());
        let (coarser_views, warnings) = (grey.collect(), Warnings::default());
        let TakenCloseUps { patches, parts: part_flips } = looks.close_ups;
        let [error_map, color_map, detail_map] = [None, None, None];
        Self {
            figures,
            error_map,
            color_map,
            detail_map,
            noise_maps: Vec::new(),
            maps: Vec::new(),
            views,
            full_views,
            coarser_views,
            patches,
            part_flips,
            warnings,
        }
    }
}

/// Returns a size with the same aspect ratio and at most `most` texels along its longer side.
fn within(size: [u32; 2], most: u32) -> [u32; 2] {
    let longer = size[0].max(size[1]);
    let scaled = |side: u32| (u64::from(side) * u64::from(most) / u64::from(longer)).max(1) as u32;
    if longer <= most { size } else { size.map(scaled) }
}
