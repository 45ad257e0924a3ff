//! The low-poly mesh that is baked onto: given, or generated from the scan.

use super::document::KeptMaterial;
use super::given::Taken;
use super::kept_textures::KeptTextures;
use super::options::{BakeOptions, NEEDS_UVS, SQUARE};
use super::scan::Scan;
use crate::bake::{self, MapKind, Shells, Simplified, SimplifyMethod, SimplifyOptions, UnwrapOptions};
use crate::error::{Error, Result, Warnings};
use crate::mesh::{Mesh, MeshData, RELIEF_OF_VERTICES};
use crate::progress::Progress;
use crate::scene::{AlphaMode, Material};
use crate::surface::with_frames;
use std::borrow::Cow;

/// A low-poly mesh, ready to be baked onto.
pub(super) struct LowPoly {
    /// With uvs, normals and tangents.
    pub mesh: Mesh,
    pub origin: Origin,
    pub material: Material,
    /// Textures of its material that are kept.
    pub kept: KeptTextures,
    /// The material of the kept file; `None` if the asset is written from scratch.
    pub own: Option<KeptMaterial>,
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
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Origin {
    /// `true` if it is the scan itself, packed.
    pub is_scan: bool,
    /// The simplification of the scan; `None` if the mesh was given.
    pub simplified: Option<Simplification>,
    /// UV islands of the atlas, if uvs were generated.
    pub islands: Option<usize>,
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
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Simplification {
    /// The method that was needed: `unchanged`, `edge-collapse`, `prune` or `cluster`.
    pub method: String,
    /// The distance of the low-poly mesh from the scan as estimated by the simplifier, model units.
    pub error: f64,
}

impl LowPoly {
    /// Takes the given mesh, adding uvs if it has none.
    pub fn given(
        taken: Taken,
        options: &BakeOptions,
        warnings: &mut Warnings,
        progress: Progress<'_>,
    ) -> Result<Self> {
        let Taken { mesh, material, kept, own } = taken;
        let mut origin = Origin::default();
        let mesh = match mesh.uvs().is_empty() {
            false => mesh,
            true if options.keep_uvs => return Err(Error::invalid("standalone maps", NEEDS_UVS)),
            true if !options.is_square() => {
                return Err(Error::invalid(options.maps_in_words(), SQUARE));
            }
            true => unwrapped(&mesh, options.size, &mut origin, progress)?,
        };
        note_uvs(&mesh, warnings);
        Ok(Self { mesh: framed(&mesh, progress)?, origin, material, kept, own })
    }

    /// Unwraps a simplified scan for maps of this size.
    pub fn made(scan: &Scan, simplified: &Simplified, size: u32, progress: Progress<'_>) -> Result<Self> {
        let mut low = Self::bare(scan, simplified);
        low.mesh = unwrapped(&low.mesh, size, &mut low.origin, progress)?;
        low.mesh = framed(&low.mesh, progress)?;
        Ok(low)
    }

    /// Takes a simplified scan without uvs.
    pub fn bare(scan: &Scan, simplified: &Simplified) -> Self {
        let method = method_name(simplified.method).to_owned();
        let simplification = Simplification { method, error: simplified.error };
        Self {
            mesh: simplified.mesh.clone(),
            origin: Origin { simplified: Some(simplification), ..Origin::default() },
            material: scan.about.carried.material.clone(),
            kept: KeptTextures::default(),
            own: None,
        }
    }

    /// Takes the triangles of a packed scan.
    pub fn packed(mesh: Mesh) -> Self {
        let (origin, material) = (Origin { is_scan: true, ..Origin::default() }, Material::default());
        Self { mesh, origin, material, kept: KeptTextures::default(), own: None }
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

    /// Returns a label that distinguishes its material from others of the asset; empty if it is the only one.
    pub fn label(&self) -> &str {
        self.own.as_ref().map_or("", |own| &own.label)
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

/// Returns the triangles that a low-poly mesh is made from: the scan's without invisible parts, which are noted.
pub(super) fn seen<'a>(scan: &'a Scan, warnings: &mut Warnings) -> Result<Cow<'a, Mesh>> {
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
pub(super) enum Relief {
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

/// Simplifies the visible part of the scan.
pub(super) fn simplified(
    seen: &Mesh,
    (triangles, relief): (u32, Relief),
    progress: Progress<'_>,
) -> Result<Simplified> {
    let options = SimplifyOptions { triangles: triangles as usize, normal_weight: relief.normal_weight() };
    bake::simplify(seen, &options, progress.begin("simplify")?)
}

/// Gives a simplified scan the vertex normals closest to the scan's; sorts the scan if necessary.
pub(super) fn fitted(scan: &Scan, simplified: Simplified, progress: Progress<'_>) -> Result<Simplified> {
    scan.sort(progress)?;
    progress.begin("fit normals")?;
    let mesh = bake::fit_normals(&simplified.mesh, scan.sorted())?;
    Ok(Simplified { mesh, ..simplified })
}

/// Notes what simplification removed, and whether it reached the requested count.
pub(super) fn note_simplified(simplified: &Simplified, triangles: u32, warnings: &mut Warnings) {
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

fn unwrapped(mesh: &Mesh, size: u32, origin: &mut Origin, progress: Progress<'_>) -> Result<Mesh> {
    let options = UnwrapOptions { size, padding: (size / 512).clamp(2, 16) };
    let unwrapped = bake::unwrap(mesh, &options, progress.begin("unwrap")?)?;
    origin.islands = Some(unwrapped.islands);
    Ok(unwrapped.mesh)
}

/// Returns the mesh with normals and tangents; those of the file are kept.
fn framed(mesh: &Mesh, progress: Progress<'_>) -> Result<Mesh> {
    progress.begin("tangents")?;
    Ok(with_frames(mesh, 0, None)?.0.into_owned())
}

fn note_uvs(mesh: &Mesh, warnings: &mut Warnings) {
    let inside = |v: f32| (0.0..=1.0).contains(&v);
    let outside = mesh.uvs()[0].iter().filter(|uv| !(inside(uv.x) && inside(uv.y))).count();
    warnings.note("vertices of the low-poly mesh with uvs outside the map, which is repeated there", outside);
}
