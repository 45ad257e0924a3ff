//! The errors of a low-poly mesh against the scan it was baked from: of its normals, of the material that it shows,
//! and of both on its map, texel by texel.

use super::cage::Cage;
use super::layout::{BAND, Layout};
use super::projection::Correspondence;
use super::scan::Scan;
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use crate::compare::{Field, angle_deg, color_difference};
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use crate::mesh::{Mesh, Point, sample_area};
use crate::parallel;
use crate::scene::{AlphaMode, Material};
use std::borrow::Cow;

/// A low-poly mesh as a viewer shows it, measured along the rays of a bake.
pub struct Verifier<'a> {
    /// The low-poly mesh, with normals.
    pub mesh: &'a Mesh,
    /// The same triangles with their material, whose normals are measured; `None` measures vertex normals.
    pub shown: Option<&'a TexturedMesh>,
    /// The cage from which each of its points is projected onto the scan.
    pub cage: &'a Cage,
    /// The scan that it should match.
    pub scan: &'a Scan,
}

/// The angles between the mesh's normals and those of the scan.
#[derive(Debug, Clone)]
pub struct NormalError {
    /// Degrees, one value for each of many points spread evenly over the low-poly mesh.
    pub angles: Field,
    /// The fraction of points whose projection ray missed the scan, so that its closest point was used: [0, 1].
    pub missed: f64,
    /// The fraction for which that failed too; they have no angle.
    pub lost: f64,
}

impl Verifier<'_> {
    /// Measures the angle between the normal that a viewer shows, the map looked up bilinearly at its finest level,
    /// and the scan's, at `count` points spread evenly over the low-poly mesh's area. The scan's normal and height
    /// maps are read at their finest level, so relief that the low-poly mesh cannot represent counts.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the mesh has no area, no normals, or different triangles from its material.
    pub fn normal_error(&self, count: usize) -> Result<NormalError> {
        self.check(self.shown)?;
        let point = sample_area(self.mesh, count)?;
        let found: Vec<(f32, Way)> = parallel::collect(count, |i| self.angle(point(i)));
        let part = |way: Way| found.iter().filter(|(_, w)| *w == way).count() as f64 / count as f64;
        let angles = found.iter().map(|(angle, _)| *angle).collect();
        Ok(NormalError {
            angles: Field::new(count as u32, 1, angles)?,
            missed: part(Way::Closest) + part(Way::Lost),
            lost: part(Way::Lost),
        })
    }

    fn check(&self, shown: Option<&TexturedMesh>) -> Result<()> {
        let count = |mesh: &Mesh| mesh.triangles().len();
        match shown {
            Some(shown) if count(shown.mesh()) != count(self.mesh) => Err(Error::invalid(
                "the low-poly mesh",
                format!(
                    "it has {} triangles; the mesh of its material has {}",
                    count(self.mesh),
                    count(shown.mesh())
                ),
            )),
            None if self.mesh.normals().is_empty() => {
                Err(Error::invalid("the low-poly mesh", "it has no normals"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the angle between the shown and the expected normal, in degrees; NaN if nothing was found.
    fn angle(&self, point: Point) -> (f32, Way) {
        let (found, way) = self.found(point);
        (found.map_or(f32::NAN, |found| self.angle_to(point, &found)), way)
    }

    /// Returns the angle between the normal shown at a point and the scan's at its correspondence, in degrees.
    fn angle_to(&self, point: Point, found: &Correspondence) -> f32 {
        angle_deg(self.shown(point).to_f64(), self.scan.mapped_normal(found, 0.0).normal.to_f64()) as f32
    }

    /// Returns the point of the scan that corresponds to a point.
    fn found(&self, point: Point) -> (Option<Correspondence>, Way) {
        let projection = self.cage.projection_ray(self.mesh, point);
        match self.scan.project(&projection) {
            Some(found) => (Some(found), Way::Met),
            None => match self.cage.fallback(self.scan, &projection) {
                Some(found) => (Some(found), Way::Closest),
                None => (None, Way::Lost),
            },
        }
    }

    /// Returns the normal that a viewer shows.
    fn shown(&self, point: Point) -> Vec3 {
        let Some(shown) = self.shown else { return point.mean_normal(self.mesh) };
        shown.normal(LookupPoint::finest(point), point.normal(shown.mesh())).normal
    }
}

/// How a point found the scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum Way {
    #[default]
    Met,
    Closest,
    Lost,
}

/// The differences of a material from that of the scan, one value for each of many points spread evenly over the
/// low-poly mesh; NaN if a point found no scan, if a value of either side is not finite, and for colours if either
/// side is invisible.
#[derive(Debug, Clone)]
pub struct MaterialError {
    /// CIEDE2000 between the base colours.
    pub color: Field,
    /// Differences of metallic, [0, 1].
    pub metallic: Field,
    /// Differences of perceptual roughness, [0, 1].
    pub roughness: Field,
    /// Differences of emitted radiance, in the channel that differs most.
    pub emission: Field,
    /// Differences of alpha, [0, 1]: 1 if opaque, 0 or 1 if a mask decides.
    pub alpha: Field,
    /// The fraction of points that found the scan and at which a value of either side is not finite, [0, 1].
    pub not_finite: f64,
}

impl Verifier<'_> {
    /// Measures the material of `shown`, the textures of both sides looked up at their finest levels, at the points
    /// of [`Verifier::normal_error`]. `shown` has the triangles of [`Verifier::mesh`], in the same order.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] if the mesh has no area, or different triangles from `shown`.
    pub fn material_error(&self, shown: &TexturedMesh, count: usize) -> Result<MaterialError> {
        self.check(Some(shown))?;
        let point = sample_area(self.mesh, count)?;
        let found = parallel::collect(count, |i| self.material_difference(shown, point(i)));
        let field = |of: fn(&Difference) -> f32| Field::new(count as u32, 1, found.iter().map(of).collect());
        Ok(MaterialError {
            color: field(|d| d.color)?,
            metallic: field(|d| d.metallic)?,
            roughness: field(|d| d.roughness)?,
            emission: field(|d| d.emission)?,
            alpha: field(|d| d.alpha)?,
            not_finite: found.iter().filter(|d| d.is_broken).count() as f64 / count as f64,
        })
    }

    fn material_difference(&self, shown: &TexturedMesh, point: Point) -> Difference {
        let (Some(found), _) = self.found(point) else { return Difference::default() };
        self.difference_to(shown, point, &found)
    }

    /// Returns the CIEDE2000 between the base colours at a point and at its correspondence on the scan; NaN if one of
    /// them is not finite, or if either side is transparent.
    fn color_to(&self, shown: &TexturedMesh, point: Point, found: &Correspondence) -> f32 {
        self.difference_to(shown, point, found).color
    }

    fn difference_to(&self, shown: &TexturedMesh, point: Point, found: &Correspondence) -> Difference {
        let scan = Shown::of(self.scan.surface(), found.point);
        Shown::of(shown, point).difference(&scan)
    }
}

/// The material that a viewer shows at a point.
struct Shown {
    color: [f32; 3],
    metallic: f32,
    roughness: f32,
    emission: Vec3,
    alpha: f32,
}

impl Shown {
    fn of(mesh: &TexturedMesh, point: Point) -> Self {
        let sample = mesh.sample(LookupPoint::finest(point));
        Self {
            color: sample.color.to_array(),
            metallic: sample.metallic,
            roughness: sample.roughness,
            emission: sample.emission,
            alpha: visible(mesh.material(point.triangle), sample.alpha),
        }
    }

    fn difference(&self, other: &Self) -> Difference {
        let emission = (self.emission - other.emission).to_array().map(f32::abs);
        let is_seen = self.alpha > 0.0 && other.alpha > 0.0;
        let color = if is_seen { color_difference(self.color, other.color) as f32 } else { f32::NAN };
        let metallic = finite((self.metallic - other.metallic).abs());
        let roughness = finite((self.roughness - other.roughness).abs());
        let emission = emission.into_iter().map(finite).fold(0.0, larger);
        let alpha = finite((self.alpha - other.alpha).abs());
        let is_finite = [metallic, roughness, emission, alpha].iter().all(|v| v.is_finite());
        let is_broken = !is_finite || is_seen && color.is_nan();
        Difference { is_broken, color, metallic, roughness, emission, alpha }
    }
}

/// Returns the number itself; NaN if it is not finite.
fn finite(v: f32) -> f32 {
    if v.is_finite() { v } else { f32::NAN }
}

/// Returns the larger number; NaN if either is.
fn larger(a: f32, b: f32) -> f32 {
    if a.is_nan() || a > b { a } else { b }
}

/// Returns the visible fraction of a surface with this alpha, [0, 1].
fn visible(material: &Material, alpha: f32) -> f32 {
    match material.alpha {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
        AlphaMode::Blend => alpha,
    }
}

/// The differences at a point.
#[derive(Clone, Copy)]
struct Difference {
    /// `true` if a visible value is not finite.
    is_broken: bool,
    color: f32,
    metallic: f32,
    roughness: f32,
    emission: f32,
    alpha: f32,
}

impl Default for Difference {
    /// The differences if no scan was found.
    fn default() -> Self {
        let none = f32::NAN;
        Self { is_broken: false, color: none, metallic: none, roughness: none, emission: none, alpha: none }
    }
}

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

/// The factor by which a texel of a width is coarser than the detail at a point of the scan.
type Coarser<'a> = dyn Fn(Point, f32) -> f32 + Sync + 'a;

/// Quantities compared at each texel in addition to normals.
#[derive(Clone, Copy, Default)]
pub struct TexelChecks<'a> {
    /// The material whose colours are compared.
    pub colors: Option<&'a TexturedMesh>,
    /// The material whose texels are compared with the scan's detail, and a function that returns the factor by which they
    /// are coarser, given a point of the scan and the width of a texel, in model units.
    pub coarser: Option<(&'a TexturedMesh, &'a Coarser<'a>)>,
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
            coarser: checks.coarser.map(|_| field(2)).transpose()?,
        }))
    }

    fn errors(&self, point: Point, found: &Correspondence, checks: TexelChecks<'_>) -> [f32; 3] {
        let color = checks.colors.map(|shown| self.color_to(shown, point, found));
        let coarser =
            checks.coarser.and_then(|(shown, coarser)| Some(coarser(found.point, shown.texel_size(point)?)));
        [self.angle_to(point, found), color.unwrap_or(f32::NAN), coarser.unwrap_or(f32::NAN)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_seen_follows_the_mode() {
        let of = |alpha: AlphaMode, value: f32| visible(&Material { alpha, ..Material::default() }, value);
        assert_eq!(of(AlphaMode::Opaque, 0.2), 1.0);
        assert_eq!([0.4, 0.5].map(|v| of(AlphaMode::Mask(0.5), v)), [0.0, 1.0]);
        assert_eq!(of(AlphaMode::Blend, 0.2), 0.2);
    }

    #[test]
    fn every_value_counts_by_itself() {
        let shown = |emission: Vec3, roughness: f32| Shown {
            color: [0.5; 3],
            metallic: 1.0,
            roughness,
            emission,
            alpha: 1.0,
        };
        let d = shown(Vec3::new(1.0, 2.0, 5.0), 0.25).difference(&shown(Vec3::new(3.0, 2.0, 4.0), 0.5));
        assert_eq!((d.color, d.metallic, d.roughness, d.emission, d.alpha), (0.0, 0.0, 0.25, 2.0, 0.0));
        let red = Shown { color: [1.0, 0.0, 0.0], ..shown(Vec3::default(), 0.5) };
        assert!(red.difference(&shown(Vec3::default(), 0.5)).color > 20.0);
        let hidden = Shown { alpha: 0.0, ..red };
        let d = hidden.difference(&shown(Vec3::default(), 0.5));
        assert!(d.color.is_nan() && d.alpha == 1.0 && !d.is_broken, "its colour is invisible");
    }

    #[test]
    fn what_is_not_finite_is_told_and_not_zero() {
        let fine =
            Shown { color: [0.5; 3], metallic: 1.0, roughness: 0.5, emission: Vec3::splat(1.0), alpha: 1.0 };
        for wrong in [f32::NAN, f32::INFINITY] {
            let emission = Vec3::new(wrong, 1.0, 2.0);
            let broken =
                Shown { color: [0.5, wrong, 0.5], metallic: wrong, roughness: wrong, emission, alpha: wrong };
            for d in [fine.difference(&broken), broken.difference(&fine), broken.difference(&broken)] {
                assert!(d.is_broken);
                let numbers = [d.color, d.metallic, d.roughness, d.emission, d.alpha];
                assert!(numbers.iter().all(|v| v.is_nan()), "{numbers:?}");
            }
        }
        assert!(!fine.difference(&fine).is_broken);
    }
}
