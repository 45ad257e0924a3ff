//! A baked asset.

use super::document::Document;
use super::low::{LowPoly, Origin};
use super::maps::StoredMaps;
use super::options::BakeOptions;
use super::packing::Packing;
use super::plan::Left;
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

/// All that a bake made.
pub(super) struct Made {
    /// With the maps that the scan's material needed.
    pub options: Arc<BakeOptions>,
    pub about: Arc<About>,
    /// The files that the low-poly mesh and the cage were read from.
    pub low_files: Vec<PathBuf>,
    /// The low-poly file that stays as it is; `None` where the asset is one mesh of one material.
    pub document: Option<Document>,
    /// The triangles of each material with their maps, at least one.
    pub parts: Vec<Part>,
    /// The levels of detail after the first.
    pub coarser: Vec<Coarser>,
    /// The alpha mode of each triangle of each level, the finest first; empty where all have their material's.
    pub alpha_modes: Vec<Vec<AlphaMode>>,
    /// Texels across and down.
    pub size: [u32; 2],
    pub trials: Vec<Trial>,
    /// What the file loses if a search chose it; `None` if the packing says so.
    pub rounding: Option<Rounding>,
    /// The properties of the scan's material that the asset has.
    pub carried: Vec<Property>,
    pub left: Vec<Left>,
    pub warnings: Warnings,
}

/// The triangles of one material, and the maps that were baked for them.
pub(super) struct Part {
    pub low: LowPoly,
    pub maps: StoredMaps,
}

impl Made {
    /// Returns the packing of its files: what a search chose goes before what is asked for.
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

/// A low-poly mesh with baked maps. Clones share all of it.
///
/// ```
/// use taotie::asset::Asset;
///
/// /// Returns a line about an asset.
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

    /// Returns the levels of detail, the finest first: with uvs, normals and tangents, all materials joined.
    pub fn levels(&self) -> impl Iterator<Item = &Mesh> {
        self.made.levels()
    }

    /// Returns the maps as they are stored; those of the first material where there are several.
    pub fn textures(&self) -> &Textures {
        &self.made.parts[0].maps.textures
    }

    /// Returns the maps of each material, by its name in files; the name is empty where there is but one.
    pub fn texture_sets(&self) -> impl Iterator<Item = (&str, &Textures)> {
        self.made.parts.iter().map(|part| (part.low.label(), &part.maps.textures))
    }

    /// Returns what became of the samples, of all materials.
    pub fn counts(&self) -> BakeCounts {
        let counts = self.made.parts.iter().map(|part| part.maps.counts);
        counts.fold(BakeCounts::default(), BakeCounts::and)
    }

    /// Returns where the low-poly mesh came from.
    pub fn origin(&self) -> &Origin {
        &self.made.parts[0].low.origin
    }

    /// Returns how many texels the maps have across and down.
    pub fn size(&self) -> [u32; 2] {
        self.made.size
    }

    /// Returns the meshes and maps that were tried where an error was wanted.
    pub fn trials(&self) -> &[Trial] {
        &self.made.trials
    }

    /// Returns what is wrong with scan, mesh and maps, or was left out.
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
