//! A baked asset: its parts with their maps, its coarser levels of detail, and the trials of the search that found
//! it.

use super::maps::{StoredMaps, Textures};
use super::plan::DroppedProperty;
use crate::asset::ask::{BakeOptions, Packing};
use crate::asset::source::{About, Document, LowPoly, Origin, Property, ScanNoise};
use std::path::PathBuf;
use std::sync::Arc;
use taotie_engine::bake::{BakeCounts, RayPreview};
use taotie_engine::error::Warnings;
use taotie_engine::length::Unit;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::AlphaMode;
use taotie_io::{CodecSet, GltfFormat, ImageCodec, TextureCodecs, VertexBits};

/// A low-poly mesh with baked maps. Clones share all data.
///
/// ```
/// use taotie::asset::Asset;
///
/// /// Describes an asset in one line.
/// fn line(asset: &Asset) -> String {
///     let triangles: Vec<usize> = asset.levels().map(|mesh| mesh.triangles().len()).collect();
///     let ([width, height], missed) = (asset.size(), asset.counts().missed);
///     format!("{triangles:?} triangles, {width}×{height} texels, {missed} rays missed")
/// }
/// ```
#[derive(Clone)]
pub struct Asset {
    pub(in crate::asset) made: Arc<Made>,
}

impl Asset {
    pub(in crate::asset) fn new(made: Made) -> Self {
        Self { made: Arc::new(made) }
    }

    /// Returns the levels of detail, the finest first: with uvs, normals and tangents, all materials merged.
    pub fn levels(&self) -> impl Iterator<Item = &Mesh> {
        self.made.levels()
    }

    /// Returns the maps as they are stored; those of the first material if there are several.
    pub fn textures(&self) -> &Textures {
        &self.made.parts[0].maps.textures
    }

    /// Returns the maps of each material with its name in files; the name is empty if there is only one.
    pub fn texture_sets(&self) -> impl Iterator<Item = (&str, &Textures)> {
        self.made.parts.iter().map(|part| (part.low.label(), &part.maps.textures))
    }

    /// Returns the outcome of the samples, over all materials.
    pub fn counts(&self) -> BakeCounts {
        let counts = self.made.parts.iter().map(|part| part.maps.counts);
        counts.fold(BakeCounts::default(), BakeCounts::and)
    }

    /// Returns some projection rays of the finest level, in the space of the scan.
    pub fn rays(&self) -> RayPreview {
        let all: Vec<&RayPreview> = self.made.parts.iter().map(|part| &part.maps.rays).collect();
        RayPreview::shared(&all)
    }

    /// Returns the unit of the scan's coordinates; `None` if it is unknown.
    pub fn unit(&self) -> Option<Unit> {
        self.made.about.unit()
    }

    /// Returns the origin of the low-poly mesh.
    pub fn origin(&self) -> &Origin {
        &self.made.parts[0].low.origin
    }

    /// Returns the size of the maps, texels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.made.size
    }

    /// Returns the candidate meshes and maps of a search.
    pub fn trials(&self) -> &[Trial] {
        &self.made.trials
    }

    /// Returns the problems of scan, mesh and maps, and omissions.
    pub fn warnings(&self) -> &Warnings {
        &self.made.warnings
    }
}

impl std::fmt::Debug for Asset {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let triangles: Vec<usize> = self.levels().map(|mesh| mesh.triangles().len()).collect();
        f.debug_struct("Asset")
            .field("triangles", &triangles)
            .field("size", &self.size())
            .finish_non_exhaustive()
    }
}

/// Everything that a bake produced.
pub(in crate::asset) struct Made {
    /// With the maps that the scan's material needed.
    pub options: Arc<BakeOptions>,
    pub about: Arc<About>,
    /// The files that the low-poly mesh and the cage were read from.
    pub low_files: Vec<PathBuf>,
    /// The low-poly file that is kept as is; `None` if the asset is one mesh with one material.
    pub document: Option<Document>,
    /// All triangles of a mesh whose parts are UDIM tiles.
    pub of_tiles: Option<Mesh>,
    /// The triangles of each material with their maps, at least one.
    pub parts: Vec<Part>,
    /// The levels of detail after the first.
    pub coarser: Vec<Coarser>,
    /// The alpha mode of each triangle of each level, the finest first; empty if all have their material's.
    pub alpha_modes: Vec<Vec<AlphaMode>>,
    /// Texels across and down.
    pub size: [u32; 2],
    pub trials: Vec<Trial>,
    /// The loss of the file's formats if a search chose it; `None` if the packing specifies it.
    pub rounding: Option<Rounding>,
    /// The properties of the scan's material that the asset has.
    pub carried: Vec<Property>,
    pub left: Vec<DroppedProperty>,
    /// The scan's noise, if requested; `None` also if it could not be measured.
    pub noise: Option<ScanNoise>,
    pub warnings: Warnings,
}

/// The triangles of one material, and the maps baked for them.
pub(in crate::asset) struct Part {
    pub low: LowPoly,
    pub maps: StoredMaps,
}

impl Made {
    /// Returns the packing of its files: a search's choice overrides the requested one.
    pub fn packing(&self, asked: &Packing) -> Packing {
        match self.rounding {
            Some(rounding) => asked.clone().with_format(&rounding.format()),
            None => asked.clone(),
        }
    }

    /// Returns the meshes of all levels, the finest first.
    pub fn levels(&self) -> impl Iterator<Item = &Mesh> {
        std::iter::once(self.mesh()).chain(self.coarser.iter().map(|level| &level.mesh))
    }

    /// Returns all triangles of the finest level.
    pub fn mesh(&self) -> &Mesh {
        let whole = self.document.as_ref().and_then(|document| document.whole.as_ref());
        self.of_tiles.as_ref().or(whole).unwrap_or(&self.parts[0].low.mesh)
    }
}

/// A coarser level of detail.
pub(in crate::asset) struct Coarser {
    pub mesh: Mesh,
    pub look: LevelLook,
    /// The pixels across the object at which it is first shown.
    pub across: u32,
    /// `true` if it meets the limits of the finest level there.
    pub is_near: bool,
}

/// The maps or materials that a level shows on its mesh.
pub(in crate::asset) enum LevelLook {
    /// The maps of the finest level.
    Shared,
    /// The same, except for a normal map baked for it on the same uvs.
    Rebaked(Box<StoredMaps>),
    /// Its own maps, or none.
    Own(Box<MadeAsset>),
    /// The scan's materials, in a separate GLB.
    Packed(Vec<u8>),
}

/// A mesh and maps.
pub(in crate::asset) struct MadeAsset {
    pub low: LowPoly,
    pub maps: StoredMaps,
    /// Texels along a side; 0 without maps.
    pub size: u32,
    /// The loss of the file's formats.
    pub rounding: Rounding,
}

/// The loss of a file's formats.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in crate::asset) struct Rounding {
    pub bits: VertexBits,
    pub images: TextureCodecs,
    pub codecs: CodecSet,
}

impl Rounding {
    /// Returns the format of its file.
    pub fn format(self) -> GltfFormat {
        let Self { bits, images, codecs } = self;
        GltfFormat { images, for_page: false, meshopt: true, codecs, bits }
    }
}

/// A file made by a search, and its measurements.
///
/// ```
/// use taotie::asset::{Asset, Trial};
///
/// /// Returns the trial closest to the scan.
/// fn nearest(asset: &Asset) -> Option<&Trial> {
///     asset.trials().iter().min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))
/// }
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Trial {
    /// `true` if it is the scan itself, packed, with its nodes, materials, uvs and textures; otherwise it was made
    /// from the scan.
    pub is_scan: bool,
    /// `true` if it became the asset.
    pub is_chosen: bool,
    /// Triangles.
    pub triangles: usize,
    /// Texels along a side of its maps; for a packed scan, along the longest side of any; 0 if it has none.
    pub size: u32,
    /// `true` if it has a normal map.
    pub has_normal_map: bool,
    /// The format of its normal map; for a packed scan with several, of the first that was re-encoded; `None` if
    /// there is none.
    pub normals: Option<ImageCodec>,
    /// The bits of its vertices.
    pub bits: VertexBits,
    /// The mean angle between its normals and the scan's as seen, degrees.
    pub mean_angle: f64,
    /// The 95th percentile of these angles, degrees.
    pub p95_angle: f64,
    /// The mean colour difference as seen, CIEDE2000; `None` if the scan has no colours.
    pub mean_color: Option<f64>,
    /// The 95th percentile of these differences.
    pub p95_color: Option<f64>,
    /// The ratio of a figure of its angles to the limit, the largest one if several are limited.
    pub angle_ratio: f64,
    /// The same for colours.
    pub color_ratio: Option<f64>,
    /// The largest ratio of its triangles or graphics memory to a ceiling; 0 without ceilings.
    pub ceiling_ratio: f64,
    /// `true` if it is close enough to the scan, and within all ceilings.
    pub is_near: bool,
    /// Its bytes as a GLB of one level of detail, without metadata.
    pub bytes: u64,
    /// Its bytes on a graphics card; see [`GltfSizes`](taotie_io::GltfSizes).
    pub gpu_bytes: u64,
}

impl Trial {
    /// The kinds of assets: with a normal map, without one, and the packed scan.
    pub const KINDS: [&'static str; 3] = ["a normal map", "no normal map", "the packed scan"];

    /// Returns its kind, one of [`Trial::KINDS`].
    pub fn kind(&self) -> &'static str {
        match self {
            Self { is_scan: true, .. } => Self::KINDS[2],
            Self { has_normal_map: true, .. } => Self::KINDS[0],
            _ => Self::KINDS[1],
        }
    }

    /// Converts ratios to limits multiplied by `factor` into ratios to the limits themselves.
    pub(in crate::asset) fn scale(&mut self, factor: f64) {
        self.angle_ratio *= factor;
        self.color_ratio = self.color_ratio.map(|ratio| ratio * factor);
        self.judge();
    }

    /// Decides whether it is close enough.
    pub(in crate::asset) fn judge(&mut self) {
        self.is_near = self.ratio() <= 1.0 && self.is_within();
    }

    /// Returns `true` if it is within all ceilings.
    pub fn is_within(&self) -> bool {
        self.ceiling_ratio <= 1.0
    }

    /// Returns the largest ratio of its differences to their limits; at most 1 is close enough.
    pub fn ratio(&self) -> f64 {
        self.angle_ratio.max(self.color_ratio.unwrap_or_default())
    }
}
