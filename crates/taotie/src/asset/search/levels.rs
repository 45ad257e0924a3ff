//! Coarser levels of detail: each simplified, rebaked or made from scratch, and as light as possible within the
//! limits of the finest while the object is small on the screen.

use super::goal::{Ceilings, Goal, Level};
use super::packed::packer;
use super::smallest::{PackedAsset, Smallest, smallest};
use super::workshop::{Shape, Subject, Workshop, encoded_mesh};
use crate::asset::ask::{BakeOptions, Figure, Lod, Requirement};
use crate::asset::bake::{Coarser, LevelLook, MadeAsset, Recipe, Rounding, StoredMaps, Trial, bake_maps};
use crate::asset::source::{
    Base, KeptTextures, LowPoly, Pair, RayLength, Rays, Scan, assign_object_map, low_poly,
};
use std::sync::Arc;
use taotie_engine::bake::{self, MapKind};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Encoding, Texture};
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::proof::Side;
use taotie_engine::scene::{NormalSpace, Scene};
use taotie_engine::surface::with_frames;
use taotie_io::{GltfAsset, GltfFormat, GltfPacker, Limits, PackedGeometry, VertexBits};

/// The source of coarser levels.
pub(in crate::asset) enum Finest<'a> {
    /// A mesh and its maps, as stored, with the loss of the file's formats if a search chose it.
    Made { low: &'a LowPoly, maps: &'a StoredMaps, rounding: Option<Rounding> },
    /// The scan, packed.
    Packed(&'a PackedAsset),
}

/// The maximum ratio of a level's triangles to those of the one before, for levels by pixels.
const LIGHTER: f64 = 0.8;
/// The factor by which a level that is good at as many pixels as the one before takes over later.
const LATER: f64 = std::f64::consts::SQRT_2;
/// The factor up to which a count is accepted as the requested one.
const NEAR_COUNT: f64 = 1.02;

/// Makes the requested coarser levels. One that cannot be made, or is hardly lighter than the one before, is omitted
/// with one of the returned warnings.
///
/// # Errors
/// [`Error::Cancelled`]; those of reading candidates.
pub(in crate::asset) fn make_levels(
    recipe: Recipe<'_>,
    (scan, finest): (&Scan, Finest<'_>),
    progress: Progress<'_>,
) -> Result<(Vec<Coarser>, Warnings)> {
    let (mut found, mut warnings) = (Vec::new(), Warnings::default());
    let lods = &recipe.options.lods;
    if lods.is_empty() {
        return Ok((found, warnings));
    }
    scan.sort(progress)?;
    let stage = progress.begin("levels of detail")?;
    let side = Side::of(scan.sorted());
    if !side.visibility.places().is_empty() {
        warnings.note("left out: the levels of detail: the scan is an interior, which is always close", 1);
        return Ok((found, warnings));
    }
    let maker = LevelMaker::new(recipe, (scan, &side), finest)?;
    for (i, wanted) in lods.iter().enumerate() {
        // All inner stages are reported as this one.
        let listener = |_: &'static str, _: f64| stage.at(i as f64 / lods.len() as f64).is_ok();
        let progress = Progress::new(&listener);
        let number = found.len() + 1;
        let before = found.last().map_or(maker.triangles(), |level: &Coarser| level.mesh.triangles().len());
        let most = most_triangles(*wanted, (before, maker.is_named()));
        let made = match *wanted {
            Lod::Triangles(count) => maker.of_triangles((number, count), progress),
            Lod::Pixels(across) => maker.for_pixels((Level { number, across }, most), progress),
        };
        let checked = made.and_then(|level| light(*wanted, level, (most, before)));
        match checked {
            Ok(level) => {
                note(*wanted, &level, &mut warnings);
                push(&mut found, (*wanted, level), &mut warnings);
            }
            Err(error @ (Error::Invalid { .. } | Error::Limit { .. })) => {
                warnings.note(format!("left out: {error}"), 1);
            }
            Err(error) => return Err(error),
        }
    }
    Ok((found, warnings))
}

/// Returns the maximum number of triangles of a level: fewer than the one before has; far fewer, if no requirement names
/// levels.
fn most_triangles(wanted: Lod, (before, is_named): (usize, bool)) -> usize {
    match wanted {
        Lod::Pixels(_) if !is_named => (LIGHTER * before as f64) as usize,
        _ => before.saturating_sub(1),
    }
}

/// Returns a level if it has at most `most` triangles.
fn light(wanted: Lod, level: Coarser, (most, before): (usize, usize)) -> Result<Coarser> {
    let triangles = level.mesh.triangles().len();
    match triangles <= most {
        true => Ok(level),
        false => Err(Error::invalid(
            format!("the level of detail {wanted}"),
            format!("it would have {triangles} triangles, and the one before has {before}"),
        )),
    }
}

/// Notes how a level differs from the requested one.
fn note(wanted: Lod, level: &Coarser, warnings: &mut Warnings) {
    let triangles = level.mesh.triangles().len();
    if let Lod::Triangles(count) = wanted
        && triangles as f64 > NEAR_COUNT * f64::from(count)
    {
        let what = format!(
            "a level of {count} triangles was requested; could not go below {triangles}: seams must be kept"
        );
        warnings.note(what, 1);
    }
    if !level.is_near {
        let least = Lod::LEAST;
        let what = format!(
            "the level of detail {wanted} does not meet the limits of the finest level even when the object fills {least} \
             pixels; it is shown below that size"
        );
        warnings.note(what, 1);
    }
}

/// Adds a level, which takes over from the one before. Earlier ones that would never be shown because of it are
/// removed.
fn push(found: &mut Vec<Coarser>, (wanted, level): (Lod, Coarser), warnings: &mut Warnings) {
    let is_for_pixels = matches!(wanted, Lod::Pixels(_));
    while let Some(last) = found.pop_if(|last| is_for_pixels && last.across <= level.across) {
        let (triangles, across) = (last.mesh.triangles().len(), level.across);
        let what = format!(
            "left out: a level of {triangles} triangles: a lighter one is good enough up to {across} pixels"
        );
        warnings.note(what, 1);
    }
    let before = found.last().map(|last| last.across).filter(|before| *before <= level.across);
    let across = before.map_or(level.across, |before| (f64::from(before) / LATER) as u32).max(1);
    found.push(Coarser { across, ..level });
}

/// A level gets its own normal map if it then has at most this fraction of the triangles.
const FAR_FEWER: f64 = 0.8;
/// The minimum number of triangles tried for a number of pixels.
const FEWEST: u32 = 16;
/// The number of triangle counts tried.
const ROUNDS: usize = 9;
/// Ranges whose ends differ by at most this factor are searched no further.
const CLOSE: f64 = 1.02;
/// The ratio between successive sizes in pixels at which a level of given triangles is tried.
const SIZE_STEP: f64 = std::f64::consts::SQRT_2;

/// The source that levels are simplified from.
enum Source {
    /// A scene of one mesh with its maps, as read back.
    Made(Scene),
    /// The scan, with its relief only in vertex normals.
    Bare,
    Packed(Box<GltfPacker>),
}

impl Source {
    fn of((recipe, scan): (Recipe<'_>, &Scan), finest: &Finest<'_>) -> Result<Self> {
        match finest {
            Finest::Made { low, maps, rounding } => {
                let material = maps.textures.material(&low.material, &low.kept);
                if recipe.options.searches() && !material.has_maps() {
                    return Ok(Self::Bare);
                }
                // Unrounded positions have no transform.
                let format = rounding.map_or_else(GltfFormat::default, Rounding::format);
                let format = GltfFormat { meshopt: false, ..format };
                let levels = [&low.mesh];
                let model = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
                let mut scene = read(taotie_io::encode_glb(&model, &format)?)?;
                if recipe.options.space == NormalSpace::Object {
                    show_object_map(&mut scene, (low, maps))?;
                }
                Ok(Self::Made(scene))
            }
            Finest::Packed(_) => Ok(Self::Packed(Box::new(packer(scan)?.0))),
        }
    }
}

fn read(glb: Vec<u8>) -> Result<Scene> {
    Ok(taotie_io::load_glb(glb, &Limits::of_own_files())?.scene)
}

/// Assigns the object-space normal map next to an asset to a scene.
fn show_object_map(scene: &mut Scene, (low, maps): (&LowPoly, &StoredMaps)) -> Result<()> {
    let map = maps.textures.separate.iter().find(|own| own.map == MapKind::Normal);
    let Some(map) = map else { return Ok(()) };
    let texture = Texture::new(map.bitmap.clone(), Encoding::Normal);
    assign_object_map(scene, None, (&texture, taotie_io::gltf_sampler([&low.mesh])))
}

/// Returns a candidate; `None` if it is unusable.
fn sound<T>(made: Result<T>) -> Result<Option<T>> {
    match made {
        Ok(made) => Ok(Some(made)),
        Err(Error::Invalid { .. } | Error::Limit { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// A mesh and its appearance.
struct Candidate {
    mesh: Mesh,
    look: LevelLook,
}

/// Returns a mesh with fewer triangles on the same uvs, with tangents if the mesh has them.
fn on_uvs(mesh: &Mesh, count: u32, progress: Progress<'_>) -> Result<Mesh> {
    let level = bake::levels(mesh, &[count as usize], progress)?.swap_remove(0).mesh;
    match mesh.tangents().is_empty() {
        true => Ok(level),
        false => Ok(with_frames(&level, 0, None)?.0.into_owned()),
    }
}

/// Makes coarser levels of a finest one.
struct LevelMaker<'a> {
    recipe: Recipe<'a>,
    scan: &'a Scan,
    base: Base<'a>,
    side: &'a Side<'a>,
    source: Source,
    finest: Finest<'a>,
    /// Triangles of the finest level.
    triangles: usize,
}

impl<'a> LevelMaker<'a> {
    /// Prepares the finest level, which is simplified repeatedly.
    pub fn new(
        recipe: Recipe<'a>,
        (scan, side): (&'a Scan, &'a Side<'a>),
        finest: Finest<'a>,
    ) -> Result<Self> {
        // The finest level was made from the same base, which is built only once.
        let base = low_poly::base(scan, recipe.options, &mut Warnings::default(), Progress::SILENT)?;
        let source = Source::of((recipe, scan), &finest)?;
        let triangles = match &finest {
            Finest::Made { low, .. } => low.mesh.triangles().len(),
            Finest::Packed(asset) => read(asset.glb.clone())?.triangle_count(),
        };
        Ok(Self { recipe, scan, base, side, source, finest, triangles })
    }

    /// Returns the number of triangles of the finest level.
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Returns `true` if a requirement of the goal names a coarser level, so that these keep their numbers.
    pub fn is_named(&self) -> bool {
        let goal = self.recipe.options.goal.as_deref().unwrap_or_default();
        goal.iter().any(|required| required.level.is_some_and(|level| level > 0))
    }

    /// Makes a level with this number of triangles, and finds the largest size in pixels at which it meets the
    /// limits; the smallest that is tried if it never does. It gets its own normal map if that meets them at a larger
    /// size.
    pub fn of_triangles(&self, (number, count): (usize, u32), progress: Progress<'_>) -> Result<Coarser> {
        let most = |surface: &bake::Scan| {
            let steps =
                std::iter::successors(Some(f64::from(Lod::FINEST)), |across| Some(across / SIZE_STEP));
            let mut steps =
                steps.map(|across| across.round() as u32).take_while(|across| *across >= Lod::LEAST);
            let keeps = |across: u32| self.workshop(Level { number, across }).ratio(surface) <= 1.0;
            steps.find(|across| keeps(*across)).unwrap_or_default()
        };
        let (shared, surface) = self.simplified(count, progress)?;
        let mut best = (shared, most(&surface));
        let is_open = self.may_rebake() && best.1 < Lod::FINEST;
        if is_open && let Some((rebaked, surface)) = sound(self.rebaked((number, count), progress))? {
            let across = most(&surface);
            if across > best.1 || best.1 == 0 {
                best = (rebaked, across);
            }
        }
        let (Candidate { mesh, look }, across) = best;
        Ok(Coarser { mesh, look, across: across.max(Lod::LEAST), is_near: across > 0 })
    }

    /// Makes the lightest level that meets the limits at this size in pixels, with at most `most` triangles: from the finest
    /// one's, or from scratch.
    ///
    /// # Errors
    /// [`Error::Invalid`] if nothing meets them there.
    pub fn for_pixels(&self, (level, most): (Level, usize), progress: Progress<'_>) -> Result<Coarser> {
        let simplified = match self.source {
            Source::Bare => None,
            _ => self.lightest((level, most), progress)?,
        };
        let fresh = match self.finest {
            Finest::Made { .. } if self.recipe.options.searches() => {
                self.made_from_scratch((level, most), progress)?
            }
            _ => None,
        };
        let best = match (simplified, fresh) {
            (Some(simplified), Some((made, bytes))) => {
                let is_lighter = self.added_bytes(&simplified.mesh)? <= bytes;
                Some(if is_lighter { simplified } else { made })
            }
            (simplified, made) => simplified.or(made.map(|(made, _)| made)),
        };
        match best {
            Some(Candidate { mesh, look }) => Ok(Coarser { mesh, look, across: level.across, is_near: true }),
            None => Err(Error::invalid(
                format!("the level of detail {}", Lod::Pixels(level.across)),
                format!(
                    "no candidate of at most {most} triangles meets the limits of the finest level there"
                ),
            )),
        }
    }

    /// Returns the fewest of the finest level's triangles that meet the limits at this size in pixels, with its maps,
    /// or with a separate normal map if that needs far fewer; `None` if `most` do not.
    fn lightest(&self, (level, most): (Level, usize), progress: Progress<'_>) -> Result<Option<Candidate>> {
        let shared = self.fewest((level, most), &|count| self.simplified(count, progress))?;
        if !self.may_rebake() {
            return Ok(shared);
        }
        let rebaked = self.fewest((level, most), &|count| self.rebaked((level.number, count), progress))?;
        let count =
            |of: &Option<Candidate>| of.as_ref().map_or(f64::INFINITY, |of| of.mesh.triangles().len() as f64);
        Ok(if count(&rebaked) < FAR_FEWER * count(&shared) { rebaked } else { shared })
    }

    /// Returns the fewest triangles that meet the limits at this size in pixels; `None` if about `most` do not.
    fn fewest(
        &self,
        (level, most): (Level, usize),
        made: &dyn Fn(u32) -> Result<(Candidate, bake::Scan)>,
    ) -> Result<Option<Candidate>> {
        let workshop = self.workshop(level);
        let [mut low, mut high] = [f64::from(FEWEST), most as f64];
        let (mut best, mut count) = (None, high.min(self.triangles as f64 * level.part().sqrt()));
        for _ in 0..ROUNDS {
            match sound(made(count as u32))? {
                Some((candidate, surface)) if workshop.ratio(&surface) <= 1.0 => {
                    high = count;
                    best = Some(candidate);
                }
                _ => low = count,
            }
            if high <= CLOSE * low {
                break;
            }
            count = (low * high).sqrt();
        }
        Ok(best)
    }

    /// Makes a level with this number of triangles, and its surface.
    fn simplified(&self, count: u32, progress: Progress<'_>) -> Result<(Candidate, bake::Scan)> {
        progress.at(0.0)?;
        match (&self.source, &self.finest) {
            (Source::Packed(packer), Finest::Packed(asset)) => {
                let part = f64::from(count) / self.triangles as f64;
                let kept = (asset.geometry.kept * part).clamp(f64::MIN_POSITIVE, 1.0);
                let geometry = PackedGeometry { kept, ..asset.geometry };
                let glb = packer.encode(geometry, &asset.images)?;
                let surface = bake::Scan::of_asset(read(glb.clone())?, self.side.surface)?;
                Ok((Candidate { mesh: surface.mesh().clone(), look: LevelLook::Packed(glb) }, surface))
            }
            (Source::Made(scene), Finest::Made { low, .. }) => {
                let mesh = on_uvs(&low.mesh, count, progress)?;
                let (mut scene, on_it) = (scene.clone(), mesh.clone());
                scene.edit(|scene| scene.meshes = vec![on_it])?;
                let surface = bake::Scan::of_asset(scene, self.side.surface)?;
                Ok((Candidate { mesh, look: LevelLook::Shared }, surface))
            }
            _ => self.bare(count, progress),
        }
    }

    /// Returns `true` if levels may get their own normal maps: there is no search, which makes levels from scratch,
    /// and the finest has a tangent-space one, which looks different on other triangles.
    fn may_rebake(&self) -> bool {
        let has_map = matches!(&self.finest, Finest::Made { maps, .. } if maps.textures.normal.is_some());
        has_map && !self.recipe.options.searches() && self.recipe.options.space == NormalSpace::Tangent
    }

    /// Makes a level with this number of triangles and its own normal map on the same uvs, half as wide from level to
    /// level.
    fn rebaked(
        &self,
        (number, count): (usize, u32),
        progress: Progress<'_>,
    ) -> Result<(Candidate, bake::Scan)> {
        let (Source::Made(scene), Finest::Made { low, .. }) = (&self.source, &self.finest) else {
            return self.simplified(count, progress);
        };
        let mesh = on_uvs(&low.mesh, count, progress)?;
        let (origin, material) = (low.origin.clone(), low.material.clone());
        let groups = low.groups.as_ref().map(|groups| Arc::new(groups.carried_over(&low.mesh, &mesh)));
        let (kept, ray_factors) = (KeptTextures::default(), Vec::new());
        let level = LowPoly { mesh, origin, material, kept, own: None, groups, ray_factors, cage: None };
        let options = BakeOptions { maps: vec![MapKind::Normal], ..self.recipe.options.clone() };
        let length = match self.recipe.rays.length {
            RayLength::Uniform(distance) => RayLength::Uniform(distance),
            // A cage has different vertices.
            RayLength::Auto | RayLength::Cage(_) => RayLength::Auto,
        };
        let Rays { skew, uvs, .. } = self.recipe.rays;
        let rays = Rays { length, skew: skew.clone(), uvs: uvs.clone() };
        let size = options.map_size().map(|side| (side >> number.min(16)).next_multiple_of(4).max(16));
        let recipe = Recipe { options: &options, rays: &rays };
        let maps = bake_maps(recipe, size, Pair { scan: self.scan, low: &level }, progress)?;
        let (mut scene, on_it, normal) = (scene.clone(), level.mesh.clone(), maps.textures.normal.clone());
        scene.edit(|scene| {
            scene.meshes = vec![on_it];
            let shown = scene.materials.iter().find_map(|material| material.normal.as_ref());
            if let (Some(shown), Some(normal)) = (shown, normal) {
                scene.textures[shown.texture.texture] = Texture::new(normal, Encoding::Normal);
            }
        })?;
        let surface = bake::Scan::of_asset(scene, self.side.surface)?;
        Ok((Candidate { mesh: level.mesh, look: LevelLook::Rebaked(Box::new(maps)) }, surface))
    }

    /// Simplifies the scan, without maps.
    fn bare(&self, triangles: u32, progress: Progress<'_>) -> Result<(Candidate, bake::Scan)> {
        let mut workshop = self.workshop(Level::FINEST);
        let shape = Shape { triangles, size: 0, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else {
            return Err(workshop.refused.pop_first().map_or(Error::Cancelled, |(_, error)| error));
        };
        let surface = workshop.surface(&draft)?;
        let bits = VertexBits { positions: 14, normals: 10, ..VertexBits::default() };
        let rounding = workshop.rounding(bits, workshop.codecs().least_lossy());
        let made = MadeAsset { low: draft.low, maps: draft.maps, size: 0, rounding };
        Ok((Candidate { mesh: made.low.mesh.clone(), look: LevelLook::Own(Box::new(made)) }, surface))
    }

    /// Searches for a separate mesh and maps, and also returns their bytes; `None` if nothing meets the limits.
    fn made_from_scratch(
        &self,
        (level, most): (Level, usize),
        progress: Progress<'_>,
    ) -> Result<Option<(Candidate, u64)>> {
        let ceiling = Requirement::of(Figure::Triangles, most as f64);
        let goal = self.recipe.options.limits().into_iter().chain([ceiling]).collect();
        let options = BakeOptions { goal: Some(goal), ..self.recipe.options.clone() };
        let found = smallest(Recipe { options: &options, ..self.recipe }, (self.scan, level), progress)?;
        let is_good = |trial: &&Trial| trial.is_near && trial.is_within();
        let chosen = found.trials.iter().find(|trial| trial.is_chosen).filter(is_good);
        let (Some(chosen), Smallest::Made(made)) = (chosen, found.smallest) else { return Ok(None) };
        Ok(Some((Candidate { mesh: made.low.mesh.clone(), look: LevelLook::Own(made) }, chosen.bytes)))
    }

    /// Returns the bytes of a level that shares the maps of the finest.
    fn added_bytes(&self, mesh: &Mesh) -> Result<u64> {
        let Finest::Made { rounding, .. } = &self.finest else { return Ok(0) };
        let format = rounding.map_or_else(GltfFormat::default, Rounding::format);
        Ok(encoded_mesh(mesh, &format)?.len() as u64)
    }

    fn workshop(&self, level: Level) -> Workshop<'_> {
        let required = self.recipe.options.limits();
        let limits = (Goal::of(&required, level.number), Ceilings::of(&required));
        let subject = Subject { scan: self.scan, base: &self.base, side: self.side, level };
        Workshop::new(self.recipe, limits, subject)
    }
}
