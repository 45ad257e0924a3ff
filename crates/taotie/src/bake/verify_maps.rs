//! The errors of a low-poly mesh on its map, texel by texel.

use super::layout::{BAND, Layout};
use super::projection::Correspondence;
use super::textured_mesh::TexturedMesh;
use super::verify::Verifier;
use crate::compare::Field;
use crate::error::{Error, Result};
use crate::math::Vec2;
use crate::mesh::Point;
use crate::parallel;
use std::borrow::Cow;

/// The errors at the centre of each texel of a map; NaN between UV islands, and if no scan was found.
#[derive(Debug, Clone)]
pub struct ErrorMaps {
    /// Degrees between the shown normals and the scan's.
    pub angles: Field,
    /// CIEDE2000 between the base colours; also NaN if either side is transparent; `None` if they were not compared.
    pub colors: Option<Field>,
    /// The width of the finest texture's texels relative to the scan's detail; NaN without textures.
    pub coarser: Option<Field>,
}

/// Quantities compared at each texel in addition to normals.
#[derive(Clone, Copy, Default)]
pub struct TexelChecks<'a> {
    /// The material whose colours are compared.
    pub colors: Option<&'a TexturedMesh>,
    /// The material whose texels are compared with the width of the finest detail at a point of the scan, in model
    /// units.
    pub detail: Option<(&'a TexturedMesh, &'a (dyn Fn(Point) -> f32 + Sync))>,
}

impl Verifier<'_> {
    /// Measures the errors at the centre of each texel of a map of this size, along the rays of
    /// [`Verifier::normal_error`]. They are laid out like the maps of the material, by [`TexturedMesh::map_places`].
    /// `None` if a triangle spans more than 16 copies of the map: a pattern that repeats so often has no error map.
    ///
    /// # Errors
    /// As [`Verifier::normal_error`]; [`Error::Invalid`] if the mesh has no uvs.
    pub fn error_maps(&self, size: [u32; 2], checks: TexelChecks<'_>) -> Result<Option<ErrorMaps>> {
        self.check(self.shown)?;
        self.check(checks.colors.or(self.shown))?;
        let shown = self.shown.or(checks.colors);
        let mesh = shown.map_or(self.mesh, TexturedMesh::mesh);
        let own = || mesh.uvs().first().map_or(&[][..], Vec::as_slice).into();
        let places: Cow<'_, [Vec2]> = shown.map_or_else(own, TexturedMesh::map_places);
        if places.is_empty() {
            return Err(Error::invalid("the low-poly mesh", "it has no uvs"));
        }
        let errors = |point: Point| match self.found(point) {
            (Some(found), _) => self.errors(point, &found, checks),
            (None, _) => [f32::NAN; 3],
        };
        let layout = match Layout::new(mesh, &places, size, 1) {
            Err(Error::Limit { .. }) => return Ok(None),
            layout => layout?,
        };
        let mut values = vec![[f32::NAN; 3]; size[0] as usize * size[1] as usize];
        parallel::pieces(&mut values, (BAND * size[0]) as usize, &|band, values| {
            layout.triangle_samples(band, |group| {
                for sample in &group.samples {
                    values[sample.texel as usize] = errors(group.point(sample));
                }
            });
        });
        let field = |i: usize| Field::new(size[0], size[1], values.iter().map(|errors| errors[i]).collect());
        Ok(Some(ErrorMaps {
            angles: field(0)?,
            colors: checks.colors.map(|_| field(1)).transpose()?,
            coarser: checks.detail.map(|_| field(2)).transpose()?,
        }))
    }

    fn errors(&self, point: Point, found: &Correspondence, checks: TexelChecks<'_>) -> [f32; 3] {
        let color = checks.colors.map(|shown| self.color_to(shown, point, found));
        let coarser = checks.detail.and_then(|(shown, detail)| {
            let texel = shown.texel_size(point)?;
            Some(texel / detail(found.point))
        });
        [self.angle_to(point, found), color.unwrap_or(f32::NAN), coarser.unwrap_or(f32::NAN)]
    }
}
