//! A baked asset.

use super::low::{LowPoly, Origin};
use super::maps::StoredMaps;
use super::options::BakeOptions;
use super::plan::Left;
use super::property::Property;
use super::scan::About;
use super::search_course::Trial;
use super::textures::Textures;
use crate::bake::BakeCounts;
use crate::error::Warnings;
use crate::mesh::Mesh;
use crate::scene::AlphaMode;
use std::sync::Arc;

/// All that a bake made.
pub(super) struct Made {
    /// With the maps that the scan's material needed.
    pub options: Arc<BakeOptions>,
    pub about: Arc<About>,
    pub low: LowPoly,
    /// The levels of detail after the first.
    pub coarser: Vec<Mesh>,
    /// The alpha mode of each triangle of each level, the finest first; empty where all have the material's.
    pub alpha_modes: Vec<Vec<AlphaMode>>,
    pub maps: StoredMaps,
    /// Texels across and down.
    pub size: [u32; 2],
    pub trials: Vec<Trial>,
    /// The properties of the scan's material that the asset has.
    pub carried: Vec<Property>,
    pub left: Vec<Left>,
    pub warnings: Warnings,
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

    /// Returns the levels of detail, the finest first: with uvs, normals and tangents.
    pub fn levels(&self) -> impl Iterator<Item = &Mesh> {
        std::iter::once(&self.made.low.mesh).chain(&self.made.coarser)
    }

    /// Returns the maps as they are stored.
    pub fn textures(&self) -> &Textures {
        &self.made.maps.textures
    }

    /// Returns what became of the samples.
    pub fn counts(&self) -> &BakeCounts {
        &self.made.maps.counts
    }

    /// Returns where the low-poly mesh came from.
    pub fn origin(&self) -> &Origin {
        &self.made.low.origin
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
