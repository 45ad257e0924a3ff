//! From a scan to an asset.

use super::given::GivenMesh;
use super::judgement::{self, Pair};
use super::low::{self, LowPoly};
use super::made::{Asset, Made};
use super::maps::{StoredMaps, bake_maps};
use super::memory::Need;
use super::notes;
use super::options::BakeOptions;
use super::packing::Packing;
use super::plan::BakePlan;
use super::scan::Scan;
use super::scan_size::ScanSize;
use super::search::smallest;
use super::search_course::Trial;
use super::write::possible_files;
use crate::bake::{Cage, MapKind};
use crate::error::{Result, Warnings};
use crate::io::{self, Bytes, Limits};
use crate::mesh::Mesh;
use crate::progress::Progress;
use crate::scene::AlphaMode;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Bakes scans, all in the same way.
///
/// ```
/// use std::sync::Arc;
/// use taotie::Progress;
/// use taotie::asset::{BakeOptions, Baker, MeshSource, Scan};
/// use taotie::mesh::Mesh;
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
}

impl Baker {
    /// Bakes as `options` say, with the memory that the machine has free.
    pub fn new(options: BakeOptions) -> Self {
        Self { options: Arc::new(options), limits: Limits::default() }
    }

    /// Bakes within these limits.
    pub fn with_limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    /// Returns what is baked, and how.
    pub fn options(&self) -> &BakeOptions {
        &self.options
    }

    /// Returns every file that an asset at `path` may be written to, the model first, so that one can ask before the bake
    /// whether they can be written, and whether any of them is one that was read.
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

    /// Returns what a bake of a scan of this size takes.
    pub fn need(&self, scan: ScanSize) -> Need {
        Need::of(&self.options, scan)
    }

    /// Bakes a scan: simplifies and unwraps it, or takes the mesh that is given; bakes the maps; measures the result.
    ///
    /// The listener hears the stages `simplify`, `unwrap`, `read the low-poly mesh`, `tangents`, `measure the gap`,
    /// `bake`,
    /// `store`, `levels of detail` and `inspect the scan`, and is asked about every 20 ms whether to go on.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::Error::Cancelled); those of [`BakeOptions::check`] and of reading what the options
    /// name; [`Error::Limit`](crate::Error::Limit) where the memory does not suffice;
    /// [`Error::Invalid`](crate::Error::Invalid) where no ray met the scan, or no mesh and map come as near as is
    /// wanted.
    pub fn bake(&self, scan: impl Into<Scan>, progress: Progress<'_>) -> Result<Asset> {
        let (options, mut scan) = (Arc::clone(&self.options), scan.into());
        scan.limits.allow_outside |= self.limits.allow_outside;
        options.check()?;
        self.need(scan.about.size.sorted()).check(self.limits_beside(&scan))?;
        progress.apart(move |progress| bake(&options, &scan, progress))
    }

    /// Returns the limits of a bake; what the scan holds already counts as free.
    fn limits_beside(&self, scan: &Scan) -> Limits {
        let held = scan.about.size.bytes();
        let free = || io::free_memory().map(|free| Bytes(free + held));
        Limits { memory: self.limits.memory.or_else(free), ..self.limits }
    }
}

/// A low-poly mesh and its maps.
struct Lightened {
    low: LowPoly,
    maps: StoredMaps,
    size: [u32; 2],
    trials: Vec<Trial>,
}

/// The surfaces that a bake begins with.
struct Subject<'a> {
    scan: &'a Scan,
    /// The low-poly mesh that is given; `None` where it is to be made.
    given: Option<GivenMesh>,
}

fn bake(asked: &BakeOptions, scan: &Scan, progress: Progress<'_>) -> Result<Asset> {
    let about = Arc::clone(&scan.about);
    let mut warnings = about.warnings.clone();
    let mut given = given(asked, &scan.limits, &mut warnings, progress)?;
    let plan = BakePlan::of(asked, &about.carried, given.as_ref().map(GivenMesh::look));
    notes::unread_options(&plan.options, &mut warnings);
    plan.note(&mut warnings);
    if let Some(given) = &mut given {
        plan.fill(&about.carried, &mut given.material);
    }
    let BakePlan { options, carried, left, .. } = plan;
    let subject = Subject { scan, given };
    let Lightened { mut low, mut maps, size, trials } =
        lightened(&options, subject, &mut warnings, progress)?;
    low.material.alpha = alpha(&options, scan, &low);
    warnings.absorb(std::mem::take(&mut maps.warnings));
    let coarser = low::coarser(&low, &options.lods, &mut warnings, progress)?;
    let pair = Pair { scan, low: &low };
    let alpha_modes = match options.bakes(&[MapKind::Alpha]) {
        true => alpha_modes(pair, &maps.cage, &coarser),
        false => Vec::new(),
    };
    judgement::judge(pair, &maps.cage, &maps.counts, &mut warnings);
    if options.inspect {
        progress.begin("inspect the scan")?;
        judgement::inspect(scan.mesh(), &mut warnings);
    }
    let options = Arc::new(options);
    Ok(Asset::new(Made {
        options,
        about,
        low,
        coarser,
        alpha_modes,
        maps,
        size,
        trials,
        carried,
        left,
        warnings,
    }))
}

/// Reads the low-poly mesh that the options name.
fn given(
    options: &BakeOptions,
    limits: &Limits,
    warnings: &mut Warnings,
    progress: Progress<'_>,
) -> Result<Option<GivenMesh>> {
    let Some(source) = &options.low else { return Ok(None) };
    let reading = progress.begin("read the low-poly mesh")?;
    let given = GivenMesh::read(source, limits, warnings)?;
    reading.at(1.0)?;
    Ok(Some(given))
}

/// Returns the treatment of alpha: that of the scan where its alpha is baked, else the low-poly mesh's own.
fn alpha(options: &BakeOptions, scan: &Scan, low: &LowPoly) -> AlphaMode {
    match scan.high.surface().alpha_mode() {
        mode if options.bakes(&[MapKind::Alpha]) && mode != AlphaMode::Opaque => mode,
        _ => low.material.alpha,
    }
}

/// Returns the alpha mode of each triangle of each level, where the scan has several modes.
fn alpha_modes(pair: Pair<'_>, cage: &Cage, coarser: &[Mesh]) -> Vec<Vec<AlphaMode>> {
    let Pair { scan, low } = pair;
    if scan.high.surface().alpha_modes().len() < 2 {
        return Vec::new();
    }
    let of_level = |mesh: &Mesh| scan.high.alpha_modes(mesh, &cage.carried_over(&low.mesh, mesh));
    std::iter::once(scan.high.alpha_modes(&low.mesh, cage)).chain(coarser.iter().map(of_level)).collect()
}

/// Returns the low-poly mesh with its maps; where an error is wanted the smallest that meets it.
fn lightened(
    options: &BakeOptions,
    Subject { scan, given }: Subject<'_>,
    warnings: &mut Warnings,
    progress: Progress<'_>,
) -> Result<Lightened> {
    if let Some(most) = options.mean_error_deg {
        let found = smallest(options, scan, most, progress)?;
        warnings.absorb(found.warnings);
        let size = [found.size; 2];
        return Ok(Lightened { low: found.low, maps: found.maps, size, trials: found.trials });
    }
    let low = match given {
        Some(given) => LowPoly::given(given, options, warnings, progress)?,
        None => {
            let simplified = low::simplified(scan, options.triangles, progress)?;
            low::note_simplified(&simplified, options.triangles, warnings);
            LowPoly::made(scan, &simplified, options.size, progress)?
        }
    };
    let size = options.map_size();
    let maps = bake_maps(options, size, Pair { scan, low: &low }, progress)?;
    Ok(Lightened { low, maps, size, trials: Vec::new() })
}
