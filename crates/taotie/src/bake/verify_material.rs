//! The error of the material that a low-poly mesh shows against the scan it was baked from.

use super::area_samples::sample_area;
use super::projection::Correspondence;
use super::texture_lookup::LookupPoint;
use super::textured_mesh::TexturedMesh;
use super::verify::Verifier;
use crate::compare::{Field, color_difference};
use crate::error::Result;
use crate::math::Vec3;
use crate::mesh::Point;
use crate::parallel;
use crate::scene::{AlphaMode, Material};

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
    pub(super) fn color_to(&self, shown: &TexturedMesh, point: Point, found: &Correspondence) -> f32 {
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
