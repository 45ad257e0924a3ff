//! The low-poly mesh that is baked onto, given or generated from the scan, with its cage.

use super::scan::Scan;
use crate::asset::ask::{BakeOptions, MeshSource};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;
use taotie_engine::bake::{
    self, Cage, CageGroups, Faults, Floating, MapKind, Remesh, Remeshed, Shells, Simplified, SimplifyMethod,
    SimplifyOptions, UnwrapOptions, UvIndex,
};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::{Bitmap, Texture};
use taotie_engine::length::ShownLength;
use taotie_engine::mesh::{Mesh, MeshData, RELIEF_OF_VERTICES};
use taotie_engine::progress::Progress;
use taotie_engine::scene::{AlphaMode, Material};
use taotie_engine::surface::with_frames;

/// A low-poly mesh, ready to be baked onto.
pub(in crate::asset) struct LowPoly {
    /// With uvs, normals and tangents.
    pub mesh: Mesh,
    pub origin: Origin,
    pub material: Material,
    /// Textures of its material that are kept.
    pub kept: KeptTextures,
    /// The material of the kept file; `None` if the asset is written from scratch.
    pub own: Option<KeptMaterial>,
    /// The objects of the scan that its triangles show; `None` for all.
    pub groups: Option<Arc<CageGroups>>,
    /// The factor of the ray distance at each vertex, from its colour; empty for 1.
    pub ray_factors: Vec<f32>,
    /// Its part of the cage of all meshes of its file; `None` if it is the only one.
    pub cage: Option<Cage>,
}

/// The origin of a low-poly mesh.
///
/// ```
/// use taotie::asset::Origin;
///
/// /// Returns a few words about a low-poly mesh.
/// fn words(origin: &Origin) -> &'static str {
///     match (&origin.simplified, origin.islands) {
///         _ if origin.is_scan => "the scan",
///         (Some(_), _) => "made of the scan",
///         (None, Some(_)) => "given, unwrapped",
///         (None, None) => "given with its uvs",
///     }
/// }
/// ```
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Origin {
    /// `true` if it is the scan itself, packed.
    pub is_scan: bool,
    /// The simplification of the scan; `None` if the mesh was given.
    pub simplified: Option<Simplification>,
    /// UV islands of the atlas, if uvs were generated.
    pub islands: Option<usize>,
    /// Groups of objects that were matched by name, if any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<String>,
}

/// The simplification of a scan.
///
/// ```
/// use taotie::asset::{Asset, Simplification};
///
/// /// Returns the method that an asset's simplification needed.
/// fn method(asset: &Asset) -> Option<&str> {
///     let simplified: &Simplification = asset.origin().simplified.as_ref()?;
///     Some(&simplified.method)
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Simplification {
    /// The method that was needed: `unchanged`, `edge-collapse`, `prune` or `cluster`.
    pub method: String,
    /// The distance of the low-poly mesh from the scan as estimated by the simplifier, model units.
    pub error: f64,
    /// The watertight outer surface that was simplified instead of the scan's own triangles, if it was requested.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remesh: Option<Remesh>,
}

/// A material of a low-poly file that is kept.
#[derive(Debug, Clone, Default)]
pub(in crate::asset) struct KeptMaterial {
    /// Its number in the file.
    pub number: usize,
    /// A label, valid in file names, that distinguishes it from the file's other materials; empty if it is the only
    /// one.
    pub label: String,
    /// The material as the file states it.
    pub said: Material,
    /// `true` if vertex colours are dropped.
    pub drops_colors: bool,
    /// Its triangles among all that the file shows.
    pub triangles: Vec<Range<usize>>,
    /// The tile of its maps, if they are a set of UDIM tiles.
    pub tile: Option<Tile>,
}

/// A UDIM tile of a material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::asset) struct Tile {
    /// 1001 + column + 10 · row, counted from the bottom left.
    pub number: u32,
    /// The label of the material without the tile.
    pub material: String,
}

/// Textures of a low-poly mesh's material that are kept unless something is baked in their place.
#[derive(Clone, Default)]
pub(in crate::asset) struct KeptTextures {
    pub color: Option<Bitmap>,
    pub metallic_roughness: Option<Bitmap>,
    pub occlusion: Option<Bitmap>,
    pub emission: Option<Bitmap>,
}

/// The surface that a low-poly mesh is made from.
pub(in crate::asset) struct Base<'a> {
    pub mesh: Cow<'a, Mesh>,
    /// The remesh, if it is one.
    pub remesh: Option<Remesh>,
}

/// A scan, and the remesh of it that is simplified, if it is one.
#[derive(Clone, Copy)]
pub(in crate::asset) struct MadeFrom<'a> {
    pub scan: &'a Scan,
    pub remesh: Option<&'a Remesh>,
}

/// A scan and the low-poly mesh made for it.
#[derive(Clone, Copy)]
pub(in crate::asset) struct Pair<'a> {
    pub scan: &'a Scan,
    pub low: &'a LowPoly,
}

impl LowPoly {
    /// Unwraps a simplified scan for maps of this size.
    pub fn made(
        from: MadeFrom<'_>,
        simplified: &Simplified,
        size: u32,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let mut low = Self::bare(from, simplified);
        low.mesh = unwrapped(&low.mesh, size, &mut low.origin, progress)?;
        low.mesh = framed(&low.mesh, progress)?;
        Ok(low)
    }

    /// Takes a simplified scan without uvs.
    pub fn bare(MadeFrom { scan, remesh }: MadeFrom<'_>, simplified: &Simplified) -> Self {
        let method = method_name(simplified.method).to_owned();
        let simplification = Simplification { method, error: simplified.error, remesh: remesh.cloned() };
        Self {
            mesh: simplified.mesh.clone(),
            origin: Origin { simplified: Some(simplification), ..Origin::default() },
            material: scan.about.carried.material.clone(),
            kept: KeptTextures::default(),
            own: None,
            groups: None,
            ray_factors: Vec::new(),
            cage: None,
        }
    }

    /// Takes the triangles of a packed scan.
    pub fn packed(mesh: Mesh) -> Self {
        let (origin, material) = (Origin { is_scan: true, ..Origin::default() }, Material::default());
        let (kept, ray_factors) = (KeptTextures::default(), Vec::new());
        Self { mesh, origin, material, kept, own: None, groups: None, ray_factors, cage: None }
    }

    /// Returns the mesh from which the scan is searched for: without its normals if they were fitted, since those of
    /// a thin edge lean to one of its sides.
    pub fn shape(&self) -> Cow<'_, Mesh> {
        let data = || MeshData { normals: Vec::new(), tangents: Vec::new(), ..self.mesh.clone().into_data() };
        let bare = self.origin.simplified.is_some().then(|| Mesh::new(data()));
        bare.and_then(Result::ok).map_or(Cow::Borrowed(&self.mesh), Cow::Owned)
    }

    /// Removes the tangents, which only a normal map needs.
    pub fn without_tangents(self) -> Result<Self> {
        let mesh = Mesh::new(MeshData { tangents: Vec::new(), ..self.mesh.into_data() })?;
        Ok(Self { mesh, ..self })
    }

    /// Returns the alpha mode: that of the scan if its alpha is baked, else its own.
    pub fn alpha(&self, options: &BakeOptions, scan: &Scan) -> AlphaMode {
        match scan.surface().alpha_mode() {
            mode if options.bakes(&[MapKind::Alpha]) && mode != AlphaMode::Opaque => mode,
            _ => self.material.alpha,
        }
    }

    /// Returns a label that distinguishes its material, and tile, from others of the asset; empty if it is the only one.
    pub fn label(&self) -> &str {
        self.own.as_ref().map_or("", |own| &own.label)
    }

    /// Returns the UDIM tile of its maps.
    pub fn tile(&self) -> Option<&Tile> {
        self.own.as_ref()?.tile.as_ref()
    }

    /// Returns the label of its material in file names, which state the tile separately.
    pub fn file_label(&self) -> &str {
        self.tile().map_or(self.label(), |tile| &tile.material)
    }
}

fn method_name(method: SimplifyMethod) -> &'static str {
    match method {
        SimplifyMethod::Kept => "unchanged",
        SimplifyMethod::Collapsed => "edge-collapse",
        SimplifyMethod::Pruned => "prune",
        SimplifyMethod::Clustered => "cluster",
    }
}

/// Returns the surface that a low-poly mesh is made from: the scan's watertight outer surface if that is requested, else
/// its triangles without invisible parts. The changes are noted.
///
/// # Errors
/// Those of [`Scan::remeshed`].
pub(in crate::asset) fn base<'a>(
    scan: &'a Scan,
    options: &BakeOptions,
    warnings: &mut Warnings,
    progress: Progress<'_>,
) -> Result<Base<'a>> {
    if !options.remesh {
        return Ok(Base { mesh: seen(scan, warnings)?, remesh: None });
    }
    let Remeshed { mesh, facts } = scan.remeshed(progress)?;
    let what = format!(
        "remeshed: {} and {} of the scan became {}; holes up to {} wide are closed",
        counted(facts.scan_shells, "separate part"),
        counted(facts.open_borders, "open border"),
        counted(facts.shells, "closed shell"),
        ShownLength::of(facts.closing, scan.unit(), 3)
    );
    warnings.note(what, 1);
    Ok(Base { mesh: Cow::Borrowed(mesh), remesh: Some(facts.clone()) })
}

/// Returns a number of things in words.
fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Returns the scan's triangles without invisible parts, which are noted.
fn seen<'a>(scan: &'a Scan, warnings: &mut Warnings) -> Result<Cow<'a, Mesh>> {
    let Some(shells) = Shells::of(scan.mesh()) else { return Ok(Cow::Borrowed(scan.mesh())) };
    let Some((mesh, share)) = scan.with_sorted(|sorted| shells.without_hidden(sorted))? else {
        return Ok(Cow::Borrowed(scan.mesh()));
    };
    let what = format!(
        "{:.1} % of the scan's area cannot be seen (walls within walls, ghost layers or filled cavities): the \
         low-poly mesh is made without them",
        share * 100.0
    );
    warnings.note(what, 1);
    Ok(Cow::Owned(mesh))
}

/// The representation of an asset's relief.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::asset) enum Relief {
    /// A normal map: the mesh must be close to the scan.
    Map,
    /// Only vertex normals: the mesh needs vertices where normals change.
    Vertices,
}

impl Relief {
    /// Returns the weight of normals in simplification.
    fn normal_weight(self) -> f32 {
        match self {
            Self::Map => 0.0,
            Self::Vertices => RELIEF_OF_VERTICES,
        }
    }
}

/// Simplifies the surface that a low-poly mesh is made from. If a remesh does not stay closed, slightly fewer triangles
/// are tried.
pub(in crate::asset) fn simplified(
    base: &Base<'_>,
    (triangles, relief): (u32, Relief),
    progress: Progress<'_>,
) -> Result<Simplified> {
    /// Further counts, each half a per cent lower.
    const TRIES: usize = 3;
    const STEP: usize = 200;
    let progress = progress.begin("simplify")?;
    let of_count = |count: usize| {
        let options = SimplifyOptions { triangles: count, normal_weight: relief.normal_weight() };
        bake::simplify(&base.mesh, &options, progress)
    };
    let count = triangles as usize;
    let found = of_count(count)?;
    let is_done = |found: &Simplified| base.remesh.is_none() || faulty_edges(&found.mesh) == 0;
    if is_done(&found) {
        return Ok(found);
    }
    for i in 1..=TRIES {
        let other = of_count(count - (i * count).div_ceil(STEP))?;
        if is_done(&other) {
            return Ok(other);
        }
    }
    Ok(found)
}

/// Returns the number of edges that no closed surface has.
fn faulty_edges(mesh: &Mesh) -> usize {
    let faults = Faults::of(mesh);
    faults.open_edges + faults.crowded_edges
}

/// Gives a simplified scan the vertex normals closest to the scan's; sorts the scan if necessary.
pub(in crate::asset) fn fitted(
    scan: &Scan,
    simplified: Simplified,
    progress: Progress<'_>,
) -> Result<Simplified> {
    scan.sort(progress)?;
    progress.begin("fit normals")?;
    let mesh = bake::fit_normals(&simplified.mesh, scan.sorted())?;
    Ok(Simplified { mesh, ..simplified })
}

/// Notes the edges of a low-poly mesh made from a remesh that are no longer closed.
pub(in crate::asset) fn note_opened(low: &LowPoly, warnings: &mut Warnings) {
    if low.origin.simplified.as_ref().is_some_and(|simplified| simplified.remesh.is_some()) {
        let what = "edges of the low-poly mesh that simplification left open or shared by more than two triangles; \
                    a different triangle count may avoid that";
        warnings.note(what, faulty_edges(&low.mesh));
    }
}

/// Notes what simplification removed, and whether it reached the requested count.
pub(in crate::asset) fn note_simplified(simplified: &Simplified, triangles: u32, warnings: &mut Warnings) {
    warnings.absorb(simplified.notes.clone());
    let found = simplified.mesh.triangles().len();
    match simplified.reached {
        true => {}
        false if found < triangles as usize => {
            warnings.note(format!("{triangles} triangles were requested; {found} are left"), 1);
        }
        false => {
            warnings.note(format!("{triangles} triangles were requested; could not go below {found}"), 1)
        }
    }
}

/// Returns the mesh with the uvs of a new atlas, whose islands it counts.
pub(super) fn unwrapped(mesh: &Mesh, size: u32, origin: &mut Origin, progress: Progress<'_>) -> Result<Mesh> {
    let options = UnwrapOptions { size, padding: (size / 512).clamp(2, 16) };
    let unwrapped = bake::unwrap(mesh, &options, progress.begin("unwrap")?)?;
    origin.islands = Some(unwrapped.islands);
    Ok(unwrapped.mesh)
}

/// Returns the mesh with normals and tangents; those of the file are kept.
pub(super) fn framed(mesh: &Mesh, progress: Progress<'_>) -> Result<Mesh> {
    progress.begin("tangents")?;
    Ok(with_frames(mesh, 0, None)?.0.into_owned())
}

/// The projection rays, with the files that the options name.
pub(in crate::asset) struct Rays {
    pub length: RayLength,
    pub skew: Skew,
    /// The scan's triangles by their uvs, if points of the same uv correspond.
    pub uvs: Option<Arc<UvIndex>>,
}

/// The normals that rays follow on flat faces.
#[derive(Clone)]
pub(in crate::asset) enum Skew {
    /// Those of the faces, away from their edges, if the scan does.
    Corrected,
    /// The normals averaged at the vertices.
    Kept,
    /// Those of the triangles where this mask is white.
    Mask(Arc<Texture>),
}

/// The lengths of projection rays.
pub(in crate::asset) enum RayLength {
    /// By the measured gap between the meshes.
    Auto,
    /// One length, model units.
    Uniform(f64),
    Cage(CageMesh),
}

impl Rays {
    /// Returns the cage of a low-poly mesh.
    ///
    /// # Errors
    /// Those of [`Rays::cages`].
    pub fn cage(&self, Pair { scan, low }: Pair<'_>) -> Result<Cage> {
        match &low.cage {
            Some(cage) => Ok(cage.clone()),
            None => Ok(self.cages(scan, &[low])?.remove(0)),
        }
    }

    /// Returns the cages of low-poly meshes that are one surface together: where they meet, their rays do, so that no gap
    /// opens between them.
    ///
    /// # Errors
    /// Those of [`Cage::uniform`] and [`Cage::from_mesh`].
    pub fn cages(&self, scan: &Scan, lows: &[&LowPoly]) -> Result<Vec<Cage>> {
        let shapes: Vec<Cow<'_, Mesh>> = lows.iter().map(|low| low.shape()).collect();
        let whole = match &*shapes {
            [only] => Cow::Borrowed(&**only),
            several => Cow::Owned(Mesh::joined(several.iter().map(|shape| &**shape))?),
        };
        let counts = lows.iter().map(|low| (low.groups.as_ref(), low.mesh.triangles().len()));
        let groups = CageGroups::joined(counts).map(Arc::new);
        let cage = self.of_shape(&whole, (scan, groups), lows)?.with_uvs(self.uvs.clone());
        let is_given = |low: &&LowPoly| low.origin.simplified.is_none() && !low.origin.is_scan;
        let reach = if matches!(self.length, RayLength::Auto) { Cage::reach(&whole) } else { 0.0 };
        let floating = lows.iter().any(is_given).then(|| Arc::new(Floating::above(&whole, reach)));
        let cage = cage.with_floating(floating);
        if let [only] = lows {
            return Ok(vec![cage.scaled(&only.ray_factors)]);
        }
        let (mut vertices, mut triangles) = (0..0, 0..0);
        let part = |low: &&LowPoly| {
            vertices = vertices.end..vertices.end + low.mesh.positions().len();
            triangles = triangles.end..triangles.end + low.mesh.triangles().len();
            cage.part((vertices.clone(), triangles.clone())).scaled(&low.ray_factors)
        };
        Ok(lows.iter().map(part).collect())
    }

    /// Returns the cage of the shape of low-poly meshes.
    fn of_shape(
        &self,
        shape: &Mesh,
        (scan, groups): (&Scan, Option<Arc<CageGroups>>),
        lows: &[&LowPoly],
    ) -> Result<Cage> {
        let is_corrected = matches!(self.skew, Skew::Corrected);
        let cage = match &self.length {
            RayLength::Auto => Cage::automatic_in(shape, scan.sorted(), groups),
            RayLength::Uniform(distance) => {
                let cage = Cage::uniform_in(shape, *distance as f32, groups)?;
                if is_corrected { cage.straightened(shape, scan.sorted()) } else { cage }
            }
            RayLength::Cage(cage) => {
                let made = cage.of(lows).and_then(|outer| Cage::from_mesh(shape, &outer));
                made.map(|made| made.with_groups(groups)).map_err(|error| cage.named(error))?
            }
        };
        Ok(match &self.skew {
            Skew::Corrected => cage,
            Skew::Kept => cage.skewed(),
            Skew::Mask(mask) => cage.straightened_by(Arc::clone(mask)),
        })
    }
}

/// The mesh of a cage.
pub(in crate::asset) struct CageMesh {
    pub mesh: Mesh,
    pub source: MeshSource,
}

impl CageMesh {
    /// Refuses a cage whose number of triangles differs from the low-poly mesh's.
    pub fn check(&self, count: usize) -> Result<()> {
        let own = self.mesh.triangles().len();
        if own == count {
            return Ok(());
        }
        let why = "it must be the low-poly mesh with moved vertices";
        let error = Error::invalid(
            "the cage",
            format!("it has {own} triangles, but the low-poly mesh has {count}; {why}"),
        );
        Err(self.named(error))
    }

    /// Returns the cage of low-poly meshes as one: the same triangles in their order.
    pub fn of(&self, lows: &[&LowPoly]) -> Result<Mesh> {
        let ranges = |low: &&LowPoly| Some(low.own.as_ref()?.triangles.clone());
        match lows.iter().map(ranges).collect::<Option<Vec<_>>>() {
            Some(all) => self.part(&all.concat()),
            None => Ok(self.mesh.clone()),
        }
    }

    /// Returns the cage of a part of the low-poly mesh, given its triangle ranges in the whole.
    fn part(&self, ranges: &[Range<usize>]) -> Result<Mesh> {
        let (positions, all) = (self.mesh.positions().to_vec(), self.mesh.triangles());
        let triangles = ranges.iter().flat_map(|range| all[range.clone()].iter().copied()).collect();
        Mesh::new(MeshData { positions, triangles, ..MeshData::default() })
    }

    /// Returns the error prefixed with the file it concerns.
    pub fn named(&self, error: Error) -> Error {
        match (self.source.path(), error) {
            (Some(path), Error::Invalid { what, why }) => Error::invalid(format!("{path}: {what}"), why),
            (_, error) => error,
        }
    }
}
