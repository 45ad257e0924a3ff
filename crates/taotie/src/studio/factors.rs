//! Factors for every material of a scene.

use crate::error::{Error, Result};
use crate::scene::{Material, Scene};

/// The maximum of factors without their own limit: results computed with it still fit single precision.
const MOST: f32 = 1e9;

/// Factors for every material of a scene; those that are `None` are unchanged. Textures are kept and multiplied by
/// them.
///
/// ```
/// use taotie::mesh::Mesh;
/// use taotie::scene::{Material, Scene};
/// use taotie::studio::MaterialFactors;
///
/// let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let polished = MaterialFactors { metallic: Some(1.0), roughness: Some(0.2), ..MaterialFactors::default() };
/// polished.apply(&mut scene)?;
/// assert_eq!((scene.materials()[0].metallic, scene.materials()[0].roughness), (1.0, 0.2));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(default))]
pub struct MaterialFactors {
    /// Base colour, linear RGB, at least 0.
    pub base_color: Option<[f32; 3]>,
    /// The fraction that reflects as a metal, [0, 1].
    pub metallic: Option<f32>,
    /// Roughness, [0, 1]; α is its square.
    pub roughness: Option<f32>,
    /// Root mean square slope of Beckmann's distribution, above 0; `None` uses α.
    pub slope: Option<f32>,
    /// Exponent of Phong and Blinn-Phong, at least 0; `None` derives it from α.
    pub shininess: Option<f32>,
}

impl MaterialFactors {
    /// Checks ranges.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the first factor that is out of range.
    pub fn check(&self) -> Result<()> {
        for (name, value) in [("metallic", self.metallic), ("roughness", self.roughness)] {
            if value.is_some_and(|v| !(0.0..=1.0).contains(&v)) {
                return Err(Error::invalid(name, "it must be between 0 and 1"));
            }
        }
        if self.shininess.is_some_and(|s| !(0.0..=MOST).contains(&s)) {
            return Err(Error::invalid("shininess", "it must be between 0 and 1e9"));
        }
        if self.slope.is_some_and(|s| !(s > 0.0 && s <= MOST)) {
            return Err(Error::invalid("slope", "it must be above 0 and at most 1e9"));
        }
        if self.base_color.is_some_and(|c| c.iter().any(|v| !(0.0..=MOST).contains(v))) {
            return Err(Error::invalid("base_color", "its components must be between 0 and 1e9"));
        }
        Ok(())
    }

    /// Applies the factors to every material of `scene`.
    ///
    /// # Errors
    /// As [`MaterialFactors::check`].
    pub fn apply(&self, scene: &mut Scene) -> Result<()> {
        if *self == Self::default() {
            return Ok(());
        }
        self.check()?;
        scene.edit(|scene| scene.materials.iter_mut().for_each(|material| self.write_into(material)))
    }

    /// Applies the factors to a material.
    pub(super) fn write_into(&self, material: &mut Material) {
        let [r, g, b, alpha] = material.base_color;
        let [r, g, b] = self.base_color.unwrap_or([r, g, b]);
        material.base_color = [r, g, b, alpha];
        material.metallic = self.metallic.unwrap_or(material.metallic);
        material.roughness = self.roughness.unwrap_or(material.roughness);
        material.classic.slope = self.slope.or(material.classic.slope);
        material.classic.shininess = self.shininess.or(material.classic.shininess);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;

    #[test]
    fn what_is_not_named_stays() {
        let brown = Material { base_color: [0.5, 0.25, 0.1, 0.75], metallic: 0.5, ..Material::default() };
        let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), brown.clone()).unwrap();
        let grey =
            MaterialFactors { base_color: Some([0.2; 3]), slope: Some(0.3), ..MaterialFactors::default() };
        grey.apply(&mut scene).unwrap();
        let mut expected = Material { base_color: [0.2, 0.2, 0.2, 0.75], ..brown };
        expected.classic.slope = Some(0.3);
        assert_eq!(scene.materials()[0], expected);
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let why = |factors: MaterialFactors| factors.check().unwrap_err().to_string();
        let none = MaterialFactors::default();
        assert!(why(MaterialFactors { roughness: Some(1.5), ..none }).starts_with("roughness: "));
        assert!(why(MaterialFactors { metallic: Some(f32::NAN), ..none }).starts_with("metallic: "));
        assert!(why(MaterialFactors { slope: Some(0.0), ..none }).starts_with("slope: "));
        assert!(why(MaterialFactors { shininess: Some(-1.0), ..none }).starts_with("shininess: "));
        assert!(
            why(MaterialFactors { base_color: Some([0.0, 0.0, -0.1]), ..none }).starts_with("base_color: ")
        );
    }
}
