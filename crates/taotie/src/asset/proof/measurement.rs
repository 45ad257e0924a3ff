//! The measurement of levels of detail, on the surface and as a viewer sees them, at as many points as it takes to
//! decide the requirements.

use super::figures::{
    AskedLimits, Beyond, Coverage, Figures, FitFigures, LevelFigures, PartFigures, Resolution, WorstParts,
    WorstPatches,
};
use super::findings;
use super::outcome::{RequirementOutcome, asked_limits};
use super::shown::{Measured, ShownLevel, measured};
use crate::asset::ask::{Lod, Requirement, Sampling};
use crate::asset::bake::judgement;
use crate::asset::source::Scan;
use std::path::Path;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::length::Unit;
use taotie_engine::progress::Progress;
use taotie_engine::proof::{
    CloseUp, DistanceBounds, Overview, Pair, Patch, PatchQuantity, Picture, Side, SilhouetteFigures,
    hausdorff, most_missing, overview, root_mean_square, share_interval, silhouettes, worst_patch,
};
use taotie_engine::scene::Scene;

/// The options of a proof. Built by `Default` and struct update.
///
/// ```
/// use taotie::asset::{Proof, Requirement, Scan, VerifyOptions, WrittenAsset};
/// use taotie::{Progress, Result};
///
/// /// Measures at as many points as needed to decide whether the mean angle is at most 1°.
/// fn verify_to_one_degree(written: &WrittenAsset, scan: Scan) -> Result<Proof> {
///     let requirements = vec![Requirement::mean_angle_deg(1.0)];
///     written.verify(scan, &VerifyOptions { requirements, ..VerifyOptions::default() }, Progress::SILENT)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct VerifyOptions {
    /// Pixels of the overview, and points of each surface, at which scan and asset are initially compared, at least
    /// 10. If a requirement's limit lies within the interval of the result, more are used, up to 4 million.
    pub points: usize,
    /// The maximum number of texels along a side of the error maps; no more than the maps have, and 0 makes none. No
    /// figure depends on it.
    pub map: u32,
    /// Pixels along a side of the images from all sides, at least 11.
    pub view: u32,
    /// Pixels along a side of the pictures of the worst patches; 0 takes none. No figure depends on it.
    pub patch_view: u32,
    /// The requirements that the figures must decide.
    #[serde(skip)]
    pub requirements: Vec<Requirement>,
}

impl Default for VerifyOptions {
    /// 20,000 points, a map of 1024² and images of 384², no pictures of patches, no requirements.
    fn default() -> Self {
        Self { points: 20_000, map: 1024, view: 384, patch_view: 0, requirements: Vec::new() }
    }
}

/// Refuses out-of-range options.
pub(super) fn check_options(options: &VerifyOptions) -> Result<()> {
    let wrong = |what: &str, why: &str| Err(Error::invalid(what, why));
    match options {
        VerifyOptions { points: 0..10, .. } => wrong("points of the proof", "use at least 10"),
        VerifyOptions { view: 0..11, .. } => wrong("pictures from all sides", "use at least 11 pixels"),
        VerifyOptions { patch_view: 4097.., .. } => {
            wrong("pictures of the worst patches", "use at most 4096 pixels")
        }
        _ => Ok(()),
    }
}

/// Measures a loaded model against its scan: returns the figures that [`verify`](crate::asset::verify) finds for the
/// same model, except those of images and files, and the warnings. `options.map` and the sizes of pictures are
/// ignored.
///
/// ```no_run
/// use taotie::Progress;
/// use taotie::asset::{Scan, VerifyOptions, measure};
/// use taotie::Limits;
///
/// let scan = Scan::read("scan.ply", &Limits::default(), Progress::SILENT)?;
/// let model = taotie::load_model("packed.glb")?.scene;
/// let (figures, _) = measure(&model, &scan, &VerifyOptions::default(), Progress::SILENT)?;
/// println!("{:?}", figures.finest().map(|finest| finest.hausdorff));
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if the meshes do not overlap, or an option is out of range;
/// [`Error::Cancelled`].
pub fn measure(
    model: &Scene,
    scan: &Scan,
    options: &VerifyOptions,
    progress: Progress<'_>,
) -> Result<(Figures, Warnings)> {
    check_options(options)?;
    scan.sort(progress)?;
    progress.begin("measure normals")?;
    let level = |scene: &Scene| ShownLevel::of(scene, scan, (Path::new("the model"), true));
    let finest = level(model)?;
    let mut warnings = Warnings::default();
    let fit = finest.whole().fit((options.points / 2).max(1), scan.mesh().diagonal());
    if let Some(fit) = fit {
        let cause = || findings::mismatch(&finest, (Some(fit.into()), false), scan.unit());
        judgement::refuse_misfit(&fit, cause, &mut warnings)?;
    }
    let (mut figures, parts) =
        Measurement { scan, unit: scan.unit(), options, across: &[] }.all(&finest, &[], &level, progress)?;
    figures.parts = parts;
    findings::note_whole(&figures, &finest, &mut warnings);
    findings::note(&figures, &[], &mut warnings);
    Ok((figures, warnings))
}

/// Measures levels of detail until all requirements are decided.
pub(super) struct Measurement<'a> {
    pub scan: &'a Scan,
    pub unit: Option<Unit>,
    pub options: &'a VerifyOptions,
    /// The pixels across the object at which each level is first shown; `None` for the finest, and for files that do
    /// not state it.
    pub across: &'a [Option<f32>],
}

impl<'a> Measurement<'a> {
    /// Returns the figures of all levels, the coarser ones initially at a quarter of the points, and those of the
    /// finest level's materials.
    pub fn all(
        &self,
        finest: &ShownLevel<'a>,
        coarser: &[Scene],
        level: &dyn Fn(&Scene) -> Result<ShownLevel<'a>>,
        progress: Progress<'_>,
    ) -> Result<(Figures, Vec<PartFigures>)> {
        let Self { scan, unit, options, .. } = *self;
        let side = Side::of(scan.sorted());
        let diagonal = scan.mesh().diagonal();
        let fit = finest.whole().fit((options.points / 2).max(1), diagonal).map(FitFigures::from);
        let mut figures = Figures { unit, diagonal, fit, ..Figures::default() };
        let found = self.add_level(&mut figures, (finest, &side), progress)?;
        if !coarser.is_empty() {
            progress.begin("measure levels")?;
        }
        for scene in coarser {
            self.add_level(&mut figures, (&level(scene)?, &side), progress)?;
        }
        Ok((figures, part_figures(finest, &found)))
    }

    /// Adds the figures of the next level, and returns the measurements on the surfaces of its materials.
    fn add_level(
        &self,
        figures: &mut Figures,
        (level, scan): (&ShownLevel<'_>, &Side<'a>),
        progress: Progress<'_>,
    ) -> Result<Vec<Measured>> {
        let number = figures.levels.len();
        let mut counts = Counts::of(self.options.points, number == 0);
        let found = measured(&level.part_surfaces(), counts.surface)?;
        let on_surface = LevelFigures::on_surface(&found, level.surface.mesh().triangles().len())?;
        let asset = Side::of(&level.surface);
        let diagonal = self.scan.mesh().diagonal() as f32;
        let pair = Pair { scan, asset: &asset, diagonal, properties: level.properties() };
        let asked = asked_limits(&self.options.requirements);
        let across = self.across.get(number).copied().flatten().unwrap_or(Lod::FINEST as f32);
        let mut seen = Seen::of(&pair, (across, counts))?;
        loop {
            figures.levels.push(on_surface.clone().with_seen(&pair, &seen, &asked)?);
            let met = figures.evaluate(&self.options.requirements);
            counts = counts.to_decide(met.iter().filter(|met| met.level == Some(number)));
            if counts == seen.counts() {
                return Ok(found);
            }
            figures.levels.pop();
            progress.begin("measure more points")?;
            seen.refine(&pair, counts)?;
        }
    }
}

/// Returns the figures of each material, if there are several.
fn part_figures(level: &ShownLevel<'_>, found: &[Measured]) -> Vec<PartFigures> {
    let parts = level.parts.iter().zip(found).filter(|(part, _)| !part.label.is_empty());
    parts
        .map(|(part, found)| PartFigures::of(&part.label, part.shown.mesh().triangles().len(), found))
        .collect()
}

/// The maximum number of points when samples are added to decide a requirement.
const MOST_POINTS: usize = 4_000_000;
/// The number of points of each surface from which the worst patch is selected. It does not grow with the others, so
/// that more points measure the same patch.
const SOUGHT: usize = 20_000;
/// The safety factor on the points expected to decide a requirement, since estimates of intervals vary.
const MARGIN: f64 = 1.5;

/// A level of detail as a viewer sees it.
struct Seen {
    counts: Counts,
    pub overview: Overview,
    pub silhouette: SilhouetteFigures,
    /// Of the scan and the asset.
    pub close_ups: [CloseUp; 2],
    /// The same at the points from which the worst patches are selected; `None` if they are those of `close_ups`.
    sought: Option<[CloseUp; 2]>,
    pub hausdorff: DistanceBounds,
}

/// The numbers of points at which the figures of a level are sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Counts {
    /// On the surface.
    pub surface: usize,
    /// Pixels of the overview.
    overview: usize,
    /// Of each surface, from which the worst patch is selected.
    sought: usize,
    /// Of each surface, seen close up.
    close_up: usize,
    /// Controls the bounds of distances, which tighten in proportion.
    distance: usize,
}

impl Seen {
    /// Samples a level whose overview has `across` pixels across.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if a surface has no area.
    pub fn of(pair: &Pair<'_>, (across, counts): (f32, Counts)) -> Result<Self> {
        let close_ups = close_ups(pair, counts.close_up)?;
        Ok(Self {
            counts,
            sought: sought(pair, counts)?,
            overview: overview(pair, Picture::of(across, counts.overview))?,
            silhouette: silhouettes(pair),
            hausdorff: hausdorff(pair, [&close_ups[0], &close_ups[1]], counts.distance),
            close_ups,
        })
    }

    /// Returns the worse of the worst windows of scan and asset.
    ///
    /// # Errors
    /// Those of [`worst_patch`].
    pub fn worse_patch(&self, pair: &Pair<'_>, of: PatchQuantity) -> Result<Option<Patch>> {
        let worst = |close_up| worst_patch(pair, (close_up, self.counts.close_up), of);
        let [of_scan, of_asset] = self.sought.as_ref().unwrap_or(&self.close_ups);
        Ok(Patch::worse([worst(of_scan)?, worst(of_asset)?]))
    }

    /// Returns the numbers of sampled points.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Measures the figures whose number of points has changed again.
    ///
    /// # Errors
    /// Those of [`Seen::of`].
    pub fn refine(&mut self, pair: &Pair<'_>, counts: Counts) -> Result<()> {
        let before = std::mem::replace(&mut self.counts, counts);
        if counts.overview != before.overview {
            self.overview = overview(pair, Picture::of(self.overview.across, counts.overview))?;
        }
        if counts.close_up != before.close_up {
            let few = std::mem::replace(&mut self.close_ups, close_ups(pair, counts.close_up)?);
            self.sought.get_or_insert(few);
        }
        if counts.distance != before.distance {
            let [of_scan, of_asset] = &self.close_ups;
            self.hausdorff = hausdorff(pair, [of_scan, of_asset], counts.distance);
        }
        Ok(())
    }
}

fn close_ups(pair: &Pair<'_>, points: usize) -> Result<[CloseUp; 2]> {
    Ok([CloseUp::of_scan(pair, points)?, CloseUp::of_asset(pair, points)?])
}

fn sought(pair: &Pair<'_>, counts: Counts) -> Result<Option<[CloseUp; 2]>> {
    (counts.sought != counts.close_up).then(|| close_ups(pair, counts.sought)).transpose()
}

impl Counts {
    /// The same number for all figures of the finest level; a quarter for a coarser one.
    pub fn of(points: usize, is_finest: bool) -> Self {
        let part = |points: usize| if is_finest { points } else { (points / 4).max(10) };
        let all = part(points);
        Self { surface: all, overview: all, sought: part(SOUGHT), close_up: all, distance: all }
    }

    /// Returns the numbers that are likely to decide the undecided requirements.
    pub fn to_decide<'m>(self, met: impl Iterator<Item = &'m RequirementOutcome>) -> Self {
        let mut next = self;
        for met in met {
            let times = met.samples_to_decide();
            let (now, next) = match met.figure.sampling() {
                Some(Sampling::Overview) => (self.overview, &mut next.overview),
                Some(Sampling::CloseUp) => (self.close_up, &mut next.close_up),
                Some(Sampling::Distance) => (self.distance, &mut next.distance),
                None => continue,
            };
            *next = (*next).max(enough(now, times));
        }
        next
    }
}

/// Returns enough points to decide a requirement that needs `times` as many; the same number if even the maximum
/// would not decide it.
fn enough(points: usize, times: f64) -> usize {
    let (now, most) = (points as f64, MOST_POINTS as f64);
    if times <= 1.0 || now >= most || now * times > most * 4.0 {
        return points;
    }
    (now * times * MARGIN).min(most) as usize
}

impl LevelFigures {
    /// Adds what a viewer sees of the level.
    ///
    /// # Errors
    /// [`taotie_engine::Error::Invalid`] if a surface has no area.
    fn with_seen(self, pair: &Pair<'_>, seen: &Seen, asked: &AskedLimits) -> Result<Self> {
        let [of_scan, of_asset] = &seen.close_ups;
        let (rms, diagonal) = (root_mean_square([of_scan, of_asset]), f64::from(pair.diagonal));
        Ok(Self {
            overview: seen.overview.clone(),
            patches: WorstPatches {
                angle: seen.worse_patch(pair, PatchQuantity::Angle)?,
                color: seen.worse_patch(pair, PatchQuantity::Color)?,
                material: seen.worse_patch(pair, PatchQuantity::Material)?,
                detail: seen.worse_patch(pair, PatchQuantity::Detail)?,
            },
            worst_parts: WorstParts::of(pair, of_asset)?,
            beyond: Beyond::of([of_scan, of_asset], pair.diagonal, asked),
            silhouette: seen.silhouette,
            coverage: coverage(pair, [of_scan, of_asset]),
            hausdorff: seen.hausdorff,
            hausdorff_of_diagonal: seen.hausdorff.scaled(1.0 / diagonal),
            rms,
            rms_of_diagonal: rms / diagonal,
            resolution: resolution(of_scan, of_asset),
            ..self
        })
    }
}

/// The distance, as a fraction of the diagonal, within which the asset counts as complete.
const COMPLETE: f32 = 0.005;
fn coverage(pair: &Pair<'_>, [of_scan, of_asset]: [&CloseUp; 2]) -> Coverage {
    let worse = if of_asset.missing() > of_scan.missing() { of_asset } else { of_scan };
    let [a, b] = [of_scan, of_asset].map(|own| share_interval(own.missing(), own.samples.len()));
    let near = of_scan.samples.iter().filter(|sample| sample.distance <= pair.diagonal * COMPLETE).count();
    Coverage {
        missed_of_scan: of_scan.missing(),
        missed_of_asset: of_asset.missing(),
        missed_interval: [a[0].max(b[0]), a[1].max(b[1])],
        missed_at: most_missing(worse),
        completeness: near as f64 / of_scan.samples.len().max(1) as f64,
        hidden_of_scan: of_scan.hidden,
        is_interior: pair.scan.visibility.is_interior(),
    }
}

/// Returns how coarse the asset's texels are; `None` if it has none.
fn resolution(of_scan: &CloseUp, of_asset: &CloseUp) -> Option<Resolution> {
    /// The factor above which texels lose detail.
    const TWICE: f32 = 2.0;
    let numbers = |values: Vec<f32>| {
        let mut values: Vec<f32> = values.into_iter().filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f32::total_cmp);
        values
    };
    let texels = numbers(of_asset.samples.iter().map(|sample| sample.texel).collect());
    let texel = f64::from(*texels.get(texels.len() / 2)?);
    let coarser = numbers(of_scan.samples.iter().map(|sample| sample.coarser).collect());
    let lossy = &coarser[coarser.partition_point(|v| *v <= TWICE)..];
    let share = lossy.len() as f64 / coarser.len().max(1) as f64;
    let p95 = lossy.get(lossy.len() * 95 / 100).map_or(1.0, |v| f64::from(*v));
    Some(Resolution { texel, coarser: p95, share })
}
