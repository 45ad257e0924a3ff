//! Coarser levels of detail: each is as light as keeps the limits of the finest where the object is small on the screen.

use super::ceilings::Ceilings;
use super::goal::Goal;
use super::level::Level;
use super::packed::packer;
use super::smallest::{MadeAsset, PackedAsset, Smallest, smallest};
use super::workshop::{Rounding, Shape, Subject, Workshop, encoded_mesh};
use crate::asset::inputs::Rays;
use crate::asset::judgement::Pair;
use crate::asset::kept_textures::KeptTextures;
use crate::asset::lod::Lod;
use crate::asset::low::{self, LowPoly};
use crate::asset::maps::{Recipe, StoredMaps, bake_maps};
use crate::asset::options::BakeOptions;
use crate::asset::requirement::Requirement;
use crate::asset::scan::Scan;
use crate::bake::{self, MapKind};
use crate::error::{Error, Result, Warnings};
use crate::image::{Encoding, Texture};
use crate::io::{self, GltfAsset, GltfFormat, GltfLevel, GltfPacker, Limits, PackedGeometry, VertexBits};
use crate::mesh::Mesh;
use crate::progress::Progress;
use crate::proof::Side;
use crate::scene::{NormalMap, NormalSpace, Scene};
use crate::surface::with_frames;

/// What coarser levels are made from.
pub(in crate::asset) enum Finest<'a> {
    /// A mesh and its maps, as they are stored, with the loss of its file if a search chose it.
    Made { low: &'a LowPoly, maps: &'a StoredMaps, rounding: Option<Rounding> },
    /// The scan, packed.
    Packed(&'a PackedAsset),
}

/// A coarser level of detail.
pub(in crate::asset) struct Coarser {
    pub mesh: Mesh,
    pub shown: Shown,
    /// The pixels across the object at which it is first shown.
    pub across: u32,
}

/// What a level shows on its mesh.
pub(in crate::asset) enum Shown {
    /// The maps of the finest level.
    Shared,
    /// The same, but a normal map that was baked for it on the same uvs.
    Rebaked(Box<StoredMaps>),
    /// Maps of its own, or none.
    Own(Box<MadeAsset>),
    /// The scan's materials, in a GLB of its own.
    Packed(Vec<u8>),
}

/// Makes the coarser levels that are asked for. One that is hardly lighter than the one before is left out, with one of the
/// warnings that are returned, too.
///
/// # Errors
/// [`Error::Cancelled`]; those of making and reading candidates.
pub(in crate::asset) fn coarser(
    recipe: Recipe<'_>,
    (scan, finest): (&Scan, Finest<'_>),
    progress: Progress<'_>,
) -> Result<(Vec<Coarser>, Warnings)> {
    let mut warnings = Warnings::default();
    if recipe.options.lods.is_empty() {
        return Ok((Vec::new(), warnings));
    }
    scan.sort(progress)?;
    let stage = progress.begin("levels of detail")?;
    let side = Side::of(scan.sorted());
    let seen = low::seen(scan, &mut Warnings::default())?;
    let source = Source::of((recipe, scan), &finest)?;
    let triangles = match &finest {
        Finest::Made { low, .. } => low.mesh.triangles().len(),
        Finest::Packed(asset) => read(asset.glb.clone())?.triangle_count(),
    };
    let maker = Maker { recipe, scan, seen: &seen, side: &side, source, finest, triangles };
    let (mut found, mut before, mut most) = (Vec::new(), triangles, Lod::FINEST);
    for (i, wanted) in recipe.options.lods.iter().enumerate() {
        let number = found.len() + 1;
        let done = i as f64 / recipe.options.lods.len() as f64;
        // All stages of it are this one.
        let listener = |_: &'static str, _: f64| stage.at(done).is_ok();
        let progress = Progress::new(&listener);
        let level = match *wanted {
            Lod::Triangles(count) => maker.of_triangles((number, count), progress)?,
            Lod::Pixels(across) => maker.for_pixels(Level { number, across }, progress)?,
        };
        let triangles = level.mesh.triangles().len();
        let is_light = match wanted {
            Lod::Triangles(_) => triangles < before,
            Lod::Pixels(_) => triangles as f64 <= LIGHTER * before as f64,
        };
        if !is_light {
            let what = format!(
                "the level of detail {wanted} would have {triangles} triangles, the one before has {before}"
            );
            warnings.note(format!("{what}: left out"), 1);
            continue;
        }
        note(*wanted, &level, &mut warnings);
        most = level.across.clamp(Lod::LEAST.min(most), most);
        before = triangles;
        found.push(Coarser { across: most, ..level });
    }
    Ok((found, warnings))
}

/// Notes where a level is not what was wanted.
fn note(wanted: Lod, level: &Coarser, warnings: &mut Warnings) {
    let triangles = level.mesh.triangles().len();
    if let Lod::Triangles(count) = wanted
        && triangles as f64 > NEAR_COUNT * f64::from(count)
    {
        let what = format!(
            "a level of {count} triangles was wanted; could not go below {triangles}: seams must stay"
        );
        warnings.note(what, 1);
    }
    if level.across == 0 {
        let least = Lod::LEAST;
        let what = format!(
            "the level of detail {wanted} keeps no limit of the finest even where the object fills {least} pixels; it is shown \
             below that"
        );
        warnings.note(what, 1);
    }
}

/// A level for a number of pixels has at most this part of the triangles of the one before.
const LIGHTER: f64 = 0.8;
/// Counts that are at most so many times the wanted one are taken for it.
const NEAR_COUNT: f64 = 1.02;
/// A level gets a normal map of its own if it then has at most this part of the triangles.
const FAR_FEWER: f64 = 0.8;
/// The fewest triangles that are tried for a number of pixels.
const FEWEST: u32 = 16;
/// Numbers of triangles that are tried.
const ROUNDS: usize = 9;
/// Pixels at which a level of so many triangles is tried: each so many times the next.
const STEP: f64 = std::f64::consts::SQRT_2;

/// What levels are simplified from.
enum Source {
    /// A scene of one mesh with its maps, as they are read back.
    Made(Scene),
    /// The scan, without what shows its relief but vertex normals.
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
                let format = rounding.map_or_else(GltfFormat::default, Rounding::format);
                let levels = [GltfLevel { mesh: &low.mesh, coverage: None }];
                let model = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
                Ok(Self::Made(read(io::encode_glb(&model, &format)?)?))
            }
            Finest::Packed(_) => Ok(Self::Packed(Box::new(packer(scan)?))),
        }
    }
}

fn read(glb: Vec<u8>) -> Result<Scene> {
    Ok(io::load_glb(glb, &Limits::of_own_files())?.scene)
}

/// A mesh, and what is shown on it.
struct Candidate {
    mesh: Mesh,
    shown: Shown,
}

/// Returns a mesh of fewer triangles on the same uvs, with tangents if the mesh has them.
fn on_uvs(mesh: &Mesh, count: u32, progress: Progress<'_>) -> Result<Mesh> {
    let level = bake::levels(mesh, &[count as usize], progress)?.swap_remove(0).mesh;
    match mesh.tangents().is_empty() {
        true => Ok(level),
        false => Ok(with_frames(&level, 0, None)?.0.into_owned()),
    }
}

struct Maker<'a> {
    recipe: Recipe<'a>,
    scan: &'a Scan,
    seen: &'a Mesh,
    side: &'a Side<'a>,
    source: Source,
    finest: Finest<'a>,
    /// Triangles of the finest level.
    triangles: usize,
}

impl Maker<'_> {
    /// Makes a level of so many triangles, and finds the most pixels at which it keeps the limits; 0 if it never does. It gets
    /// a normal map of its own if that keeps them at more pixels.
    fn of_triangles(&self, (number, count): (usize, u32), progress: Progress<'_>) -> Result<Coarser> {
        let most = |surface: &bake::Scan| {
            let steps = std::iter::successors(Some(f64::from(Lod::FINEST)), |across| Some(across / STEP));
            let mut steps =
                steps.map(|across| across.round() as u32).take_while(|across| *across >= Lod::LEAST);
            let keeps = |across: u32| self.workshop(Level { number, across }).ratio(surface) <= 1.0;
            steps.find(|across| keeps(*across)).unwrap_or_default()
        };
        let (shared, surface) = self.simplified(count, progress)?;
        let mut best = (shared, most(&surface));
        if self.may_rebake() && best.1 < Lod::FINEST {
            let (rebaked, surface) = self.rebaked((number, count), progress)?;
            let across = most(&surface);
            if across > best.1 || across == 0 {
                best = (rebaked, across);
            }
        }
        let (Candidate { mesh, shown }, across) = best;
        Ok(Coarser { mesh, shown, across })
    }

    /// Makes the lightest level that keeps the limits at so many pixels: of the finest one's triangles, or anew.
    fn for_pixels(&self, level: Level, progress: Progress<'_>) -> Result<Coarser> {
        let simplified = match self.source {
            Source::Bare => None,
            _ => self.lightest(level, progress)?,
        };
        let anew = match self.finest {
            Finest::Made { .. } if self.recipe.options.searches() => self.anew(level, progress)?,
            _ => None,
        };
        let best = match (simplified, anew) {
            (Some(simplified), Some((made, bytes))) => {
                let is_lighter = self.added_bytes(&simplified.mesh)? <= bytes;
                Some(if is_lighter { simplified } else { made })
            }
            (simplified, made) => simplified.or(made.map(|(made, _)| made)),
        };
        match best {
            Some(Candidate { mesh, shown }) => Ok(Coarser { mesh, shown, across: level.across }),
            None => self.of_triangles((level.number, self.triangles as u32), progress),
        }
    }

    /// Returns the fewest triangles of the finest level's that keep the limits at so many pixels, with its maps, or with a normal
    /// map of their own if they are far fewer then; `None` if not even all do.
    fn lightest(&self, level: Level, progress: Progress<'_>) -> Result<Option<Candidate>> {
        let shared = self.fewest(level, &|count| self.simplified(count, progress))?;
        if !self.may_rebake() {
            return Ok(shared);
        }
        let rebaked = self.fewest(level, &|count| self.rebaked((level.number, count), progress))?;
        let count =
            |of: &Option<Candidate>| of.as_ref().map_or(f64::INFINITY, |of| of.mesh.triangles().len() as f64);
        Ok(if count(&rebaked) < FAR_FEWER * count(&shared) { rebaked } else { shared })
    }

    /// Returns the fewest triangles that keep the limits at so many pixels; `None` if not even all of the finest level do.
    fn fewest(
        &self,
        level: Level,
        made: &dyn Fn(u32) -> Result<(Candidate, bake::Scan)>,
    ) -> Result<Option<Candidate>> {
        let workshop = self.workshop(level);
        let [mut low, mut high] = [f64::from(FEWEST), self.triangles as f64];
        let (mut best, mut count) = (None, high * level.part().sqrt());
        for _ in 0..ROUNDS {
            let (candidate, surface) = made(count as u32)?;
            if workshop.ratio(&surface) <= 1.0 {
                high = count;
                best = Some(candidate);
            } else {
                low = count;
            }
            if high <= NEAR_COUNT * low {
                break;
            }
            count = (low * high).sqrt();
        }
        Ok(best)
    }

    /// Makes a level of so many triangles, and its surface.
    fn simplified(&self, count: u32, progress: Progress<'_>) -> Result<(Candidate, bake::Scan)> {
        progress.at(0.0)?;
        match (&self.source, &self.finest) {
            (Source::Packed(packer), Finest::Packed(asset)) => {
                let part = f64::from(count) / self.triangles as f64;
                let kept = (asset.geometry.kept * part).clamp(f64::MIN_POSITIVE, 1.0);
                let geometry = PackedGeometry { kept, ..asset.geometry };
                let glb = packer.encode(geometry, &asset.images)?;
                let surface = bake::Scan::of_asset(read(glb.clone())?, self.side.surface)?;
                Ok((Candidate { mesh: surface.mesh().clone(), shown: Shown::Packed(glb) }, surface))
            }
            (Source::Made(scene), Finest::Made { low, .. }) => {
                let mesh = on_uvs(&low.mesh, count, progress)?;
                let (mut scene, on_it) = (scene.clone(), mesh.clone());
                scene.edit(|scene| scene.meshes = vec![on_it])?;
                let surface = bake::Scan::of_asset(scene, self.side.surface)?;
                Ok((Candidate { mesh, shown: Shown::Shared }, surface))
            }
            _ => self.bare(count, progress),
        }
    }

    /// Returns `true` if levels may get normal maps of their own: nothing is searched for, which makes levels anew, and the finest
    /// has one in tangent space, which other triangles bend otherwise.
    fn may_rebake(&self) -> bool {
        let has_map = matches!(&self.finest, Finest::Made { maps, .. } if maps.textures.normal.is_some());
        has_map && !self.recipe.options.searches() && self.recipe.options.space == NormalSpace::Tangent
    }

    /// Makes a level of so many triangles with a normal map of its own on the same uvs, half as wide from level to level.
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
        let level = LowPoly { mesh, origin, material, kept: KeptTextures::default(), own: None };
        let options = BakeOptions { maps: vec![MapKind::Normal], ..self.recipe.options.clone() };
        let rays = match self.recipe.rays {
            Rays::Uniform(distance) => Rays::Uniform(*distance),
            // A cage is one of other vertices.
            Rays::Auto | Rays::Cage(_) => Rays::Auto,
        };
        let size = options.map_size().map(|side| (side >> number).next_multiple_of(4).max(16));
        let recipe = Recipe { options: &options, rays: &rays };
        let maps = bake_maps(recipe, size, Pair { scan: self.scan, low: &level }, progress)?;
        let (mut scene, on_it, normal) = (scene.clone(), level.mesh.clone(), maps.textures.normal.clone());
        scene.edit(|scene| {
            scene.meshes = vec![on_it];
            for shown in scene.materials.iter().filter_map(|material| material.normal.as_ref()) {
                if let (NormalMap { texture, .. }, Some(normal)) = (shown, &normal) {
                    scene.textures[texture.texture] = Texture::new(normal.clone(), Encoding::Normal);
                }
            }
        })?;
        let surface = bake::Scan::of_asset(scene, self.side.surface)?;
        Ok((Candidate { mesh: level.mesh, shown: Shown::Rebaked(Box::new(maps)) }, surface))
    }

    /// Simplifies the scan, without maps.
    fn bare(&self, triangles: u32, progress: Progress<'_>) -> Result<(Candidate, bake::Scan)> {
        let mut workshop = self.workshop(Level::FINEST);
        let shape = Shape { triangles, size: 0, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else {
            return Err(workshop.refused.pop_first().map_or(Error::Cancelled, |(_, error)| error));
        };
        let surface = workshop.surface(&draft)?;
        let rounding = workshop.rounding(VertexBits::default(), workshop.codecs().least_lossy());
        let made = MadeAsset { low: draft.low, maps: draft.maps, size: 0, rounding };
        Ok((Candidate { mesh: made.low.mesh.clone(), shown: Shown::Own(Box::new(made)) }, surface))
    }

    /// Searches for a mesh and maps of their own, and returns their bytes, too; `None` if nothing keeps the limits.
    fn anew(&self, level: Level, progress: Progress<'_>) -> Result<Option<(Candidate, u64)>> {
        let found = smallest(self.recipe, (self.scan, level), progress)?;
        let chosen = found.trials.iter().find(|trial| trial.is_chosen).filter(|trial| trial.is_near);
        let (Some(chosen), Smallest::Made(made)) = (chosen, found.smallest) else { return Ok(None) };
        Ok(Some((Candidate { mesh: made.low.mesh.clone(), shown: Shown::Own(made) }, chosen.bytes)))
    }

    /// Returns the bytes of a level that shares the maps of the finest.
    fn added_bytes(&self, mesh: &Mesh) -> Result<u64> {
        let Finest::Made { rounding, .. } = &self.finest else { return Ok(0) };
        let format = rounding.map_or_else(GltfFormat::default, Rounding::format);
        Ok(encoded_mesh(mesh, &format)?.len() as u64)
    }

    fn workshop(&self, level: Level) -> Workshop<'_> {
        let required = self.recipe.options.goal.clone().unwrap_or_else(Requirement::visually_lossless);
        let limits = (Goal::of(&required, level.number), Ceilings::of(&required));
        let Self { scan, seen, side, .. } = *self;
        Workshop::new(self.recipe, limits, Subject { scan, seen, side, level })
    }
}
