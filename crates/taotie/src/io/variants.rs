//! Material variants: one model in several sets of materials.

use crate::error::{Error, Result};
use crate::scene::Scene;

/// The sets of materials that a file offers for one model: KHR_materials_variants.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Variants {
    pub(super) names: Vec<String>,
    /// The lists of materials by variant.
    pub(super) mappings: Vec<Mapping>,
    /// The mapping of each mesh of the scene; meshes beyond the end have none.
    pub(super) mapping_of_mesh: Vec<Option<usize>>,
    /// The material of each instance of the scene if no variant is chosen.
    pub(super) authored: Vec<usize>,
}

/// Variant and material, by ascending variant.
pub(super) type Mapping = Vec<(usize, usize)>;

impl Variants {
    /// Returns the names, in file order; empty if there are no variants.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Gives every instance of `scene` its material in the variant `name`. Anything that the variant does not mention
    /// gets the material without variants, so the order of calls does not matter. `scene` is the one that was loaded
    /// with this.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no variant with this name; the text lists the existing ones; also if `scene` is
    /// a different one that lacks the material.
    pub fn apply(&self, name: &str, scene: &mut Scene) -> Result<()> {
        let variant = self.names.iter().position(|known| known == name);
        let variant = variant
            .ok_or_else(|| Error::invalid(format!("unknown variant '{name}'"), self.what_there_is()))?;
        let chosen: Vec<Option<usize>> = self.mappings.iter().map(|m| material_in(m, variant)).collect();
        scene.edit(|scene| {
            for (instance, authored) in scene.instances.iter_mut().zip(&self.authored) {
                let mapping = self.mapping_of_mesh.get(instance.mesh).copied().flatten();
                instance.material = mapping.and_then(|mapping| chosen[mapping]).unwrap_or(*authored);
            }
        })
    }

    fn what_there_is(&self) -> String {
        match self.names.is_empty() {
            true => "the file has no variants".into(),
            false => {
                format!("expected one of: {}", self.names.join(", "))
            }
        }
    }
}

fn material_in(mapping: &Mapping, variant: usize) -> Option<usize> {
    let place = mapping.binary_search_by_key(&variant, |(variant, _)| *variant).ok()?;
    Some(mapping[place].1)
}
