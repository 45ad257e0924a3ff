//! Candidates of a search, made as they would be written, read back and measured; and the best of them.

use super::goal::{Ceilings, Codecs, Goal, Level, Statistic};
use crate::asset::ask::{BakeOptions, Figure, Looking, Requirement};
use crate::asset::bake::{Recipe, Rounding, StoredMaps, Trial, bake_maps, chosen_side, refuse_astray};
use crate::asset::source::{Base, LowPoly, MadeFrom, Pair, Relief, Scan, low_poly};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use taotie_engine::bake::{self, MapKind, Simplified};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::length::Unit;
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::proof::{self, CloseUp, PatchQuantity, Picture, PixelDifferences, Properties, Side};
use taotie_io::{
    CodecSet, GltfAsset, GltfFormat, GltfSizes, GltfSource, ImageCodec, Limits, PackedGeometry, PackedImage,
    TextureCodecs, VertexBits,
};

/// The number of pixels at which a trial is measured if the object fills the picture of the finest level.
const PIXELS: usize = 20_000;

/// The number of pixels for trials whose ratio to a limit is near 1: the proof also uses more pixels until it is certain.
const FINE_PIXELS: usize = 60_000;
/// Ratios near 1: wider above, since they include the uncertainty of few pixels.
const NEAR_LIMIT: std::ops::Range<f64> = 0.96..1.1;

/// The mean angle lost by rounding normals to 8 bits, degrees; each additional bit halves it.
const ANGLE_OF_8_BITS: f64 = 0.26;

/// Returns the bits of vertices under a normal map, which compensates for the rounding of normals.
pub(super) fn under_map(size: u32) -> VertexBits {
    VertexBits { positions: 14, normals: 8, uvs: uv_bits(size) }
}

/// Returns the bits of uvs for textures with this side in texels: steps of at most a quarter of a texel.
pub(super) fn uv_bits(size: u32) -> u8 {
    const WITHIN_TEXEL: u32 = 2;
    (size.max(1).next_power_of_two().ilog2() + WITHIN_TEXEL).clamp(8, 16) as u8
}

/// Returns the mean angle lost by rounding normals to `bits` bits, degrees.
pub(super) fn angle_of(bits: u8) -> f64 {
    ANGLE_OF_8_BITS * f64::from(1u32 << 8) / f64::from(1u32 << bits)
}

/// The mesh and maps of a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Shape {
    pub triangles: u32,
    /// Texels along a side of its maps; 0 if it has none.
    pub size: u32,
    pub has_normal_map: bool,
}

/// A candidate that was made but not yet written.
pub(super) struct Draft {
    pub shape: Shape,
    pub low: LowPoly,
    pub maps: StoredMaps,
}

/// A candidate that was read back.
struct Read {
    triangles: usize,
    gpu_bytes: u64,
    surface: bake::Scan,
}

/// The differences of a candidate.
struct Differences {
    /// In ascending order.
    seen: PixelDifferences,
    /// The largest ratio to a limit of angles, of what is missing and of the distance.
    angle_ratio: f64,
    /// The largest ratio to a limit of colours; `None` if they are not compared.
    color_ratio: Option<f64>,
}

impl Differences {
    fn ratio(&self) -> f64 {
        self.angle_ratio.max(self.color_ratio.unwrap_or_default())
    }
}

/// A sorted scan.
#[derive(Clone, Copy)]
pub(super) struct Subject<'a> {
    pub scan: &'a Scan,
    /// The surface that meshes are made from.
    pub base: &'a Base<'a>,
    /// How it is sampled.
    pub side: &'a Side<'a>,
    pub level: Level,
}

/// Makes candidates of a scan and measures them.
pub(super) struct Workshop<'a> {
    recipe: Recipe<'a>,
    /// The same without a normal map.
    plain: BakeOptions,
    subject: Subject<'a>,
    /// `true` if colours are compared.
    has_material: bool,
    /// Simplified meshes, since several map sizes are tried on the same triangles.
    known: BTreeMap<(u32, Relief), Simplified>,
    pub goal: Goal,
    /// The maximum distance between the visible surfaces, in model units; infinite without a limit.
    farthest: f64,
    pub ceilings: Ceilings,
    codecs: Codecs,
    /// The formats of maps; that of normals is chosen for each candidate.
    pub images: TextureCodecs,
    pub trials: Vec<Trial>,
    /// The number of trials, for the progress of the search.
    pub tried: Arc<AtomicUsize>,
    /// Why candidates were refused: their mesh lost the scan's shape, or has more UV islands than fit on its maps.
    pub refused: BTreeMap<Shape, Error>,
    /// Contents of the scan's file that the packed scan lacks.
    pub packing_losses: Warnings,
    /// Why the scan itself is not a candidate.
    pub not_packed: Option<Error>,
}

impl Draft {
    /// Returns the bytes of the candidate as a GLB of one level of detail without metadata.
    fn encoded(&self, rounding: Rounding) -> Result<Vec<u8>> {
        self.encoded_as(&rounding.format())
    }

    fn encoded_as(&self, format: &GltfFormat) -> Result<Vec<u8>> {
        let material = self.maps.textures.material(&self.low.material, &self.low.kept);
        let levels = [&self.low.mesh];
        taotie_io::encode_glb(&GltfAsset { levels: &levels, material, ..GltfAsset::default() }, format)
    }

    /// Returns the number of bytes of only its mesh.
    pub fn mesh_bytes(&self, bits: VertexBits, codecs: CodecSet) -> Result<u64> {
        let format = Rounding { bits, codecs, ..Rounding::default() }.format();
        Ok(encoded_mesh(&self.low.mesh, &format)?.len() as u64)
    }
}

impl<'a> Workshop<'a> {
    /// Creates a workshop.
    pub fn new(recipe: Recipe<'a>, (goal, ceilings): (Goal, Ceilings), subject: Subject<'a>) -> Self {
        let codecs = Codecs::new(&recipe.options.images, recipe.options.codecs);
        let mut plain = recipe.options.clone();
        plain.maps.retain(|map| *map != MapKind::Normal);
        Self {
            recipe,
            plain,
            // Colours are not judged in an asset that should have none.
            has_material: !subject.scan.about.is_plain
                && (recipe.options.carry || recipe.options.bakes(&[MapKind::Albedo])),
            subject,
            known: BTreeMap::new(),
            goal,
            farthest: farthest(&recipe.options.limits(), subject),
            ceilings,
            images: codecs.least_lossy().into(),
            codecs,
            trials: Vec::new(),
            tried: Arc::default(),
            refused: BTreeMap::new(),
            packing_losses: Warnings::default(),
            not_packed: None,
        }
    }

    /// Returns the maximum number of triangles of a mesh: those that it is made from, or the ceiling.
    pub fn triangles(&self) -> u32 {
        let most = self.ceilings.most_triangles(self.has_other_maps());
        most.min(self.subject.base.mesh.triangles().len() as f64) as u32
    }

    /// Returns the maximum side of maps for a scan with textures, texels: a new atlas needs more than preserves its
    /// detail, but not many times more.
    pub fn most_side(&self) -> u32 {
        const MARGIN: u32 = 4;
        let ceiling =
            ((self.ceilings.most_texels(&self.codecs) / self.textures() as f64).sqrt() as u32 & !3).max(16);
        match self.has_other_maps() {
            true => ceiling.min(MARGIN * chosen_side(self.subject.scan.about.size.detail_side)),
            false => ceiling,
        }
    }

    /// Returns the maximum number of textures of a generated asset: roughness, metallic and occlusion share one.
    fn textures(&self) -> usize {
        let carried = self.subject.scan.about.carried.maps();
        let has = |map: MapKind| {
            self.recipe.options.maps.contains(&map) || (self.recipe.options.carry && carried.has(map))
        };
        let numbers = [MapKind::MetallicRoughness, MapKind::OcclusionMap].into_iter().any(has);
        let others = [MapKind::Albedo, MapKind::Emission].into_iter().filter(|map| has(*map)).count();
        1 + others + usize::from(numbers)
    }

    /// Returns the pixels of the scan at which textures are judged.
    pub fn picture(&self) -> Picture {
        self.subject.level.picture(PIXELS)
    }

    /// Returns the level of detail that candidates are for.
    pub fn level(&self) -> Level {
        self.subject.level
    }

    /// Returns `true` if the packed scan itself would contain everything requested: no map must be baked, it need not
    /// be watertight, and it is not a coarser level of a generated asset. Changed, it has no motion or variants.
    pub fn may_pack(&self) -> bool {
        let (options, scan) = (self.recipe.options, self.subject.scan);
        let about = &scan.about;
        let carried = about.carried.maps();
        let is_own = |map: &MapKind| *map == MapKind::Normal || carried.has(*map);
        let is_whole = !(scan.is_changed && about.is_rigged);
        is_whole
            && options.carry
            && !options.remesh
            && self.subject.level.is_finest()
            && options.maps.iter().all(is_own)
    }

    /// Returns `true` if the packed scan is likely to be the smallest, or is the only candidate that keeps the
    /// contents of the scan's file. A mesh with fitted normals is smaller than a scan without materials.
    pub fn packs_first(&self) -> bool {
        self.may_pack() && (self.has_material || self.subject.scan.about.is_rigged)
    }

    /// Returns `true` if a goal of differences was requested, not only ceilings.
    pub fn has_goal(&self) -> bool {
        let is_ceiling = |required: &Requirement| required.figure.looking() == Looking::Files;
        self.recipe.options.goal.as_ref().is_some_and(|goal| goal.is_empty() || !goal.iter().all(is_ceiling))
    }

    /// Returns `true` if there are maps other than the normal map.
    pub fn has_other_maps(&self) -> bool {
        !self.plain.maps.is_empty()
    }

    /// Returns the simplified mesh of a candidate.
    pub fn simplified(&mut self, shape: Shape, progress: Progress<'_>) -> Result<&Simplified> {
        let mesh = (shape.triangles, if shape.has_normal_map { Relief::Map } else { Relief::Vertices });
        if !self.known.contains_key(&mesh) {
            let own = low_poly::simplified(self.subject.base, mesh, progress)?;
            let fitted = low_poly::fitted(self.subject.scan, own.clone(), progress)?;
            let is_better = shape.has_normal_map || self.angle(&fitted)? <= self.angle(&own)?;
            self.known.insert(mesh, if is_better { fitted } else { own });
        }
        Ok(&self.known[&mesh])
    }

    /// Returns the mean visible angle of a mesh with only its vertex normals, degrees.
    fn angle(&self, Simplified { mesh, .. }: &Simplified) -> Result<f64> {
        let read = self.read_back(encoded_mesh(mesh, &GltfFormat::default())?)?;
        let asset = Side::of(&read.surface);
        let Differences { seen, .. } = self.seen(&self.pair(&asset));
        Ok(Statistic::Mean.of(&seen.angles).unwrap_or(f64::INFINITY))
    }

    /// Makes a candidate; `None` if it is refused.
    pub fn draft(&mut self, shape: Shape, progress: Progress<'_>) -> Result<Option<Draft>> {
        match self.made(shape, progress) {
            Ok(draft) => Ok(Some(draft)),
            Err(error @ (Error::Invalid { .. } | Error::Limit { .. })) => {
                self.refused.insert(shape, error);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    fn made(&mut self, shape: Shape, progress: Progress<'_>) -> Result<Draft> {
        let Shape { size, has_normal_map, .. } = shape;
        let scan = self.subject.scan;
        let from = MadeFrom { scan, remesh: self.subject.base.remesh.as_ref() };
        let simplified = self.simplified(shape, progress)?;
        let mut low = match size {
            0 => LowPoly::bare(from, simplified),
            _ => LowPoly::made(from, simplified, size, progress)?,
        };
        low.material.alpha = low.alpha(self.recipe.options, scan);
        let pair = Pair { scan, low: &low };
        refuse_astray(pair)?;
        let options = if has_normal_map { self.recipe.options } else { &self.plain };
        let maps = match size {
            0 => StoredMaps::none(pair),
            _ => bake_maps(Recipe { options, ..self.recipe }, [size; 2], pair, progress)?,
        };
        let low = if has_normal_map { low } else { low.without_tangents()? };
        Ok(Draft { shape, low, maps })
    }

    /// Writes a candidate, reads it back and measures it.
    pub fn trial(&mut self, draft: &Draft, rounding: Rounding) -> Result<Trial> {
        let has_maps = draft.shape.size > 0;
        let about = Trial {
            size: draft.shape.size,
            has_normal_map: draft.shape.has_normal_map && has_maps,
            normals: has_maps.then_some(rounding.images.normals),
            bits: rounding.bits,
            ..Trial::default()
        };
        self.measured(about, draft.encoded(rounding)?)
    }

    /// Reads a file back and measures it; `about` describes it.
    pub fn measured(&mut self, about: Trial, encoded: Vec<u8>) -> Result<Trial> {
        let bytes = encoded.len() as u64;
        let Read { triangles, gpu_bytes, surface } = self.read_back(encoded)?;
        let [mean, p95] = [Statistic::Mean, Statistic::Quantile(0.95)];
        let Differences { seen, angle_ratio, color_ratio } = self.differences(&surface);
        let mut trial = Trial {
            triangles,
            bytes,
            gpu_bytes,
            ceiling_ratio: self.ceilings.ratio(triangles, gpu_bytes),
            mean_angle: mean.of(&seen.angles).unwrap_or(f64::INFINITY),
            p95_angle: p95.of(&seen.angles).unwrap_or(f64::INFINITY),
            mean_color: mean.of(&seen.colors),
            p95_color: p95.of(&seen.colors),
            angle_ratio,
            color_ratio,
            ..about
        };
        trial.judge();
        self.trials.push(trial);
        self.tried.fetch_add(1, Ordering::Relaxed);
        Ok(trial)
    }

    /// Returns the loss of a candidate with this format of its normal map, and the chosen formats of other maps.
    pub fn rounding(&self, bits: VertexBits, normals: ImageCodec) -> Rounding {
        Rounding { bits, images: TextureCodecs { normals, ..self.images }, codecs: self.codecs.set }
    }

    /// Returns the available image formats.
    pub fn codecs(&self) -> &Codecs {
        &self.codecs
    }

    /// Returns the scan as sampled.
    pub fn side(&self) -> &'a Side<'a> {
        self.subject.side
    }

    /// Returns the surface of a lossless candidate.
    pub fn surface(&self, draft: &Draft) -> Result<bake::Scan> {
        let format = GltfFormat::default();
        Ok(self.read_back(draft.encoded_as(&format)?)?.surface)
    }

    /// Returns the scan.
    pub fn scan(&self) -> &'a Scan {
        self.subject.scan
    }

    fn read_back(&self, encoded: Vec<u8>) -> Result<Read> {
        let limits = Limits::of_own_files();
        let gpu_bytes = GltfSizes::read(GltfSource::Glb(&encoded), &limits)?.gpu_bytes;
        let scene = taotie_io::load_glb(encoded, &limits)?.scene;
        Ok(Read {
            triangles: scene.triangle_count(),
            gpu_bytes,
            surface: bake::Scan::of_asset(scene, self.subject.side.surface)?,
        })
    }

    /// Returns the largest ratio of the differences of a surface to their limits.
    pub fn ratio(&self, surface: &bake::Scan) -> f64 {
        self.differences(surface).ratio()
    }

    /// Compares a surface with the scan.
    fn differences(&self, surface: &bake::Scan) -> Differences {
        let asset = Side::of(surface);
        let pair = self.pair(&asset);
        let mut found = self.seen(&pair);
        // Coarser levels are never seen close up.
        if self.subject.level.is_finest() {
            self.see_patches(&pair, &mut found);
        }
        if found.ratio() <= 1.0 && self.farthest.is_finite() {
            found.angle_ratio = found.angle_ratio.max(self.distance_ratio(&pair));
        }
        found
    }

    fn pair<'p>(&self, asset: &'p Side<'p>) -> proof::Pair<'p>
    where
        'a: 'p,
    {
        let scan = self.subject.side;
        let diagonal = scan.surface.mesh().diagonal() as f32;
        let states = self.subject.scan.about.states_material;
        let properties = Properties::of([self.has_material, states], asset.surface);
        proof::Pair { scan, asset, diagonal, properties }
    }

    /// Compares random pixels: more of them if a ratio to a limit is near 1.
    fn seen(&self, pair: &proof::Pair<'_>) -> Differences {
        let of_pixels = |count: usize| {
            let seen = proof::pixel_differences(pair, self.subject.level.picture(count)).sorted();
            let (angle_ratio, color_ratio) = self.goal.ratios(&seen, [None; 4]);
            Differences { seen, angle_ratio, color_ratio }
        };
        let found = of_pixels(PIXELS);
        if NEAR_LIMIT.contains(&found.ratio()) { of_pixels(FINE_PIXELS) } else { found }
    }

    /// Replaces the worst pixels, which may be anywhere and show less detail than close-ups, by the worst patches of the
    /// proof, if all other limits are met.
    fn see_patches(&self, pair: &proof::Pair<'_>, found: &mut Differences) {
        let (angle, color) = self.goal.ratios(&found.seen, [Some(0.0); 4]);
        if angle.max(color.unwrap_or_default()) > 1.0 {
            return;
        }
        let limited = self.goal.limits_patches();
        // Without them, the worst pixels count.
        if limited.contains(&true)
            && let Ok(patches) = worst_patches(pair, limited)
        {
            (found.angle_ratio, found.color_ratio) = self.goal.ratios(&found.seen, patches);
        }
    }

    /// Returns the ratio of the largest distance between visible points of the surfaces to its limit; 0 if it is within.
    fn distance_ratio(&self, pair: &proof::Pair<'_>) -> f64 {
        /// The part of the limit that distances may reach: bounds are that wide.
        const PART: f64 = 0.95;
        let most = self.farthest * self.goal.shape * PART;
        proof::stray(pair, most as f32).map_or(0.0, |distance| f64::from(distance) / most)
    }
}

/// Returns the most that the figures of angles, colours, materials and detail in the worst patch of either surface are likely to be;
/// `None` for those not `wanted`, or without anything to compare.
fn worst_patches(pair: &proof::Pair<'_>, wanted: [bool; 4]) -> Result<[Option<f64>; 4]> {
    let close_ups = [CloseUp::of_scan(pair, PIXELS)?, CloseUp::of_asset(pair, PIXELS)?];
    let of = [PatchQuantity::Angle, PatchQuantity::Color, PatchQuantity::Material, PatchQuantity::Detail];
    let mut most = [None; 4];
    for i in (0..4).filter(|i| wanted[*i]) {
        for close_up in &close_ups {
            let patch = proof::worst_patch(pair, (close_up, PIXELS), of[i])?;
            most[i] = most[i].into_iter().chain(patch.map(|patch| patch.interval[1])).reduce(f64::max);
        }
    }
    Ok(most)
}

/// Returns the maximum distance from a scan in model units at a level of detail; infinite without a requirement.
fn farthest(required: &[Requirement], subject: Subject<'_>) -> f64 {
    let diagonal = subject.scan.sorted().mesh().diagonal();
    // Levels for small objects are never seen close up.
    let of_all = if subject.level.is_finest() { None } else { Some(subject.level.number) };
    let is_of_level = |one: &&Requirement| one.level == of_all || one.level == Some(subject.level.number);
    let those = required.iter().filter(|one| one.figure == Figure::Hausdorff).filter(is_of_level);
    let limits = those.map(|one| match (one.is_length, subject.scan.unit()) {
        (false, _) => one.most * diagonal,
        (true, unit) => one.most / unit.map_or(1.0, Unit::metres),
    });
    limits.fold(f64::INFINITY, f64::min)
}

/// Returns the bytes of a mesh without material as a GLB.
pub(super) fn encoded_mesh(mesh: &Mesh, format: &GltfFormat) -> Result<Vec<u8>> {
    let levels = [mesh];
    taotie_io::encode_glb(&GltfAsset { levels: &levels, ..GltfAsset::default() }, format)
}

/// The ratio of a candidate's angles to their limits from which it is close enough to the goal from below.
const CLOSE: f64 = 0.97;

/// The target ratio of angles, in the middle of those that hit the goal.
pub(super) const AIM: f64 = 0.5 * (1.0 + CLOSE);

/// Returns `true` if a trial reaches the goal and another one would hardly be smaller.
pub(super) fn is_hit(trial: &Trial) -> bool {
    trial.is_near && trial.angle_ratio >= CLOSE
}

/// A candidate and its measurements.
pub(super) struct Winner {
    pub candidate: Candidate,
    pub trial: Trial,
}

/// The contents of the asset.
pub(super) enum Candidate {
    /// A mesh and maps generated from the scan.
    Made(Box<Draft>, Rounding),
    /// The packed scan.
    Packed {
        glb: Vec<u8>,
        geometry: PackedGeometry,
        /// Those that were re-encoded.
        images: Vec<PackedImage>,
    },
}

/// The smallest candidate that reaches the goal; until there is one, the nearest one, within the ceilings if
/// possible.
#[derive(Default)]
pub(super) struct Best {
    so_far: Option<Winner>,
    /// The smallest ratio of any candidate within the ceilings.
    least_ratio: Option<f64>,
}

/// Ratios up to this factor above the smallest one count as equal; then bytes decide.
const EQUAL: f64 = 1.05;

impl Best {
    /// Replaces the best candidate if this one is better.
    pub fn offer(&mut self, candidate: Candidate, trial: Trial) {
        let known = self.least_ratio.unwrap_or(f64::INFINITY);
        let least_ratio = if trial.is_within() { known.min(trial.ratio()) } else { known };
        self.least_ratio = Some(least_ratio);
        let is_better = |than: &Trial| match (trial.is_near, than.is_near) {
            (true, true) => trial.bytes < than.bytes,
            (false, false) => match (trial.is_within(), than.is_within()) {
                (true, true) => {
                    let is_equal = |ratio: f64| ratio.is_finite() && ratio <= EQUAL * least_ratio;
                    match (is_equal(trial.ratio()), is_equal(than.ratio())) {
                        (true, true) => trial.bytes < than.bytes,
                        (false, false) => trial.ratio() < than.ratio(),
                        (is_equal, _) => is_equal,
                    }
                }
                (false, false) => trial.ceiling_ratio < than.ceiling_ratio,
                (is_within, _) => is_within,
            },
            (is_near, _) => is_near,
        };
        if self.so_far.as_ref().is_none_or(|winner| is_better(&winner.trial)) {
            self.so_far = Some(Winner { candidate, trial });
        }
    }

    /// Returns `true` if the best candidate is within all ceilings.
    pub fn is_within(&self) -> bool {
        self.so_far.as_ref().is_some_and(|winner| winner.trial.is_within())
    }

    /// Returns the fewest bytes with which the goal is reached; infinite if it has not been reached.
    pub fn bytes(&self) -> f64 {
        self.near().map_or(f64::INFINITY, |winner| winner.trial.bytes as f64)
    }

    /// Applies [`Trial::scale`].
    pub fn scale(&mut self, factor: f64) {
        self.least_ratio = self.least_ratio.map(|ratio| ratio * factor);
        if let Some(winner) = &mut self.so_far {
            winner.trial.scale(factor);
        }
    }

    /// Returns the bytes of the best candidate; infinite if there is none.
    pub fn least_bytes(&self) -> f64 {
        self.so_far.as_ref().map_or(f64::INFINITY, |winner| winner.trial.bytes as f64)
    }

    /// Returns `true` if most of its bytes are textures of the scan: candidates made from the scan need them too, and
    /// have more vertices at their own UV islands.
    pub fn is_mostly_textures(&self) -> bool {
        self.near().is_some_and(|winner| match &winner.candidate {
            Candidate::Packed { images, .. } => {
                let of_images: usize = images.iter().map(|image| image.bytes.len()).sum();
                2 * of_images as u64 > winner.trial.bytes
            }
            Candidate::Made(..) => false,
        })
    }

    /// Returns the best candidate.
    pub fn into_winner(self) -> Option<Winner> {
        self.so_far
    }

    fn near(&self) -> Option<&Winner> {
        self.so_far.as_ref().filter(|winner| winner.trial.is_near)
    }
}

impl Candidate {
    /// Returns a candidate generated from the scan.
    pub fn made(draft: Draft, rounding: Rounding) -> Self {
        Self::Made(Box::new(draft), rounding)
    }
}
