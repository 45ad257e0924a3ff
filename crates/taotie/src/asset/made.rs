//! A baked asset.

use super::document::Document;
use super::low::{LowPoly, Origin};
use super::maps::StoredMaps;
use super::options::BakeOptions;
use super::packing::Packing;
use super::plan::DroppedProperty;
use super::property::Property;
use super::scan::About;
use super::search::{Coarser, Rounding, Trial};
use super::textures::Textures;
use crate::bake::BakeCounts;
use crate::error::Warnings;
use crate::mesh::Mesh;
use crate::scene::AlphaMode;
use std::path::PathBuf;
use std::sync::Arc;

/// Everything that a bake produced.
pub(super) struct Made {
    /// With the maps that the scan's material needed.
    pub options: Arc<BakeOptions>,
    pub about: Arc<About>,
    /// The files that the low-poly mesh and the cage were read from.
    pub low_files: Vec<PathBuf>,
    /// The low-poly file that is kept as is; `None` if the asset is one mesh with one material.
    pub document: Option<Document>,
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
    pub warnings: Warnings,
}

/// The triangles of one material, and the maps baked for them.
pub(super) struct Part {
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
        whole.unwrap_or(&self.parts[0].low.mesh)
    }
}

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
    pub(super) made: Arc<Made>,
}

impl Asset {
    pub(super) fn new(made: Made) -> Self {
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
