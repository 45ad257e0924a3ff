//! The requested materials: a variant, a preset or a TOML file, and maps.

use super::factors::MaterialFactors;
use super::maps::MapOptions;
use super::material_file::MaterialFile;
use crate::error::Result;
use crate::io::Limits;
use crate::scene::{GreenChannel, Scene, SceneData, preset};
use std::path::PathBuf;

/// The requested materials; by default those of the file.
///
/// ```
/// use taotie::mesh::Mesh;
/// use taotie::scene::{Material, Scene};
/// use taotie::studio::MaterialOptions;
///
/// let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let bronze = MaterialOptions { material: Some("bronze".into()), ..MaterialOptions::default() };
/// bronze.apply(&mut scene)?;
/// assert_eq!(scene.materials()[0].metallic, 1.0);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct MaterialOptions {
    /// A variant of the file: one of the sets of materials that it contains. [`super::load`] chooses it.
    pub variant: Option<String>,
    /// A preset's name, or a TOML file's path; see [`MaterialFile`].
    pub material: Option<String>,
    /// Factors for every material, replacing those of the file or of `material`.
    pub factors: MaterialFactors,
    /// Maps for every material.
    pub maps: MapOptions,
    /// `Down` makes green point down in every normal map, including the file's own; `Up` leaves each unchanged.
    pub green: GreenChannel,
}

impl MaterialOptions {
    /// Applies the material, the factors and the maps to every material of `scene`.
    ///
    /// # Errors
    /// As [`MaterialFile::choose`], [`MaterialFile::apply`] and [`MaterialFactors::apply`], and those of the maps.
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        self.apply_within(scene, &Limits::default())
    }

    /// Like [`MaterialOptions::apply`], within limits of memory and pixels.
    pub(super) fn apply_within(&self, scene: &mut Scene, limits: &Limits) -> Result<()> {
        if let Some(choice) = &self.material {
            MaterialFile::choose(choice)?.apply_within(scene, limits)?;
        }
        self.factors.apply(scene)?;
        self.maps.apply_within(scene, limits)?;
        if self.green == GreenChannel::Down {
            scene.edit(point_down)?;
        }
        Ok(())
    }

    /// Returns the files that are read for the materials: a TOML file, its maps, and the requested maps.
    ///
    /// # Errors
    /// As [`MaterialFile::choose`].
    pub fn files(&self) -> Result<Vec<PathBuf>> {
        let mut files = self.maps.files();
        if let Some(choice) = self.material.as_ref().filter(|choice| preset(choice).is_none()) {
            files.push(PathBuf::from(choice));
            files.extend(MaterialFile::choose(choice)?.files());
        }
        Ok(files)
    }
}

/// Makes green point down in every normal map.
fn point_down(scene: &mut SceneData) {
    for material in &mut scene.materials {
        let coat = material.clearcoat.as_mut().and_then(|coat| coat.normal.as_mut());
        material.normal.iter_mut().chain(coat).for_each(|map| map.green = GreenChannel::Down);
    }
}
