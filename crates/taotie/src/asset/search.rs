//! The mesh and map of the fewest bytes whose normals are near enough.

use super::judgement::{Pair, refuse_astray};
use super::low::{self, LowPoly};
use super::maps::{Recipe, StoredMaps, bake_maps};
use super::scan::Scan;
use super::search_course::{Candidate, Course, Trial, Weight};
use crate::bake::{self, Simplified};
use crate::error::{Error, Result, Warnings};
use crate::image::{Encoding, Texture};
use crate::io::{self, GltfAsset, GltfFormat, GltfLevel};
use crate::mesh::Mesh;
use crate::progress::Progress;
use crate::proof::{self, Side};
use crate::scene::{GreenChannel, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// The sizes that are tried: triangles, and texels along a side.
const TRIANGLES: [u32; 9] = [1_000, 2_500, 5_000, 10_000, 20_000, 40_000, 80_000, 150_000, 300_000];
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// The number of pixels at which a trial is measured.
const PIXELS: usize = 20_000;

/// The mesh and map that were found.
pub(super) struct Found {
    pub low: LowPoly,
    pub maps: StoredMaps,
    /// Texels along a side.
    pub size: u32,
    pub trials: Vec<Trial>,
    /// The warnings on the way to it.
    pub warnings: Warnings,
}

/// Tries meshes and maps from the smallest file up. From the first that is near enough its real bytes correct the
/// estimates, and all are tried that may be smaller.
///
/// # Errors
/// [`Error::Invalid`] where none comes within `most` degrees, with the nearest that was found.
pub(super) fn smallest(recipe: Recipe<'_>, scan: &Scan, most: f64, progress: Progress<'_>) -> Result<Found> {
    let total = scan.mesh().triangles().len();
    let (mut candidates, mut course) = (candidates(total), Course::default());
    scan.sort(progress)?;
    let side = Side::of(scan.sorted());
    let (known, mut noted) = (BTreeMap::new(), Warnings::default());
    let seen = low::seen(scan, &mut noted)?;
    let mut search =
        Search { recipe, scan, seen: &seen, side: &side, known, refused: Vec::new(), best: None };
    while let Some(candidate) = course.next(&candidates) {
        let Some((tried, mean_angle)) = search.tried(candidate, progress)? else {
            candidates.retain(|other| other.triangles != candidate.triangles);
            continue;
        };
        let weight = (mean_angle <= most).then(|| tried.weight()).transpose()?;
        if course.add(candidate, mean_angle, weight) {
            search.best = Some(tried);
        }
    }
    let mut refused = search.refused.into_iter();
    match search.best {
        Some(best) => {
            let mut found = best.found(&search.known, course.trials);
            found.warnings.absorb(noted);
            refused.for_each(|error| found.warnings.note(format!("not considered: {error}"), 1));
            Ok(found)
        }
        None if course.trials.is_empty() => {
            Err(refused.next().unwrap_or_else(|| none_near_enough(most, &[], total)))
        }
        None => Err(none_near_enough(most, &course.trials, total)),
    }
}

/// The candidates as they are made.
struct Search<'a> {
    recipe: Recipe<'a>,
    scan: &'a Scan,
    /// The triangles of the scan that meshes are made of.
    seen: &'a Mesh,
    side: &'a Side<'a>,
    /// Maps of several sizes are tried on the same triangles.
    known: BTreeMap<u32, Simplified>,
    /// Why meshes were refused that lost the scan's shape; no map of any size makes up for that.
    refused: Vec<Error>,
    /// The smallest so far.
    best: Option<Tried>,
}

/// A candidate that was made.
struct Tried {
    low: LowPoly,
    maps: StoredMaps,
    candidate: Candidate,
}

impl Search<'_> {
    /// Makes a candidate, and measures the mean angle of its normals; `None` if its mesh lost the scan's shape.
    fn tried(&mut self, candidate: Candidate, progress: Progress<'_>) -> Result<Option<(Tried, f64)>> {
        let Candidate { triangles, size } = candidate;
        let simplified = match self.known.entry(triangles) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(place) => place.insert(low::simplified(self.seen, triangles, progress)?),
        };
        let low = LowPoly::made(self.scan, simplified, size, progress)?;
        let pair = Pair { scan: self.scan, low: &low };
        if let Err(error) = refuse_astray(pair) {
            self.refused.push(error);
            return Ok(None);
        }
        let maps = bake_maps(self.recipe, [size; 2], pair, progress)?;
        let mean_angle = mean_angle(self.side, &low, &maps)?;
        Ok(Some((Tried { low, maps, candidate }, mean_angle)))
    }
}

impl Tried {
    /// Returns what it weighs as a GLB with PNG textures, without further levels of detail.
    fn weight(&self) -> Result<Weight> {
        let levels = [GltfLevel { mesh: &self.low.mesh, coverage: None }];
        let mesh = GltfAsset { levels: &levels, ..GltfAsset::default() };
        let material = self.maps.textures.material(&self.low.material, &self.low.kept);
        let bytes = |asset: &GltfAsset<'_>| -> Result<u64> {
            Ok(io::encode_glb(asset, &GltfFormat::default())?.len() as u64)
        };
        Ok(Weight { mesh: bytes(&mesh)?, all: bytes(&GltfAsset { material, ..mesh })? })
    }

    fn found(self, known: &BTreeMap<u32, Simplified>, trials: Vec<Trial>) -> Found {
        let Candidate { triangles, size } = self.candidate;
        let mut warnings = Warnings::default();
        if let Some(simplified) = known.get(&triangles) {
            low::note_simplified(simplified, triangles, &mut warnings);
        }
        Found { low: self.low, maps: self.maps, size, trials, warnings }
    }
}

/// Returns all candidates that are coarser than a scan of so many triangles.
fn candidates(scan: usize) -> Vec<Candidate> {
    let coarser = TRIANGLES.into_iter().filter(|triangles| (*triangles as usize) < scan);
    coarser.flat_map(|triangles| SIZES.map(|size| Candidate { triangles, size })).collect()
}

fn none_near_enough(most: f64, trials: &[Trial], scan: usize) -> Error {
    let best = trials.iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle));
    let why = match best {
        Some(Trial { triangles, size, mean_angle, .. }) => format!(
            "no mesh and map come so near; the nearest are {triangles} triangles and {size}×{size} texels with \
             {mean_angle:.3}°"
        ),
        None => format!(
            "the scan has {scan} triangles, too few to be simplified; name the number of triangles instead"
        ),
    };
    Error::invalid(format!("a mean normal error of {most}°"), why)
}

/// Returns the mean angle as seen between a candidate and its scan, degrees.
fn mean_angle(scan: &Side<'_>, low: &LowPoly, maps: &StoredMaps) -> Result<f64> {
    let Some(bitmap) = maps.textures.normal.clone() else {
        return Err(Error::invalid("a mean normal error", "it needs a normal map in tangent space"));
    };
    let (space, green, transform) = (NormalSpace::Tangent, GreenChannel::Up, UvTransform::default());
    let texture = TextureRef { texture: 0, uv_set: 0, sampler: io::gltf_sampler([&low.mesh]), transform };
    let normal = Some(NormalMap { texture, scale: 1.0, space, green });
    let mut scene = Scene::of_mesh(low.mesh.clone(), Material::default())?;
    scene.edit(|scene| {
        scene.textures = vec![Texture::new(bitmap, Encoding::Normal)];
        scene.materials =
            vec![Material { normal, double_sided: low.material.double_sided, ..Material::default() }];
    })?;
    let surface = bake::Scan::of_asset(scene, scan.surface)?;
    let asset = Side::of(&surface);
    let diagonal = scan.surface.mesh().diagonal() as f32;
    let pair = proof::Pair { scan, asset: &asset, diagonal, has_material: false };
    let angles = proof::overview(&pair, PIXELS)?.angles;
    Ok(angles.map_or(f64::INFINITY, |angles| angles.summary.mean))
}
