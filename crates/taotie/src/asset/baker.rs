//! From a scan to an asset.

use super::ask::{BakeOptions, Packing, note_unread_options};
use super::bake::{
    Asset, BakePlan, Coarser, LevelLook, Made, MadeAsset, MemoryEstimate, Part, Recipe, Rounding, StoredMaps,
    Trial, bake_maps, judgement, set_sizes, side_shortfall,
};
use super::search::{Finest, Level, PackedAsset, Smallest, make_levels, smallest};
use super::source::{
    Base, Document, GivenMesh, Inputs, LowPoly, MadeFrom, Pair, Rays, Relief, Scan, ScanSize, low_poly,
    warnings_of_packed_scan,
};
use super::write::possible_files;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::bake::{self, MapKind};
use taotie_engine::error::{Result, Warnings};
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::scene::AlphaMode;
use taotie_io::{Bytes, FileSet, Limits};

/// Bakes scans with fixed options.
///
/// ```
/// use std::sync::Arc;
/// use taotie::asset::{BakeOptions, Baker, MeshSource, Scan};
/// use taotie::{Mesh, Progress};
///
/// let scan = Scan::from_mesh(Mesh::sphere(1.0, 128, 64), Progress::SILENT)?;
/// let low = Some(MeshSource::Mesh(Arc::new(Mesh::sphere(1.0, 24, 12))));
/// let baker = Baker::new(BakeOptions { low, size: 64, ..BakeOptions::default() });
/// let asset = baker.bake(scan, Progress::SILENT)?;
/// assert_eq!((asset.size(), asset.levels().count()), ([64, 64], 1));
/// assert!(asset.textures().normal.is_some());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Baker {
    options: Arc<BakeOptions>,
    limits: Limits,
    files: Option<FileSet>,
}

impl Baker {
    /// Creates a baker with `options` that uses the machine's free memory.
    pub fn new(options: BakeOptions) -> Self {
        Self { options: Arc::new(options), ..Self::default() }
    }

    /// Returns this baker with the given limits.
    pub fn with_limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// Returns this baker for a set of files: before work begins, it refuses output paths that the scan, the low-poly
    /// mesh or the cage was read from. Without it, [`Asset::write`] refuses them afterwards.
    ///
    /// ```
    /// use taotie::Progress;
    /// use taotie::asset::{Baker, Scan};
    /// use taotie_io::FileSet;
    ///
    /// let folder = tempfile::tempdir().unwrap();
    /// let path = folder.path().join("ball.obj");
    /// std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    /// let scan = Scan::read(&path, &Default::default(), Progress::SILENT)?;
    ///
    /// let files = FileSet::new();
    /// files.claim(&path)?;
    /// let error = Baker::default().with_files(&files).bake(&scan, Progress::SILENT).unwrap_err();
    /// assert!(error.to_string().contains("overwrite the input"));
    /// # Ok::<(), taotie::Error>(())
    /// ```
    pub fn with_files(self, files: &FileSet) -> Self {
        Self { files: Some(files.clone()), ..self }
    }

    /// Returns the bake options.
    pub fn options(&self) -> &BakeOptions {
        &self.options
    }

    /// Returns every file that an asset at `path` may be written to, the model first, to check before the bake that
    /// they are writable and that none of them is an input. Files named after the materials of a low-poly file are
    /// not included, since it has not been read yet.
    ///
    /// ```
    /// use std::path::{Path, PathBuf};
    /// use taotie::asset::{Baker, Packing};
    ///
    /// let files = Baker::default().may_write(Path::new("vase.gltf"), &Packing::default());
    /// assert!(["vase.gltf", "vase.bin", "vase_color.png"].iter().all(|name| files.contains(&PathBuf::from(name))));
    /// ```
    pub fn may_write(&self, path: &Path, packing: &Packing) -> Vec<PathBuf> {
        possible_files(path, &self.options, packing)
    }

    /// Returns the memory and time that a bake of a scan of this size needs.
    pub fn need(&self, scan: ScanSize) -> MemoryEstimate {
        MemoryEstimate::of(&self.options, scan)
    }

    /// Bakes a scan: simplifies and unwraps it, or takes the given mesh; bakes the maps; measures the result.
    ///
    /// The listener receives the stages `read the low-poly mesh`, `inspect the scan`, `measure the noise` and
    /// `remove the noise` if requested, `simplify` (after `sort the scan` and `remesh the scan` if that is requested),
    /// `sort the scan` if no earlier bake did so, `fit normals`, `unwrap`, `tangents`, `measure the gap`,
    /// `bake`, `store` and `levels of detail`, and is asked about every 20 ms whether to continue.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::Error::Cancelled); those of [`BakeOptions::check`] and of reading the files named
    /// in the options; [`Error::Limit`](crate::Error::Limit) if memory is insufficient;
    /// [`Error::Invalid`](crate::Error::Invalid) if simplification lost the scan's shape, no ray met the scan, or a
    /// search produced nothing at all. If a search finds no asset within the requirements, the result is the nearest
    /// one, with a warning.
    pub fn bake(&self, scan: impl Into<Scan>, progress: Progress<'_>) -> Result<Asset> {
        let (options, mut scan) = (Arc::clone(&self.options), scan.into());
        scan.limits.allow_outside |= self.limits.allow_outside;
        options.check()?;
        let limits = self.limits_beside(&scan);
        need_of(&options, &scan).check(limits)?;
        self.protect(scan.files())?;
        let (asked, high) = (Arc::clone(&options), scan.clone());
        let inputs = progress.apart(move |progress| Inputs::read(&asked, &high, progress))?;
        // On this thread: one that continues after cancellation would keep the set.
        self.protect(&inputs.files)?;
        progress.apart(move |progress| bake(&options, Sources { scan, inputs, limits }, progress))
    }

    /// Protects input files from being overwritten.
    fn protect(&self, read: &[PathBuf]) -> Result<()> {
        self.files.as_ref().map_or(Ok(()), |files| files.protect(read))
    }

    /// Returns the limits of a bake; memory held by the scan already counts as free.
    fn limits_beside(&self, scan: &Scan) -> Limits {
        let held = scan.held();
        let free = || taotie_io::free_memory().map(|free| Bytes(free + held));
        Limits { memory: self.limits.memory.or_else(free), ..self.limits }
    }
}

/// Low-poly meshes and their maps.
struct Lightened {
    parts: Vec<Part>,
    size: [u32; 2],
    trials: Vec<Trial>,
    /// The loss of the file's formats if a search chose it.
    rounding: Option<Rounding>,
    /// The packed scan, if that is the asset.
    packed: Option<PackedAsset>,
}

/// All inputs of a bake.
struct Sources {
    scan: Scan,
    inputs: Inputs,
    /// The limits of the bake itself.
    limits: Limits,
}

/// Returns the need of a bake for a scan that is already read and one mesh.
fn need_of(options: &BakeOptions, scan: &Scan) -> MemoryEstimate {
    let need = MemoryEstimate {
        is_sorted: scan.is_sorted(),
        ..MemoryEstimate::of(options, scan.about.size.joined())
    };
    if scan.device.is_some() { need.with_device() } else { need }
}

/// The surfaces that a bake starts from.
struct Subject<'a> {
    scan: &'a Scan,
    /// The given low-poly mesh; `None` if it is generated.
    given: Option<GivenMesh>,
}

fn bake(asked: &BakeOptions, sources: Sources, progress: Progress<'_>) -> Result<Asset> {
    let Sources { scan, inputs, limits } = sources;
    let Inputs { mut given, rays, files: low_files, warnings: of_inputs } = inputs;
    let (scan, about) = (&scan, Arc::clone(&scan.about));
    let mut warnings = about.warnings.clone();
    warnings.absorb(of_inputs);
    let materials = given.as_ref().map_or(1, |given| given.set_count(asked.udim));
    MemoryEstimate { materials, ..need_of(asked, scan) }.check(limits)?;
    let looks = given.as_ref().map_or_else(Vec::new, |given| given.looks(asked));
    if asked.size == BakeOptions::AUTO_SIZE {
        side_shortfall(about.size.detail_side).into_iter().for_each(|what| warnings.note(what, 1));
    }
    let asked = &asked.sized(about.size);
    let plan = BakePlan::of(asked, &about.carried, &looks);
    note_unread_options(&plan.options, &mut warnings);
    let lacks_colors = plan.options.bakes(&[MapKind::VertexColor]) && scan.mesh().colors().is_empty();
    warnings.note("the map of vertex colours is black: the scan has none", usize::from(lacks_colors));
    let materials = given.iter_mut().flat_map(GivenMesh::materials_mut);
    materials.for_each(|material| plan.fill(&about.carried, material));
    let mut document = given.as_mut().and_then(GivenMesh::take_document);
    let mut options = plan.options.clone();
    if let Some(what) = about.one_level.filter(|_| options.searches() && !options.lods.is_empty()) {
        warnings.note(format!("left out: the levels of detail: the scan has {what}"), 1);
        options.lods.clear();
    }
    let mut of_scan = Warnings::default();
    if options.inspect {
        // Before the scan is sorted for rays: doing both together would set the peak memory of a bake.
        progress.begin("inspect the scan")?;
        judgement::inspect(scan.mesh(), &mut of_scan);
    }
    let (scan, noise) = match options.noise {
        Some(handling) => scan.clone().settle_noise(handling, &mut warnings, progress)?,
        None => (scan.clone(), None),
    };
    let scan = &scan;
    let (subject, recipe) = (Subject { scan, given }, Recipe { options: &options, rays: &rays });
    let Lightened { mut parts, size, trials, rounding, packed } =
        lightened(recipe, subject, &mut warnings, progress)?;
    if packed.is_none() {
        for part in &mut parts {
            part.low.material.alpha = part.low.alpha(&options, scan);
        }
    }
    let coarser = {
        let Part { low, maps } = &parts[0];
        let finest = packed.as_ref().map_or(Finest::Made { low, maps, rounding }, Finest::Packed);
        let recipe = Recipe { options: &options, rays: &rays };
        let (coarser, of_levels) = make_levels(recipe, (scan, finest), progress)?;
        of_scan.absorb(of_levels);
        coarser
    };
    let (carried, left) = match packed {
        Some(asset) => {
            options.maps.clear();
            if scan.packed_file().is_some() {
                warnings = warnings_of_packed_scan(&warnings);
            }
            document = Some(Document::of_packed(asset.glb, limits));
            (about.carried.found.iter().map(|found| found.property).collect(), Vec::new())
        }
        None => {
            plan.note(&mut warnings);
            (plan.carried, plan.left)
        }
    };
    let alpha_modes = match options.bakes(&[MapKind::Alpha]) && has_several_modes(scan) {
        true if document.is_some() => {
            let is_blended = |part: &&Part| part.low.material.alpha == AlphaMode::Blend;
            note_blended(parts.iter().filter(is_blended).count(), &mut warnings);
            Vec::new()
        }
        true => alpha_modes(scan, &parts[0], &coarser),
        false => Vec::new(),
    };
    let of_tiles = match options.udim {
        true => Some(Mesh::joined(parts.iter().map(|part| &part.low.mesh))?),
        false => None,
    };
    let whole = document.as_ref().and_then(|document| document.whole.as_ref());
    let whole = of_tiles.as_ref().or(whole).unwrap_or(&parts[0].low.mesh);
    let origin = &parts[0].low.origin;
    if !origin.is_scan {
        parts.iter().for_each(|part| judge(scan, part, &mut warnings));
        judgement::note_missing_parts(scan, whole, origin.simplified.is_some(), &mut warnings);
    }
    warnings.absorb(of_scan);
    if rounding.is_some() && parts[0].maps.textures.normal.is_none() {
        options.maps.retain(|map| *map != MapKind::Normal);
    }
    let options = Arc::new(options);
    Ok(Asset::new(Made {
        options,
        about,
        low_files,
        document,
        of_tiles,
        parts,
        coarser,
        alpha_modes,
        size,
        trials,
        rounding,
        carried,
        left,
        noise,
        warnings,
    }))
}

/// Notes the problems of a part, with its label.
fn judge(scan: &Scan, part: &Part, warnings: &mut Warnings) {
    let mut own = Warnings::default();
    let Part { low, maps } = part;
    judgement::judge(Pair { scan, low }, &maps.cage, &maps.counts, &mut own);
    match low.label() {
        "" => warnings.absorb(own),
        label => own.iter().for_each(|(what, count)| warnings.note(format!("{label}: {what}"), count)),
    }
}

/// Returns true if the scan's triangles have several alpha modes.
fn has_several_modes(scan: &Scan) -> bool {
    scan.surface().alpha_modes().len() > 1
}

/// Returns the alpha mode of each triangle of each level of the only part.
fn alpha_modes(scan: &Scan, Part { low, maps }: &Part, coarser: &[Coarser]) -> Vec<Vec<AlphaMode>> {
    let of_level = |Coarser { mesh, look, .. }: &Coarser| match look {
        LevelLook::Own(own) => scan.sorted().alpha_modes(mesh, &own.maps.cage),
        _ => scan.sorted().alpha_modes(mesh, &maps.cage.carried_over(&low.mesh, mesh)),
    };
    let finest = scan.sorted().alpha_modes(&low.mesh, &maps.cage);
    std::iter::once(finest).chain(coarser.iter().map(of_level)).collect()
}

/// Returns the low-poly mesh with its maps, material by material; if an error bound is requested, the smallest that
/// meets it.
fn lightened(
    recipe: Recipe<'_>,
    Subject { scan, given }: Subject<'_>,
    warnings: &mut Warnings,
    progress: Progress<'_>,
) -> Result<Lightened> {
    let options = recipe.options;
    if options.searches() {
        let found = smallest(recipe, (scan, Level::FINEST), progress)?;
        warnings.absorb(found.warnings);
        return found_asset(scan, found.smallest, found.trials);
    }
    let lows = match given {
        Some(given) => {
            let taken = given.taken(options, warnings)?.into_iter();
            taken
                .map(|taken| LowPoly::given(taken, options, warnings, progress))
                .collect::<Result<Vec<_>>>()?
        }
        None => {
            if !options.remesh {
                progress.begin("simplify")?;
            }
            let base = low_poly::base(scan, options, warnings, progress)?;
            let simplified = low_poly::simplified(&base, (options.triangles, Relief::Map), progress)?;
            let Base { remesh, .. } = base;
            low_poly::note_simplified(&simplified, options.triangles, warnings);
            let simplified = low_poly::fitted(scan, simplified, progress)?;
            let from = MadeFrom { scan, remesh: remesh.as_ref() };
            let low = LowPoly::made(from, &simplified, options.size, progress)?;
            low_poly::note_opened(&low, warnings);
            judgement::refuse_astray(Pair { scan, low: &low })?;
            vec![low]
        }
    };
    let lows = share_cage(recipe.rays, scan, lows, progress)?;
    let sizes = set_sizes(options, &lows, warnings)?;
    let part = |(low, size): (LowPoly, [u32; 2])| -> Result<Part> {
        let baked = bake_maps(recipe, size, Pair { scan, low: &low }, progress);
        let maps =
            baked.map_err(|error| if low.label().is_empty() { error } else { error.within(low.label()) });
        Ok(Part { maps: maps?, low })
    };
    let size = sizes.iter().copied().max_by_key(|[width, height]| width * height).unwrap_or_default();
    let parts = lows.into_iter().zip(sizes).map(part).collect::<Result<Vec<_>>>()?;
    Ok(Lightened { parts, size, trials: Vec::new(), rounding: None, packed: None })
}

/// Gives each of several low-poly meshes its part of the cage of all of them.
fn share_cage(
    rays: &Rays,
    scan: &Scan,
    mut lows: Vec<LowPoly>,
    progress: Progress<'_>,
) -> Result<Vec<LowPoly>> {
    if lows.len() > 1 {
        scan.sort(progress)?;
        progress.begin("measure the gap")?;
        let cages = rays.cages(scan, &lows.iter().collect::<Vec<_>>())?;
        lows.iter_mut().zip(cages).for_each(|(low, cage)| low.cage = Some(cage));
    }
    Ok(lows)
}

/// Returns the result of a search.
fn found_asset(scan: &Scan, found: Smallest, trials: Vec<Trial>) -> Result<Lightened> {
    match found {
        Smallest::Made(made) => {
            let MadeAsset { low, maps, size, rounding } = *made;
            let parts = vec![Part { low, maps }];
            Ok(Lightened { parts, size: [size; 2], trials, rounding: Some(rounding), packed: None })
        }
        Smallest::Packed(asset) => {
            let scene = taotie_io::load_glb(asset.glb.clone(), &Limits::of_own_files())?.scene;
            let low = LowPoly::packed(bake::Scan::surface_of(scene)?.mesh().clone());
            let maps = StoredMaps::none(Pair { scan, low: &low });
            let parts = vec![Part { low, maps }];
            let rounding = Some(asset.rounding);
            Ok(Lightened { parts, size: [0; 2], trials, rounding, packed: Some(asset) })
        }
    }
}

/// Notes materials of a kept file that are blended as a whole because parts of the scan are.
fn note_blended(materials: usize, warnings: &mut Warnings) {
    warnings.note(
        "materials of the low-poly mesh blended as a whole because parts of the scan are: viewers may draw \
         their triangles in the wrong order",
        materials,
    );
}
