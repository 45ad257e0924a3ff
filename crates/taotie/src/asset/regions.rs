//! The worst parts of an asset: of its UV islands, and of its materials.

use crate::bake::TexturedMesh;
use crate::error::Result;
use crate::proof::{CloseUp, Pair, WorstRegions};
use crate::surface::uv_islands;

/// The UV islands and materials of an asset that differ most from the scan, seen close up.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct WorstParts {
    /// The worst of its UV islands; `None` without uvs, or if there is only one.
    pub islands: Option<WorstRegions>,
    /// The worst of its materials; `None` if there is only one.
    pub materials: Option<WorstRegions>,
    /// The names of the materials, in the order of their numbers; empty if there is only one.
    pub material_names: Vec<String>,
}

impl WorstParts {
    /// Compares the parts of an asset.
    ///
    /// # Errors
    /// Those of [`WorstRegions::of`].
    pub(super) fn of(pair: &Pair<'_>, of_asset: &CloseUp) -> Result<Self> {
        let asset = pair.asset.surface.surface();
        let mesh = asset.mesh();
        let worst = |labels: Vec<u32>| -> Result<Option<WorstRegions>> {
            match labels.iter().any(|label| *label != labels[0]) {
                true => WorstRegions::of(pair, of_asset, &labels).map(Some),
                false => Ok(None),
            }
        };
        let islands = if mesh.uvs().is_empty() { None } else { worst(uv_islands(mesh))? };
        let numbers = 0..mesh.triangles().len() as u32;
        let materials = worst(numbers.map(|t| asset.material_number(t) as u32).collect())?;
        let material_names = materials.as_ref().map_or_else(Vec::new, |_| names(asset));
        Ok(Self { islands, materials, material_names })
    }
}

/// Returns the names of the materials in the order of the first triangles that use them.
fn names(asset: &TexturedMesh) -> Vec<String> {
    let mut numbers: Vec<usize> = Vec::new();
    let mut names = Vec::new();
    for t in 0..asset.mesh().triangles().len() as u32 {
        let number = asset.material_number(t);
        if !numbers.contains(&number) {
            numbers.push(number);
            names.push(match asset.material(t).name.as_str() {
                "" => format!("material {number}"),
                name => name.to_owned(),
            });
        }
    }
    names
}
