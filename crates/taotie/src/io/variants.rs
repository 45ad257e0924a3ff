//! Material variants: one model in several sets of materials.

use crate::error::{Error, Result};
use crate::scene::Scene;

/// The sets of materials that a file offers for one model: KHR_materials_variants.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Variants {
    pub(super) names: Vec<String>,
    /// The lists of materials by variant.
    pub(super) mappings: Vec<Mapping>,
    /// The mapping of each mesh of the scene; meshes beyond its end have none.
    pub(super) mapping_of_mesh: Vec<Option<usize>>,
    /// The material of each instance of the scene where no variant is chosen.
    pub(super) authored: Vec<usize>,
}

/// Variant and material, in rising order of variant.
pub(super) type Mapping = Vec<(usize, usize)>;

impl Variants {
    /// Returns the names, in the order of the file; empty where it has no variants.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Gives every instance of `scene` the material that it has in the variant `name`. What the variant does not
    /// mention has the material of a file without variants, so the order of calls does not count. `scene` is the one
    /// that was loaded with this.
    ///
    /// # Errors
    /// [`Error::Invalid`] where there is no variant of this name; the text lists those that there are; also where
    /// `scene` is another one, which lacks the material.
    pub fn apply(&self, name: &str, scene: &mut Scene) -> Result<()> {
        let variant = self.names.iter().position(|known| known == name);
        let variant =
            variant.ok_or_else(|| Error::invalid(format!("variant '{name}'"), self.what_there_is()))?;
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
                format!("the file has no such variant; it has: {}", self.names.join(", "))
            }
        }
    }
}

fn material_in(mapping: &Mapping, variant: usize) -> Option<usize> {
    let place = mapping.binary_search_by_key(&variant, |(variant, _)| *variant).ok()?;
    Some(mapping[place].1)
}
