//! A surface with replaced texture images.

use super::appearance::{Appearance, MaterialSample};
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use crate::error::Result;
use crate::image::Texture;
use crate::math::Vec3;

/// The triangles of a surface, some of whose textures are replaced.
pub(crate) struct Retextured<'a> {
    surface: &'a Scan,
    appearance: Appearance,
}

impl<'a> Retextured<'a> {
    /// Replaces textures by their index.
    ///
    /// # Errors
    /// As [`crate::image::Bitmap::new`].
    pub fn new(surface: &'a Scan, textures: &[usize], with: &Texture) -> Result<Self> {
        Ok(Self { surface, appearance: surface.surface().retextured(textures, with)? })
    }

    /// Returns the normal with which a renderer shades a point, as [`Scan::seen_normal`] does.
    pub fn seen_normal(&self, at: LookupPoint, toward: Vec3) -> Vec3 {
        let mesh = self.surface.mesh();
        let normal = self.appearance.normal(mesh, at, at.point.normal(mesh)).normal;
        if mesh.faces(at.point.triangle, toward) { normal } else { -normal }
    }

    /// Returns the material at a point, as [`Scan::seen_material`] does.
    pub fn seen_material(&self, at: LookupPoint) -> MaterialSample {
        self.appearance.sample(self.surface.mesh(), at)
    }
}
